"""A study of methods as a figure, error against wall time, and as a report on the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rbsdem._files import write_figure
from rbsdem._types import Axes, DataFrame
from rbsdem.errors import InputError
from rbsdem.methods.ladder import LEVELS
from rbsdem.methods.study import MethodStudy
from rbsdem.output.style import Line, axes_or_new, line_of, style
from rbsdem.output.tables import console, plain, table

if TYPE_CHECKING:
    from rbsdem.methods.ladder import MethodRun

#: Marker, filling and gray of each method; located events are filled.
MARKS: dict[tuple[str, str | None], Line] = {
    ("rk4", "step"): {"marker": "o", "color": "black", "markerfacecolor": "white"},
    ("rk4", "located"): {"marker": "o", "color": "black"},
    ("rk45", None): {"marker": "D", "color": "0.25"},
    ("newmark", None): {"marker": "s", "color": "0.45", "markerfacecolor": "white"},
    ("hht", None): {"marker": "^", "color": "0.45", "markerfacecolor": "white"},
    ("generalised_alpha", None): {"marker": "v", "color": "0.45"},
    ("auto", None): {"marker": "*", "color": "black"},
    ("static", None): {"marker": "o", "color": "black"},
}
_FRONT: Line = {"drawstyle": "steps-post", "color": "0.8", "lw": 5, "solid_capstyle": "butt"}
_CHOSEN: Line = {"marker": "o", "ms": 10, "mfc": "none", "color": "black", "ls": "none"}

OWN = {"marker": "x", "color": "black"}

NAMES = {"generalised_alpha": "generalised-alpha", "rk4": "RK4", "rk45": "RK5(4)", "hht": "HHT"}

#: Lines of the column's own level of kinematics, and of those below it.
DASHES = ("-", (0, (4, 1.5)), (0, (1, 1.5)))

#: Errors beyond this are not worth the room.
TOP = 10.0


def methods(study: MethodStudy, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw error against wall time, both logarithmic, with the Pareto front.

    Parameters
    ----------
    study : MethodStudy
        The study, as `rbsdem.compare_methods` returns it.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the lines, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    InputError
        If there is nothing to draw.
    """
    done = [row for row in study.rows if math.isfinite(row.error)]
    if not done or study.reference is None:
        raise InputError("compare_methods: there is no setting with an error to draw; see notes")
    floor = max(study.reference.resolution, 1e-16)
    with axes_or_new(ax, (5.2, 3.6)) as drawn:
        front = sorted((row for row in done if row.pareto), key=lambda row: row.seconds)
        drawn.plot(*_points(front, floor), **_FRONT, zorder=1, label="Pareto front")
        families = dict.fromkeys(row.setting.family for row in done)
        # The column's own is the highest.
        levels = [level for level in reversed(LEVELS) if any(f[2] == level for f in families)]
        for family in families:
            method, events, level, _, own = family
            rows = [row for row in done if row.setting.family == family]
            label = NAMES.get(method, method.capitalize())
            if events:
                label += ", located" if events == "located" else ", step"
            if len(levels) > 1:
                label += f" ({level})"
            mark = MARKS[method, events]
            if own:
                label, mark = "as given", OWN
            default: Line = {"linewidth": 0.6, "markersize": 4, "markeredgewidth": 0.7, "zorder": 3}
            default |= {"label": label, "linestyle": DASHES[levels.index(level)]}
            drawn.plot(*_points(rows, floor), **line_of(default | mark, line))
        _dress(drawn, study, floor)
    return drawn


def _points(rows: Sequence[MethodRun], floor: float) -> tuple[list[float], list[float]]:
    """Return wall times [s] and errors, which are not drawn below the floor."""
    return [row.seconds for row in rows], [max(row.error, floor) for row in rows]


def _dress(ax: Axes, study: MethodStudy, floor: float) -> None:
    """Give axes scales, labels, the agreement of the reference (`floor`), and the choice."""
    ax.set(xscale="log", yscale="log", xlabel="Wall time (s)", ylabel="Relative error")
    low, high = ax.get_ylim()
    low, high = min(low, floor / 3), min(high, TOP)
    # Down to the axis, also where panels share it.
    ax.axhspan(1e-300, floor, color="0.94", linewidth=0, zorder=0)
    text: Any = {"fontsize": "small", "color": "0.4", "ha": "right", "va": "top"}
    across = ax.get_yaxis_transform()
    ax.text(0.985, floor, "agreement of the reference", transform=across, **text)
    ax.set_ylim(low, high)
    if study.choice is not None:
        ax.axhline(study.choice.tolerance, color="0.6", linewidth=0.6, linestyle=(0, (4, 3)))
        if study.choice.row is not None:
            ax.plot(*_points([study.choice.row], floor), **_CHOSEN, label="chosen", zorder=4)
    ax.tick_params(which="both", top=True, right=True)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small", handlelength=2.2)


def save(study: MethodStudy, path: Path, title: str) -> Path | None:
    """Write the figure; return None if there is nothing to draw, or nothing to draw it with."""
    try:
        ax = methods(study)
    except (ImportError, InputError):
        return None
    import matplotlib.pyplot as plt  # noqa: PLC0415

    with style():
        ax.set_title(title, loc="left")
        write_figure(ax, path, dpi=200)
    figure: Any = ax.figure
    plt.close(figure)
    return path


def _reasons(rows: Sequence[MethodRun]) -> list[str]:
    """Return lines on the settings without an answer, one for each reason."""
    found: dict[str, list[MethodRun]] = {}
    for row in rows:
        if row.status not in ("completed", "collapsed"):
            found.setdefault(f"{row.status}: {row.reason}", []).append(row)
    return [f"{', '.join(str(row.setting) for row in same)} {why}" for why, same in found.items()]


def report(study: MethodStudy, title: str) -> None:
    """Print the whole study."""
    out = console(160)

    def say(text: str = "") -> None:
        out.print(text, markup=False, soft_wrap=not out.is_terminal)

    out.print(plain(title, style="bold"))
    say()
    reference = study.reference
    if reference is not None:
        say(f"Reference: {reference.first}, against {reference.second}.")
        say(
            f"They agree to {reference.digits:.1f} digits in {study.response}, "
            f"{reference.moment_digits:.1f} in base moment, {reference.energy_digits:.1f} in "
            f"energy and {reference.peak_digits:.1f} in peak."
        )
        if reference.warning:
            say(f"Note: {reference.warning}.")
    say()
    out.print(table(_settings(study), styles=_styles(study)))
    say("\n* on the Pareto front. Errors are relative to the reference's peaks; Error is the")
    say("largest of the four before it; To finer: what the next finer setting changes.")
    for reason in _reasons(study.rows):
        say(f"  {reason}")
    if study.choice is not None:
        say(f"\n{str(study.choice).capitalize()}.")
    if study.physics is not None:
        physics = study.physics
        say("\nWhat each part of the model changes, the others as given:\n")
        out.print(table(physics.to_pandas().drop(columns=["response_rms", "status", "reason"])))
        say(f"\nSolved by {physics.setting}, error {physics.resolution:.1e}. What changes peak,")
        say(f"base moment, energy or residual by more than {physics.tolerance:g} matters.")
        for effect in physics.effects:
            if effect.matters is None:
                say(f"  {effect.part} {effect.status}: {effect.reason}")
    for warning in study.warnings:
        say(f"Note: {warning}.")
    say(f"\nDone in {study.seconds:.1f} s of {study.budget:g} s.")


def _settings(study: MethodStudy) -> DataFrame:
    """Return the settings as they are printed."""
    import pandas  # noqa: PLC0415

    rows, errors = [], ("moment", "energy", "peak", "error")
    for row in study.rows:
        value = row.setting.value
        if row.setting.method == "auto" and row.reason:
            method = row.reason.split(":")[0]
            value = f"chose {NAMES.get(method, method.capitalize())}"
        if row.status not in ("completed", "collapsed"):
            value += f": {row.status}"
        given = " (as given)" if row.setting.own else ""
        rows.append(
            {
                " ": "*" if row.pareto else "",
                "Method": f"{row.setting.name}, {row.setting.kinematics}{given}",
                "Setting": value,
                "Time, s": row.seconds,
                study.response.capitalize(): row.response_rms,
                **{name.capitalize(): getattr(row, name) for name in errors},
                "To finer": row.move,
            }
        )
    return pandas.DataFrame(rows)


def _styles(study: MethodStudy) -> list[str | None]:
    """Return the style of each row of the table: the chosen setting is bold."""
    chosen = None if study.choice is None else study.choice.row
    return ["bold" if chosen is not None and row == chosen else None for row in study.rows]
