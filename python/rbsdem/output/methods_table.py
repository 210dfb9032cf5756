"""A trade as tables and as a report on the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rbsdem._optional import console, need_rich, plain
from rbsdem._views import view_of
from rbsdem.errors import InputError
from rbsdem.methods.outcome import Trade
from rbsdem.methods.rows import seconds_text

if TYPE_CHECKING:
    from rich.table import Table

    from rbsdem.methods.rows import Row


@view_of(Trade, "table")
def settings_table(trade: Trade) -> Table:
    """Return the settings as a table of rich."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column("")
    table.add_column("Setting", no_wrap=True)
    table.add_column("Time", justify="right", no_wrap=True)
    names = (trade.response.capitalize(), "Moment", "Energy", "Peak", "Error", "To finer")
    for name in names:
        table.add_column(name, justify="right", no_wrap=True)
    floor = trade.reference.resolution if trade.reference else 0.0
    family = None
    for row in trade.rows:
        if row.setting.family != family:
            family = row.setting.family
            given = " (as given)" if row.setting.own else ""
            table.add_row("", f"[bold]{row.setting.name}[/bold], {row.setting.kinematics}{given}")
        mark = "*" if row.pareto else ""
        chosen = trade.choice is not None and trade.choice.row == row
        if row.status in ("completed", "collapsed"):
            errors = (row.response_rms, row.moment, row.energy, row.peak, row.error, row.move)
            cells = [seconds_text(row.seconds), *(_number(value, floor) for value in errors)]
        else:
            cells = ["-", f"[dim]{row.status}[/dim]"]
        value = row.setting.value
        if row.setting.method == "auto" and row.reason:
            value = f"chose {row.reason.split(':')[0]}"
        style = "bold" if chosen else None
        table.add_row(mark, plain(f"  {value}"), *cells, style=style)
    return table


def reasons(rows: Sequence[Row]) -> list[str]:
    """Return lines on the settings without an answer, one for each reason."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        if row.status not in ("completed", "collapsed"):
            found.setdefault(f"{row.status}: {row.reason}", []).append(row)
    return [f"{', '.join(str(row.setting) for row in same)} {why}" for why, same in found.items()]


def report(trade: Trade, title: str) -> None:
    """Print the whole trade."""
    need_rich()
    out = console(132)

    def say(text: str = "") -> None:
        out.print(text, markup=False, soft_wrap=not out.is_terminal)

    out.print(plain(title, style="bold"))
    say()
    reference = trade.reference
    if reference is not None:
        say(f"Reference: {reference.first}, against {reference.second}.")
        say(
            f"They agree to {reference.digits:.1f} digits in {trade.response}, "
            f"{reference.moment_digits:.1f} in base moment, {reference.energy_digits:.1f} in "
            f"energy and {reference.peak_digits:.1f} in peak."
        )
        if reference.note:
            say(f"Note: {reference.note}.")
    say()
    out.print(trade.table())
    say("\n* on the Pareto front. Errors are relative to the reference's peaks; Error is the")
    say("largest of the four before it; To finer: what the next finer setting changes.")
    for reason in reasons(trade.rows):
        say(f"  {reason}")
    if trade.choice is not None:
        say(f"\n{str(trade.choice).capitalize()}.")
    if trade.physics is not None:
        physics = trade.physics
        say("\nWhat each part of the model changes, the others as given:\n")
        out.print(trade.physics_table())
        say(f"\nSolved by {physics.setting}, error {physics.resolution:.1e}. What changes peak,")
        say(f"base moment, energy or residual by more than {physics.tolerance:g} matters.")
        for effect in physics.effects:
            if effect.matters is None:
                say(f"  {effect.part} {effect.status}: {effect.reason}")
    for note in trade.notes:
        say(f"Note: {note}.")
    say(f"\nDone in {trade.seconds:.1f} s of {trade.budget:g} s.")


@view_of(Trade, "physics_table")
def physics_table(trade: Trade) -> Table:
    """Return the effects of the parts of the model as a table of rich."""
    if trade.physics is None:
        raise InputError("trade: the parts of the model were not compared; see notes")
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column("Changed", no_wrap=True)
    for name in ("Peak", "Residual", "Base moment", "Energy", "Time"):
        table.add_column(f"{name}\n{'ratio' if name == 'Time' else '%'}", justify="right")
    table.add_column("Matters")
    for effect in trade.physics.effects:
        if effect.matters is None:
            table.add_row(effect.part, f"[dim]{effect.status}")
            continue
        changes = (effect.peak, effect.residual, effect.moment, effect.energy)
        cells = [f"{100 * change:+.2f}" for change in changes]
        word = "[bold]yes[/bold]" if effect.matters else "no"
        table.add_row(effect.part, *cells, f"{effect.time_ratio:.2f}", word)
    return table


def _number(value: float, floor: float) -> str:
    """Return an error; gray below the agreement of the reference."""
    if math.isnan(value):
        return ""
    if math.isinf(value):
        return "ends"
    return f"{value:.1e}" if value >= floor else f"[dim]{value:.1e}[/dim]"
