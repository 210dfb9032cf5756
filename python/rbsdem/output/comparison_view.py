"""A comparison as a figure and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rbsdem import plot
from rbsdem._optional import need_rich
from rbsdem._views import view_of
from rbsdem.curves.scores import Comparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

_KINDS = (("peak_force", 1e-3), ("energy", 1e-3), ("stiffness", 1e-6), ("damping", 1e2))


@view_of(Comparison, "plot")
def draw(comparison: Comparison, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the loop of the model over that of the test."""
    return plot.loops_over_test(
        comparison.model_curve,
        (comparison.displacement, comparison.test_force),
        title=f"{comparison.name}\nNRMSE {comparison.nrmse:.3f}",
        height=comparison.height if comparison.height > 0 else None,
        ax=ax,
        **line,
    )


@view_of(Comparison, "table")
def table(comparison: Comparison) -> Table:
    """Return the half-cycles as a table of rich, test and model side by side: mm, kN, kJ."""
    rich = need_rich()
    found = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    units = "d\nmm", "Drift\n%", "Peak\nkN", "", "Energy\nkJ", "", "Secant\nkN/mm", ""
    for name in ("Cycle", *units, "Damping\n%", ""):
        found.add_column(name, justify="right", no_wrap=True)
    test, model = comparison.test_cycles, comparison.model_cycles
    for i in range(len(test)):
        d = test.displacement[i]
        drift = d / comparison.height
        cells = [f"{1 + i // 2}{'ab'[i % 2]}", f"{d * 1e3:.1f}", f"{drift * 1e2:.2f}"]
        for name, unit in _KINDS:
            cells.append(f"{getattr(test, name)[i] * unit:.3g}")
            cells.append(f"{getattr(model, name)[i] * unit:.3g}" if i < len(model) else "")
        found.add_row(*(cell.replace("nan", "-") for cell in cells))
    return found
