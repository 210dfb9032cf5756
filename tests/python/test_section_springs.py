"""Springs from the section: the paper's four columns, rules, refusals, figures."""

from __future__ import annotations

import dataclasses
import pickle
from typing import Any

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError
from rbsdem.errors import AccuracyWarning
from rbsdem.section.paper import KEYS, PaperSection, SectionSprings, paper_columns, paper_sections

# By an independent program with the same laws and rules (not part of the project): K_c [N m/rad],
# D_c [rad], K_y, D_y, K_u, B_1.
REFERENCE = {
    "soesianawati_1": (2.5108e8, 3.0723e-4, 7.2997e7, 2.7202e-3, 7.3730e6, 0.26373),
    "tanaka_park_1": (1.6605e8, 4.4627e-4, 4.3916e7, 4.4219e-3, 4.0341e6, 0.33141),
    "tanaka_park_5": (6.0637e8, 2.4026e-4, 1.4567e8, 2.9170e-3, 1.4838e7, 0.23938),
    "zahn_7": (2.1163e8, 4.3067e-4, 6.7329e7, 3.0846e-3, 9.1183e6, 0.37334),
}


def of_paper(paper: PaperSection, **options: Any) -> SectionSprings:
    """Return the springs of a column of table 2, of its own length and axial load."""
    return rbsdem.section.springs(paper.section, paper.length, paper.axial_load, **options)


@pytest.mark.parametrize("key", KEYS)
def test_flexure_agrees_with_the_other_program(key):
    """Its initial stiffness is E_c I/l_p with (E_s/E_c - 1) A_s y^2, within 3 per cent."""
    paper = paper_sections()[key]
    springs, section = of_paper(paper), paper.section
    f = springs.flexure
    assert (f.k_c, f.d_c, f.k_y, f.d_y, f.k_u, f.b1) == pytest.approx(REFERENCE[key], rel=0.005)
    assert (f.b0, f.inner) == (0.4, "kc")
    ec = section.concrete_law["ec"]
    inertia = section.inertia + sum((200e9 / ec - 1) * a * y**2 for y, a, _ in section.bars)
    assert f.k_c == pytest.approx(ec * inertia / springs.hinge_length, rel=0.03)
    assert springs.hinge_length == pytest.approx(
        0.08 * paper.length
        + 0.022e-6 * paper.longitudinal_yield_stress * paper.longitudinal_diameter
    )


@pytest.mark.parametrize(
    ("rule", "factor", "low", "high", "k_u"),
    [
        ("A", 1.0, (1.00, 1.04, 0.92), (1.17, 1.19, 1.16), (0.97, 0.88, 0.40, 0.65)),
        ("A", 0.95, (1.00, 0.99, 0.85), (1.17, 1.13, 1.08), (0.92, 0.83, 0.38, 0.62)),
        ("B", 1.0, (0.89, 1.04, 1.01), (1.08, 1.19, 1.33), (0.93, 0.77, 0.37, 0.60)),
        ("B", 0.95, (0.89, 0.99, 0.94), (1.08, 1.13, 1.23), (0.88, 0.74, 0.35, 0.57)),
    ],
)
def test_bands_of_table_3(rule, factor, low, high, k_u):
    """What a section analysis reproduces of table 3: D_y, M_y, K_y, K_u as section.md has them.

    The shear spring is the same by every rule.
    """
    ratios = []
    for key, paper in paper_sections().items():
        springs = of_paper(paper, yield_rule=rule, moment_factor=factor)
        f, v, printed = springs.flexure, springs.shear, paper_columns()[key]
        m, s = printed.flexure, printed.shear
        m_y = [one.k_c * one.d_c + one.k_y * (one.d_y - one.d_c) for one in (f, m)]
        ratios.append((f.d_y / m.d_y, m_y[0] / m_y[1], f.k_y / m.k_y, f.k_u / m.k_u))
        assert 0.93 < f.k_c / m.k_c < 1.07
        assert 0.94 < f.d_c / m.d_c < 1.06
        assert 0.80 < v.k / s.k < 1.20
        assert 0.83 < v.d_y / s.d_y < 1.17
        assert 0.95 < v.k * v.d_y / (s.k * s.d_y) < 1.05
    found = np.array(ratios)
    np.testing.assert_allclose(found[:, :3].min(axis=0), low, atol=0.006)
    np.testing.assert_allclose(found[:, :3].max(axis=0), high, atol=0.006)
    np.testing.assert_allclose(found[:, 3], k_u, atol=0.006)


def test_the_line_goes_through_the_events():
    springs = of_paper(paper_sections()["zahn_7"])
    f, events, l_p = springs.flexure, springs.events, springs.hinge_length
    turn = [getattr(events, name).curvature * l_p for name in ("cracking", "yielding", "ultimate")]
    moment = [getattr(events, name).moment for name in ("cracking", "yielding", "ultimate")]
    np.testing.assert_allclose(f.response(turn), moment, rtol=1e-9)


def test_options_of_the_fit():
    paper = paper_sections()["soesianawati_1"]
    plain = of_paper(paper, shear="none")
    assert plain.shear is None
    # Coexisting shear: the moments of yield and ultimate fall, cracking stays.
    lower = of_paper(paper, moment_factor=0.95, shear="none").flexure
    f = plain.flexure
    assert (lower.k_c, lower.d_c, lower.d_y) == (f.k_c, f.d_c, f.d_y)
    m_y = [s.k_c * s.d_c + s.k_y * (s.d_y - s.d_c) for s in (f, lower)]
    assert m_y[1] / m_y[0] == pytest.approx(0.95, rel=1e-12)
    assert f.k_u > 0
    assert lower.k_u / f.k_u == pytest.approx(0.95, rel=1e-12)
    # Rule B: the same moment at a smaller curvature; 0.89 to 1.08 of table 3.
    b = of_paper(paper, yield_rule="B", shear="none")
    assert b.events.yielding.moment == pytest.approx(plain.events.yielding.moment, rel=1e-9)
    assert b.flexure.d_y < f.d_y
    # Hinge length scales rotations and stiffnesses.
    half = of_paper(paper, hinge_length=plain.hinge_length / 2, shear="none").flexure
    assert half.k_c == pytest.approx(2 * f.k_c)
    assert half.d_y == pytest.approx(f.d_y / 2)
    # B_1 by eq 7 at another rotation, or given.
    other = of_paper(paper, d_m=f.d_y, shear="none").flexure
    assert other.b1 == pytest.approx((m_y[0] + f.k_c * f.d_c) / (f.d_c + f.d_y) / f.k_c)
    assert of_paper(paper, b1=0.5, shear="none").flexure.b1 == 0.5
    closed = of_paper(paper, shear="closed")
    k = 0.48 * 0.5 * paper.section.concrete_law["ec"] * paper.gross_area / paper.length
    assert closed.shear.k == pytest.approx(k, rel=1e-12)
    assert closed.shear.k_post == 0.0


def test_a_falling_moment_is_told():
    paper = paper_sections()["zahn_7"]
    with pytest.warns(AccuracyWarning, match="K_u = -"):
        springs = of_paper(paper, ultimate="drop", shear="none")
    assert springs.flexure.k_u == 0.0
    assert "K_u = -" in springs.report
    report = of_paper(paper).report
    for words in ("400 x 400 mm", "12 bars", "cracking", "yielding", "ultimate", "K_c", "hinge"):
        assert words in report


SECTION = paper_sections()["soesianawati_1"].section
LOAD = 744e3


def tip_stiffness(column: rbsdem.Column) -> float:
    """Of the virgin column, as its static path has it."""
    return float(rbsdem.cyclic(column, force=[1.0]).force[0]) / float(
        rbsdem.cyclic(column, force=[1.0]).displacement[0]
    )


def without_load(column: rbsdem.Column) -> rbsdem.Column:
    """Without second-order effects, which are not the subject here."""
    return dataclasses.replace(column, axial_load=0.0, kinematics="small")


def test_bodies_share_the_springs_of_a_section_as_theory_says():
    """A hinge at the foot, the slip of the whole length, and beyond one body the curvature above.

    The flexibility of the top is H^2/K + 1/K_V + (H - l_p)^3/(3 E I) for any number of bodies from
    2 on; one body has no flexibility above its hinge. The foot alone yields.
    """
    height = 1.6
    springs = rbsdem.section.springs(SECTION, height, LOAD, yield_rule="first")
    k, l_p = springs.flexure.k_c, springs.hinge_length
    above = (height - l_p) ** 3 / (3 * k * l_p)
    strength = []
    for n in (1, 2, 3, 4, 8):
        column = without_load(
            rbsdem.section.column(SECTION, height, axial_load=LOAD, model="paper", n=n)
        )
        flexibility = height**2 / k + 1 / springs.shear.k + (n > 1) * above
        assert tip_stiffness(column) == pytest.approx(1 / flexibility, rel=1e-9)
        # At one rotation of the foot the force is the same, whatever is above it.
        loop = rbsdem.cyclic(column, displacement=np.linspace(0.0, 0.04, 401))
        strength.append(np.interp(0.015, loop.rotation[:, 0], loop.force))
    np.testing.assert_allclose(strength, strength[0], rtol=1e-6)


@pytest.mark.parametrize("kind", ["shear", "flexure"])
def test_springs_of_a_whole_column_are_refused_in_several_joints(kind):
    springs = rbsdem.section.springs(SECTION, 1.6, LOAD)
    elastic = rbsdem.springs.Elastic(1e9)
    given = {"shear": elastic, "flexure": elastic}
    for several in (getattr(springs, kind), [getattr(springs, kind)] * 4):
        with pytest.raises(InputError, match=rf"{kind} is .* whole column.*4 joints.*column\("):
            rbsdem.Column(1.6, 600.0, **(given | {kind: several}), n=4)
    # One of them at the foot, or shared by hand, is what a user may want.
    rbsdem.Column(1.6, 600.0, **(given | {kind: [getattr(springs, kind), *[elastic] * 3]}), n=4)
    rbsdem.Column(1.6, 600.0, **(given | {kind: getattr(springs, kind).split(4)}), n=4)
    again = pickle.loads(pickle.dumps(getattr(springs, kind)))
    with pytest.raises(InputError, match="whole column"):
        rbsdem.Column(1.6, 600.0, **(given | {kind: again}), n=2)


def test_an_axial_load_in_kn_is_noticed():
    for call in (
        lambda: rbsdem.section.springs(SECTION, 1.6, 744.0),
        lambda: rbsdem.section.column(SECTION, 1.6, axial_load=744.0),
    ):
        with pytest.warns(AccuracyWarning, match="744 N is only .* of f'c A; loads are in N"):
            call()
