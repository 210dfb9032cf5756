"""Bars by rows: where they lie by hand, what they are the same as, and case files of them."""

import math
from dataclasses import replace

import pytest

import rbsdem
from rbsdem import Bars, Concrete, InputError, RectangularSection, Steel, Ties
from rbsdem.frames import TeeSection
from rbsdem.run.case import case_of_text

STEEL, OTHER = Steel(450e6, 600e6), Steel(500e6, 650e6)
COMMON = {"concrete": Concrete(25e6), "ties": Ties(0.008, 0.15, Steel(400e6)), "cover": 0.03}
BEAM = RectangularSection(
    0.3, 0.5, top=Bars(4, 0.016), bottom=Bars(3, 0.016), side=Bars(2, 0.012), steel=STEEL, **COMMON
)  # fmt: skip


def area(diameter):
    return math.pi * diameter**2 / 4


def heights(section):
    return sorted({round(y, 9) for y, _, _ in section.bars}, reverse=True)


def test_rows_lie_on_the_ties():
    # 250 - 30 - 8 - 8 = 204 mm; two bars of each side at the thirds between the rows.
    assert heights(BEAM) == pytest.approx([0.204, 0.068, -0.068, -0.204])
    assert BEAM.steel_area == pytest.approx(7 * area(0.016) + 4 * area(0.012), rel=1e-12)
    assert len(BEAM.single_bars) == 11
    # In the corners of the ties: 150 - 30 - 8 - 6 = 106 mm.
    sides = [x for x, y, d in BEAM.place_bars(BEAM.single_bars) if abs(y) < 0.1]
    assert sorted(sides) == pytest.approx([-0.106, -0.106, 0.106, 0.106])


def test_several_rows_with_clear_distances():
    # 25 mm between bars of 20 and 16 mm; 30 mm, or the 32 mm of the thickest bar.
    for rows, second in (
        ([Bars(2, 0.020), Bars(2, 0.016)], 0.202 - 0.010 - 0.025 - 0.008),
        ([Bars(2, 0.020), Bars(2, 0.016, clear=0.03)], 0.202 - 0.010 - 0.030 - 0.008),
        ([Bars(2, 0.020), Bars(2, 0.032)], 0.202 - 0.010 - 0.032 - 0.016),
    ):
        drawn = RectangularSection(0.3, 0.5, top=rows, steel=STEEL, **COMMON)
        assert heights(drawn) == pytest.approx([0.202, second])
        assert drawn.effective_depth == pytest.approx(
            0.25 + sum(y * a for y, a, _ in drawn.bars) / drawn.steel_area
        )


def test_rows_are_the_bars_that_they_name():
    plain = RectangularSection(
        0.3, 0.5, bars=list(BEAM.bars), bar_diameter=BEAM.bar_diameter, **COMMON
    )
    one, two = (rbsdem.section.diagram(each, 0.0).moment for each in (BEAM, plain))
    assert (one == two).all()
    turned = BEAM.mirrored
    assert (turned.top, turned.bottom) == (BEAM.bottom, BEAM.top)
    assert turned.mirrored == BEAM
    assert heights(replace(BEAM, depth=0.6))[0] == pytest.approx(0.254)
    even = replace(BEAM, bottom=BEAM.top)
    assert even.symmetric


def test_bars_of_a_slab_lie_along_it():
    tee = TeeSection(
        0.3, 0.5, top=[Bars(4, 0.016), Bars(18, 0.010)], bottom=Bars(3, 0.016), steel=STEEL,
        flange_width=1.2, flange_thickness=0.12, **COMMON,
    )  # fmt: skip
    assert max(x for x, y, d in tee.place_bars(tee.single_bars) if d < 0.012) > 0.5
    with pytest.raises(InputError, match="top: 18 bars"):
        replace(tee, flange_below=True, top=Bars(18, 0.014))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bars": [(0.2, 1e-3, STEEL)]}, "give bars or rows"),
        ({"layout": rbsdem.Layout(8, 0.016, STEEL)}, "give rows .* or layout"),
        ({"steel": None}, "steel is missing"),
        ({"top": (), "bottom": (), "side": None}, "none needs it"),
        ({"top": Bars(20, 0.016)}, "20 bars of 0.016 m do not fit into a row of 0.224 m"),
        ({"depth": 0.1}, "must not meet"),
        ({"top": 4}, "section: top = 4 must be a sequence of rows"),
        ({"top": [Bars(2, 0.016), 0.016]}, "section: top = 0.016 must be Bars; as Bars"),
    ],
)
def test_refusals(change, words):
    with pytest.raises(InputError, match=words):
        replace(BEAM, **change)


def test_refusals_of_a_row():
    for given, words in (
        ({"number": 0}, "Bars: number = 0 must be"),
        ({"diameter": 16.0}, "20 mm is 0.02"),
        ({"clear": -0.01}, "Bars: clear"),
    ):
        with pytest.raises(InputError, match=words):
            Bars(**{"number": 2, "diameter": 0.016} | given)


def test_rows_of_a_case_file():
    column = RectangularSection(0.4, 0.4, layout=rbsdem.Layout(8, 0.018, STEEL), **COMMON)
    beam = replace(BEAM, top=[Bars(4, 0.016), Bars(2, 0.02, OTHER, clear=0.03)])
    frame = rbsdem.Frame.grid([3.2], [5.6], columns=column, beams=beam, beam_load=20e3)
    text = frame.to_namelist() + "&loading drive = 'displacement', values = 0.01 /\n"
    assert "&row face = 'top', number = 4, diameter = 0.016 /" in text
    again = case_of_text(text).column
    assert again == frame
    assert again.kinds["B-1-1"].sections == (beam, beam)
    for old, new, words in (
        ("face = 'top', number = 4", "face = 'up', number = 4", "'up' is not known"),
        ("face = 'top', number = 4, ", "face = 'top', ", "row: number is missing"),
        ("&row face = 'bottom'", "&row face = 'side'", "'side' appears twice"),
        ("clear = 0.03", "clear = -0.03", "row: clear"),
        ("&row face = 'bottom'", "&bars y = 0.1, area = 1e-4, steel = 1 /\n&row face = 'bottom'",
         "bars or a layout too"),
    ):  # fmt: skip
        assert old in text
        with pytest.raises(InputError, match=words):
            case_of_text(text.replace(old, new, 1))
