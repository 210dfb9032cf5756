"""Tables: a frame as csv, and on the terminal in the units of paper.

Every record of many rows has a `to_pandas`, in SI; what is written or printed of it comes from that
frame, here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rbsdem._files import Tabular
from rbsdem._types import DataFrame
from rbsdem.output.units import factor as factor_of
from rbsdem.output.units import known, paper

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text


#: Letters of a line where standard output is no terminal.
_WIDE = 200
#: Widest column of text; what is longer goes over several lines. Words up to the second stay whole.
_WIDEST, _LONGEST_WORD = 60, 20


def table(
    record: Tabular | DataFrame,
    *,
    styles: Sequence[str | None] | None = None,
    caption: str | None = None,
) -> Table:
    """Return a table for the terminal: mm, kN, kJ (or those of `plot.units`) and per cent.

    The unit of a number is at the end of its column's name (``peak_force_N``), or in the column
    "unit" of its row. Other columns are printed as they are.

    Parameters
    ----------
    record : a record with ``to_pandas``, or DataFrame
        The table. An index that has a name becomes the first column.
    styles : sequence of str or None, optional
        Style of each row, as `rich` names them.
    caption : str, optional
        Text below the table.

    Returns
    -------
    rich.table.Table
        ``print`` shows it, in colours ``rich.print`` does.
    """
    import rich.box  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    class Printed(Table):
        """A table that is its own text. Without room texts go over several lines, never numbers."""

        def __rich_console__(self, console: Any, options: Any) -> Any:
            widths, frame = list(widest), 3 * len(widest)
            while sum(widths) + frame > options.max_width and widths != least:
                # Headings of numbers break before texts do.
                triples = zip(widths, least, are_numbers, strict=True)
                spare = [(a > b and number, a - b) for a, b, number in triples]
                widths[spare.index(max(spare))] -= 1
            for column, width in zip(self.columns, widths, strict=True):
                column.width = width
            room = max(options.max_width, sum(widths) + frame)
            yield from super().__rich_console__(console, options.update(max_width=room))

        def __str__(self) -> str:
            out = console(_WIDE)
            with out.capture() as text:
                out.print(self, crop=False)
            return text.get().rstrip("\n")

        __repr__ = __str__

    made = Printed(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False, caption=caption)
    columns = cells(record)
    widest, least, are_numbers = [], [], [numbers for _, numbers, _ in columns]
    for heading, numbers, texts in columns:
        width, figures = (max(map(len, [*words, ""])) for words in (heading.splitlines(), texts))
        widest.append(max(width, figures) if numbers else min(max(width, figures), _WIDEST))
        words = heading.split() + ([] if numbers else " ".join(texts).split())
        shortest = max(map(len, words), default=0)
        least.append(max(shortest, figures) if numbers else min(shortest, _LONGEST_WORD))
        look: Any = {"justify": "right"} if numbers else {"overflow": "fold"}
        made.add_column(heading, **look)
    for at, row in enumerate(zip(*(texts for _, _, texts in columns), strict=True)):
        made.add_row(*map(plain, row), style=styles[at] if styles else None)
    return made


def cells(record: Tabular | DataFrame) -> list[tuple[str, bool, list[str]]]:
    """Return heading, whether they are numbers, and texts of each column of a table.

    Parameters
    ----------
    record : a record with ``to_pandas``, or DataFrame
        As for `table`.
    """
    from pandas import DataFrame  # noqa: PLC0415
    from pandas.api.types import is_numeric_dtype  # noqa: PLC0415

    frame = record if isinstance(record, DataFrame) else record.to_pandas()
    if frame.index.name is not None:
        frame = frame.reset_index()
    units = [str(unit) for unit in frame["unit"]] if "unit" in frame else None
    found = []
    for name in frame.columns:
        heading, factor = _heading(str(name))
        values = list(frame[name])
        if name == "unit":
            values = [paper(unit)[1] for unit in values]
        numbers = is_numeric_dtype(frame[name]) and frame[name].dtype != bool
        if numbers:
            factors = [factor_of(u) for u in units] if units else [factor] * len(frame)
            values = [_figure(value, by) for value, by in zip(values, factors, strict=True)]
        found.append((heading, numbers, [_word(value) for value in values]))
    return found


def console(width: int) -> Console:
    """Return the console of rich on standard output.

    Parameters
    ----------
    width : int
        Letters of a line where standard output is no terminal.
    """
    from rich.console import Console  # noqa: PLC0415

    class Terminal(Console):
        """A console whose reader may leave: what called it decides what that means."""

        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    out = Terminal(highlight=False)
    return out if out.is_terminal else Terminal(highlight=False, width=width)


def plain(text: str, **style: Any) -> Text:
    """Return a text of rich that has no markup, for words that come from outside.

    Parameters
    ----------
    text : str
        The words; what cannot be printed, such as the codes that steer a terminal, becomes "?".
    **style
        Of `rich.text.Text`.
    """
    from rich.text import Text  # noqa: PLC0415

    return Text("".join(c if c.isprintable() else "?" for c in text), **style)


def _heading(name: str) -> tuple[str, float]:
    """Return the heading of a column and the factor of its numbers."""
    stem, _, unit = name.rpartition("_")
    if not (stem and known(unit)):
        stem, unit = name, "drift" if "drift" in name.split("_") else ""
    words = stem.replace("_", " ")
    words = words[:1].upper() + words[1:]
    factor, on_paper = paper(unit)
    return (f"{words}\n{on_paper}" if on_paper else words), factor


def _figure(value: float, factor: float) -> str:
    """Return a number times a factor with three digits; whole numbers as they are, NaN a dash."""
    import pandas  # noqa: PLC0415

    if pandas.isna(value):
        return "-"
    if isinstance(value, int):
        return str(value)
    value *= factor
    if math.isinf(value):
        return "∞"
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"


def _word(value: object) -> str:
    """Return a value that is no number as one line of text."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    lines = "" if value is None else str(value)
    return lines.splitlines()[0] if lines else ""
