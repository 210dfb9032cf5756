"""Code values as tables."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rbsdem._optional import need_pandas, need_rich
from rbsdem._views import view_of
from rbsdem.checks.code_comparison import SOURCES, CodeComparison
from rbsdem.checks.code_values import CodeValues

if TYPE_CHECKING:
    from rich.table import Table

#: Factor to the unit on paper, and that unit.
_UNITS = {
    "N": (1e-3, "kN"),
    "N m": (1e-3, "kN m"),
    "m": (1e3, "mm"),
    "N/m": (1e-6, "kN/mm"),
    "rad": (1e2, "%"),
    "drift": (1e2, "%"),
}


@view_of(CodeValues, "to_pandas")
def to_pandas(values: CodeValues) -> Any:
    """Return a DataFrame, a row for each value."""
    return need_pandas().DataFrame([asdict(value) for value in values])


@view_of(CodeValues, "table")
def table(values: CodeValues) -> Table:
    """Return a table of rich; what is not confirmed has an asterisk."""
    rich = need_rich()
    found = rich.table.Table(
        box=rich.box.SIMPLE_HEAD,
        padding=(0, 1),
        show_edge=False,
        caption=None
        if all(value.confirmed for value in values)
        else "* not confirmed by a second source",
    )
    found.add_column("Value")
    found.add_column("", justify="right")
    found.add_column("Unit")
    found.add_column("Meaning")
    found.add_column("Source")
    for value in values:
        factor, unit = _UNITS.get(value.unit, (1.0, value.unit))
        mark = "" if value.confirmed else " *"
        found.add_row(
            value.name, f"{factor * value.value:.4g}", unit, value.meaning, value.source + mark
        )
    return found


@view_of(CodeComparison, "to_pandas")
def compared_to_pandas(found: CodeComparison) -> Any:
    """Return a DataFrame, a row a quantity, a column a source."""
    rows = [{"quantity": row.name, "unit": row.unit} | row.values for row in found]
    columns = ["quantity", "unit", *_sources(found)]
    return need_pandas().DataFrame(rows, columns=columns).set_index("quantity")


@view_of(CodeComparison, "table")
def compared(found: CodeComparison) -> Table:
    """Return a table of rich; a dash where a source says nothing."""
    rich = need_rich()
    made = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    made.add_column("")
    made.add_column("Unit")
    sources = _sources(found)
    for source in sources:
        made.add_column(source, justify="right")
    for row in found:
        factor, unit = _UNITS[row.unit]
        cells = [f"{factor * row.values[s]:.3g}" if s in row.values else "-" for s in sources]
        made.add_row(row.meaning, unit, *cells)
    return made


def _sources(found: CodeComparison) -> list[str]:
    """Return the sources that say anything of the column."""
    return [source for source in SOURCES if any(source in row.values for row in found)]
