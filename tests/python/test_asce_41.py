"""Clauses of ASCE 41-17 on numbers by hand."""

import pytest

from rbsdem.checks import asce_41
from rbsdem.checks.asce_41 import beam_rotations

#: sqrt(psi) in sqrt(MPa).
PSI = 0.083036


@pytest.mark.parametrize(
    ("strength", "period", "site", "c1", "c2"),
    [
        (3, 0.5, "D", 1.133333, 1.02), (3, 0.15, "D", 1.833333, 1 + (2 / 0.15) ** 2 / 800),
        (3, 0.5, "A", 1.0615385, 1.02), (3, 0.8, "F", 1.0520833, 1.0),
        (5, 0.3, "C", 1.4938272, 1.2222222), (0.5, 0.3, "D", 1.0, 1.0),
    ],
)  # fmt: skip
def test_c_1_and_c_2(strength, period, site, c1, c2):
    found = (
        asce_41.inelastic_factor(strength, period, site),
        asce_41.pinching_factor(strength, period),
    )
    assert found == pytest.approx((c1, c2), abs=1e-6)


@pytest.mark.parametrize(
    ("period", "near", "slope", "limit"),
    [(0.8, True, -0.25, 4.287992), (0.8, False, -0.10, 5.647893), (0.4, True, -0.25, 4.159848)],
)
def test_mu_max(period, near, slope, limit):
    # Delta_d 0.20 over 0.06 m, alpha_PDelta -0.05, alpha_2 -0.30.
    found = asce_41.negative_slope(-0.30, -0.05, near_field=near)
    assert found == pytest.approx(slope, rel=1e-12)
    assert asce_41.largest_strength(0.20 / 0.06, found, period) == pytest.approx(limit, abs=1e-6)


def test_mass_factors():
    given = [(1, 0.3), (2, 0.3), (3, 0.3), (3, 1.1)]
    assert [asce_41.mass_factor(*each) for each in given] == [1.0, 1.0, 0.9, 1.0]


def test_a_column_of_500_mm():
    # f'c 35, d 437.5, M/V 1500 mm, 1750 kN, three legs of 10 mm at 100 mm of 460 MPa.
    ties = 235.62, 460.0, 100.0
    found = [
        asce_41.column_shear_strength(35.0, 250e3, 437.5, 1500.0, 1.75e6, ties, mu)
        for mu in (1, 4, 6)
    ]
    assert found == pytest.approx([790.78e3, 672.16e3, 553.55e3], rel=1e-4)
    assert asce_41.column_stiffness(0.2) == pytest.approx(0.4)
    turned = asce_41.column_rotations(0.3, 0.01, 0.3, 50.0, 525.0)
    assert (turned.a, turned.b, turned.c) == pytest.approx((0.0285, 0.0483333, 0.12), abs=1e-7)
    assert turned.io == pytest.approx(0.15 * 0.0285)
    # a = 0.044125: immediate occupancy ends at 0.005
    assert asce_41.column_rotations(0.1, 0.0175, 0.2, 50.0, 525.0).io == 0.005


@pytest.mark.parametrize(
    ("conforming", "bars", "psi", "printed"),
    [
        (True, 0.25, 4.5, (0.02, 0.035, 0.00625)),
        (True, 0.1, 4.0, (0.022333, 0.042667, 0.007667)),
        (False, 0.25, 4.5, (0.01125, 0.0175, 0.00325)),
        (False, 0.1, 4.0, (0.015, 0.022667, 0.003833)),
        (True, -0.2, 2.0, (0.025, 0.05, 0.010)),
        (True, 0.7, 8.0, (0.015, 0.02, 0.005)),
        (False, 0.7, 8.0, (0.005, 0.01, 0.0015)),
    ],
)
def test_table_10_7(conforming, bars, psi, printed):
    # The table has 3 and 6 sqrt(psi), which are 0.25 and 0.50 sqrt(MPa) rounded.
    found = beam_rotations(bars, 0.25 + (psi - 3.0) / 12.0, conforming=conforming)
    assert found[:3] == pytest.approx(printed, abs=5e-7)
    assert found[3] == 0.2
    near = beam_rotations(bars, psi * PSI, conforming=conforming)
    assert near[:3] == pytest.approx(printed, rel=0.01)


def test_beams_controlled_by_shear():
    assert asce_41.shear_controlled_rotations(0.5) == (0.0015, 0.01, 0.02)
    assert asce_41.shear_controlled_rotations(0.6) == (0.0015, 0.005, 0.01)
