"""A tested column, predicted from its drawing under the displacements of the test, rbsdem."""

import numpy as np
from given import DRAWINGS, Drawing

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties


def solve(of: Drawing, displacement: np.ndarray) -> np.ndarray:
    """Return the lateral forces [N] at the displacements [m]."""
    section = RectangularSection(
        of.side,
        of.side,
        Concrete(of.concrete),
        layout=Layout(of.bars, of.bar, Steel(of.bar_yield, of.bar_ultimate)),
        ties=Ties(of.tie, of.spacing, Steel(of.tie_yield), legs=of.legs),
        cover=of.cover,
    )
    column = rbsdem.section.column(section, of.height, axial_load=of.axial_load)
    return rbsdem.cyclic(column, displacement=displacement).force


if __name__ == "__main__":
    test = rbsdem.peer.shipped_reversals("soesianawati_1")
    print(np.c_[test.force, solve(DRAWINGS["soesianawati_1"], test.displacement)])
