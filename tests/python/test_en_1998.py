"""Clauses of EN 1998 on numbers by hand."""

import pytest

from rbsdem.checks import en_1998

#: A column of 500 mm: f_c 35, 8 bars of 25 mm, N 1750 kN, L_V 1500 mm.
CONFINED = 0.555983 * 0.00471239 * 460 / 35
GIVEN = 0.2, 0.088478 / 0.147463, 35.0, 3.0, CONFINED


def test_chord_rotations():
    gaps = ((4.0, 187.5), (4.0, 187.5))
    assert en_1998.confinement((410, 410), 100, gaps) == pytest.approx(0.555983, abs=1e-6)
    assert en_1998.ultimate_rotation(*GIVEN) == pytest.approx(0.0409424, rel=1e-5)
    assert en_1998.plastic_rotation(*GIVEN) == pytest.approx(0.0315025, rel=1e-5)
    # Slender members count up to 9.
    slender = [en_1998.ultimate_rotation(0.2, 1.0, 35.0, s, 0.1) for s in (9, 12)]
    assert slender[0] == slender[1]
    slip = 25.0, 460.0, 35.0
    found = [en_1998.yield_rotation(9.155112e-6, 1500, 500, z, slip) for z in (375.0, 0.0)]
    assert found == pytest.approx([0.0100465, 0.0089021], rel=1e-5)


def test_shear():
    # x 186.27 mm; rho_tot of b h.
    area = 500 * 437.5
    strut = (500 - 186.27) / 3000 * 1.75e6
    ties = 235.62 / 100 * 375 * 460
    found = [
        en_1998.shear_resistance(strut, area, 0.015708, 3.0, 35.0, ties, mu) for mu in (0, 2, 5, 9)
    ]
    assert found == pytest.approx([758.58e3, 701.02e3, 614.69e3, 614.69e3], rel=1e-4)
    # A beam of 300 x 450 mm, f_c 25, four bars of 16 mm above: 99.645 kN against 65.9 at yield.
    cracks = en_1998.shear_without_stirrups(25.0, 300, 450, 804.248 / 135e3, 0.0)
    assert cracks == pytest.approx(99.645e3, rel=1e-4)
    eta = 0.6 * (1 - 25 / 250)
    inner, outer = (en_1998.joint_strength(25, 400, 300, 0.1, exterior=e) for e in (False, True))
    assert inner == pytest.approx(eta * 25 * 120e3 * (1 - 0.1 / eta) ** 0.5)
    assert outer == pytest.approx(0.8 * inner)


@pytest.mark.parametrize(
    ("elastic", "strength", "period", "corner", "reached"),
    [
        (0.0585491, 2.927456, 0.6283185, 0.5, 0.0585491),  # long: equal displacements
        (0.0117720, 1.4715, 0.2513274, 0.5, 0.01550416),
        (0.0117720, 2.943, 0.2513274, 0.5, 0.0194619),
        (0.0088290, 7.3575, 0.2176559, 0.5, 0.0187254),
        (1.0, 0.9, 0.1, 0.5, 1.0),  # elastic
        (1.0, 50.0, 0.01, 1.0, 3.0),  # three elastic displacements at most
    ],
)
def test_targets_of_one_mass(elastic, strength, period, corner, reached):
    found = en_1998.target_of_one_mass(elastic, strength, period, corner)
    assert found == pytest.approx(reached, rel=3e-6)
