"""Clauses of ACI 318-19 on numbers by hand."""

import pytest

from rbsdem.checks import aci_318
from rbsdem.section.strength import block_share


def test_beams_by_hand():
    assert [block_share(fc) for fc in (20, 28, 35, 56, 70)] == pytest.approx(
        [0.85, 0.85, 0.80, 0.65, 0.65]
    )
    assert aci_318.balanced_ratio(25.0, 500.0, 200e3) == pytest.approx(0.01970455, abs=5e-9)
    # 0.17 sqrt(25) 300 450, and two legs of 8 mm at 150 mm of 500 MPa.
    assert aci_318.one_way_shear(25.0, 300.0, 450.0) == pytest.approx(114.75e3)
    assert aci_318.stirrups(100.531, 500.0, 450.0, 150.0) == pytest.approx(150.8e3, rel=1e-4)
