"""Limit states along a response, against closed forms and against the strains they read."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import SECTION as DRAWN

import rbsdem
from rbsdem import InputError
from rbsdem.springs import Bilinear, Elastic, Layered, PeakOriented, SteelSpring

SECTION = rbsdem.peer.paper_sections()["zahn_7"].section
COLUMN = rbsdem.section.column(SECTION, 1.6, axial_load=1.01e6)
PATH = 1.6 * rbsdem.protocol([0.0025, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07], cycles=2)
RESULT = rbsdem.cyclic(COLUMN, displacement=PATH, openings=True)


def test_states_of_springs_are_where_their_lines_end():
    """A cantilever of one bilinear spring: the rotation at yield times the height, to round-off."""
    flexure = Bilinear(k=1e8, d_y=0.004, k_post=1e6)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    states = rbsdem.cyclic(column, displacement=np.linspace(0.0, 0.02, 30)).limit_states()
    assert states.names() == ["first_yield"]
    assert states["first_yield"].displacement == pytest.approx(0.008, rel=1e-6)
    assert states.drift("first_yield") == pytest.approx(0.004, rel=1e-6)
    assert math.isnan(states.drift("cap"))


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_what_codes_are_not_for_does_not_hide_the_rest():
    """No relation for bar buckling is for tension; cracking and yield are strains all the same."""
    column = rbsdem.section.column(SECTION, 1.6, axial_load=-0.3e6)
    states = rbsdem.cyclic(column, displacement=[0.0, 0.01, 0.03]).limit_states()
    assert {"cracking", "first_yield"} <= set(states.names())


def test_first_state_of_either_side_counts():
    flexure = Bilinear(k=1e8, d_y=0.004, k_post=1e6)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    path = [0.0, 0.004, -0.012, 0.02]
    state = rbsdem.cyclic(column, displacement=path).limit_states()["first_yield"]
    assert (state.row, state.time) == (2, pytest.approx(1.75))
    assert state.displacement == pytest.approx(-0.008)


def test_each_side_has_its_own_lines():
    """Of a capped spring that yields earlier to the negative side."""
    flexure = PeakOriented(
        d_y=0.004, f_y=4e5, d_cap=0.02, f_cap=5e5, d_pc=0.03, d_y_neg=0.002, f_y_neg=2e5
    )
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    result = rbsdem.cyclic(column, displacement=[0.0, 0.006, -0.012, 0.0])
    state = result.limit_states()["first_yield"]
    assert state.displacement == pytest.approx(-0.004)
    assert "d_y_neg" in state.source
    assert result.hinge().yield_rotation == (0.004, 0.002)


def test_a_spring_without_a_cracking_point_does_not_crack():
    """A rigid column on a capped hinge: its only states are yield and cap, at theirs."""
    capped = {"d_y": 0.004, "f_y": 4e5, "d_cap": 0.02, "f_cap": 5e5, "d_pc": 0.03}
    slip = {"d_y": 0.01, "f_y": 1e9, "d_cap": 0.02, "f_cap": 1e9, "d_pc": 0.1}
    column = rbsdem.Column(2.0, 100.0, PeakOriented(**slip), PeakOriented(**capped))
    path = np.linspace(0.0, 0.05, 30)
    states = rbsdem.cyclic(column, displacement=path).limit_states()
    assert states.names() == ["first_yield", "cap"]
    cracked = replace(column, flexure=PeakOriented(**capped, d_c=0.001, f_c=2e5))
    states = rbsdem.cyclic(cracked, displacement=path).limit_states()
    assert states.names() == ["cracking", "first_yield", "cap"]
    # Nor does concrete without tensile strength, under no load, crack at time 0.
    plain = replace(SECTION, concrete=rbsdem.Concrete(SECTION.concrete.fc, ft=0.0))
    rest = rbsdem.cyclic(
        rbsdem.section.column(plain, 1.6, axial_load=0.0), displacement=[0.0, 1e-4], openings=True
    )
    assert "cracking" not in rest.limit_states()


def test_a_steel_spring_yields():
    """At 6.2 times f_y/k the ductility is 6.2, in flexure and in shear."""
    steel = SteelSpring(k=1e8, f_y=4e5, k_post=1e6)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), steel)
    result = rbsdem.cyclic(column, displacement=[0.0, 6.2 * 0.008])
    assert result.hinge().ductility == pytest.approx(6.2, rel=1e-4)
    assert result.hinge().plastic_rotation[-1] == pytest.approx(5.2 * 0.004, rel=1e-4)
    assert result.limit_states()["first_yield"].displacement == pytest.approx(0.008, rel=1e-4)
    shear = rbsdem.Column(2.0, 100.0, steel, Elastic(1e14))
    state = rbsdem.cyclic(shear, displacement=[0.0, 6.2 * 0.004]).limit_states()["shear_yield"]
    assert state.displacement == pytest.approx(0.004, rel=1e-4)


def test_layers_without_a_drawing_yield_where_their_steel_does():
    """Two bars 0.4 m apart that share nothing else: the rotation at yield is 2 f_y/k/0.4."""
    steel = SteelSpring(k=1e8, f_y=2e5, k_post=1e6, r0=20.0)
    flexure = Layered([(-0.2, steel), (0.2, steel)])
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    path = np.linspace(0.0, 0.06, 200)
    result = rbsdem.cyclic(column, displacement=path, openings=True)
    state = result.limit_states()["first_yield"]
    assert state.drift == pytest.approx(0.01, rel=1e-3)
    assert result.hinge().yield_rotation[0] == pytest.approx(0.01, rel=1e-3)


def test_plastic_rotation_and_curvature_of_a_hinge():
    """A rigid column on one bilinear hinge of 0.25 m: the rotation is the drift."""
    flexure = Bilinear(k=1e8, d_y=0.004, k_post=1e6)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    result = rbsdem.cyclic(column, displacement=[0.0, 0.006, 0.02, 0.0, -0.014])
    hinge = result.hinge(length=0.25)
    assert hinge.yield_rotation == (0.004, 0.004)
    expected = [0.0, 0.0, 0.006, 0.0, -0.003]
    assert hinge.plastic_rotation == pytest.approx(expected, abs=1e-8)
    assert hinge.curvature == pytest.approx(4.0 * result.rotation[:, 0])
    assert hinge.plastic_curvature[2] == pytest.approx(0.024, rel=1e-4)
    assert hinge.ductility == pytest.approx(2.5, rel=1e-4)
    with pytest.raises(InputError, match="length"):
        _ = result.hinge().curvature
    with pytest.raises(InputError, match="joint = 2"):
        result.hinge(2)
    # The layered hinge knows its length, and yields where its first bar does.
    states, hinge = RESULT.limit_states(), RESULT.hinge()
    row = states["first_yield"].row
    ends = sorted(abs(hinge.rotation[row - 1 : row + 1]))
    assert ends[0] <= hinge.yield_rotation[0] <= ends[1]
    strains = RESULT.strains(1).value
    middle = (strains[:, 0] - strains[:, 9]) / np.ptp(RESULT.strains(1).position[:10])
    assert abs(hinge.curvature) == pytest.approx(abs(middle), rel=1e-9, abs=1e-12)


def test_loss_of_strength_is_that_of_the_comparison():
    state = RESULT.limit_states()["strength_loss"]
    assert abs(state.displacement) == RESULT.strength_loss()
    side = np.sign(state.displacement)
    lost = side * RESULT.force[state.row] / (side * RESULT.force).max()
    with pytest.raises(KeyError, match="not reached"):
        RESULT.limit_states()["axial_failure"]
    # A repeated cycle steps over the 80 % by what it has lost.
    assert 0.7 < lost <= 0.8


def test_strains_of_the_hinge_are_read():
    states = RESULT.limit_states()
    strains = RESULT.strains(1)
    row = states["first_yield"].row
    at = SECTION.bars[0][2].fy / SECTION.bars[0][2].es
    assert strains.bar_tension[row] >= at > strains.bar_tension[:row].max()
    # The cover's outermost layer lies inside the extreme fibre: it gets there later.
    row = states["nominal_moment"].row
    assert strains.cover_compression[: row - 1].max() < 0.003
    assert states["nominal_moment"].threshold == 0.003
    core = SECTION.confinement
    row = states["hoop_yield"].row
    assert strains.core_compression[: row - 1].max() < core.eps_cc
    order = ["cracking", "first_yield", "nominal_moment", "spalling", "hoop_yield"]
    assert [name for name in states.names() if name in order] == order


def test_bars_of_two_steels_in_a_row_yield_each_at_its_strain():
    """The order in which the bars are listed says nothing: the softer ones yield first."""
    strong, soft = rbsdem.Steel(450e6, 650e6), rbsdem.Steel(300e6, 650e6)
    section = replace(DRAWN, layout=rbsdem.Layout(12, 0.02, strong, between_steel=soft))
    listed = {"layout": None, "bar_diameter": 0.02}
    found = []
    for bars in (section.bars, section.bars[::-1]):
        column = rbsdem.section.column(
            replace(section, **listed, bars=list(bars)), 1.6, axial_load=0.5e6
        )
        result = rbsdem.cyclic(column, displacement=[0.02 * 1.6])
        state = result.limit_states()["first_yield"]
        assert state.threshold == soft.fy / soft.es
        found.append(state.drift)
        # The outermost of them is there at that strain, of all its layers' rows.
        strains, place = result.path.strains(1), max(bar[0] for bar in bars if bar[2] == soft)
        layer = np.flatnonzero((strains.position == place) & (strains.part == "bar"))[0]
        at = np.interp(state.time, result.path.time, strains.value[:, layer])
        assert at == pytest.approx(state.threshold, rel=1e-9)
    assert found[1] == pytest.approx(found[0], rel=1e-9)


def test_states_do_not_depend_on_what_comes_after():
    part = rbsdem.cyclic(COLUMN, displacement=PATH[:700], openings=True).limit_states()
    whole = RESULT.limit_states()
    assert len(part) >= 3
    for state in part:
        if state.name != "strength_loss":
            assert state == whole[state.name]


def test_ends_of_a_path_are_states():
    flexure = Elastic(1e8)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e9), flexure)
    path = np.linspace(0.0, 0.2, 40)
    states = rbsdem.cyclic(column, displacement=path, collapse_drift=0.05).limit_states()
    assert states["collapse"].row == states.result.time.size - 1
    # Near the squash load the layers lose the axial load under a small drift.
    other = rbsdem.peer.paper_sections()["soesianawati_1"].section
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="axial load ratio"):
        heavy = rbsdem.section.column(
            other, 1.6, axial_load=0.9 * other.concrete.fc * other.gross_area
        )
    lost = rbsdem.cyclic(heavy, displacement=np.linspace(0.0, 0.1, 200), openings=True)
    assert lost.summary["status"] == "axial_failure"
    assert lost.limit_states()["axial_failure"].row == lost.time.size - 1


def test_openings_are_asked_for():
    """In time, where another analysis may take long; a static path finds them by itself."""
    column, push = replace(COLUMN, damping=0.02, top_mass=5e4), 3.0 * np.ones(5)
    shaken = rbsdem.time_history(column, np.arange(5) * 0.01, ground_acceleration=push)
    with pytest.raises(InputError, match="openings=True"):
        shaken.limit_states()
    plain = rbsdem.cyclic(COLUMN, displacement=PATH[:700]).limit_states()
    kept = rbsdem.cyclic(COLUMN, displacement=PATH[:700], openings=True).limit_states()
    assert list(plain) == list(kept)
