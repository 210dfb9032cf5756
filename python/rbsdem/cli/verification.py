"""The command `verify`: printed numbers of others beside those of the program."""

from __future__ import annotations

import click
import rich.box
from rich.table import Table

from rbsdem.methods.verification import Verification
from rbsdem.methods.verification import verify as solve
from rbsdem.output.tables import console, plain


@click.command("verify")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--all", "every", is_flag=True, help="each number, not the worst of each problem")
@click.option("--output", type=click.Path(dir_okay=False), metavar="FILE", help="all as csv")
def verify(names: tuple[str, ...], every: bool, output: str | None) -> int:
    """Solve problems of textbooks, standards and other programs, and compare with their numbers.

    NAME is the beginning of the name of a problem; without names all are solved. Of each problem
    the table has the number that differs most, in units of the last printed digit.

    Exit codes: 0 all are inside the printed digits or explained, 1 some are not, 2 no such problem.
    """
    found = solve(list(names) or None)
    console(160).print(_table(found if every else found.worst()))
    print(found)
    if output is not None:
        found.to_csv(output)
        print(f"wrote {output}")
    return 0 if found.holds else 1


def _table(found: Verification) -> Table:
    """Return a table whose texts are folded and whose numbers are whole."""
    made = Table(box=rich.box.SIMPLE_HEAD, show_edge=False, padding=(0, 1))
    numbers = ("printed", "rbsdem", "difference")
    rows = found.to_pandas()
    for name in rows:
        whole = name in numbers
        made.add_column(name, justify="right" if whole else "left", no_wrap=whole)
    for row, one in zip(rows.itertuples(index=False), found.comparisons, strict=True):
        made.add_row(*map(plain, row), style=None if one.holds else "red")
    return made
