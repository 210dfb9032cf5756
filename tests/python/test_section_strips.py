"""Sections cut into strips: areas and moments of the shapes, confinement by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import SPECIMEN

from rbsdem import CircularSection, Concrete, RectangularSection, peer
from rbsdem.frames import TeeSection
from rbsdem.section import hinge
from rbsdem.section.hinge import Strip, Strips
from rbsdem.springs import ConcreteSpring

SQUARE = replace(
    SPECIMEN, depth=0.5, cover_perpendicular=0.03, axial_load=1e6, transverse_yield_stress=350e6
)
# Cover to the centre of the spiral: a core of 0.5 - 2 x 0.03.
ROUND = replace(SQUARE, name="Round", section="circular", width=0.5, cover=0.03)
CASED = replace(ROUND, name="Cased", section="square(spiral table)")
ALL = pytest.mark.parametrize("specimen", [SQUARE, ROUND, CASED], ids=lambda s: s.name)

DISC = math.pi / 4 * 0.44**2


def cut(specimen: peer.Specimen, number: int) -> Strips:
    drawing = peer.draw(specimen)
    return hinge.strips_of(
        drawing.section,
        number,
        restrained=drawing.restrained,
        round_core=drawing.round_core,
    )


def total(strips: tuple[Strip, ...], power: int = 0) -> float:
    return sum(strip.area * strip.y**power for strip in strips)


@ALL
@pytest.mark.parametrize("number", [1, 7, 14])
def test_strips_add_up_to_the_shape(specimen, number):
    s = cut(specimen, number)
    gross = math.pi / 4 * 0.25 if specimen is ROUND else specimen.width * 0.5
    core = (0.4 - 0.07) * (0.5 - 0.05) if specimen is SQUARE else DISC
    assert total(s.core) == pytest.approx(core, rel=1e-12)
    assert total(s.cover) == pytest.approx(gross - core, rel=1e-12)
    for strips in (s.core, s.cover):
        assert [strip.y for strip in strips] == pytest.approx(
            [-strip.y for strip in reversed(strips)], abs=1e-15
        )


@ALL
def test_second_moments_converge_with_order_two(specimen):
    """Of areas in their centroids: what is missing is that of the strips about themselves.

    The core of hoops ends at an edge of strips.
    """
    exact = math.pi / 64 * 0.5**4 if specimen is ROUND else specimen.width * 0.5**3 / 12
    missing = []
    for number in (20, 40, 80):
        s = cut(specimen, number)
        missing.append(exact - total(s.core, 2) - total(s.cover, 2))
    assert missing[0] > 0
    assert missing[0] / missing[1] == pytest.approx(4, rel=0.05)
    assert missing[1] / missing[2] == pytest.approx(4, rel=0.05)


def test_places_of_strips():
    """Half a disc has its centroid at 4 r/(3 pi); the core of hoops ends, a ring does not."""
    low, high = cut(ROUND, 2).core
    assert (low.y, high.y) == (pytest.approx(-4 * 0.22 / 3 / math.pi), pytest.approx(-low.y))
    assert len(cut(ROUND, 20).cover) == 20
    s = cut(SQUARE, 20)
    # Strips of 25 mm; the core ends 25 mm from the faces.
    assert (len(s.core), len(s.cover)) == (18, 20)


@pytest.mark.parametrize("specimen", [ROUND, CASED], ids=lambda s: s.name)
def test_confinement_by_a_spiral_by_hand(specimen):
    s = cut(specimen, 10)
    ratio = 4 * (math.pi / 4 * 0.01**2) / (0.44 * 0.08)
    bars = 8 * math.pi / 4 * 0.02**2 / DISC
    effective = (1 - 0.07 / (2 * 0.44)) / (1 - bars)
    assert s.hoop_pressure == pytest.approx([ratio * 350e6] * 2)
    assert s.confining_stress == pytest.approx([0.5 * effective * ratio * 350e6] * 2)


def test_confinement_by_hoops_by_hand():
    """Eight held bars around a core of 330 x 450 mm; three legs."""
    s = cut(SQUARE, 10)
    ratio = 3 * math.pi / 4 * 0.01**2 / (0.08 * 0.33)
    clear = 2 * (0.33 + 0.45) / 8 - 0.02
    bars = 8 * math.pi / 4 * 0.02**2 / (0.33 * 0.45)
    effective = (1 - 8 * clear**2 / 6 / (0.33 * 0.45)) / (1 - bars)
    effective *= (1 - 0.07 / 0.66) * (1 - 0.07 / 0.9)
    assert s.hoop_pressure == pytest.approx([2 * ratio * 350e6] * 2)
    assert s.confining_stress == pytest.approx([effective * ratio * 350e6] * 2)
    for specimen in (SQUARE, ROUND, CASED):
        bare = cut(replace(specimen, transverse_spacing=None), 10)
        assert (*bare.confining_stress, *bare.hoop_pressure) == (0.0, 0.0, 0.0, 0.0)
        assert not bare.core


@ALL
def test_the_strain_at_the_peak_of_the_core(specimen):
    """Mander, Priestley and Park (1988), equation 5: eps_cc/eps_co = 1 + 5 (f_cc/f_co - 1)."""
    springs = [spring for _, spring in peer.column(specimen).joints("flexure")[0].layers]
    concrete = [spring for spring in springs if isinstance(spring, ConcreteSpring)]
    strips = cut(specimen, 10)
    core, cover = concrete[0], concrete[-1]
    gain = core.f_peak / strips.core[0].area / (cover.f_peak / strips.cover[-1].area)
    assert gain > 1.02
    assert core.d_peak / cover.d_peak == pytest.approx(1 + 5 * (gain - 1), rel=1e-7)


def polygon(corners: np.ndarray) -> float:
    """Return the area inside of a closed line."""
    x, y = corners.T
    return 0.5 * abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()))


@pytest.mark.parametrize("wall", [None, 0.15])
def test_outlines_enclose_the_concrete(wall):
    """A rectangle and a tee to round-off, a circle as a polygon."""
    concrete = Concrete(30e6)
    tee = TeeSection(0.3, 0.5, concrete, flange_width=0.9, flange_thickness=0.15)
    made = [
        RectangularSection(0.4, 0.6, concrete, wall=wall),
        CircularSection(0.6, concrete, wall=wall),
    ]
    for section in [*made, tee]:
        found = polygon(section.outline()) - (
            polygon(section.void()) if wall and section.wall else 0.0
        )
        near = 1e-3 if isinstance(section, CircularSection) else 1e-12
        assert found == pytest.approx(section.gross_area, rel=near)
