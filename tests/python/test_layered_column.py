"""Blind columns: where their joints are, what the number of bodies changes, what may be fitted."""

from __future__ import annotations

import copy
import hashlib
import math
import pickle
from dataclasses import fields, replace

import numpy as np
import pytest
from samples import SECTION, SPECIMEN

import rbsdem
from rbsdem import peer
from rbsdem.errors import InputError
from rbsdem.section.parameters import FACTORS, parameters, table
from rbsdem.springs import Elastic

# Turning points; every row of a static run is exact.
LOOP = 1.6 * np.array([0.0, 0.003, -0.003, 0.01, -0.01, 0.01, -0.02, 0.03, -0.03, 0.0])


def stiffness_at_first(column: rbsdem.Column, load: float) -> float:
    """Return force over displacement of a small push, with the second-order part taken out."""
    d = 1e-6
    height = sum(column.lengths) if column.lengths is not None else column.height
    force = rbsdem.cyclic(column, displacement=[0.0, d]).force[-1]
    return force / d + load / height


def test_the_number_of_bodies_does_not_matter_in_the_layered_model():
    """The hinge keeps its length, the top its flexibility; cracks above spread, P-Delta differs."""
    squat = replace(SPECIMEN, length=0.8, transverse_diameter=0.006, transverse_spacing=0.2)
    for specimen, share in ((SPECIMEN, 4e-3), (squat, 1e-2)):
        path = specimen.length / 1.6 * LOOP
        forces = [
            rbsdem.cyclic(peer.column(specimen, n=n), displacement=path).force
            for n in (2, 3, 5, 9, 17)
        ]
        for force in forces[1:]:
            assert np.max(np.abs(force - forces[0])) < share * np.max(np.abs(forces[0]))


@pytest.mark.parametrize("n", [2, 3, 8])
def test_elastic_stiffness_of_the_layered_model_in_closed_form(n):
    """1/k = (L - l)^3/3EI + (L/k_hinge) L + 1/k_shear, without axial load."""
    bare = replace(SPECIMEN, axial_load=0.0)
    column = peer.column(bare, "layered", n=n)
    joint = column.drawing.joint
    d = 1e-7
    foot = joint.spring.response([d])[0] / d
    length, above = bare.length, bare.length - joint.length
    shear = column.joints("shear")[0].f_c / column.joints("shear")[0].d_c
    flexibility = above**3 / (3 * joint.flexural_stiffness) + length**2 / foot + 1 / shear
    assert stiffness_at_first(column, 0.0) == pytest.approx(1 / flexibility, rel=2e-3)


def test_strength_of_the_hinge_is_that_of_the_section():
    """Plane sections with the same strengths: near the confined moment of the section analysis."""
    plain = parameters().with_values(
        steel_strength=1.0, concrete_strength=1.0, concrete_size=0.0, isotropic_hardening=0.0
    )
    spring = peer.column(SPECIMEN, "layered", model_parameters=plain).flexure[0]
    largest = np.max(spring.response(np.linspace(0, 0.04, 200)[1:], axial_load=1.2e6))
    moment = rbsdem.section.moment_curvature(
        peer.draw(SPECIMEN).section,
        1.2e6,
        np.linspace(0, 0.15, 100)[1:],
        tension="zero",
        confined=True,
    )
    assert largest == pytest.approx(np.max(moment), rel=0.1)


def test_numbers_to_fit_stand_between_their_bounds_and_come_back():
    column = peer.column(SPECIMEN)
    before = column.drawing.parameters.values
    for name, number in column.parameters.items():
        assert number.low < number.value < number.high, name
        middle = math.sqrt(number.low * number.high)
        other = column.with_parameters(**{name: middle})
        # A factor has become one on the values that it has changed.
        assert other.parameters[name].value == pytest.approx(1.0 if name in FACTORS else middle)
        for one in FACTORS[name][0] if name in FACTORS else ():
            assert other.drawing.parameters.values[one] / before[one] == pytest.approx(middle), one
        assert other.n == column.n


@pytest.mark.parametrize(("n", "error"), [(2, 0.05), (17, 0.005)])
def test_the_column_above_cracks_as_a_continuous_one(n, error):
    """Its curvature gains (M - M_c)(1/c - 1)/EI where M is above M_c, at foot moments of 4 M_c."""
    share = 0.4
    given = parameters().with_values(cracked_above=share)
    column = peer.column(SPECIMEN, n=n, model_parameters=given)
    above = column.height - column.drawing.joint.length
    bending = column.drawing.joint.flexural_stiffness
    tensile = 0.6e6 * math.sqrt(40) + 1.2e6 / 0.16
    m_c = tensile * 0.4**3 / 6
    # Foot moment 4 M_c above the hinge: the quarter at the top has not cracked.
    low = above / 4
    gain = 4 * m_c / above * (above**3 - low**3) / 3 - m_c * (above**2 - low**2) / 2
    expected = (4 * m_c * above**2 / 3 + (1 / share - 1) * gain) / bending
    found = 0.0
    for i, spring in enumerate(column.joints("flexure")[1:]):
        lever = above * (1 - (i + 0.5) / (n - 1))
        moment = 4 * m_c * lever / above
        cracking = spring.k_c * spring.d_c
        beyond = max(moment - cracking, 0.0)
        found += lever * (min(moment, cracking) / spring.k_c + beyond / spring.k_y)
    assert found == pytest.approx(expected, rel=error)


def test_a_column_that_does_not_crack_is_elastic_above():
    given = parameters().with_values(cracked_above=0.0)
    column = peer.column(SPECIMEN, model_parameters=given)
    assert all(isinstance(spring, Elastic) for spring in column.joints("flexure")[1:])


@pytest.mark.parametrize("model", ["layered", "paper"])
def test_a_section_makes_the_column_of_the_specimen(model):
    """What a section does not tell follows from it: restrained bars, mass."""
    column = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6, model=model)
    drawn = peer.column(SPECIMEN, model)
    assert (column.height, column.n, column.kinematics) == (1.6, drawn.n, "pdelta")
    assert column.model == {"layered": "layered 2026.8", "paper": "paper"}[model]
    assert column.axial_load == drawn.axial_load
    assert column.mass == pytest.approx(0.4 * 0.4 * 1.6 * 2400)
    force = rbsdem.cyclic(column, displacement=LOOP).force
    expected = rbsdem.cyclic(drawn, displacement=LOOP).force
    assert force == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.max(np.abs(expected)))


def test_parameters_of_another_fit_name_themselves():
    """They are meant for all columns: what a column limits is limited, and not refused."""
    own = replace(parameters().with_values(steel_strength=1.3, stiffness=3.0), version="2099.1")
    column = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6, model_parameters=own)
    assert (column.version, column.model) == ("2099.1", "layered 2099.1")
    assert len(column.drawing.parameters.own) == len(table())


def test_the_table_of_parameters():
    """Its values are part of every answer that names the version: a refit is a new version."""
    values = parameters().values
    digest = hashlib.sha256(repr(sorted(values.items())).encode()).hexdigest()
    assert (parameters().version, len(values), digest[:16]) == ("2026.8", 42, "49a1a16717493c7e")
    for name, row in table().items():
        assert row.meaning, name
        assert not row.low > 1, name
        assert not row.high < 1, name
    ranks = sorted(row.rank for row in table().values() if row.rank)
    assert ranks == list(range(1, len(ranks) + 1))


def test_changed_parameters_are_named_as_changed():
    column = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
    changed = column.with_parameters(steel_strength=1.0)
    assert (column.version, changed.version) == ("2026.8", "2026.8 changed")
    assert (column.model, changed.model) == ("layered 2026.8", "layered 2026.8 changed")
    assert "model = 'layered 2026.8'" in column.to_namelist()
    assert repr(column) == (
        "LayeredColumn(height=1.6, n=2, axial_load=1.2e+06, model='layered 2026.8')"
    )
    back = changed.with_parameters(steel_strength=parameters().steel_strength)
    assert back == column


LAYERED = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
KEPT = {
    "mass": {"mass": 5e3},
    "axial_load": {"axial_load": 1.1e6},
    "kinematics": {"kinematics": "finite"},
    "masses": {"mass": None, "masses": (100.0, 400.0)},
    "lengths": {"lengths": (0.3, 1.3)},
    "shear": {"shear": Elastic(1e9)},
    "flexure": {"flexure": Elastic(1e8)},
    "self_weight": {"self_weight": True},
    "gravity": {"gravity": 9.0},
    "top_mass": {"top_mass": 2e4},
    "top_inertia": {"top_mass": 1.0, "top_inertia": 5.0},
    "depth": {"depth": 0.4},
    "rotary_inertia": {"rotary_inertia": 3.0},
    "damping": {"damping": 0.05},
    "axial_height": {"axial_height": 2.0},
    "axial_force_ratio": {"axial_force_ratio": 1.5},
    "model": {"model": "mine"},
    "footing": {"footing": rbsdem.Footing(Elastic(1e9), Elastic(1e9))},
}
# With the height and the number of bodies the springs are others; joints that open have no layers.
OTHERS = {"height", "n", "drawing", "axial_spring", "top"}


def test_other_parameters_keep_what_was_replaced():
    """Also springs and lengths that are not the model's any more; the others are made anew."""
    assert {field.name for field in fields(LAYERED) if field.init} == set(KEPT) | OTHERS
    made = {"shear", "flexure", "lengths", "model", "drawing"}
    for name, changes in KEPT.items():
        column = replace(LAYERED, **changes)
        assert column.with_parameters() == column
        other = {"steel_strength": 1.0} if name != "flexure" else {"shear_strength": 1.1}
        changed = column.with_parameters(**other)
        for field in {field.name for field in fields(column)} - made | ({name} & made):
            assert getattr(changed, field) == getattr(column, field), (name, field)
        assert changed != column
    for springs, name in (("shear", "shear_strength"), ("flexure", "wear")):
        column = replace(LAYERED, **KEPT[springs])
        assert name in LAYERED.parameters
        assert name not in column.parameters
        with pytest.raises(InputError, match=f"{name} belongs to springs that were replaced"):
            column.with_parameters(**{name: 1.0})


def test_a_calibrated_column_keeps_what_was_replaced():
    pytest.importorskip("scipy")
    column = replace(LAYERED, top_mass=2e4, damping=0.05)
    result = rbsdem.cyclic(LAYERED.with_parameters(steel_strength=1.0), displacement=LOOP)
    test = LOOP, result.force
    fit = rbsdem.calibrate(column, test, ["steel_strength"], evaluations=40)
    assert fit.values["steel_strength"] == pytest.approx(1.0, rel=1e-3)
    assert (fit.column.top_mass, fit.column.damping) == (2e4, column.damping)
    assert fit.column.version == "2026.8 changed"


def test_a_layered_column_comes_back_from_pickle_and_copy():
    for again in (pickle.loads(pickle.dumps(LAYERED)), copy.deepcopy(LAYERED)):
        assert again == LAYERED
        assert again.with_parameters(wear=0.1) == LAYERED.with_parameters(wear=0.1)


STOCKY = rbsdem.section.column(SECTION, 0.7, axial_load=3.5e6)


@pytest.mark.parametrize("column", [LAYERED, STOCKY], ids=["slender", "stocky"])
def test_each_parameter_has_its_say_up_to_its_bounds(column):
    """A value beyond, where the model would take the bound instead, is refused."""

    def springs(**values: float) -> tuple[object, ...]:
        other = column.with_parameters(**values)
        return other.shear, other.flexure, other.lengths

    for name, one in column.parameters.items():
        for place in (0.0, 0.5, 0.9):
            nearer, further = one.at(place), one.at(place + 0.1)
            assert springs(**{name: nearer}) != springs(**{name: further}), (name, place)
    beyond = 0
    for name, (least, most) in column.drawing.limits.items():
        if math.isfinite(most):
            column.with_parameters(**{name: most})
            with pytest.raises(InputError, match=f"{name} = .* is above .* changes nothing"):
                column.with_parameters(**{name: most + 1e-3 * max(abs(most), 1.0)})
            beyond += 1
        if 0 < least < math.inf:
            column.with_parameters(**{name: least})
            with pytest.raises(InputError, match=f"{name} = .* is below .* changes nothing"):
                column.with_parameters(**{name: 0.999 * least})
            beyond += 1
    assert beyond == 12


def test_parameters_of_another_model_are_held_to_the_same_limits():
    changed = parameters().with_values(hinge_length=3.9)
    with pytest.raises(InputError, match=r"hinge_length = 3.9 is above .* changes nothing"):
        rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6, model_parameters=changed)
    for name, value in (("shear_cap", -0.1), ("fatigue", -0.1)):
        changed = parameters().with_values(**{name: value})
        with pytest.raises(InputError, match=f"{name} = {value:g} is below"):
            rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6, model_parameters=changed)


def test_a_parameter_beyond_its_limit_starts_at_the_limit():
    """The version's stiffness above a stocky hinge of high axial load would be above 2."""
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="axial load ratio"):
        column = rbsdem.section.column(SECTION, 1.6, axial_load=5e6)
    stiffness = column.parameters["stiffness"]
    assert column.drawing.parameters.stiffness > column.drawing.limits["stiffness"][1]
    assert stiffness.value == stiffness.high == column.drawing.limits["stiffness"][1]
    same = column.with_parameters(stiffness=stiffness.value)
    assert same.flexure[1].k_c == pytest.approx(column.joints("flexure")[1].k_c)


def test_another_axial_load_draws_the_springs_again():
    """`dataclasses.replace` gives the column that the section makes for that load, bit for bit."""
    section = rbsdem.peer.paper_sections()["zahn_7"].section
    column, other = (
        rbsdem.section.column(section, 1.6, axial_load=load) for load in (0.5e6, 1.0e6)
    )
    again = replace(column, axial_load=1.0e6)
    assert again == other
    assert again.drawing == other.drawing
    assert replace(replace(column, damping=0.02), axial_load=1.0e6) == replace(other, damping=0.02)
    # Springs of the user's own stay as they are.
    own = Elastic(1e9)
    mixed = replace(replace(column, shear=[own, own]), axial_load=1.0e6)
    assert mixed.joints("shear") == (own, own)
    assert mixed.flexure == other.flexure
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="axial load ratio"):
        replace(column, axial_load=0.9 * section.concrete.fc * section.gross_area)


def test_double_curvature_follows_the_axial_load():
    section = rbsdem.peer.paper_sections()["zahn_7"].section
    column = rbsdem.section.column(section, 1.6, axial_load=0.5e6)
    twice = column.double_curvature()
    other = replace(column, axial_load=1e6).double_curvature()
    assert replace(twice, axial_load=1e6) == other
    # Springs of the user's own suit any size.
    own = Elastic(1e9)
    assert replace(column, height=2.0, n=1, lengths=None, shear=own, flexure=own).height == 2.0
