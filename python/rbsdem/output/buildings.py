"""Figures of buildings assessed: performance point, mode shapes, members by their levels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import _arguments
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem.checks.acceptance import Assessment
from rbsdem.errors import InputError
from rbsdem.many.target import Target
from rbsdem.output import frames
from rbsdem.output.style import MODEL_LINE, TEST_LINE, ZERO_LINE, axes_or_new, line_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {"asce_41": "ASCE 41-17", "en_1998": "EN 1998-1, N2", "capacity_spectrum": "FEMA 440"}
#: Fills of ends by the levels that they have passed, and of those that are not covered.
_PASSED = ("white", "#f4d35e", "#ee964b", "#c0392b")
_NOT_COVERED = "0.75"
_POINT: dict[str, Any] = {"marker": "o", "markersize": 4.5, "color": "#c0392b", "zorder": 5}


def target(found: Target, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw a target displacement: curve, its two lines and the spectrum as those of one mass.

    Parameters
    ----------
    found : Target
        What `rbsdem.codes.target` returned.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the curve, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        Acceleration over displacement of the equivalent mass: base shear over the effective mass,
        displacement over the participation of the first mode.
    """
    _arguments.instance(found, "plot.target", Target, "as of rbsdem.codes.target")
    curve, lines, gamma = found.curve, found.lines, found.curve.gamma
    per_g = 1.0 / (gamma * curve.modal_mass * STANDARD_GRAVITY)
    at = found.displacement / gamma
    periods = found.spectrum.period
    periods = np.concatenate((np.linspace(0.0, periods[1], 20), periods[2:]))
    inside = [one for one in periods if _inside(found, one)]
    sa = np.array([found.spectrum.sa(one) for one in inside]) / STANDARD_GRAVITY
    sd = np.array([found.spectrum.sd(one) for one in inside])
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        drawn.plot(1e3 * sd, sa, **{**TEST_LINE, "linestyle": "-"}, label=found.spectrum.name)
        shown = line_of({**MODEL_LINE, "label": "push-over"}, line)
        drawn.plot(1e3 * curve.displacement / gamma, curve.force * per_g, **shown)
        corners = np.array([0.0, lines.yield_displacement, lines.end_displacement])
        forces = np.array([0.0, lines.yield_force, lines.end_force])
        look: dict[str, Any] = {"color": "#c0392b", "linewidth": 0.8, "zorder": 4}
        drawn.plot(1e3 * corners / gamma, forces * per_g, **look, label="two lines")
        top = 1.08 * max(float(sa.max()), float(curve.force.max()) * per_g)
        # The capacity spectrum has its point on the secant.
        shown_period = found.factors.get("T_sec", found.period)
        slope = (2.0 * np.pi / shown_period) ** 2 / STANDARD_GRAVITY
        drawn.plot([0.0, 1e3 * top / slope], [0.0, top], **{**ZERO_LINE, "color": "0.6"})
        name = _NAMES[found.method]
        if found.reached:
            height = found.base_shear * per_g
            drawn.vlines(1e3 * at, 0.0, height, **{**look, "linestyle": ":"})
            words = f"{name}: roof {1e3 * found.displacement:.0f} mm"
            drawn.plot([1e3 * at], [height], **_POINT, linestyle="none", label=words)
        else:
            drawn.plot([], [], linestyle="none", label=f"{name}: beyond the end of the curve")
        drawn.set_xlim(0.0, 1.25e3 * max(at, min(curve.largest / gamma, 1.5 * at)))
        drawn.set_ylim(0.0, top)
        drawn.set(xlabel="Spectral displacement (mm)", ylabel="Spectral acceleration (g)")
        look = {"frameon": True, "framealpha": 0.85, "edgecolor": "none"}
        drawn.legend(loc="upper right", handlelength=1.6, **look)
        drawn.tick_params(right=True, top=True)
    return drawn


def _inside(found: Target, period: float) -> bool:
    """Return whether a spectrum of points has a period."""
    try:
        found.spectrum.sa(period)
    except InputError:
        return False
    return True


def assessment(found: Assessment, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw a frame with ends of members and joints in the colours of the levels they have passed.

    Parameters
    ----------
    found : Assessment
        What `rbsdem.codes.assess` returned.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the marks, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m. Members beyond their shear strength have the colour of the last level.
    """
    _arguments.instance(found, "plot.assessment", Assessment, "as of rbsdem.codes.assess")
    structure, states = found.result.frame, found.states()
    names = ["within all", *(f"beyond {name}" for name in found.levels)]
    names[-1] += " or in shear" if found.counts()["shear"] else ""
    with axes_or_new(ax, frames._figure_size(structure)) as drawn:
        frames._draw_supports(drawn, structure, frames._size(structure))
        frames._undeformed(drawn, structure, True)
        places: dict[int, list[Any]] = {}
        for member in structure.geometry.values():
            for end, share in (("start", 0.06), ("end", 0.94)):
                if (member.name, end) in states:
                    at = member.foot + share * member.clear * member.axis
                    places.setdefault(states[member.name, end], []).append(at)
        nodes = dict(
            zip(
                structure.parts.nodes,
                np.column_stack((structure.parts.x, structure.parts.y)),
                strict=True,
            )
        )
        for (name, _), passed in states.items():
            if name in nodes:
                places.setdefault(passed, []).append(nodes[name])
        for passed, points in sorted(places.items()):
            face = _NOT_COVERED if passed < 0 else _PASSED[passed]
            name = "not covered" if passed < 0 else names[passed]
            mark = {"linestyle": "none", "marker": "o", "markersize": 5.0, "zorder": 5}
            mark |= {"markeredgecolor": "black", "markeredgewidth": 0.5, "markerfacecolor": face}
            words = f"{name} ({len(points)})"
            drawn.plot(*np.array(points).T, **line_of({**mark, "label": words}, line))
        drawn.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, handletextpad=0.2)
        frames._dress(drawn, structure)
    return drawn
