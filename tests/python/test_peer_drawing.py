"""From properties to the section as drawn: bars, covers, and what the table leaves open."""

from __future__ import annotations

import math
import operator
from dataclasses import replace

import pytest
from samples import SPECIMEN

import rbsdem
from rbsdem import peer
from rbsdem.errors import AccuracyWarning

SQUARE = replace(
    SPECIMEN, depth=0.5, axial_load=1e6, longitudinal_number=12, cover_perpendicular=0.03,
    intermediate_diameter=0.016, intermediate_parallel=3, intermediate_yield_stress=400e6,
    longitudinal_ultimate_stress=600e6, transverse_yield_stress=350e6,
    transverse_ultimate_stress=500e6, transverse_spacing=0.1,
)  # fmt: skip
ROUND = replace(
    SQUARE, name="Round", section="circular", width=0.5, cover=0.03, longitudinal_number=8
)


def area(diameter: float) -> float:
    return math.pi / 4 * diameter**2


def test_bars_of_a_rectangle():
    drawn = peer.draw(SQUARE)
    d = drawn.section
    # Cover 20, hoop 10, half a bar 10: 210 from mid-depth; thinner bars touch the hoop too.
    found = sorted((round(y, 9), a) for y, a, _ in d.bars)
    corner, inner = 2 * area(0.02), area(0.016)
    expected = [
        (-0.212, inner), (-0.21, corner), (-0.105, 2 * inner), (0.0, 2 * inner),
        (0.105, 2 * inner), (0.21, corner), (0.212, inner),
    ]  # fmt: skip
    for (y, a), (y_expected, a_expected) in zip(found, expected, strict=True):
        assert (y, a) == (pytest.approx(y_expected, abs=1e-12), pytest.approx(a_expected))
    assert d.steel_area == pytest.approx(4 * area(0.02) + 8 * area(0.016))
    assert {steel.fy for _, _, steel in d.bars} == {450e6, 400e6}
    assert (d.cover, d.side_cover, d.ties.legs, d.bar_diameter) == (0.02, 0.03, 3.0, 0.02)
    assert not drawn.assumed


@pytest.mark.parametrize("n", [6, 7, 8, 25])
def test_a_round_section_is_the_same_in_both_directions(n):
    """Its cover goes to the centre of the spiral: bars at 250 - 25 - 10 - 10."""
    d = peer.draw(replace(ROUND, longitudinal_number=n)).section
    assert isinstance(d, rbsdem.CircularSection)
    assert d.cover == pytest.approx(0.025)
    assert max(y for y, _, _ in d.bars) == pytest.approx(0.205, rel=0.03)
    assert d.steel_area == pytest.approx(n * area(0.02))
    places = [y for y, _, _ in d.bars]
    assert places == pytest.approx([-y for y in reversed(places)], abs=1e-12)
    # Of a ring: half its polar moment about either axis.
    inertia = sum(a * y**2 for y, a, _ in d.bars)
    assert inertia == pytest.approx(n * area(0.02) * 0.205**2 / 2)


def test_an_octagon_is_a_circle_and_a_square_spiral_is_square():
    assert isinstance(
        peer.draw(replace(ROUND, section="octagonal")).section, rbsdem.CircularSection
    )
    d = peer.draw(replace(ROUND, section="square(spiral table)"))
    assert d.round_core
    assert isinstance(d.section, rbsdem.RectangularSection)


@pytest.mark.parametrize(
    ("change", "name", "value", "said"),
    [
        ({"cover": None}, "cover", 0.025, "cover"),
        ({"cover": None, "cover_perpendicular": None}, "side_cover", 0.025, "cover"),
        ({"transverse_spacing": None}, "ties", None, "no transverse"),
        ({"transverse_diameter": None}, "ties", None, "no transverse"),
        ({"shear_legs": None}, "ties.legs", 2.0, ""),
        ({"shear_legs": None}, "ties.legs_across", 2.0, ""),
        ({"longitudinal_ultimate_stress": None}, "bars", 450e6, "1.5 times"),
        ({"intermediate_perpendicular": None}, "bars", 450e6, "as equal as possible"),
    ],
)
def test_what_the_table_leaves_open(change, name, value, said):
    d = peer.draw(replace(SQUARE, **change))
    found = operator.attrgetter(name)(d.section)
    if name == "bars":
        found = max(steel.fy for _, _, steel in found)
    assert found == pytest.approx(value)
    assert any(said in text for text in d.assumed) if said else not d.assumed


def test_a_yield_stress_that_is_guessed_is_a_warning():
    missing = {"corner_yield_stress": None, "intermediate_yield_stress": None}
    with pytest.warns(AccuracyWarning, match="corner_yield_stress is not given; taken as"):
        d = peer.draw(replace(SQUARE, **missing))
    assert {steel.fy for _, _, steel in d.section.bars} == {420e6}
    assert any("corner_yield_stress" in text for text in d.assumed)
    with pytest.warns(AccuracyWarning, match="transverse_yield_stress is not given; taken as"):
        d = peer.draw(replace(SQUARE, transverse_yield_stress=None))
    assert d.section.ties.steel.fy == pytest.approx(450e6)
    # Ultimate stresses are 1.5 times the yield stress by default.
    none = {"longitudinal_ultimate_stress": None, "transverse_ultimate_stress": None}
    d = peer.draw(replace(SQUARE, **none)).section
    corner = next(steel for _, _, steel in d.bars if steel.fy == 450e6)
    assert (corner.fu, d.ties.steel.fu) == (pytest.approx(675e6), pytest.approx(525e6))


def test_faces_that_do_not_add_up_keep_the_number_of_bars():
    """24 bars, of which the faces tell 12: the others are bundled with them."""
    with pytest.warns(AccuracyWarning, match="bundled bars"):
        d = peer.draw(replace(SQUARE, longitudinal_number=24))
    assert d.section.steel_area == pytest.approx(4 * area(0.02) + 20 * area(0.016))
    assert "times 2.5" in d.assumed[0]


def test_wires_stronger_than_the_plateau_is_long():
    strong = replace(SQUARE, transverse_yield_stress=1424e6, transverse_ultimate_stress=1500e6)
    assert peer.draw(strong).section.confinement is not None


@pytest.mark.filterwarnings("ignore:.*(is not given; taken as|bundled bars)")
def test_every_specimen_of_the_database_is_drawn(peer_folder):
    for specimen in peer.read_specimens(peer_folder):
        section = peer.draw(specimen).section
        assert 0.004 < section.steel_area / specimen.gross_area < 0.09, specimen.name
