"""Force-displacement loops: mm and kN, the model over the test."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _arguments
from rbsdem._optional import need_matplotlib
from rbsdem.curves.curve import Curve, loop_pair
from rbsdem.errors import InputError
from rbsdem.model.response import Response
from rbsdem.output.style import (
    MODEL_LINE,
    TEST_LINE,
    TEST_POINTS,
    ZERO_LINE,
    axes_or_new,
    keep_letters,
    line_of,
    style,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Panel", "four_panels", "loop", "loops_over_test"]

FIGURE_SIZE = (6.9, 6.0)


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
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
    ImportError
        If matplotlib is not installed.

    Examples
    --------
    >>> ax = loop([0.0, 0.01, 0.0], [0.0, 2.0e5, -1.0e5])
    >>> ax.get_xlabel()
    'Top displacement (mm)'
    """
    shaken = force is None and isinstance(curve, Response) and curve.dynamic
    d, f = _curve((curve, force) if force is not None else curve, "the loop")
    with axes_or_new(ax) as drawn:
        drawn.plot(d, f, **line_of(MODEL_LINE, line))
        _dress(drawn, height)
        if shaken:
            drawn.set_ylabel("Base shear (kN)")
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
    ImportError
        If matplotlib is not installed.
    """
    measured = _curve(test, "the test")
    computed = _curve(model, "the model")
    with axes_or_new(ax) as drawn:
        drawn.plot(*measured, label="Test", **(TEST_POINTS if test_points else TEST_LINE))
        drawn.plot(*computed, **line_of({**MODEL_LINE, "label": "Model"}, line))
        _dress(drawn, height)
        if title:
            at = drawn.transAxes
            drawn.text(0.035, 0.955, title, transform=at, ha="left", va="top", zorder=5)
        if legend:
            drawn.legend(loc="lower right", handlelength=2.4)
    return drawn


def four_panels(
    panels: Sequence[Panel], *, test_label: str = "Test", model_label: str = "Model"
) -> Figure:
    """Draw up to four loops over their tests, (a) to (d), in one figure.

    Parameters
    ----------
    panels : sequence of Panel
        One to four panels, in the order (a) to (d).
    test_label, model_label : str
        Texts of the legend below the panels.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, 175 mm wide; `save` writes it.

    Raises
    ------
    InputError
        If there are no panels or more than four, or if displacements and forces of one differ in
        length or are empty.
    ImportError
        If matplotlib is not installed.
    """
    if not 1 <= len(panels) <= 4:
        raise InputError(f"four_panels: {len(panels)} panels; give one to four")
    need_matplotlib()
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = 1 if len(panels) <= 2 else 2
    with style():
        # Not through pyplot: a script that draws many figures then keeps none of them open.
        figure = Figure(
            figsize=(FIGURE_SIZE[0], FIGURE_SIZE[1] * (rows / 2 + 0.04 * (2 - rows))),
            layout="constrained",
        )
        figure.get_layout_engine().set(w_pad=0.06, h_pad=0.05, wspace=0.04, hspace=0.03)
        grid = figure.subplots(rows, 2, squeeze=False).ravel()
        for ax in grid[len(panels) :]:
            ax.remove()
        for letter, ax, panel in zip("abcd", grid, panels, strict=False):
            loops_over_test(
                panel.model,
                panel.test,
                title=f"({letter}) {panel.title}",
                height=panel.height,
                test_points=panel.test_points,
                legend=False,
                ax=ax,
            )
        handles = grid[0].get_lines()[:2]
        figure.legend(
            handles,
            [test_label, model_label],
            loc="outside lower center",
            ncols=2,
            handlelength=3.2,
            columnspacing=3.0,
        )
        # Ticks and layout take their style when they are first drawn.
        figure.draw_without_rendering()
    return figure


def _curve(curve: Any, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return displacements [mm] and forces [kN] of a result, a test or a pair of arrays."""
    names = (f"{name}: displacements", f"{name}: forces")
    d, f = map(_arguments.vector, loop_pair(curve, name), names)
    if d.shape != f.shape or d.size == 0:
        raise InputError(
            f"{name}: displacements have shape {d.shape}, forces {f.shape}; "
            f"they must be vectors of one length"
        )
    return d * 1e3, f * 1e-3


def _dress(ax: Axes, height: float | None) -> None:
    """Limits symmetric about zero, zero lines, labels, and drift ratios on top."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    # Lines across the axes, such as those through zero, have no extent of their own.
    lines = [line for line in ax.get_lines() if line.get_transform() == ax.transData]
    points = [np.asarray(line.get_xydata(), dtype=np.float64) for line in lines]
    reach = np.nanmax(np.abs(np.vstack(points)), axis=0)
    x, y = (1.08 * value if value > 0 else 1.0 for value in reach)
    ax.set_xlim(-x, x)
    ax.set_ylim(-y, y)
    if not any(line.get_gid() == "zero" for line in ax.get_lines()):
        ax.axhline(0.0, gid="zero", **ZERO_LINE)
        ax.axvline(0.0, gid="zero", **ZERO_LINE)
    for axis in (ax.xaxis, ax.yaxis):
        # More ticks will be made, perhaps in another style than that in which the axes were.
        keep_letters(axis, axis)
    steps = [1, 2, 2.5, 5, 10]
    ax.xaxis.set_major_locator(MaxNLocator(nbins=7, symmetric=True, steps=steps))
    ax.yaxis.set_major_locator(MaxNLocator(nbins=9, symmetric=True, steps=steps))
    ax.set_xlabel("Top displacement (mm)")
    ax.set_ylabel("Lateral force (kN)")
    ax.tick_params(right=True, top=height is None)
    if height is not None:
        height = _arguments.number(height, "height")
        if not height > 0:
            raise InputError(f"height = {height} m; give a positive height for the drift ratios")
        if any(child.get_gid() == "drift" for child in ax.child_axes):
            return
        share = 0.1 / height  # per cent of a height in m, of a displacement in mm
        top = ax.secondary_xaxis(
            "top", functions=(lambda d: d * share, lambda drift: drift / share), gid="drift"
        )
        top.xaxis.set_major_locator(MaxNLocator(nbins=9, symmetric=True, steps=[1, 2, 5, 10]))
        # In the letters of the axes below, wherever those come from.
        top.set_xlabel("Drift ratio (%)", fontproperties=ax.xaxis.label.get_fontproperties())
        keep_letters(top.xaxis, ax.xaxis)
