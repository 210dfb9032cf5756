"""Figures of ground motions, and of analyses of many runs: IDA, stripes, fragility."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from rbsdem._types import Axes
from rbsdem.errors import InputError
from rbsdem.many.fragility import Capacities, Counts, Fragility
from rbsdem.many.ida import IDA, Stripes
from rbsdem.many.runs import Runs
from rbsdem.motions.motion import GroundMotion, Spectrum
from rbsdem.output.style import MODEL_LINE, Line, axes_or_new, line_of

_RECORD: Line = {"color": "0.72", "linewidth": 0.5}
_POINT: Line = {"color": "0.35", "marker": ".", "linestyle": "none", "markersize": 4}
_COLLAPSE: Line = {"color": "#c0392b", "marker": "x", "linestyle": "none"}
_STYLES = ("--", "-", "--")
#: Colours of several curves in one figure.
_COLOURS = ("#1f77b4", "#2ca02c", "#e67e22", "#c0392b", "#6c3483", "#000000")


def ida(analysis: IDA, *, edp: str | None = None, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the curve of every record, its collapse, and the 16, 50 and 84 % fractiles.

    Parameters
    ----------
    analysis : IDA
        The analysis.
    edp : str, optional
        Measure of the response, by default `Runs.drift_measure`.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    **line
        Keywords of the lines of the fractiles.
    """
    edp = edp or analysis.runs.drift_measure
    percent = 100.0 if edp.endswith("drift") else 1.0
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        for column, motion in np.ndindex(analysis.lower.shape):
            level, response = analysis.curve(motion, list(analysis.runs.columns)[column], edp)
            stands = np.isfinite(response)
            drawn.plot(percent * response[stands], level[stands], **_RECORD)
            if not stands.all():
                last = percent * response[stands][-1]
                drawn.plot([last], [level[stands][-1]], **_COLLAPSE, markersize=3)
        level, fractiles = analysis.fractiles(edp=edp)
        for values, style, name in zip(fractiles, _STYLES, ("16 %", "50 %", "84 %"), strict=True):
            stands = np.isfinite(values)
            look = line_of(MODEL_LINE | {"linestyle": style, "label": name}, line)
            x, y = percent * values[stands], level[stands]
            drawn.plot(np.append(0.0, x), np.append(0.0, y), **look)
        if ax is None:
            _label_response(drawn, edp, analysis.runs)
            drawn.set_ylim(bottom=0)
            drawn.set_xlim(left=0)
            drawn.legend()
    return drawn


def stripes(
    analysis: Stripes, *, edp: str | None = None, ax: Axes | None = None, **line: Any
) -> Axes:
    """Draw the response of every run over its level; collapses stand at the right edge.

    Parameters
    ----------
    analysis : Stripes
        The analysis.
    edp : str, optional
        Measure of the response, by default `Runs.drift_measure`.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    **line
        Keywords of the points.
    """
    edp = edp or analysis.runs.drift_measure
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        _points(drawn, analysis.runs, edp, line)
        if ax is None:
            _label_response(drawn, edp, analysis.runs)
    return drawn


def fragility(
    fitted: Fragility, *, level: float = 0.9, ax: Axes | None = None, **line: Any
) -> Axes:
    """Draw the curve, its confidence band and the data that it was fitted to.

    Parameters
    ----------
    fitted : Fragility
        The curve.
    level : float, optional
        Confidence of the band; 0 draws none.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    **line
        Keywords of the curve.
    """
    width = max(fitted.beta, 0.05)
    x = fitted.theta * np.exp(np.linspace(-2.8 * width, 2.8 * width, 200))
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        look = line_of(MODEL_LINE | {"label": fitted.name}, line)
        curve = drawn.plot(x, fitted.probability(x), **look)[0]
        if level:
            # Where the bootstrap determines no band none is drawn.
            with suppress(InputError):
                low, high = fitted.band(x, level)
                drawn.fill_between(x, low, high, color=curve.get_color(), alpha=0.15, linewidth=0)
        at, share = _shares(fitted)
        drawn.plot(at, share, **_POINT | {"color": curve.get_color()})
        if ax is None:
            drawn.set(xlabel=fitted.intensity_name, ylabel="Probability", ylim=(0, 1.02))
            drawn.set_xlim(left=0)
            drawn.set_title(f"{fitted.name}: θ = {fitted.theta:.3g}, β = {fitted.beta:.2f}")
    return drawn


def fragilities(
    curves: Mapping[str, Fragility], *, level: float = 0.9, ax: Axes | None = None
) -> Axes:
    """Draw the curves of several limit states in one figure.

    Parameters
    ----------
    curves : mapping of Fragility
        The curves by name.
    level : float, optional
        Confidence of the bands; 0 draws none.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    """
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        for number, (name, curve) in enumerate(curves.items()):
            label = f"{name}: θ = {curve.theta:.3g}, β = {curve.beta:.2f}"
            colour = _COLOURS[number % len(_COLOURS)]
            fragility(curve, level=level, ax=drawn, label=label, color=colour)
        if ax is None and curves:
            drawn.set(xlabel=next(iter(curves.values())).intensity_name, ylabel="Probability")
            drawn.set_ylim(0, 1.02)
            drawn.set_xlim(left=0)
            drawn.legend()
    return drawn


def _shares(fitted: Fragility) -> tuple[Any, Any]:
    """Return intensities, and the share of runs that reached the limit state there."""
    if isinstance(fitted.data, Counts):
        return fitted.data.intensity, fitted.data.failures / fitted.data.number
    if isinstance(fitted.data, Capacities):
        values = np.sort(fitted.data.values[np.isfinite(fitted.data.values)])
        return values, (np.arange(values.size) + 0.5) / fitted.data.size
    return np.empty(0), np.empty(0)


def _points(ax: Axes, runs: Runs, edp: str, line: Line) -> None:
    """Draw the response of each run over its intensity; collapses at the right edge."""
    percent = 100.0 if edp.endswith("drift") else 1.0
    response = percent * runs.response(edp)
    stands = np.isfinite(response)
    ax.plot(response[stands], runs.intensity[stands], **line_of(_POINT, line))
    if not stands.all():
        edge = 1.1 * response[stands].max() if stands.any() else 1.0
        right = np.full((~stands).sum(), edge)
        ax.plot(right, runs.intensity[~stands], **_COLLAPSE, markersize=4, label="collapse")


def _label_response(ax: Axes, edp: str, runs: Runs) -> None:
    """Label the axes of response and intensity."""
    name = edp.replace("_", " ").capitalize()
    ax.set(xlabel=f"{name} (%)" if edp.endswith("drift") else name, ylabel=runs.measure.label)


def motion(motion: GroundMotion, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the acceleration over time.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    **line
        Keywords of the line.
    """
    with axes_or_new(ax, (6.0, 2.2)) as drawn:
        default = MODEL_LINE | {"linewidth": 0.7, "label": motion.name}
        drawn.plot(motion.time, motion.acceleration, **line_of(default, line))
        if ax is None:
            drawn.set(xlabel="Time (s)", ylabel="Acceleration (m/s²)", title=motion.name)
    return drawn


def spectrum(spectrum: Spectrum, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the pseudo-acceleration over the period.

    Parameters
    ----------
    spectrum : Spectrum
        The spectrum.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones with logarithmic scales.
    **line
        Keywords of the line.
    """
    with axes_or_new(ax) as drawn:
        drawn.plot(spectrum.period, spectrum.pseudo_acceleration, **line_of(MODEL_LINE, line))
        if ax is None:
            drawn.set(xlabel="Period (s)", ylabel="Pseudo-acceleration (m/s²)")
            drawn.set(xscale="log", yscale="log", title=f"Damping {100 * spectrum.damping:g} %")
    return drawn
