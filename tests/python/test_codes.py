"""Values of codes and regressions, against worked numbers of each formula.

Column C1: 500 x 500 mm, f'c = 35 MPa, 8 bars of 25 mm of 460 MPa at 62.5 mm from the faces, ties of
three legs of 10 mm at 100 mm, 1750 kN, shear span 1.5 m. The numbers were worked out by hand and by
other programs.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import BAR
from samples import EIGHT_BARS as SECTION
from samples import MILD as STEEL
from samples import TWELVE_BARS as ROUND

import rbsdem
from rbsdem.checks import asce_41, formulas
from rbsdem.checks.code_values import backbones, drift_at_loss, yield_drift
from rbsdem.codes import code_values, compare, quantities
from rbsdem.section.quantities import goodnight_buckling_strain
from rbsdem.section.strength import nominal_moment
from rbsdem.springs import Bilinear, Elastic

C1 = quantities(SECTION, 1.5, 1750e3)


def test_worked_numbers():
    """Of C1, and of published examples."""
    q, f = C1, formulas
    curvature, moment, deep = f.yield_point(q)
    rotations = asce_41.column_rotations(0.2, 0.00471239, 417.066 / 790.78, 35.0, 460.0)
    round_ones = asce_41.column_rotations(
        0.2, 0.00471239, 417.066 / 790.78, 35.0, 460.0, circle=True
    )
    haselton = f.Haselton(q)
    # With the ratio of hoops that the worked number has.
    hoops, circle = replace(q, hoop_ratio=2 * 0.00471239), replace(q, round=True, hoop_ratio=0.01)
    # The example of Elwood and Eberhard: bars of 1.375 in, 36 in deep, 54 in long.
    published = replace(q, bar=1.375 * 25.4, depth=36 * 25.4, span=54 * 25.4)
    for found, expected, rel in (
        ((curvature, moment, deep), (9.155112e-6, 625.599e6, 0.425770), 2e-6),
        ((f.hinge_length_priestley(q), f.hinge_length_paulay(q)), (506.0, 373.0), 1e-6),
        (
            [asce_41.column_stiffness(nu) for nu in (-0.1, 0.1, 0.2, 0.5, 0.9)],
            [0.3, 0.3, 0.4, 0.7, 0.7],
            1e-6,
        ),
        (
            [f.asce_41_shear_strength(q, ductility) for ductility in (1, 2, 4, 6, 9)],
            [790.78e3, 790.78e3, 672.16e3, 553.55e3, 553.55e3],
            1e-5,
        ),
        ((rotations.a, rotations.b, rotations.c), (0.0242384, 0.0453309, 0.16), 3e-6),
        ((rotations.io, rotations.ls, rotations.cp), (0.0036358, 0.0226655, 0.0317316), 2e-5),
        ((round_ones.a, round_ones.b), (0.0346119, 0.0619302), 3e-6),
        (f.ec_8_confinement(q), 0.555983, 2e-6),
        ((f.ec_8_ultimate_rotation(q), f.ec_8_plastic_rotation(q)), (0.0409424, 0.0315025), 2e-6),
        (f.ec_8_yield_rotation(q, cracked=True), 0.0100465, 1e-5),
        (f.ec_8_yield_rotation(q, cracked=False), 0.0089021, 1e-5),
        (
            [f.ec_8_shear_resistance(q, ductility) for ductility in (0, 2, 5, 9)],
            [758.58e3, 701.02e3, 614.69e3, 614.69e3],
            1e-5,
        ),
        ((haselton.capping_rotation, haselton.post_capping_rotation), (0.0421693, 0.0766593), 2e-6),
        (
            (haselton.hardening, haselton.yield_stiffness, haselton.initial_stiffness),
            (1.181551, 0.252549, 0.471357),
            2e-6,
        ),
        (f.elwood_eberhard_stiffness(q), 0.335294, 2e-6),
        (
            [
                f.elwood_eberhard_stiffness(replace(published, load=nu * 35.0 * 250e3))
                for nu in (0.2, 0.4)
            ],
            [0.2499, 0.3815],
            2e-4,
        ),
        (f.berry_spalling_drift(hoops), 0.01664, 1e-6),
        (f.berry_buckling_rotation(hoops), 0.0453154, 2e-5),
        (f.berry_buckling_drift(hoops), 0.042174, 2e-5),
        (f.berry_buckling_rotation(circle), 0.0586721, 2e-5),
        (goodnight_buckling_strain(circle), 0.0261, 1e-6),
        (f.goodnight_buckling_drift(circle), 0.0489, 1e-4),
    ):
        assert found == pytest.approx(expected, rel=rel)


def test_yield_in_compression_under_high_axial_load():
    """Equilibrium of the linear stresses of a section whose concrete is at 1.8 f'c/E_c."""
    q = replace(C1, load=5000e3)
    curvature, moment, deep = formulas.yield_point(q)
    ec = 4700.0 * math.sqrt(35.0)
    axis = deep * q.d
    assert curvature * axis == pytest.approx(1.8 * 35.0 / ec)
    stress = [200e3 * curvature * (axis - y) for y in (62.5, 250.0, 437.5)]
    forces = [s * a for s, a in zip(stress, (q.compression, q.web, q.tension), strict=True)]
    block = 0.5 * ec * curvature * axis**2 * q.width
    # The bars between are spread evenly in the formula; their mean is that of mid-depth.
    assert block + sum(forces) == pytest.approx(5000e3, rel=1e-9)
    arms = block * (250.0 - axis / 3) + (forces[0] - forces[2]) * 187.5
    spread = q.web * 200e3 * curvature * 375.0**2 / 12.0
    assert moment == pytest.approx(arms + spread, rel=1e-9)


# A published test of another program, with its limits: 0.5 on, b falls to zero at 0.7.
@pytest.mark.parametrize(
    ("nu", "a", "b", "c"),
    [(0.3, 0.0285, 0.0483333, 0.12), (0.6, 0.0156, 0.0178261, 0.0), (0.7, 0.0113, 0.0113, 0.0)],
)
def test_asce_41_under_high_axial_load(nu, a, b, c):
    found = asce_41.column_rotations(nu, 0.01, 0.3, 50.0, 525.0)
    assert (found.a, found.b, found.c) == pytest.approx((a, b, c), rel=2e-6)


def area(diameter: float) -> float:
    return 0.25 * math.pi * (1e-3 * diameter) ** 2


def steel(fy: float, fu: float | None = None) -> rbsdem.Steel:
    return rbsdem.Steel(1e6 * fy, None if fu is None else 1e6 * fu, es=200e9)


#: 300 x 600 mm, nothing alike: 4 D25 of 500 MPa in tension, 2 D16 of 300 between, 2 D20 of 420 in
#: compression; D10 at 100 mm of 400 MPa, two legs along the depth and four across.
UNLIKE = rbsdem.RectangularSection(
    0.3,
    0.6,
    rbsdem.Concrete(30e6),
    bars=[
        (0.24, 4 * area(25), steel(500, 625)),
        (0.0, 2 * area(16), steel(300)),
        (-0.245, 2 * area(20), steel(420)),
    ],
    bar_diameter=0.025,
    ties=rbsdem.Ties(0.01, 0.1, steel(400), legs=2, legs_across=4),
    cover=0.03,
)


def test_a_section_where_nothing_is_alike():
    """Every value by hand: 600 kN, span 1.8 m; d = 540, d' = 55 mm, core 230 x 530 mm.

    alpha = (1 - 100/460)(1 - 100/1060)(1 - (2 195^2 + 6 (485/3)^2)/(6 230 530)) = 0.483114, as the
    two legs along the depth leave 195 mm between the corner bars of the width and the four across
    it 485/3 mm on the sides. omega = (1963.5 500 + 402.1 300)/(300 540 30), omega' = 628.3
    420/(300 540 30).
    """
    assert formulas.ec_8_confinement(quantities(UNLIKE, 1.8, 600e3)) == pytest.approx(0.4831136)
    by_hand = {
        "yield.moment": 618627.75,
        "yield.curvature": 0.007822783,
        "hinge.priestley": 0.55,
        "hinge.paulay": 0.419,
        "asce_41.stiffness": 0.3111111,
        "asce_41.shear": 515454.3,
        "asce_41.a": 0.02518551,
        "asce_41.b": 0.06153652,
        "ec_8.yield": 0.01028998,
        "ec_8.ultimate": 0.03571190,
        "ec_8.plastic": 0.02616780,
        "ec_8.shear": 490789.5,
        "elwood.stiffness": 0.2879121,
        "elwood.shear_drift": 0.03848292,
        "elwood.axial_drift": 0.07503535,
        "sezen.shear": 515454.3,
        "haselton.cap": 0.03938418,
        "haselton.stiffness": 0.2,
        "haselton.initial": 0.3558457,
        "berry.spalling": 0.01848889,
        "berry.buckling": 0.04820221,
        "berry.rotation": 0.05143689,
        "goodnight.strain": 0.03674880,
    }
    values = code_values(UNLIKE, 1.8, 600e3)
    assert {name: values[name] for name in by_hand} == pytest.approx(by_hand, rel=1e-6)


def test_the_order_of_bars_does_not_matter():
    """Two steels in one row count by their areas: f_y of the four outer bars is their mean."""
    mixed = rbsdem.RectangularSection(
        0.4,
        0.4,
        rbsdem.Concrete(40e6),
        layout=rbsdem.Layout(12, 0.02, steel(450), between_steel=steel(300)),
        ties=rbsdem.Ties(0.01, 0.08, STEEL, legs=4),
        cover=0.02,
    )
    turned = replace(mixed, layout=None, bars=mixed.bars[::-1], bar_diameter=0.02)
    values, same = code_values(mixed, 1.6, 5e5), code_values(turned, 1.6, 5e5)
    assert {v.name: v.value for v in same} == pytest.approx({v.name: v.value for v in values})
    assert values.quantities.fy == pytest.approx(0.5 * (450 + 300))
    design, other = (
        rbsdem.section.interaction(each, "aci318").design_moment for each in (mixed, turned)
    )
    assert design == pytest.approx(other, abs=1.0)
    assert (values.quantities.fy_compression, values.quantities.fy_web) == pytest.approx((375, 300))


def test_values_have_no_jump_where_a_row_leaves_the_outermost():
    """A second row moves inwards over a fifth of the distance of the rows, 1 mm a step.

    All of what it does is spread over 45 mm; a row that leaves at once changes values by 22 %.
    """

    def values(second):
        bars = [(0.19, 3 * BAR, STEEL), (-0.19, 3 * BAR, STEEL)]
        bars += [(y, BAR, STEEL) for y in (second, -second)]
        found = code_values(replace(SECTION, bars=bars), 1.5, 1e6)
        return np.array([value.value for value in found])

    found = np.array([values(0.19 - 0.38 * share) for share in np.linspace(0.0, 0.2, 77)])
    assert np.abs(np.diff(np.log(found), axis=0)).max() < 0.02
    # As one row, and as a row and a web.
    assert quantities(SECTION, 1.5, 1e6).web == pytest.approx(2e6 * BAR)


def test_values_of_a_drawing():
    values = code_values(SECTION, 1.5, 1750e3)
    assert values["yield.shear"] == pytest.approx(417.066e3, rel=1e-5)
    assert {value.name for value in values if not value.confirmed} == {
        "elwood.shear_drift",
        "berry.spalling",
        "berry.buckling",
    }


def test_backbones_have_their_corners():
    """M_y = 625.599 kNm of C1 with 0.4 E I: theta_y = 0.0053997; then a, b, c of ASCE 41."""
    values = code_values(SECTION, 1.5, 1750e3)
    lines = {line.name: line for line in backbones(values)}
    assert list(lines) == ["ASCE 41", "EC 8-3", "Elwood", "Haselton"]
    at = 625.599e6 * 1500 / (3 * 0.4 * 27806 * 500**4 / 12)
    assert yield_drift(values, "asce_41.stiffness") == pytest.approx(at, rel=1e-4)
    asce = lines["ASCE 41"]
    a, b = values["asce_41.a"], values["asce_41.b"]
    assert asce.drift == pytest.approx([0.0, at, at + a, at + a, at + b, at + b], rel=1e-4)
    assert asce.moment / 625.599e3 == pytest.approx([0, 1, 1, 0.16, 0.16, 0], rel=1e-4)
    # An axial load of 1750 kN leans by 2 % of the span and takes 35 kN.
    lost = asce.force(1.5, 0.0) - asce.force(1.5, 1750e3)
    assert lost == pytest.approx(1750e3 * asce.drift)
    cap = lines["Haselton"].drift[2] - lines["Haselton"].drift[1]
    assert cap == pytest.approx(0.0421693, rel=1e-5)
    assert drift_at_loss(values, "ASCE 41-17, yield + a") == pytest.approx(at + a, rel=1e-4)
    assert math.isnan(drift_at_loss(code_values(ROUND, 3.0, 1e6), "EN 1998-3, theta_um (A.1)"))


def test_a_response_beside_the_codes():
    """The model is a bilinear column, whose quantities are known in closed form."""
    flexure = Bilinear(k=1e8, d_y=0.006, k_post=1e4)
    column = rbsdem.Column(1.5, 100.0, Elastic(1e14), flexure)
    result = rbsdem.cyclic(column, displacement=1.5 * rbsdem.protocol([0.003, 0.02, 0.04]))
    drift = np.linspace(0.0, 0.08, 9)
    test = 1.5 * drift, 3e5 * np.array([0.0, 0.8, 0.9, 1.0, 1.0, 0.9, 0.7, 0.6, 0.5])
    values = code_values(SECTION, 1.5, 1750e3)
    found = compare(values, result, test).to_pandas()
    assert found.loc["largest_force", "model"] == pytest.approx(4e5, rel=0.01)
    assert found.loc["stiffness", "model"] == pytest.approx(1e8 / 1.5**2, rel=1e-6)
    assert found.loc["yield_drift", "model"] == pytest.approx(0.006, rel=0.01)
    assert found.loc["strength_loss", "test"] == pytest.approx(0.055)
    assert math.isnan(found.loc["strength_loss", "model"])
    assert found.loc["strength_loss", "EC 8-3"] == values["ec_8.ultimate"]
    # Without second-order effects the yield force is M_y/L.
    assert found.loc["largest_force", "ASCE 41"] == pytest.approx(625.599e3 / 1.5, rel=1e-5)
    assert found.loc["bar_buckling", "Berry"] == values["berry.buckling"]


def test_double_curvature_is_as_stiff_as_its_halves_in_series():
    """At the same force its top moves twice as far: all sources have half the stiffness."""
    values = code_values(SECTION, 1.5, 1750e3)
    path = rbsdem.protocol([0.002, 0.01])
    found = []
    for height, top in ((1.5, "free"), (3.0, "fixed")):
        column = rbsdem.section.column(SECTION, height, axial_load=1750e3, top=top)
        response = rbsdem.cyclic(column, displacement=height * path, openings=True)
        row = compare(values, response).to_pandas().loc["stiffness"].dropna()
        found.append(row.drop("unit").to_dict())
    free, fixed = found
    assert set(free) == {"model", "ASCE 41", "EC 8-3", "Elwood", "Haselton"}
    assert fixed == pytest.approx({source: 0.5 * value for source, value in free.items()}, rel=1e-3)


def test_circles_have_the_values_of_circles():
    values = code_values(ROUND, 1.8, 1e6)
    assert not any(name.startswith(("ec_8", "haselton")) for name in values.names())
    assert "goodnight.drift" in values.names()
    # Codes take the nominal moment: the line between two close points of the diagram.
    dense = rbsdem.section.interaction(ROUND, "aci318", points=2000)
    assert values["yield.moment"] == pytest.approx(dense.moment_at(1e6), rel=1e-5)
    assert nominal_moment(SECTION, 2880.68e3) == pytest.approx(687.48e3, rel=1e-5)
    assert math.isnan(nominal_moment(SECTION, 9.2e6))
    bare = rbsdem.RectangularSection(
        0.4, 0.4, rbsdem.Concrete(30e6), layout=rbsdem.Layout(8, 0.02, STEEL), cover=0.03
    )
    names = code_values(bare, 1.6, 5e5).names()
    assert "ec_8.ultimate" in names
    assert not {"asce_41.a", "berry.rotation"} & set(names)
