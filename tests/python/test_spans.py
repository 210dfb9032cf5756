"""Shear spans M/V of members where their ends yield, and the strength in shear that follows."""

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import BEAM
from samples import UPRIGHT as COLUMN

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.section.columns import plastic_moments
from rbsdem.section.parameters import parameters
from rbsdem.section.spans import beam_spans, line_spans


def test_ends_of_a_beam_by_hand():
    # L = 6 m, w = 10 kN/m, M- = 180 and M+ = 120 kN m: V = 300/6 + 30 and 300/6 - 30 kN.
    both = (180e3, 120e3), (180e3, 120e3)
    start, end = beam_spans(*both, 6.0, 10e3)
    assert start == end == pytest.approx((180 / 80, 3.0))  # 120/20 is beyond half of the length
    # Without load the point of contraflexure is where the two plastic moments meet.
    assert beam_spans(*both, 6.0)[0] == pytest.approx((3.6, 2.4))
    # Under 40 kN/m the hinge that sags is sqrt(2 300/40) m from the end that hogs.
    away = math.sqrt(2 * 300 / 40)
    assert beam_spans(*both, 6.0, 40e3)[1][0] == pytest.approx(180 / (40 * away), rel=1e-12)
    # Where it reaches the other end both formulas are one.
    meets = 2 * 300 / 36
    near, far = (beam_spans(*both, 6.0, 1e3 * meets * f)[0][0] for f in (1 - 1e-9, 1 + 1e-9))
    assert near == pytest.approx(far, rel=1e-8)


def test_lines_of_columns_by_hand():
    # A cantilever wall of three storeys, triangular load: V of the storeys 6, 5, 3 of 6 parts.
    heights = [3.0, 3.0, 3.0]
    wall = line_spans(14.0, [(1e9, 1e9)] * 3, [0.0] * 3, heights, heights, [1.0, 2.0, 3.0])
    # The resultant acts at 14/6 storeys: 7 m above the base, 4 m above the first floor.
    assert wall[0] == pytest.approx((7.0, 4.0))
    assert wall[1] == pytest.approx((4.0 * 6 / 5, 1.8))
    assert wall[2] == pytest.approx((3.0, 0.75))  # none at its head: a quarter of the length
    # Columns that yield before their beams have the two plastic moments.
    weak = line_spans(2.0, [(2.0, 3.0), (1.0, 1.0)], [9.0, 9.0], [3.0, 3.0], [2.5, 2.0], [1, 2])
    assert weak == [pytest.approx((1.0, 1.5)), pytest.approx((1.0, 1.0))]
    # One storey, a beam of half the moment of the column: M/V = 2/3 and 1/3 of its length.
    (portal,) = line_spans(2.0, [(2.0, 2.0)], [1.0], [3.0], [3.0], [1.0])
    assert portal == pytest.approx((2.0, 1.0))
    # On a hinge all of the shear comes from the head.
    (hinged,) = line_spans(0.0, [(2.0, 2.0)], [1.0], [3.0], [3.0], [1.0])
    assert hinged == pytest.approx((0.75, 3.0))


def test_a_loaded_beam_is_stronger_where_it_hogs():
    loaded, free = (rbsdem.section.member(BEAM, 7.0, load=w) for w in (25e3, 0.0))
    hogs, sags = plastic_moments(BEAM, 0.0)
    away = math.sqrt(2 * (hogs + sags) / 25e3)
    (span, _), _ = loaded.shear_spans
    assert span == pytest.approx(hogs / (25e3 * away), rel=1e-9)
    strength = [dict(each.shear)[0.0].f_y for each in (loaded, free)]
    # The spring is that of a member without load of this M/V.
    (alone, _), _ = rbsdem.section.member(BEAM, 2.0).shear_spans
    like = rbsdem.section.member(BEAM, 2.0 * span / alone)
    assert strength[0] == pytest.approx(dict(like.shear)[0.0].f_y, rel=1e-6)
    assert strength[0] > 1.1 * strength[1]


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")  # deeper than the tests
def test_a_wall_cut_at_its_floors_is_no_stronger():
    wall = replace(COLUMN, width=0.2, depth=1.5, layout=rbsdem.Layout(12, 0.016, BEAM.steel))
    more = {"floor_mass": 20e3, "beam_load": 10e3, "ends": 0.0, "pattern": "uniform"}
    weak = replace(BEAM, top=rbsdem.Bars(2, 0.012), bottom=rbsdem.Bars(2, 0.012))
    frame = rbsdem.Frame.grid([3.0] * 4, [5.0], columns=wall, beams=weak, **more)
    cut = frame.kinds["C-1-1"]
    # A cantilever of 12 m has M/V 7.5 m under a uniform load; the beams bend it back a little.
    (span, _), _ = cut.shear_spans
    assert 4.0 < span < 7.5
    halves, whole = (
        rbsdem.section.member(wall, length, axial_load=frame.parts.compression[0])
        for length in (3.0, 2 * span)
    )
    strength = [dict(each.shear)[0.0].f_y for each in (cut, whole, halves)]
    assert strength[0] == pytest.approx(strength[1], rel=0.01)
    assert strength[2] > 1.2 * strength[0]


def test_equal_ends_are_cantilevers_to_the_middle():
    made = rbsdem.section.member(COLUMN, 3.0, axial_load=500e3)
    assert made.shear_spans == ((1.5, 1.5), (1.5, 1.5))


def test_a_run_tells_of_another_m_over_v():
    given = {"beams": BEAM, "floor_mass": 20e3, "beam_load": 25e3}
    frame = rbsdem.Frame.grid([3.2], [5.6], columns=COLUMN, **given)
    beam = frame.kinds["B-1-1"]
    # Made for double its M/V: told with the member and both values.
    wrong = rbsdem.section.member(
        BEAM, beam.length, load=25e3, rigid_end=beam.rigid_end,
        shear_spans=tuple((2 * hogs, sags) for hogs, sags in beam.shear_spans),
    )  # fmt: skip
    built = replace(frame, beams=wrong, drawing=None)
    with pytest.warns(AccuracyWarning, match=r"member B-1-1: .* M/V is .* was found for") as told:
        push = rbsdem.pushover(built, drift=0.02)
    member = push.member("B-1-1")
    row = int(member.shear[:, 1].argmax())
    span = member.moment[row, 1] / member.shear[row, 1]
    assert f"{span:.3g} m, and its" in str(told[0].message)
    # Where the ends yield it is what the springs were made for.
    assert span == pytest.approx(beam.shear_spans[1][0], rel=0.15)


def test_beams_lose_in_cycles_and_columns_more():
    """Bars of beams wear by half of what those of columns do, and grow by a quarter of it."""
    fitted, lost = parameters(), []
    for given in (fitted.with_values(fatigue=0.0), None, fitted):
        kind = rbsdem.section.member(BEAM, 3.0, model_parameters=given)
        mast = rbsdem.Frame.grid([3.0], columns=kind)
        force = np.abs(rbsdem.cyclic(mast, displacement=[0.06, -0.06] * 3).force)
        lost.append(1.0 - force[4:].sum() / force[:2].sum())
    assert lost[0] < 0.002
    assert 0.01 < lost[1] < lost[2] < 0.05
