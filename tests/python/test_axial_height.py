"""An axial load above the top, which leans with the column: its second-order moments."""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem import Column
from rbsdem.springs import Bilinear, Compression, Elastic, Layered

HEIGHT, LOAD = 2.0, 2e5


def column(**options: object) -> Column:
    given = {"n": 3, "kinematics": "pdelta", "axial_load": LOAD} | options
    return Column(HEIGHT, 600.0, Elastic(2e9), Bilinear(6e7, 2e-3, 6e6), **given)


def test_it_has_the_second_order_moments_of_more_load_at_the_top():
    d = [0.0, 0.03, -0.03, 0.05]
    high = rbsdem.cyclic(column(axial_height=2.5), displacement=d).force
    more = rbsdem.cyclic(column(axial_load=1.25 * LOAD), displacement=d).force
    assert high == pytest.approx(more, rel=1e-12)
    assert not np.allclose(high, rbsdem.cyclic(column(), displacement=d).force, rtol=1e-3)


def test_one_joint_in_closed_form():
    """F = k theta/L - P (H/L) theta."""
    one = Column(
        HEIGHT, 600.0, Elastic(1e15), Elastic(5e6), kinematics="pdelta", axial_load=LOAD,
        axial_height=3.0,
    )  # fmt: skip
    force = rbsdem.cyclic(one, displacement=[0.0, 0.02]).force[-1]
    theta = 0.02 / HEIGHT
    assert force == pytest.approx(5e6 * theta / HEIGHT - LOAD * 1.5 * theta, rel=1e-6)


def test_layers_share_the_load_itself():
    """A joint that rocks on its edge has the moment P times the distance of the edge."""
    edge = Compression(k=1e10)
    column = Column(
        HEIGHT, 600.0, Elastic(1e12), Layered([(-0.15, edge), (0.15, edge)]), axial_load=LOAD,
        axial_height=4.0, kinematics="pdelta",
    )  # fmt: skip
    d = 0.02
    force = rbsdem.cyclic(column, displacement=[0.0, d]).force[-1]
    assert force * HEIGHT + LOAD * 4.0 * d / HEIGHT == pytest.approx(0.15 * LOAD, rel=1e-4)
