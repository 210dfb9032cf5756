"""Ready models, drawn in a few lines each: to try an analysis, and to begin a drawing with.

`print(inspect.getsource(rbsdem.examples.house))` shows how a model is drawn.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rbsdem.model.column import Column
from rbsdem.model.materials import Bars, Concrete, Layout, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection
from rbsdem.section.columns import column
from rbsdem.section.frame import Frame


def house(storeys: int = 4, bays: int = 2, **changes: Any) -> Frame:
    """Return a frame of a dwelling house, drawn by its sections.

    Storeys of 3.2 m and bays of 5.6 m; columns 400 x 400 mm with 8 bars of 18, beams 300 x 500 mm
    with 5 bars of 16 above and 3 below; dead and live load on the beams, facades on the outer
    nodes, masses of these loads.

    Parameters
    ----------
    storeys, bays : int, optional
        Their numbers.
    **changes
        Other arguments of `Frame.grid`, as ``infills=``, ``walls=`` or ``beams=``.
    """
    concrete, bars = Concrete(25e6), Steel(450e6, 600e6)
    ties = Ties(0.008, 0.100, Steel(400e6))
    upright = RectangularSection(
        0.40, 0.40, concrete, layout=Layout(8, 0.018, bars), ties=ties, cover=0.03
    )
    beam = RectangularSection(
        0.30, 0.50, concrete, top=Bars(5, 0.016), bottom=Bars(3, 0.016), steel=bars, ties=ties,
        cover=0.03,
    )  # fmt: skip
    given: dict[str, Any] = {
        "columns": upright, "beams": beam, "dead_load": 18e3, "live_load": 8e3, "live_share": 0.3,
        "node_load": 25e3, "self_weight": True, "mass": "from_loads", "kinematics": "pdelta",
        "damping": 0.05, "pattern": "modal",
    }  # fmt: skip
    return Frame.grid([3.2] * storeys, [5.6] * bays, **given | changes)


def portal() -> Frame:
    """Return a portal of one storey and one bay with a fixed base, drawn by its sections."""
    concrete, bars = Concrete(30e6), Steel(460e6, 600e6)
    ties = Ties(0.008, 0.100, Steel(400e6))
    upright = RectangularSection(
        0.35, 0.35, concrete, layout=Layout(8, 0.016, bars), ties=ties, cover=0.03
    )
    beam = RectangularSection(
        0.25, 0.45, concrete, top=Bars(4, 0.016), bottom=Bars(3, 0.016), steel=bars, ties=ties,
        cover=0.03,
    )  # fmt: skip
    return Frame.grid(
        [3.0], [5.0], columns=upright, beams=beam, beam_load=20e3, node_load=100e3,
        mass="from_loads", kinematics="pdelta", damping=0.05,
    )  # fmt: skip


def pier() -> Column:
    """Return the pier of a foot bridge, a cantilever of 3.6 m with a deck of 60 t on top."""
    bars = Steel(460e6, 600e6)
    section = CircularSection(
        0.60,
        Concrete(35e6),
        layout=Layout(12, 0.020, bars),
        spiral=Spiral(0.010, 0.08, bars),
        cover=0.03,
    )
    deck = 60e3
    drawn = column(section, 3.6, axial_load=9.81 * deck)
    return replace(drawn, top_mass=deck, damping=0.02)
