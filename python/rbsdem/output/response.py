"""A response over time, over the height, and its energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike, Axes
from rbsdem.errors import InputError
from rbsdem.model.column import bodies
from rbsdem.model.response import Response
from rbsdem.model.rows import ENERGIES
from rbsdem.output.style import (
    MODEL_LINE,
    ZERO_LINE,
    AxesArray,
    Line,
    axes_or_new,
    line_of,
    new_axes,
    style_of,
)

Over = Literal["displacement", "drift", "force", "base_shear", "base_moment"]

#: What is drawn over time: factor to its unit on paper, and its label.
_OVER: dict[str, tuple[float, str]] = {
    "displacement": (1e3, "Top displacement (mm)"),
    "drift": (1e2, "Drift ratio (%)"),
    "force": (1e-3, "Lateral force (kN)"),
    "base_shear": (1e-3, "Base shear (kN)"),
    "base_moment": (1e-3, "Base moment (kN m)"),
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
    result: Response, over: Over = "displacement", *, ax: Axes | None = None, **line: Any
) -> Axes:
    """Draw a response over time, or over the points of a static path.

    Parameters
    ----------
    result : Result
        The response.
    over : {"displacement", "drift", "force", "base_shear", "base_moment"}, optional
        What is drawn: in mm, %, kN and kN m.
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
    _arguments.instance(result, "history: result", Response)
    over = _arguments.choice(over, "over", _OVER)
    factor, label = _OVER[over]
    with axes_or_new(ax, (5.2, 2.4)) as drawn:
        drawn.plot(result.time, factor * getattr(result, over), **line_of(MODEL_LINE, line))
        if not any(each.get_gid() == "zero" for each in drawn.get_lines()):
            drawn.axhline(0.0, gid="zero", **ZERO_LINE)
        _along(result, drawn, label)
    return drawn


def _along(result: Response, ax: Axes, label: str) -> None:
    """Dress axes whose x is the time, or the points of a path."""
    ax.set_xlim(result.time[0], max(result.time[-1], result.time[0] + 1e-9))
    ax.set(xlabel="Time (s)" if result.dynamic else "Point of the path", ylabel=label)
    ax.tick_params(right=True, top=True)


def energy(result: Response, *, ax: Axes | None = None) -> Axes:
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
            values = result.energy[name] * 1e-3
            drawn.plot(result.time, values, **line, lw=0.8, label=_ENERGY_LABELS[name])
        _along(result, drawn, "Energy (kJ)")
        if names:
            drawn.legend(loc="best", handlelength=2.4)
    return drawn


def profile(
    result: Response,
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
            shear = np.append(state["shear"], state["shear"][-1]) * 1e-3
            axes[1].step(shear, joints, **line, lw=0.9)
            axes[2].plot(np.append(state["moment"], 0.0) * 1e-3, joints, **line, lw=0.9)
        for ax, label in zip(axes, ("Drift (%)", "Shear (kN)", "Moment (kN m)"), strict=True):
            ax.axvline(0.0, **ZERO_LINE)
            ax.set(ylim=(0.0, height), xlabel=label)
            ax.tick_params(right=True, top=True)
        axes[0].set_ylabel("Height (m)")
        axes[0].legend(loc="best", handlelength=2.0)
    return np.asarray(axes)


def _lengths(result: Response) -> Array:
    column = result.column
    lengths, *_ = bodies(column)
    beneath = () if column.footing is None else (column.footing.height,)
    # What holds a fixed top has no length.
    above = (0.0,) if column.top == "fixed" else ()
    return np.array([*beneath, *lengths, *above], dtype=np.float64)


def _displacements(state: Line, joints: Array) -> tuple[Array, Array]:
    """Return heights and displacements of the lower and upper end of each body [m].

    To first order in the rotations, and scaled so that the top has its displacement.
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
