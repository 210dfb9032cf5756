"""Blind columns: where their joints are, what the number of bodies changes, what may be fitted."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import peer
from rbsdem.errors import InputError
from rbsdem.peer.layers import hinge_joint

SPECIMEN = peer.Specimen(
    name="Square",
    section="rectangular",
    length=1.6,
    width=0.4,
    depth=0.4,
    concrete_strength=40e6,
    axial_load=1.2e6,
    longitudinal_number=8,
    cover=0.02,
    corner_diameter=0.02,
    intermediate_diameter=0.02,
    intermediate_perpendicular=1,
    intermediate_parallel=1,
    corner_yield_stress=450e6,
    longitudinal_ultimate_stress=650e6,
    transverse_yield_stress=400e6,
    transverse_diameter=0.01,
    transverse_spacing=0.08,
    shear_legs=3.0,
)
# Turning points; every row of a static run is exact.
LOOP = 1.6 * np.array([0.0, 0.003, -0.003, 0.01, -0.01, 0.01, -0.02, 0.03, -0.03, 0.0])


def stiffness_at_first(column: rbsdem.Column, load: float) -> float:
    """Return force over displacement of a small push, with the second-order part taken out."""
    d = 1e-6
    height = sum(column.lengths) if column.lengths is not None else column.height
    force = rbsdem.cyclic(column, displacement=[0.0, d]).force[-1]
    return force / d + load / height


def test_the_number_of_bodies_does_not_matter_in_the_layered_model():
    """The hinge keeps its length, the top its flexibility; P-Delta between the bodies differs."""
    forces = [
        rbsdem.cyclic(peer.column(SPECIMEN, "best", n=n), displacement=LOOP).force
        for n in (2, 3, 5, 9, 17)
    ]
    largest = np.max(np.abs(forces[0]))
    for force in forces[1:]:
        assert np.max(np.abs(force - forces[0])) < 2e-3 * largest


@pytest.mark.parametrize("n", [2, 3, 8])
def test_elastic_stiffness_of_the_layered_model_in_closed_form(n):
    """1/k = (L - l)^3/3EI + (L/k_hinge) L + 1/k_shear, without axial load."""
    bare = replace(SPECIMEN, axial_load=0.0)
    column = peer.column(bare, "best", n=n)
    drawing = peer.draw(bare)
    joint = hinge_joint(drawing, drawing.section(), bare.length, 0.0, peer.Hinge())
    d = 1e-7
    foot = joint.spring.response([d])[0] / d
    length, above = bare.length, bare.length - joint.length
    shear = column.shear[0].f_c / column.shear[0].d_c
    flexibility = above**3 / (3 * joint.flexural_stiffness) + length**2 / foot + 1 / shear
    assert stiffness_at_first(column, 0.0) == pytest.approx(1 / flexibility, rel=2e-3)


@pytest.mark.parametrize("n", [2, 4, 9])
def test_more_bodies_in_the_papers_model_add_the_flexibility_above_the_hinge(n):
    bare = replace(SPECIMEN, axial_load=0.0)
    one, column = peer.column(bare, "paper"), peer.column(bare, "paper", n=n)
    springs = peer.draw(bare).section().springs(bare.length, 0.0, yield_rule="first")
    bending = springs.flexure.k_c * springs.hinge_length
    above = (bare.length - springs.hinge_length) ** 3 / (3 * bending)
    expected = 1 / stiffness_at_first(one, 0.0) + above
    assert 1 / stiffness_at_first(column, 0.0) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("model", ["paper", "best"])
def test_both_directions_are_alike(model):
    column = peer.column(SPECIMEN, model)
    force = rbsdem.cyclic(column, displacement=LOOP).force
    mirrored = rbsdem.cyclic(column, displacement=-LOOP).force
    assert mirrored == pytest.approx(-force, rel=1e-6, abs=1e-6 * np.max(np.abs(force)))


def test_strength_of_the_hinge_is_that_of_the_section():
    """Plane sections with the same strengths: near the confined moment of the section analysis."""
    hinge = peer.Hinge(steel_strength=1.0, concrete_strength=1.0, concrete_size=0.0, growth=0.0)
    spring = peer.column(SPECIMEN, "best", hinge=hinge).flexure[0]
    largest = np.max(spring.response(np.linspace(0, 0.04, 200)[1:]))
    moment = (
        peer.draw(SPECIMEN)
        .section()
        .moment_curvature(1.2e6, np.linspace(0, 0.15, 100)[1:], tension="zero", confined=True)
    )
    assert largest == pytest.approx(np.max(moment), rel=0.1)


@pytest.mark.parametrize(
    ("model", "options", "text"),
    [
        ("best", {"n": 1}, "n = 1: the layered model needs a joint above the hinge; give 2"),
        ("paper", {"n": 0}, "n = 0; give 1 or more"),
        ("best", {"n": 2.5}, "n = 2.5 must be a whole number"),
        ("bets", {}, "'bets' is not known; there are paper, best"),
    ],
)
def test_wrong_choices_are_refused(model, options, text):
    with pytest.raises(InputError, match=text):
        peer.column(SPECIMEN, model, **options)


@pytest.mark.parametrize("load", [9e6, -1.5e6])
def test_an_axial_load_over_the_capacity_is_refused(load):
    crushed = replace(SPECIMEN, axial_load=load)
    with pytest.raises(InputError, match=f"axial load = {load / 1e3:g} kN is not between"):
        peer.column(crushed, "best")


def test_numbers_to_fit_stand_between_their_bounds_and_come_back():
    column = peer.column(SPECIMEN, "best")
    for name, number in column.parameters.items():
        assert number.low < number.value < number.high, name
        other = column.with_parameters(**{name: math.sqrt(number.low * number.high)})
        assert other.parameters[name].value == pytest.approx(math.sqrt(number.low * number.high))
        assert other.n == column.n


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"concrete_strength": 40.0}, "concrete_strength = 40 Pa .* 40 MPa is 40e6"),
        ({"length": 1600.0}, "length = 1600 m .* 1600 mm is 1.6"),
        ({"width": 0.0}, "width = 0 m must be"),
        ({"axial_load": math.nan}, "axial_load = nan N must be"),
        ({"longitudinal_number": 0}, "longitudinal_number = 0"),
        ({"length": -1.0, "depth": 400.0}, "length = -1 m(.|\n)*depth = 400 m"),
    ],
)
@pytest.mark.parametrize("model", ["paper", "best"])
def test_numbers_that_no_column_has_are_refused(model, changed, text):
    with pytest.raises(InputError, match=text):
        peer.column(replace(SPECIMEN, **changed), model)
