"""Limit states as tables."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rbsdem._optional import need_pandas, need_rich
from rbsdem._views import view_of
from rbsdem.checks.limit_states import LimitState, LimitStates

if TYPE_CHECKING:
    from rich.table import Table


@view_of(LimitStates, "to_pandas")
def to_pandas(states: LimitStates) -> Any:
    """Return a DataFrame, a row for each state."""
    names = list(LimitState.__dataclass_fields__)
    return need_pandas().DataFrame([asdict(state) for state in states], columns=names)


@view_of(LimitStates, "table")
def table(states: LimitStates) -> Table:
    """Return a table of rich: drift in per cent, displacement in mm."""
    rich = need_rich()
    found = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    found.add_column("Limit state")
    when = "Time\ns" if states.result.dynamic else "Point"
    for name in (when, "Drift\n%", "d\nmm", "Threshold"):
        found.add_column(name, justify="right")
    found.add_column("Source")
    for state in states:
        found.add_row(
            state.name.replace("_", " "),
            f"{state.time:.4g}",
            f"{100 * state.drift:.2f}",
            f"{1e3 * state.displacement:.1f}",
            f"{state.threshold:.4g}".replace("nan", ""),
            state.source,
        )
    return found
