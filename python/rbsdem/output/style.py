"""The style of all figures, and axes in it.

Axes that are given keep the style of the caller; new ones have the house style, the dictionary
`RC`. matplotlib (``pip install "rbsdem[plot]"``) is imported when a figure is asked for.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from weakref import WeakSet

import numpy as np

from rbsdem import _arguments
from rbsdem._files import write_figure
from rbsdem._types import Axes, NDArray
from rbsdem.errors import InputError
from rbsdem.output.units import factor

#: Return type of functions with several axes: an array of them, as ``pyplot.subplots`` does.
AxesArray = NDArray[np.object_]
Line = dict[str, Any]

_TICKS = {"labelsize": 8.0, "direction": "in", "major.width": 0.6, "major.size": 3.0}
_LETTERS = ("font.size", "axes.labelsize", "axes.titlesize", "legend.fontsize")
RC: dict[Any, Any] = {
    **dict.fromkeys(_LETTERS, 9.0),
    **{f"{axis}tick.{name}": value for axis in "xy" for name, value in _TICKS.items()},
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "axes.linewidth": 0.6,
    "axes.unicode_minus": True,
    "axes.grid": False,
    "lines.linewidth": 0.8,
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "pdf.fonttype": 42,
}
"""The style of every figure, as matplotlib parameters."""

MODEL_LINE: Line = {"color": "black", "linestyle": "-", "linewidth": 0.75, "zorder": 3}
TEST_LINE: Line = {"color": "0.55", "linestyle": (0, (3.2, 1.4)), "linewidth": 0.85, "zorder": 2}
TEST_POINTS: Line = {
    "color": "0.45",
    "linestyle": "none",
    "marker": "o",
    "markersize": 3.4,
    "markerfacecolor": "white",
    "markeredgewidth": 0.8,
    "zorder": 4,
}
ZERO_LINE: Line = {"color": "0.75", "linewidth": 0.4, "zorder": 1}

# Figures that were made in the house style.
_HOUSE: WeakSet[Any] = WeakSet()

DPI = 300


@contextmanager
def style() -> Iterator[None]:
    """Use the house style `RC` inside a ``with`` block only."""
    import matplotlib as mpl  # noqa: PLC0415

    with mpl.rc_context(RC):
        yield


def new_axes(rows: int, columns: int, size: tuple[float, float], **grid: Any) -> AxesArray:
    """Make a figure of pyplot in the house style.

    Parameters
    ----------
    rows, columns : int
        Axes below and beside each other.
    size : tuple of float
        Width and height [in].
    **grid
        As for ``pyplot.subplots``.

    Returns
    -------
    ndarray of matplotlib Axes
        Row by row. What is drawn on them later has the house style, too.
    """
    import matplotlib.pyplot as plt  # noqa: PLC0415

    with style():
        figure, axes = plt.subplots(
            rows, columns, figsize=size, layout="constrained", squeeze=False, **grid
        )
    _HOUSE.add(figure)
    drawn: AxesArray = axes.ravel()
    return drawn


@contextmanager
def style_of(ax: Axes) -> Iterator[None]:
    """Use the house style in a ``with`` block if the axes were made in it, else that of the caller.

    Parameters
    ----------
    ax : matplotlib Axes
        Where is drawn.
    """
    if ax.get_figure() not in _HOUSE:
        yield
        return
    with style():
        yield


@contextmanager
def axes_or_new(ax: Axes | None, size: tuple[float, float] = (3.5, 3.0)) -> Iterator[Axes]:
    """Yield the axes of the caller in the caller's style, or new axes in the house style.

    Parameters
    ----------
    ax : matplotlib Axes or None
        Axes of the caller; None makes a figure.
    size : tuple of float
        Width and height of a new figure [in].
    """
    if ax is not None:
        if not hasattr(ax, "get_figure"):
            raise InputError(f"ax = {_arguments.shown(ax)} must be axes of matplotlib")
        with style_of(ax):
            yield ax
        return
    with style():
        yield new_axes(1, 1, size)[0]


def save(figure: Any, path: str | os.PathLike[str], *, pdf: bool = False) -> list[Path]:
    """Write a figure as PNG at 300 dpi, and as PDF beside it if asked for.

    Parameters
    ----------
    figure : matplotlib Figure or Axes, or array of Axes
        The figure.
    path : path-like
        File to write; the ending .png is added if it is missing, and the folder is created.
    pdf : bool, default False
        Write the PDF as well.

    Returns
    -------
    list of Path
        The files written.
    """
    target = Path(path)
    if not target.suffix:
        target = target.with_suffix(".png")
    files = [target, target.with_suffix(".pdf")] if pdf else [target]
    with style():
        for file in files:
            write_figure(figure, file, dpi=DPI)
    return files


def line_of(default: Line, given: Line) -> Line:
    """Return the properties of a line, those given in place of the defaults, aliases included."""
    from matplotlib.cbook import normalize_kwargs  # noqa: PLC0415
    from matplotlib.lines import Line2D  # noqa: PLC0415

    return {**default, **normalize_kwargs(given, Line2D)}


def keep_letters(axis: Any, model: Any) -> None:
    """Give all ticks of an axis, those to come as well, the letters that one of another has."""
    label = model.get_major_ticks()[0].label1
    axis.set_tick_params(labelsize=label.get_fontsize(), labelcolor=label.get_color())
    with suppress(ValueError):  # matplotlib 3.7 does not know it
        axis.set_tick_params(labelfontfamily=label.get_fontfamily())


def drift_axis(ax: Axes, height: float) -> None:
    """Put drift ratios above displacements, in the letters of the axis below."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    if any(child.get_gid() == "drift" for child in ax.child_axes):
        return
    share = 100.0 / (height * factor("m"))  # per cent of the height

    both = (lambda displacement: displacement * share), (lambda drift: drift / share)
    top = ax.secondary_xaxis("top", functions=both, gid="drift")
    top.xaxis.set_major_locator(MaxNLocator(nbins=9, symmetric=True, steps=[1, 2, 5, 10]))
    # In the letters of the axes below, wherever those come from.
    top.set_xlabel("Drift ratio (%)", fontproperties=ax.xaxis.label.get_fontproperties())
    keep_letters(top.xaxis, ax.xaxis)
