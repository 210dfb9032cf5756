"""Force-displacement loops: mm and kN, the model over the test, and what is told of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike, Axes, NDArray
from rbsdem.calibration.fit import Calibration
from rbsdem.checks.code_values import CodeComparison
from rbsdem.curves.envelope import Envelope, Method
from rbsdem.curves.metrics import Curve, loop_pair
from rbsdem.curves.scores import Comparison
from rbsdem.errors import InputError
from rbsdem.model.column import bodies
from rbsdem.output.style import (
    MODEL_LINE,
    TEST_LINE,
    TEST_POINTS,
    ZERO_LINE,
    AxesArray,
    Line,
    axes_or_new,
    drift_axis,
    keep_letters,
    line_of,
    new_axes,
    style,
    style_of,
)
from rbsdem.output.units import factor, labelled
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.limit_states import LimitStates
from rbsdem.run.rows import ENERGIES, Result

FIGURE_SIZE = (6.9, 6.0)

_MARKERS = "os^Dv<>phX*P8"
_STATE: Line = {"ls": "none", "ms": 5.0, "mfc": "white", "mec": "black", "mew": 0.9, "zorder": 5}

#: Lines of the backbones, told apart in print without colour.
_BACKBONES: dict[str, Line] = {
    "ASCE 41": {"ls": "-", "marker": "s"},
    "EC 8-3": {"ls": (0, (5, 1.5)), "marker": "o"},
    "Elwood": {"ls": (0, (1.2, 1.2)), "marker": "^"},
    "Haselton": {"ls": (0, (5, 1.2, 1, 1.2)), "marker": "D"},
}
_BACKBONE: Line = {"color": "black", "lw": 1.0, "ms": 3.2, "mfc": "white", "zorder": 4}
_AT_ZERO: Line = {"ls": "none", "ms": 6.0, "mec": "black", "mew": 0.8, "zorder": 5}
#: Drifts of damage: row of the table, column of the table, label, fill.
_DAMAGE = (
    ("spalling", "model", "spalling, model", "white"),
    ("spalling", "Berry", "spalling, Berry, Eberhard", "black"),
    ("bar_buckling", "model", "bar buckling, model", "white"),
    ("bar_buckling", "Berry", "bar buckling, Berry, Eberhard", "black"),
    ("bar_buckling", "Goodnight", "bar buckling, Goodnight et al.", "0.6"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Subplot:
    """The contents of one panel of `four_panels`.

    Attributes
    ----------
    title : str
        Name of the specimen, without the letter of the panel.
    model, test : Curve
        Objects with `displacement` and `force`, or pairs of arrays [m, N].
    height : float, optional
        Height of the column for the axis of drift ratios [m].
    test_points : bool, default False
        Draw the test as single points, where only its reversal points are known.
    """

    title: str
    model: Curve
    test: Curve
    height: float | None = None
    test_points: bool = False


def loop(
    curve: Curve | ArrayLike,
    force: ArrayLike | None = None,
    *,
    height: float | None = None,
    ax: Axes | None = None,
    **line: Any,
) -> Axes:
    """Draw one force-displacement loop.

    Parameters
    ----------
    curve : Result, PeerTest, pair of arrays, or array_like of shape (n,)
        The loop, or its displacements [m]. That of a response in time is the base shear against the
        displacement of the top.
    force : array_like, shape (n,), optional
        Forces [N], if `curve` holds displacements.
    height : float, optional
        Height of the column [m]; adds an axis of drift ratios on top.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, limits symmetric about zero.

    Raises
    ------
    InputError
        If displacements and forces differ in length or are empty.

    Examples
    --------
    >>> ax = loop([0.0, 0.01, 0.0], [0.0, 2.0e5, -1.0e5])
    >>> ax.get_xlabel()
    'Top displacement (mm)'
    """
    shaken = force is None and isinstance(curve, ColumnResult) and curve.dynamic
    d, f = _curve((curve, force) if force is not None else curve, "the loop")
    with axes_or_new(ax) as drawn:
        drawn.plot(d, f, **line_of(MODEL_LINE, line))
        _dress(drawn, height)
        if shaken:
            drawn.set_ylabel(labelled("Base shear", "N"))
    return drawn


def loops_over_test(
    model: Curve,
    test: Curve,
    *,
    title: str | None = None,
    height: float | None = None,
    test_points: bool = False,
    legend: bool = True,
    ax: Axes | None = None,
    **line: Any,
) -> Axes:
    """Draw a computed loop over the measured one: solid black over dashed gray, as in figure 3.

    Parameters
    ----------
    model, test : Result, PeerTest or pair of arrays
        The two loops [m, N].
    title : str, optional
        Written in the upper left corner, which a loop leaves empty.
    height : float, optional
        Height of the column [m]; adds an axis of drift ratios on top.
    test_points : bool, default False
        Draw the test as single points, where only its reversal points are known.
    legend : bool, default True
        Say which line is which.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the model's line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, limits symmetric about zero.

    Raises
    ------
    InputError
        If displacements and forces differ in length or are empty.
    """
    measured = _curve(test, "the test")
    computed = _curve(model, "the model")
    with axes_or_new(ax) as drawn:
        drawn.plot(*measured, label="Test", **(TEST_POINTS if test_points else TEST_LINE))
        drawn.plot(*computed, **line_of(MODEL_LINE | {"label": "Model"}, line))
        _dress(drawn, height)
        if title:
            at = drawn.transAxes
            drawn.text(0.035, 0.955, title, transform=at, ha="left", va="top", zorder=5)
        if legend:
            drawn.legend(loc="lower right", handlelength=2.4)
    return drawn


def four_panels(
    panels: Sequence[Subplot], *, test_label: str = "Test", model_label: str = "Model"
) -> AxesArray:
    """Draw up to four loops over their tests, (a) to (d), in one figure.

    Parameters
    ----------
    panels : sequence of Subplot
        One to four panels, in the order (a) to (d).
    test_label, model_label : str
        Texts of the legend below the panels.

    Returns
    -------
    ndarray of matplotlib.axes.Axes
        The panels, in a figure 175 mm wide; `save` writes it.

    Raises
    ------
    InputError
        If there are no panels or more than four, or if displacements and forces of one differ in
        length or are empty.
    """
    if not 1 <= len(panels) <= 4:
        raise InputError(f"four_panels: {len(panels)} panels; give one to four")
    from matplotlib.figure import Figure  # noqa: PLC0415
    from matplotlib.layout_engine import ConstrainedLayoutEngine  # noqa: PLC0415

    rows = 1 if len(panels) <= 2 else 2
    with style():
        # Not through pyplot: a script that draws many figures then keeps none of them open.
        figure = Figure(
            figsize=(FIGURE_SIZE[0], FIGURE_SIZE[1] * (rows / 2 + 0.04 * (2 - rows))),
            layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05, wspace=0.04, hspace=0.03),
        )
        grid = figure.subplots(rows, 2, squeeze=False).ravel()
        for ax in grid[len(panels) :]:
            ax.remove()
        for letter, ax, panel in zip("abcd", grid, panels, strict=False):
            look: Any = {"height": panel.height, "test_points": panel.test_points, "legend": False}
            title = f"({letter}) {panel.title}"
            loops_over_test(panel.model, panel.test, title=title, ax=ax, **look)
        look = {"loc": "outside lower center", "ncols": 2, "handlelength": 3.2}
        handles = grid[0].get_lines()[:2]
        figure.legend(handles, [test_label, model_label], columnspacing=3.0, **look)
        # Ticks and layout take their style when they are first drawn.
        figure.draw_without_rendering()
    return grid[: len(panels)]


def envelope(envelope: Envelope, *, method: Method | None = None, ax: Axes | None = None) -> Axes:
    """Draw an envelope, and its idealisation dashed if a method is given.

    Parameters
    ----------
    envelope : Envelope
        The envelope.
    method : str, optional
        As for `Envelope.idealise`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    with axes_or_new(ax) as drawn:
        x, y = envelope.displacement * factor("m"), envelope.force * factor("N")
        drawn.plot(x, y, **MODEL_LINE)
        if method is not None:
            lines = envelope.idealise(method)
            corners = np.array([0.0, lines.yield_displacement, lines.end_displacement])
            path = corners * factor("m"), lines.force(corners) * factor("N")
            drawn.plot(*path, **TEST_LINE, label=lines.source)
            at = lines.yield_displacement * factor("m"), lines.yield_force * factor("N")
            drawn.plot(*at, **TEST_POINTS | {"color": "black"})
            drawn.legend(loc="lower right")
        drawn.set_xlim(left=0.0, auto=True)
        drawn.set_ylim(bottom=0.0, auto=True)
        drawn.set(xlabel=labelled("Top displacement", "m"), ylabel=labelled("Lateral force", "N"))
    return drawn


def limit_states(states: LimitStates, *, ax: Axes | None = None) -> Axes:
    """Draw the loop thin and gray, and a marker for each limit state.

    Parameters
    ----------
    states : LimitStates
        The limit states, as `Result.limit_states` returns them.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    result = states.result
    with axes_or_new(ax, (4.6, 3.4)) as drawn:
        loop(result, height=result.structure.height, ax=drawn, color="0.55", linewidth=0.6)
        for state, marker in zip(states, _MARKERS, strict=False):
            at = factor("m") * state.displacement, factor("N") * state.force
            name = state.name.replace("_", " ")
            drawn.plot(*at, marker=marker, label=name, **_STATE)
        if len(states):
            drawn.legend(loc="upper left", fontsize=6.5, handletextpad=0.2, borderaxespad=0.3)
    return drawn


def comparison(comparison: Comparison, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the loop of the model over that of the test.

    Parameters
    ----------
    comparison : rbsdem.curves.scores.Comparison
        The comparison, as `rbsdem.compare` returns it.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the model's line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    title = f"{comparison.name}\nNRMSE {comparison.nrmse:.3f}"
    return _over_test(comparison, title, ax, line)


def _over_test(scores: Comparison, title: str, ax: Axes | None, line: Line) -> Axes:
    """Draw the loop of the model over that of the test under a title."""
    test = scores.displacement, scores.test_force
    height = scores.height if scores.height > 0 else None
    return loops_over_test(scores.model_curve, test, title=title, height=height, ax=ax, **line)


def calibration(
    fit: Calibration[Any], *, axes: Sequence[Axes] | AxesArray | None = None, **line: Any
) -> AxesArray:
    """Draw the loops before and after a calibration over the test, to the same scale.

    Parameters
    ----------
    fit : Calibration
        The calibration, as `rbsdem.calibrate` returns it.
    axes : sequence of 2 matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the model's line, as for ``Axes.plot``.

    Returns
    -------
    ndarray of matplotlib.axes.Axes
        Before and after.
    """
    if axes is None:
        axes = new_axes(1, 2, (6.9, 3.2))
    if len(axes) != 2:
        raise InputError(f"calibration: plot: {len(axes)} axes; give two, for before and after")
    names = ("(a) before", "(b) after")
    for ax, name, scores in zip(axes, names, (fit.before, fit.after), strict=True):
        _over_test(scores, f"{name}: NRMSE {scores.nrmse:.3f}", ax, line)
    highest = max(ax.get_ylim()[1] for ax in axes)
    for ax in axes:
        ax.set_ylim(-highest, highest)
    return np.asarray(axes)


def code_comparison(compared: CodeComparison, *, ax: Axes | None = None) -> Axes:
    """Draw the loop, the test if there is one, the backbones, and drifts of damage.

    Parameters
    ----------
    compared : CodeComparison
        The comparison, as `rbsdem.codes.compare` returns it.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    result = compared.result
    height = result.column.height
    with axes_or_new(ax, (6.2, 3.4)) as drawn:
        if compared.test is not None:
            d, f = compared.test
            drawn.plot(100 * d / height, factor("N") * f, **TEST_LINE, label="test")
        drift, force = 100 * result.drift, factor("N") * result.loop_force
        drawn.plot(drift, force, color="0.6", linewidth=0.6, zorder=2.5, label="model")
        for line in compared.backbones:
            strength = factor("N") * line.force(compared.span, compared.leaning)
            way = _above_zero(100 * line.drift, strength)
            drawn.plot(*way, label=line.name, **_BACKBONE, **_BACKBONES[line.name])
        drifts = compared.to_pandas()
        for row, source, label, fill in _DAMAGE:
            if source in drifts and np.isfinite(drifts.loc[row, source]):
                look: Line = {"marker": "v" if row == "spalling" else "P", "mfc": fill}
                drawn.plot(100 * drifts.loc[row, source], 0.0, label=label, **_AT_ZERO, **look)
        drawn.axhline(0.0, **ZERO_LINE)
        drawn.axvline(0.0, **ZERO_LINE)
        drawn.margins(x=0.03, y=0.06)
        force_name = labelled("Base shear" if result.dynamic else "Lateral force", "N")
        drawn.set(xlabel="Drift ratio (%)", ylabel=force_name)
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=7.5, handlelength=3.0)
    return drawn


def _above_zero(drift: Array, force: Array) -> tuple[Array, Array]:
    """Return a backbone up to where second-order moments have used up its strength."""
    below = np.flatnonzero(force < 0)
    if below.size == 0:
        return drift, force
    end = int(below[0])
    share = force[end - 1] / (force[end - 1] - force[end])
    last = drift[end - 1] + share * (drift[end] - drift[end - 1])
    return np.append(drift[:end], last), np.append(force[:end], 0.0)


def _curve(curve: Any, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return displacements and forces on paper of a result, a test or a pair of arrays."""
    names = (f"{name}: displacements", f"{name}: forces")
    d, f = map(_arguments.vector, loop_pair(curve, name), names)
    if d.shape != f.shape or d.size == 0:
        raise InputError(
            f"{name}: displacements have shape {d.shape}, forces {f.shape}; "
            f"they must be vectors of one length"
        )
    return d * factor("m"), f * factor("N")


def _dress(ax: Axes, height: float | None) -> None:
    """Give axes limits symmetric about zero, zero lines, labels, and drift ratios on top."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    # Lines across the axes, such as those through zero, have no extent of their own.
    lines = [line for line in ax.get_lines() if line.get_transform() == ax.transData]
    points = [np.asarray(line.get_xydata(), dtype=np.float64) for line in lines]
    reach = np.nanmax(np.abs(np.vstack(points)), axis=0)
    x, y = (1.08 * value if value > 0 else 1.0 for value in reach)
    ax.set(xlim=(-x, x), ylim=(-y, y))
    if not any(line.get_gid() == "zero" for line in ax.get_lines()):
        ax.axhline(0.0, gid="zero", **ZERO_LINE)
        ax.axvline(0.0, gid="zero", **ZERO_LINE)
    for axis in (ax.xaxis, ax.yaxis):
        # More ticks will be made, perhaps in another style than that in which the axes were.
        keep_letters(axis, axis)
    steps = [1, 2, 2.5, 5, 10]
    ax.xaxis.set_major_locator(MaxNLocator(nbins=7, symmetric=True, steps=steps))
    ax.yaxis.set_major_locator(MaxNLocator(nbins=9, symmetric=True, steps=steps))
    ax.set(xlabel=labelled("Top displacement", "m"), ylabel=labelled("Lateral force", "N"))
    ax.tick_params(right=True, top=height is None)
    if height is not None:
        height = _arguments.number(height, "height")
        if not height > 0:
            raise InputError(f"height = {height} m; give a positive height for the drift ratios")
        drift_axis(ax, height)


Over = Literal["displacement", "drift", "force", "base_shear", "base_moment"]

#: Quantities that are drawn over time, and their units.
_OVER = {
    "displacement": ("Top displacement", "m"),
    "drift": ("Drift ratio", "drift"),
    "force": ("Lateral force", "N"),
    "base_shear": ("Base shear", "N"),
    "base_moment": ("Base moment", "N m"),
}

#: Grays and dashes for several lines on one pair of axes, legible in print.
_LINES: tuple[Line, ...] = (
    {"color": "black", "linestyle": "-"},
    {"color": "black", "linestyle": "--"},
    {"color": "0.5", "linestyle": "-"},
    {"color": "0.5", "linestyle": "--"},
    {"color": "0.5", "linestyle": ":"},
    {"color": "black", "linestyle": ":"},
)

_ENERGY_LABELS = {
    "input": "input",
    "kinetic": "kinetic",
    "spring": "springs",
    "damping": "damping",
    "axial": "axial load and weight",
}


def history(
    result: Result, over: Over = "displacement", *, ax: Axes | None = None, **line: Any
) -> Axes:
    """Draw a response over time, or over the points of a static path.

    Parameters
    ----------
    result : Result
        The response, of a building along its direction.
    over : {"displacement", "drift", "force", "base_shear", "base_moment"}, optional
        The quantity, in mm, %, kN and kN m; a building has no base moment.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    InputError
        If `over` is none of these.
    """
    _arguments.instance(result, "history: result", Result)
    over = _arguments.choice(over, "over", [name for name in _OVER if hasattr(result, name)])
    words, unit = _OVER[over]
    with axes_or_new(ax, (5.2, 2.4)) as drawn:
        drawn.plot(result.time, factor(unit) * getattr(result, over), **line_of(MODEL_LINE, line))
        if not any(each.get_gid() == "zero" for each in drawn.get_lines()):
            drawn.axhline(0.0, gid="zero", **ZERO_LINE)
        _along(result, drawn, labelled(words, unit))
    return drawn


def _along(result: Result, ax: Axes, label: str) -> None:
    """Dress axes whose x is the time, or the points of a path."""
    ax.set_xlim(result.time[0], max(result.time[-1], result.time[0] + 1e-9))
    ax.set(xlabel="Time (s)" if result.dynamic else "Point of the path", ylabel=label)
    ax.tick_params(right=True, top=True)


def energy(result: Result, *, ax: Axes | None = None) -> Axes:
    """Draw the energies of a response over time; those that stay zero are left out.

    Parameters
    ----------
    result : Result
        The response.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, energies in kJ. "springs" is stored and dissipated.
    """
    with axes_or_new(ax, (5.2, 2.8)) as drawn:
        names = [name for name in ENERGIES if name != "residual" and np.any(result.energy[name])]
        for name, line in zip(names, _LINES, strict=False):
            values = result.energy[name] * factor("J")
            drawn.plot(result.time, values, **line, lw=0.8, label=_ENERGY_LABELS[name])
        _along(result, drawn, labelled("Energy", "J"))
        if names:
            drawn.legend(loc="best", handlelength=2.4)
    return drawn


def profile(
    result: ColumnResult,
    time: ArrayLike | None = None,
    *,
    axes: Sequence[Axes] | AxesArray | None = None,
) -> AxesArray:
    """Draw drift, shear and moment over the height at chosen moments.

    The displacement of a body is straight between its ends, with a step where a joint slips. Shears
    and moments are those of the joints' springs, at the heights of the joints; the moment of the
    top is zero.

    Parameters
    ----------
    result : Result
        The response.
    time : array_like, optional
        The moments [s], up to six; in a static analysis numbers of points. By default the moment
        of the largest displacement of the top.
    axes : sequence of 3 matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    ndarray of matplotlib.axes.Axes
        For the drift, the shear and the moment.

    Raises
    ------
    InputError
        If a moment is outside of the rows, or there are more than six.
    """
    if time is None:
        moments = np.array([result.time[np.argmax(np.abs(result.displacement))]])
    else:
        moments = _arguments.finite_vector(np.atleast_1d(time), "time")
    if not 1 <= moments.size <= len(_LINES):
        raise InputError(f"time has {moments.size} moments; give one to {len(_LINES)}")
    states = [result.at(float(moment)) for moment in moments]
    if axes is None:
        axes = new_axes(1, 3, (6.9, 3.0))
    elif len(axes) != 3:
        raise InputError(f"axes has {len(axes)} of them; give three, for drift, shear and moment")
    height = result.column.height
    joints = np.concatenate(([0.0], np.cumsum(_lengths(result))))
    with style_of(axes[0]):
        for moment, state, line in zip(moments, states, _LINES, strict=False):
            name = f"{moment:g} s" if result.dynamic else f"point {moment:g}"
            places, moved = _displacements(state, joints)
            axes[0].plot(100 * moved / height, places, **line, lw=0.9, label=name)
            shear = np.append(state["shear"], state["shear"][-1]) * factor("N")
            axes[1].step(shear, joints, **line, lw=0.9)
            axes[2].plot(np.append(state["moment"], 0.0) * factor("N m"), joints, **line, lw=0.9)
        labels = "Drift (%)", labelled("Shear", "N"), labelled("Moment", "N m")
        for ax, label in zip(axes, labels, strict=True):
            ax.axvline(0.0, **ZERO_LINE)
            ax.set(ylim=(0.0, height), xlabel=label)
            ax.tick_params(right=True, top=True)
        axes[0].set_ylabel("Height (m)")
        axes[0].legend(loc="best", handlelength=2.0)
    return np.asarray(axes)


def _lengths(result: ColumnResult) -> Array:
    """Return the lengths above the joints from the ground up: footing, bodies, support [m]."""
    column = result.column
    lengths, *_ = bodies(column)
    beneath = () if column.footing is None else (column.footing.height,)
    # The support of a fixed top has no length.
    above = (0.0,) if column.top == "fixed" else ()
    return np.array([*beneath, *lengths, *above], dtype=np.float64)


def _displacements(state: dict[str, Any], joints: Array) -> tuple[Array, Array]:
    """Return heights and displacements of the ground and of both ends of each body [m].

    `state` is a row of the result, `joints` the heights of the joints and of the top. To first
    order in the rotations, and scaled so that the top has its displacement.
    """
    turned = np.cumsum(state["rotation"])
    lower = np.cumsum(state["slip"]) + np.concatenate(
        ([0.0], np.cumsum(turned * np.diff(joints))[:-1])
    )
    upper = lower + turned * np.diff(joints)
    places = np.column_stack((joints[:-1], joints[1:])).ravel()
    moved = np.column_stack((lower, upper)).ravel()
    share = state["displacement"] / moved[-1] if moved[-1] else 1.0
    return np.concatenate(([0.0], places)), np.concatenate(([0.0], share * moved))
