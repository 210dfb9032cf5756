"""Hollow sections, against closed forms and against solid ones."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
import pytest

import rbsdem
from rbsdem import InputError
from rbsdem.section.hinge import cut

STEEL = rbsdem.Steel(460e6, 600e6)
CONCRETE = rbsdem.Concrete(35e6)
TIES = rbsdem.Ties(0.012, 0.1, STEEL, legs=4)
SPIRAL = rbsdem.Spiral(0.012, 0.1, STEEL)
BOX = rbsdem.RectangularSection(
    2.0,
    3.0,
    CONCRETE,
    layout=rbsdem.Layout(40, 0.025, STEEL, face=9),
    inner_layout=rbsdem.Layout(28, 0.02, STEEL, face=6),
    ties=TIES,
    cover=0.04,
    wall=0.4,
    side_wall=0.3,
)
RING = rbsdem.CircularSection(
    2.5,
    CONCRETE,
    layout=rbsdem.Layout(40, 0.025, STEEL),
    inner_layout=rbsdem.Layout(30, 0.02, STEEL),
    spiral=SPIRAL,
    cover=0.04,
    wall=0.35,
)


def test_sizes_in_closed_form():
    assert BOX.gross_area == pytest.approx(2.0 * 3.0 - 1.4 * 2.2)
    assert BOX._figures["inertia"] == pytest.approx((2.0 * 3.0**3 - 1.4 * 2.2**3) / 12)
    assert BOX._figures["shear_area"] == pytest.approx(5 / 6 * 0.6 * 3.0)
    assert BOX.web_width == pytest.approx(0.6)
    assert RING.gross_area == pytest.approx(math.pi / 4 * (2.5**2 - 1.8**2))
    assert RING._figures["inertia"] == pytest.approx(math.pi / 64 * (2.5**4 - 1.8**4))
    assert RING.web_width == pytest.approx(0.7)


@pytest.mark.parametrize("section", [BOX, RING])
def test_part_near_a_face_is_the_integral_of_the_width(section):
    strips = cut(section, 2000)
    pieces = [(strip.y, strip.area) for strip in (*strips.core, *strips.cover)]
    assert sum(area for _, area in pieces) == pytest.approx(section.gross_area, rel=1e-12)
    for share in (0.05, 0.13, 0.4, 0.77, 1.0):
        depth = share * section.depth
        inside = [(y, a) for y, a in pieces if y < depth - 0.5 * section.depth]
        area, first = section.part(depth)
        assert area == pytest.approx(sum(a for _, a in inside), rel=5e-3)
        assert first == pytest.approx(sum(a * y for y, a in inside), rel=5e-3, abs=5e-3)


def test_core_lies_between_two_hoops():
    """The walls between hoop centre lines, 46 mm from both surfaces."""
    core = sum(strip.area for strip in cut(BOX, 1000).core)
    assert core == pytest.approx(1.908 * 2.908 - 1.492 * 2.292, rel=1e-9)
    core = sum(strip.area for strip in cut(RING, 1000).core)
    assert core == pytest.approx(math.pi / 4 * (2.408**2 - 1.892**2), rel=1e-9)


def test_bars_around_the_void():
    inner = [y for y, area, _ in BOX.bars if area == pytest.approx(math.pi / 4 * 0.02**2)]
    assert len(inner) == 28
    assert max(inner) == pytest.approx(1.1 + 0.04 + 0.012 + 0.01)
    ring = [y for y, area, _ in RING.bars if area == pytest.approx(math.pi / 4 * 0.02**2)]
    assert max(ring) == pytest.approx(0.9 + 0.04 + 0.012 + 0.01)


def test_small_void_is_a_solid_section():
    """As the void vanishes, moments tend to those of the solid section."""
    layout = rbsdem.Layout(8, 0.02, STEEL)
    solid = rbsdem.RectangularSection(0.5, 0.5, CONCRETE, layout=layout, cover=0.03)
    moments = []
    for void in (0.1, 0.01, 0.001):
        box = rbsdem.RectangularSection(
            0.5, 0.5, CONCRETE, layout=layout, cover=0.03, wall=0.25 - 0.5 * void
        )
        moments.append(rbsdem.section.moment_curvature(box, 1e6, 0.01))
    exact = rbsdem.section.moment_curvature(solid, 1e6, 0.01)
    errors = np.abs(np.array(moments) / exact - 1.0)
    assert errors[2] < 1e-4
    assert errors[2] < errors[1] < errors[0] < 0.05


def test_walls_are_not_confined():
    for section in (BOX, RING):
        found = section.confinement
        assert (found.lateral_stress, found.effectiveness) == (0.0, 0.0)
        assert found.fcc == pytest.approx(35e6)
        assert cut(section, 20).confining_stress == 0.0


@pytest.mark.parametrize("section", [BOX, RING])
def test_everything_that_a_section_can_be_asked(section):
    load = 0.05 * 35e6 * section.gross_area
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="hollow"):
        column = rbsdem.section.column(section, 12.0, axial_load=load)
    loop = rbsdem.cyclic(column, displacement=12.0 * rbsdem.protocol([0.005, 0.01]))
    assert loop.summary["status"] == "completed"
    # The strength of the column is that of its section, less the second-order moment.
    peak = rbsdem.section.diagram(section, load).moment.max()
    assert abs(loop.summary["peak_force"]) * 12.0 + load * 0.12 == pytest.approx(peak, rel=0.15)
    code = rbsdem.section.interaction(section, "aci318")
    steel = section.steel_area
    assert code.axial_load[-1] == pytest.approx(
        0.85 * 35e6 * (section.gross_area - steel) + 460e6 * steel
    )
    assert (
        0.0
        < rbsdem.section.shear_strength(section, 12.0, load)
        < 0.25 * 35e6 * section.web_width * 3.0
    )
    assert rbsdem.section.springs(section, 12.0, load).flexure.k_c > 0
    ax = rbsdem.plot.section(section)
    assert len(ax.patches) > len(section.bars)
    plt.close(ax.figure)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wall": 1.5}, "half of the depth"),
        ({"wall": 0.0}, "above 0"),
        ({"side_wall": 1.0}, "half of the width"),
        ({"wall": 0.1}, "leave nothing"),
        ({"layout": None}, "inner_layout goes with layout"),
        ({"inner_layout": 3}, "must be a Layout"),
    ],
)
def test_faults_are_named(changes, words):
    given = {
        "layout": BOX.layout,
        "inner_layout": BOX.inner_layout,
        "ties": TIES,
        "cover": 0.04,
        "wall": 0.4,
    }
    with pytest.raises(InputError, match=words):
        rbsdem.RectangularSection(2.0, 3.0, CONCRETE, **(given | changes))


def test_codes_are_for_solid_sections():
    with pytest.raises(InputError, match="hollow"):
        rbsdem.codes.code_values(BOX, 12.0, 1e6)
