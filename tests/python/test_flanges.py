"""Beams with slabs: tees in closed form, as springs, in frames and in files; effective widths."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import reference_section as reference

import rbsdem
from rbsdem import Concrete, InputError, RectangularSection, Steel, Ties, plot
from rbsdem.frames import FrameNode, Member, TeeSection
from rbsdem.section import diagram, flange_width, moment_curvature, rigid_ends
from rbsdem.section.hinge import strips_of
from rbsdem.section.strength import column_shear_strength, nominal_moment
from rbsdem.springs import Elastic

FY = 420e6
STEEL = Steel(FY, 620e6)
WEB = {
    "width": 0.3, "depth": 0.5, "concrete": Concrete(30e6), "bar_diameter": 0.016,
    "ties": Ties(0.008, 0.1, STEEL), "cover": 0.03,
    "bars": [(-0.2, 0.8e-3, STEEL), (0.2, 1.0e-3, STEEL), (0.19, 0.5e-3, STEEL)],
}  # fmt: skip
TEE = TeeSection(**WEB, flange_width=1.2, flange_thickness=0.12)
#: A tee whose wings are nothing, and the rectangle that it is.
NARROW = TeeSection(**WEB, flange_width=0.3, flange_thickness=0.12)
RECTANGLE = RectangularSection(**WEB)
BOTH_WAYS = pytest.mark.parametrize("tee", [TEE, TEE.mirrored], ids=["above", "below"])

pytestmark = pytest.mark.filterwarnings("ignore:the section has a flange")


@BOTH_WAYS
def test_sizes_and_strips_in_closed_form(tee):
    """The parallel axes of web and wings; strips hold the same, the core is that of the web."""
    side = 1 if tee is TEE else -1
    web, wings = 0.3 * 0.5, 0.9 * 0.12
    centroid = side * wings * 0.19 / (web + wings)
    inertia = 0.3 * 0.5**3 / 12 + web * centroid**2
    inertia += 0.9 * 0.12**3 / 12 + wings * (side * 0.19 - centroid) ** 2
    assert tee.gross_area == pytest.approx(web + wings)
    assert tee.centroid == pytest.approx(centroid)
    assert tee.inertia == pytest.approx(inertia)
    assert (tee.web_width, tee.shear_area) == (0.3, pytest.approx(5 / 6 * web))
    strips = strips_of(tee, 14)
    pieces = [(strip.y, strip.area) for strip in (*strips.core, *strips.cover)]
    assert sum(a for _, a in pieces) == pytest.approx(tee.gross_area)
    assert sum(a * y for y, a in pieces) == pytest.approx(tee.gross_area * centroid)
    assert sum(strip.area for strip in strips.core) == pytest.approx((0.3 - 0.068) * (0.5 - 0.068))
    fine = [
        (strip.y, strip.area)
        for part in ("core", "cover")
        for strip in getattr(strips_of(tee, 2000), part)
    ]
    for depth in (0.05, 0.12, 0.2, 0.42, 0.5):
        inside = [(y, a) for y, a in fine if y < depth - 0.25]
        area, first = tee.part(depth)
        assert area == pytest.approx(sum(a for _, a in inside), rel=1e-3)
        assert first == pytest.approx(sum(a * y for y, a in inside), rel=1e-3)


@BOTH_WAYS
def test_the_uncracked_section_bends_about_its_centroid(tee):
    """E_c I of concrete and bars, each less the concrete that it displaces."""
    modulus = tee.concrete_law["ec"]
    parts = [(tee.centroid, tee.gross_area, tee.inertia)]
    parts += [(y, (200e9 / modulus - 1) * area, 0.0) for y, area, _ in tee.bars]
    centre = sum(y * area for y, area, _ in parts) / sum(area for _, area, _ in parts)
    inertia = sum(own + area * (y - centre) ** 2 for y, area, own in parts)
    assert moment_curvature(tee, 0.0, 1e-5) == pytest.approx(1e-5 * modulus * inertia, rel=2e-5)


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
@BOTH_WAYS
@pytest.mark.parametrize("load", [0.0, 400e3, -150e3])
def test_a_tee_is_that_of_fibres(tee, load):
    """An independent program, cracked and past yield, to both sides."""
    rows = [(1e3 * y, 1e6 * area, 420.0, 620.0) for y, area, _ in tee.bars]
    edge = -130.0 if tee.flange_below else 130.0

    def width(y: np.ndarray) -> np.ndarray:
        return np.where((y - edge) * np.sign(edge) > 0, 1200.0, 300.0)

    fibres = reference.Fibres(500.0, width, 30.0, rows)
    curvature = 0.05 * np.linspace(0.02, 1.0, 12) ** 1.5
    for way in (1, -1):
        expected = fibres.moments(load, way * curvature / 1e3) / 1e3
        moment = moment_curvature(tee, load, way * curvature)
        np.testing.assert_allclose(moment, expected, rtol=5e-4, atol=2e-4 * np.abs(expected).max())


@pytest.mark.parametrize("area", [2e-3, 9.5e-3])
def test_the_fully_plastic_moment(area):
    """A_s f_y (d - a/2) with the block in the flange, or through it, or in the web."""
    block, bars = 0.85 * 30e6, [(-0.2, area, STEEL), (0.2, area, STEEL)]
    # The bars in compression are left out: they would not yield where the block is thin.
    pressed = replace(TEE, bars=bars[:1], bar_diameter=0.03).mirrored
    force = area * FY
    high = force / (block * 1.2)
    moment = force * (0.45 - 0.5 * high)
    if high > 0.12:
        flange = block * 1.2 * 0.12
        high = 0.12 + (force - flange) / (block * 0.3)
        moment = flange * (0.45 - 0.06) + (force - flange) * (0.45 - 0.06 - 0.5 * high)
    assert nominal_moment(pressed, 0.0) == pytest.approx(moment)
    if area > 2e-3:
        return
    high = force / (block * 0.3)
    moment = force * (0.45 - 0.5 * high)
    pulled = replace(TEE, bars=bars[1:], bar_diameter=0.03)
    assert nominal_moment(pulled, 0.0) == pytest.approx(moment)
    # The laws of concrete and steel in the place of the block: the bars have not hardened yet.
    assert diagram(pressed, 0.0).events.peak.moment > moment
    found = moment_curvature(pulled, 0.0, 0.015, tension="bare")
    assert found == pytest.approx(moment, rel=0.01)


def test_a_flange_as_wide_as_the_web_is_none():
    for name in ("gross_area", "inertia", "shear_area", "centroid", "confinement"):
        assert getattr(NARROW, name) == getattr(RECTANGLE, name)
    for load in (0.0, 300e3):
        for one, other in ((NARROW, RECTANGLE), (NARROW.mirrored, RECTANGLE.mirrored)):
            assert (diagram(one, load).moment == diagram(other, load).moment).all()
            assert rbsdem.section.shear_strength(one, 2.0, load) == rbsdem.section.shear_strength(
                other, 2.0, load
            )
    with pytest.warns(rbsdem.errors.AccuracyWarning):
        assert rbsdem.section.member(NARROW, 5.0) == rbsdem.section.member(RECTANGLE, 5.0)
    even = replace(NARROW, bars=[(0.2, 1e-3, STEEL), (-0.2, 1e-3, STEEL)])
    assert even.symmetric


def test_upside_down():
    assert TEE.mirrored.flange_below
    assert TEE.mirrored.mirrored.mirrored == TEE.mirrored
    curvatures = np.linspace(0.002, 0.05, 9)
    for load in (0.0, 200e3):
        assert moment_curvature(TEE, load, -curvatures) == pytest.approx(
            -moment_curvature(TEE.mirrored, load, curvatures), rel=1e-9
        )
    turn = 0.02 * rbsdem.protocol([0.5, 1.0])
    hinges = [rbsdem.section.member(one, 5.0).flexure[0][1] for one in (TEE, TEE.mirrored)]
    assert hinges[1].response(-turn) == pytest.approx(-hinges[0].response(turn), rel=1e-9)
    # A layout is the same from both sides, and stays one.
    layout = rbsdem.Layout(8, 0.016, STEEL)
    laid = replace(TEE, bars=(), bar_diameter=None, layout=layout).mirrored
    assert (laid.layout, laid.flange_below) == (layout, True)


def test_in_a_column_and_its_case_file(tmp_path):
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="the section has a flange"):
        column = rbsdem.section.column(TEE, 2.0, axial_load=50e3)
    loop = rbsdem.cyclic(column, displacement=2.0 * rbsdem.protocol([0.005, 0.02]))
    # Where y > 0 and its flange are in tension, and where y < 0 is.
    for force, section in ((loop.force.max(), TEE), (-loop.force.min(), TEE.mirrored)):
        peak = diagram(section, 50e3).events.peak.moment
        # At 2 % bars have hardened less than at the peak of the diagram.
        assert 2.0 * force == pytest.approx(peak, rel=0.2)
    text = column.to_namelist() + "&loading drive = 'displacement', values = 0.01 /\n"
    (tmp_path / "case.nml").write_text(text)
    assert rbsdem.read_case(tmp_path / "case.nml").column == column
    assert column.drawing.section == TEE
    assert "with a flange of 1200 x 120 mm" in str(TEE)
    with pytest.raises(InputError, match="this section has a flange"):
        rbsdem.codes.code_values(TEE, 2.0, 50e3)
    with pytest.raises(InputError, match="shear diagram: the wings"):
        rbsdem.section.shear_diagram(TEE, 2.0, 0.0)


def test_a_slab_pushed_in_a_frame():
    """The moments of the beam are those of its faces: y > 0 is above."""
    beam = rbsdem.section.member(TEE, 5.6, rigid_end=0.2)
    column = rbsdem.FrameMember(modulus=30e9, area=0.16, inertia=0.1)
    frame = rbsdem.Frame.grid([3.2], [6.0], columns=column, beams=beam, base="pinned")
    push = rbsdem.pushover(frame, drift=0.02)
    start, end = push.member("B-1-1").moment[-1]
    # Pushed to the right, the beam sags at its start and hogs at its end.
    hogs, sags = (diagram(one, 0.0).events for one in (TEE, TEE.mirrored))
    assert hogs.peak.moment > 1.4 * sags.peak.moment
    assert abs(start) == pytest.approx(sags.yielding.moment, rel=0.1)
    assert abs(end) == pytest.approx(hogs.yielding.moment, rel=0.1)


def test_a_beam_that_fails_in_shear_says_so():
    """Its spring yields at the strength of the simplified theory; each end has its own faces."""
    bars = [(-0.2, 2e-3, STEEL), (0.2, 4e-3, STEEL)]
    drawn = replace(TEE, bars=bars, bar_diameter=0.02, ties=None)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="there are no ties"):
        beam = rbsdem.section.member(drawn, 4.0, shear_spans=((2.0, 2.0), (2.0, 2.0)))
    (_, first), *_, (_, last) = beam.shear
    assert last == first.mirrored() != first
    strengths = [
        column_shear_strength(replace(TEE, bars=one, ties=None), 2.0, 0.0)
        for one in ([(-y, area, steel) for y, area, steel in bars], bars)
    ]
    factor = rbsdem.section.parameters().values["shear_strength"]
    assert (first.f_y_neg, first.f_y) == pytest.approx([factor * one for one in strengths])
    # Held against rotation at both ends, it is the same from both sides: the weaker end fails.
    nodes = [
        FrameNode("left", 0, 3, "fixed"),
        FrameNode("right", 4, 3, "free", push_y=1.0, flexure=Elastic(k=1e11)),
        FrameNode("ground", 0, 0, "fixed"),
    ]
    post = Member("post", "ground", "left", rbsdem.FrameMember(30e9, 0.16, 2e-3))
    frame = rbsdem.Frame(
        nodes=nodes, members=[Member("beam", "left", "right", beam), post], pattern="nodes",
        control="y", control_node="right",
    )  # fmt: skip
    for way in (1, -1):
        push = rbsdem.cyclic(frame, displacement=way * np.linspace(0.003, 0.06, 400))
        told = [event for event in push.events if event.group == "shear"]
        assert {event.name for event in told} == {"cracking", "shear_failure", "cap"}
        at = next(event for event in told if event.name == "shear_failure")
        assert abs(at.force) == pytest.approx(min(first.f_y, first.f_y_neg), rel=0.01)
        # The few bars below are pulled at the start where the far end goes up.
        assert (at.end == "start") == (way > 0)


@pytest.mark.parametrize(
    ("section", "length"),
    [
        (RECTANGLE, 2.5),
        (RECTANGLE.mirrored, 2.0),
        (replace(RECTANGLE, concrete=Concrete(45e6), depth=0.6), 2.2),
    ],
)
def test_slip_at_faces_without_axial_load(section, length):
    """At yield the beam of layers turns as plane sections and the slip of Sezen and Moehle do.

    s = eps_y f_y d_b/(8 u) with u = sqrt(f_c) (MPa), and the bar turns the section about the
    neutral axis by s over its distance.
    """
    yields = diagram(section, 0.0, tension="bare").events.yielding
    slip = FY / 1e6 * 16e-3 / (8 * math.sqrt(section.concrete.fc / 1e6))
    deflection = yields.curvature * length**2 / 3 + yields.curvature * slip * length
    beam = rbsdem.section.column(section, length, axial_load=0.0)
    push = rbsdem.cyclic(beam, displacement=np.linspace(0, 2 * deflection, 401)[1:])
    at = np.interp(deflection, push.displacement, push.force)
    assert at * length == pytest.approx(yields.moment, rel=0.12)
    # Parts that have not cracked are stiffer.
    reached = np.interp(yields.moment / length, push.force, push.displacement)
    assert 0.7 < reached / deflection < 1.1


def test_the_figure_has_the_flange_and_its_bars():
    slab = replace(TEE, bars=[*WEB["bars"], (0.22, 2.4e-3, STEEL)])
    axes = plot.section(slab)
    assert axes.get_xlim() == pytest.approx((-648, 648))
    # Above; twelve bars of the slab along it, the others in the web.
    corners = axes.patches[0].get_xy()
    assert np.ptp(corners[corners[:, 1] > 150][:, 0]) == pytest.approx(1200)
    at = [x for x, y, _ in slab.place_bars(slab.single_bars) if y == 0.22]
    assert (len(at), max(at)) == (12, pytest.approx(0.6 - 0.03 - 0.008, abs=2e-3))
    assert max(abs(x) for x, y, _ in slab.place_bars(slab.single_bars) if y != 0.22) < 0.15
    plt.close(axes.figure)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"flange_width": 0.2},
            "flange_width = 0.2 m must be at least the width of the web, 0.3 m",
        ),
        ({"flange_thickness": 0.5}, "flange_thickness = 0.5 m must be above 0 and below the depth"),
        ({"flange_width": 1200}, "flange_width"),
        ({"flange_width": math.nan}, "flange_width"),
        ({"wall": 0.1}, "wall is not for a tee"),
    ],
)
def test_what_is_no_tee(change, words):
    with pytest.raises(InputError, match=words):
        replace(TEE, **change)


def test_effective_widths():
    """ACI 318-19, table 6.3.2.1: slab, webs and span govern in turn; tees and L-sections."""
    assert flange_width(0.3, 0.12, 8.0, 6.0) == pytest.approx(0.3 + 2 * 8 * 0.12)
    assert flange_width(0.3, 0.12, 8.0, 1.5) == pytest.approx(0.3 + 1.5)
    assert flange_width(0.3, 0.12, 6.0, 6.0) == pytest.approx(0.3 + 2 * 6.0 / 8)
    assert flange_width(0.3, 0.12, 12.0, 6.0, sides=1) == pytest.approx(0.3 + 6 * 0.12)
    assert flange_width(0.3, 0.12, 6.0, 6.0, sides=1) == pytest.approx(0.3 + 6.0 / 12)
    with pytest.raises(InputError, match="sides = 3 must be 1 or 2"):
        flange_width(0.3, 0.12, 6.0, 6.0, sides=3)


def test_rigid_ends_of_a_node():
    column = replace(
        RECTANGLE, width=0.4, depth=0.4, bars=[(0.15, 1e-3, STEEL), (-0.15, 1e-3, STEEL)]
    )
    m_b = 0.5 * (nominal_moment(TEE, 0.0) + nominal_moment(TEE.mirrored, 0.0))
    assert rigid_ends(column, TEE, share=1) == (0.25, 0.2)
    assert rigid_ends(column, TEE, share=0.5) == (0.125, 0.1)
    for columns, beams, area in itertools.product((1, 2), (1, 2), np.linspace(5e-4, 2e-3, 12)):
        other = replace(column, bars=[(0.15, area, STEEL), (-0.15, area, STEEL)])
        ratio = columns * nominal_moment(other, 400e3) / (beams * m_b)
        expected = (0.25, 0.0) if ratio > 1.2 else (0.0, 0.2) if ratio < 0.8 else (0.125, 0.1)
        assert rigid_ends([other] * columns, [TEE] * beams, axial_load=400e3) == expected
    for change, words in (
        ({"share": 1.5}, "share = 1.5"),
        ({"axial_load": 1e9}, "axial_load"),
        ({"share": "stiff"}, "must be a number"),
    ):
        with pytest.raises(InputError, match=words):
            rigid_ends(column, TEE, **change)
    with pytest.raises(InputError, match="one beam at least"):
        rigid_ends(column, [])
