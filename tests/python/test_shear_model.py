"""The shear spring of the blind model, and where displacement and axial load act."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import SPECIMEN, write_history, write_table

import rbsdem
from rbsdem import peer
from rbsdem.model.shape import Section
from rbsdem.section.parameters import parameters
from rbsdem.section.shear import cracked_shear_stiffness, shear_spring
from rbsdem.section.strength import (
    arch_factor,
    axial_failure_drift,
    axial_strut,
    column_shear_strength,
    shear_sizes,
    shear_strength_sezen,
    truss,
)
from rbsdem.springs import Elastic

# Slender and well tied; the same squat, with few ties and much steel.
SLENDER = replace(
    SPECIMEN, name="Slender", length=2.0, concrete_strength=30e6, axial_load=700e3, cover=0.025,
    corner_diameter=0.016, intermediate_diameter=0.016, longitudinal_ultimate_stress=620e6,
)  # fmt: skip
SQUAT = replace(
    SLENDER, name="Squat", length=0.8, corner_diameter=0.025, intermediate_diameter=0.025,
    transverse_diameter=0.006, transverse_spacing=0.18, shear_legs=2.0,
)  # fmt: skip
STIFFNESS = 7e8


def section(specimen: peer.Specimen) -> Section:
    return peer.draw(specimen).section


def spring(specimen: peer.Specimen, **numbers: float) -> rbsdem.springs.Pinching:
    given = parameters().with_values(**{f"shear_{name}": v for name, v in numbers.items()})
    s = specimen
    return shear_spring(section(s), s.length, s.axial_load, STIFFNESS, given)[0]


def cycles(specimen: peer.Specimen, *drifts: float) -> np.ndarray:
    steps = [np.linspace(0, 2 * math.pi, 81)[1:] for _ in drifts]
    waves = [drift * np.sin(step) for drift, step in zip(drifts, steps, strict=True)]
    return specimen.length * np.concatenate([[0.0], *waves])


def test_cracked_stiffness_by_hand():
    """Park and Paulay: rho/(1 + 4 n rho) E_s b d."""
    ratio = 3 * math.pi / 4 * 0.01**2 / (0.4 * 0.08)
    modular = 200e9 / ((3320 * math.sqrt(30) + 6900) * 1e6)
    # Bars in tension: three at the face; the two at mid-depth count neither way.
    d = 0.4 - 0.025 - 0.01 - 0.008
    expected = ratio / (1 + 4 * modular * ratio) * 200e9 * 0.4 * d
    assert cracked_shear_stiffness(section(SLENDER)) == pytest.approx(expected)


@pytest.mark.parametrize("load", [0.0, 100e3, 700e3])
@pytest.mark.parametrize("specimen", [SLENDER, SQUAT], ids=lambda s: s.name)
def test_lines_up_to_the_largest_force(specimen, load):
    specimen = replace(specimen, axial_load=load)
    one, drawn = spring(specimen, strength=0.9), section(specimen)
    place = specimen.length, specimen.axial_load
    v_n = 0.9 * column_shear_strength(drawn, *place)
    v_s = specimen.shear_legs * math.pi / 4 * specimen.transverse_diameter**2 * 400e6
    v_s *= (0.4 - 0.025 - specimen.transverse_diameter - specimen.corner_diameter / 2) / (
        specimen.transverse_spacing
    )
    assert one.f_y == pytest.approx(v_n)
    # The two relations need not agree on a section with few ties; the lines stay apart.
    v_c = shear_strength_sezen(drawn, *place) - v_s
    assert one.f_c == pytest.approx(min(v_c, 0.9 * v_n))
    assert one.f_cap == pytest.approx(1.02 * v_n)
    assert one.f_c / one.d_c == pytest.approx(STIFFNESS / specimen.length)
    # Ties slip by what they carry, which is not the strut; no steeper than before cracking.
    rise, strut = one.f_y - one.f_c, 0.9 * axial_strut(drawn, *place)
    slip = max((rise - strut) / cracked_shear_stiffness(drawn), rise / (0.9 * STIFFNESS))
    assert one.d_y - one.d_c == pytest.approx(slip * specimen.length)


def test_the_arch_of_a_squat_column_by_hand():
    """k = 4 d/a, less by twice the axial load ratio; without ties 0.4/0.75 of it."""
    drawn = section(SQUAT)
    d = 0.4 - 0.025 - 0.006 - 0.0125
    ratio = 2 * math.pi / 4 * 0.006**2 / (0.4 * 0.18)
    tied = 0.4 / 0.75 + (1 - 0.4 / 0.75) * ratio / (0.06 * math.sqrt(30) / 400)
    gain = (4 * d / 0.8 - 1) * tied
    assert arch_factor(drawn, 0.8, 0.3 * 30e6 * 0.16) == pytest.approx(1 + 0.4 * gain)
    assert arch_factor(drawn, 0.8, 0.0) == pytest.approx(1 + gain)
    assert arch_factor(drawn, 0.1, 0.0) == pytest.approx(1 + tied)
    assert arch_factor(drawn, 4.5 * d, 0.0) == arch_factor(drawn, 0.8, 3e6) == 1.0


def test_the_strength_of_a_column_is_that_of_concrete_ties_and_strut():
    """At the strain at mid-depth of V_n itself: k beta sqrt(f'c) b z + alpha A f d/s + V_p."""
    drawn, load, length = section(SQUAT), 700e3, 0.8
    d = 0.4 - 0.025 - 0.006 - 0.0125
    # Squatter than 4 d: the strut of 4 d. Ties at 0.18 m are closer than 0.75 d.
    strut = load * 0.4 * (0.8 - 0.65 * load / (30e6 * 0.16)) / (2 * 4 * d)
    ties = 2 * math.pi / 4 * 0.006**2 * 400e6 * d / 0.18
    assert axial_strut(drawn, length, load) == pytest.approx(strut)
    assert axial_strut(drawn, 4 * d, load) == pytest.approx(strut)
    assert axial_strut(drawn, 8 * d, load) == pytest.approx(0.5 * strut)
    assert axial_strut(drawn, length, -load) == 0.0
    assert truss(drawn) == pytest.approx(ties)
    v_n = column_shear_strength(drawn, length, load)
    arch = arch_factor(drawn, length, load)
    # The concrete alone, at the same strain: what makes the theory's own strength that of the sum.
    sizes = shear_sizes(drawn)
    strain = (v_n * max(length - d, d) / d + v_n - 0.5 * load) / (2 * 200e9 * sizes.tension_steel)
    least = 0.06 * math.sqrt(30) / 400
    tied = min(max((sizes.tie_ratio / least - 0.9) / 0.1, 0.0), 1.0)
    s_ze = max(35 * 0.9 * d * 1e3 / 35, 0.85 * 0.9 * d * 1e3)
    s_ze += tied * (300 - s_ze)
    beta = 0.4 / (1 + 1500 * max(strain, 0)) * 1300 / (1000 + s_ze)
    concrete = beta * math.sqrt(30) * 1e6 * 0.4 * 0.9 * d
    assert v_n == pytest.approx(arch * concrete + ties + strut)


@pytest.mark.parametrize(("spacing", "share"), [(0.7, 1.0), (0.875, 0.5), (1.0, 0.0), (2.0, 0.0)])
def test_ties_that_a_crack_passes_by_carry_nothing(spacing, share):
    d = 0.4 - 0.025 - 0.006 - 0.0125
    drawn = section(replace(SQUAT, transverse_spacing=spacing * d))
    full = 2 * math.pi / 4 * 0.006**2 * 400e6 / spacing
    assert truss(drawn) == pytest.approx(share * full, abs=1e-6)


def test_what_lasts_and_what_stays_by_hand():
    """Ties and the strut of the axial load stay; the bond demand shortens what lasts."""
    column = peer.column(SQUAT)
    foot, given = column.shear[0], parameters()
    d = 0.4 - 0.025 - 0.006 - 0.0125
    v_s = 2 * math.pi / 4 * 0.006**2 * 400e6 * d / 0.18
    strut = 700e3 * 0.4 * (0.8 - 0.65 * 700e3 / (30e6 * 0.16)) / (8 * d)
    assert foot.s_min == pytest.approx((given.shear_decay_ties * v_s + strut) / foot.f_y)
    demand = 450 * 0.025 / (10 * math.sqrt(30) * 0.8)
    lasts = max(2 * v_s / foot.f_y, 0.1) ** 2 * 0.12 / demand
    # In units of the work at yield of a spring whose ties carry the strut, too.
    slip = foot.d_c + (foot.f_y - foot.f_c) * 0.8 / cracked_shear_stiffness(section(SQUAT))
    assert foot.lambda_s == pytest.approx(given.shear_endurance * lasts * slip / foot.d_y)
    # The force is gone where the axial load is.
    lost = axial_failure_drift(section(SQUAT), 700e3) * 0.8
    assert foot.d_cap + foot.d_pc == pytest.approx(max(lost, foot.d_cap + 0.05 * 0.8))


@pytest.mark.parametrize(
    "change",
    [
        {"transverse_spacing": None},
        {"axial_load": -2e6},
        {"axial_load": -9e6},
        {"axial_load": 4e6},
        {"transverse_spacing": 0.01},
        {"length": 0.1},
        {"concrete_strength": 120e6},
    ],
)
@pytest.mark.parametrize("numbers", [{}, {"cap": 0.0}])
def test_a_spring_comes_of_every_section(change, numbers):
    """The lines stay apart, so that the rule takes them."""
    one = spring(replace(SQUAT, **change), **numbers)
    assert 0 < one.f_c < one.f_y <= one.f_cap
    assert one.f_c / one.d_c > one.f_y / one.d_y


def test_a_slender_column_does_not_know_of_shear_failure():
    """Its shear spring stays on the lines before yield: what lies behind them has no say."""
    d = cycles(SLENDER, 0.005, 0.01, 0.02, 0.03)
    column = peer.column(SLENDER, "layered")
    force = rbsdem.cyclic(column, displacement=d).force
    assert np.max(np.abs(force)) < 0.7 * column.joints("shear")[0].f_y
    other = column.with_parameters(shear_endurance=10.0, shear_pinch_force=0.05)
    assert other.drawing.parameters.shear_endurance == 10.0
    assert np.array_equal(rbsdem.cyclic(other, displacement=d).force, force)


def test_a_squat_column_fails_in_shear():
    d = cycles(SQUAT, 0.005, 0.01, 0.02, 0.03, 0.03, 0.03)
    # An endurance of its own: the test is of the rule, not of fitted numbers.
    column = peer.column(SQUAT, "layered").with_parameters(shear_endurance=100.0)
    foot = column.joints("shear")[0]
    bending = replace(column, shear=[Elastic(foot.f_c / foot.d_c), *column.joints("shear")[1:]])
    force = rbsdem.cyclic(column, displacement=d).force
    strong = rbsdem.cyclic(bending, displacement=d).force
    peak, last = np.max(np.abs(force)), np.max(np.abs(force[-80:]))
    assert np.max(np.abs(strong)) > 1.3 * foot.f_cap
    # The spring carries the lateral force, and the part of the axial load along the joint.
    drift = np.max(np.abs(d)) / SQUAT.length
    assert peak <= foot.f_cap + SQUAT.axial_load * drift
    assert last < 0.8 * peak
    # Pinched: less work than of one that bends.
    assert np.trapezoid(force, d) < 0.5 * np.trapezoid(strong, d)


def test_a_column_that_failed_in_shear_loses_its_axial_load():
    """At the drift of Elwood and Moehle, the sooner the larger the load; never before shear."""
    lost = []
    for load in (700e3, 1400e3):
        column = peer.column(replace(SQUAT, axial_load=load))
        states = rbsdem.cyclic(column, displacement=cycles(SQUAT, 0.01, 0.02, 0.04)).limit_states()
        limit = axial_failure_drift(section(SQUAT), load)
        assert states.drift("axial_failure") == pytest.approx(limit, rel=0.1)
        assert states["axial_failure"].time > states["shear_yield"].time
        lost.append(limit)
    assert lost[1] < lost[0]
    far = rbsdem.cyclic(peer.column(SLENDER), displacement=cycles(SLENDER, 0.01, 0.04))
    assert "axial_failure" not in far.limit_states()


@pytest.mark.parametrize("model", ["paper", "layered"])
def test_axial_load_above_the_top(model):
    """The sections carry P, which acts at L + L_top."""
    high = replace(SLENDER, top_length=0.5, pdelta_code=3)
    column, plain = peer.column(high, model), peer.column(SLENDER, model)
    assert (column.axial_load, column.axial_height) == (700e3, 2.5)
    assert (plain.axial_load, plain.axial_height) == (700e3, None)
    assert column.flexure == plain.flexure
    # With code 4 the net force has the horizontal part of the load in it.
    assert peer.column(replace(high, pdelta_code=4), model).axial_height is None


@pytest.mark.parametrize("measured_mm", [1500, 2000])
def test_displacement_measured_below_the_top(tmp_path, measured_mm):
    """A test that the model made itself: predicted without error wherever it was measured."""
    (specimen,) = write_table(
        tmp_path,
        [{"Lmeas_mm": f"{measured_mm}", "L_mm": "2000", "pdelta_code": "3", "Ltop_mm": "250"}],
    )
    top = cycles(specimen, 0.005, 0.01, 0.02)
    net = peer.predict(specimen, "layered", displacement=top).force
    # Code 3: the hinge of the ram at L + L_top, its other end at the foot.
    force = net + 1.2e6 * np.sin(np.arctan(top / 2.0))
    write_history(tmp_path / "a.csv", top * measured_mm / 2000, force)
    test = specimen.test()
    assert test.displacement == pytest.approx(top, rel=1e-12, abs=1e-15)
    assert peer.predict(specimen, "layered").score("nrmse") < 1e-9
    assert test.base_moment == pytest.approx(net * 2.0 + 1.2e6 * 1.125 * top)


def test_a_round_column_loses_its_axial_load_by_asce_41():
    """theta_y + b of table 10-9, whatever fails first; never without an axial load."""
    drawn = rbsdem.CircularSection(
        0.5, rbsdem.Concrete(30e6), layout=rbsdem.Layout(10, 0.02, rbsdem.Steel(450e6)),
        spiral=rbsdem.Spiral(0.008, 0.15, rbsdem.Steel(450e6)), cover=0.03,
    )  # fmt: skip
    column = rbsdem.section.column(drawn, 2.5, axial_load=500e3)
    d = 2.5 * np.linspace(0.0, 0.09, 400)
    state = rbsdem.cyclic(column, displacement=d).limit_states()["axial_failure"]
    values = rbsdem.codes.code_values(drawn, 2.5, 500e3)
    limit = values["asce_41.b"] + 0.01
    assert state.drift == pytest.approx(limit, abs=0.09 / 399)
    assert (state.lower, state.upper) == pytest.approx((limit, 1.7 * limit))
    light = rbsdem.cyclic(rbsdem.section.column(drawn, 2.5, axial_load=0.0), displacement=d)
    assert "axial_failure" not in light.limit_states()
