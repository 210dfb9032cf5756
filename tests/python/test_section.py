"""Moment-curvature of sections: another program, closed forms, degenerate sections."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest
import reference_section as reference
import strategies
from samples import EIGHT_BARS, STEEL, TWELVE_BARS

import rbsdem
from rbsdem import (
    CircularSection,
    Concrete,
    InputError,
    Layout,
    RectangularSection,
    SolveError,
    Spiral,
    Steel,
    Ties,
)
from rbsdem.section import diagram, moment_curvature
from rbsdem.section.hinge import strips_of

TENSION = ("ts", "bare", "zero")


def tied(**changes) -> RectangularSection:
    """A column of 400 x 400 mm with 8 bars of 20 mm."""
    given = {
        "layout": Layout(8, 0.02, STEEL),
        "ties": Ties(0.01, 0.1, Steel(400e6), legs=3),
        "cover": 0.03,
    }
    return RectangularSection(0.4, 0.4, Concrete(30e6), **(given | changes))


def width(section: rbsdem.model.shape.Section, y: np.ndarray) -> np.ndarray:
    """Return the width of concrete at ordinates, all in mm."""
    half, void = 500 * section.depth, 500 * section.depth - 1e3 * (section.wall or np.inf)
    if isinstance(section, CircularSection):
        outer, inner = (np.sqrt(np.maximum(0, r**2 - y**2)) for r in (half, max(void, 0)))
        return 2 * (outer - inner)
    webs = 2e3 * (section.side_wall or 0)
    return np.where(np.abs(y) < void, webs, 1e3 * section.width)


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
@pytest.mark.parametrize("seed", range(24))
def test_any_section_is_that_of_fibres(seed):
    """Moments and strains of solid and hollow sections, to both sides, or where they end.

    section.md asks for 0.2 per cent between programs.
    """
    rng = np.random.default_rng(seed)
    section = strategies.section(rng)
    tension = TENSION[seed % 3]
    rows = [(1e3 * y, 1e6 * a, 1e-6 * s.fy, 1e-6 * s.fu) for y, a, s in section.bars]
    fc = 1e-6 * section.concrete.fc
    fibres = reference.Fibres(1e3 * section.depth, lambda y: width(section, y), fc, rows, tension)
    least, most = section.axial_capacity
    load = rng.choice([0.0, rng.uniform(0.1, 0.6) * most, 0.3 * least])
    last = rng.uniform(0.01, 0.04) * rng.choice([-1, 1]) / section.depth
    share = np.linspace(0.05, 1.0, 10) ** 1.5
    try:
        moment_curvature(section, load, last * share, tension=tension)
    except SolveError as error:
        end = float(re.search(r"curvature of (\S+) 1/m", str(error))[1])
        with pytest.raises(ValueError, match="no equilibrium"):
            fibres.moments(load, np.array([1.15 * end / 1e3]))
        last = 0.98 * end
    moment, strain = rbsdem.section.strains(section, load, last * share, tension)
    expected = fibres.moments(load, last * share / 1e3) / 1e3
    largest = np.abs(expected).max()
    np.testing.assert_allclose(moment, expected, rtol=5e-4, atol=2e-4 * largest, strict=True)
    for eps0, phi in zip(strain, last * share / 1e3, strict=True):
        assert fibres.sums(eps0, phi)[0] == pytest.approx(load, rel=5e-3, abs=3e-4 * most)
    # Neither their order nor their shape matters.
    mixed, more = rng.permutation(10), {"rtol": 1e-7, "atol": 1e-9 * largest}
    again = moment_curvature(section, load, last * share[mixed].reshape(2, 5), tension=tension)
    np.testing.assert_allclose(again, moment[mixed].reshape(2, 5), **more)


def test_a_section_that_falls_past_its_cracks_and_its_peak():
    """Lightly reinforced: the moment drops at cracking and falls past the peak."""
    bars = [(0.7, 800e-6, STEEL), (-0.7, 800e-6, STEEL)]
    section = RectangularSection(0.3, 1.5, Concrete(25e6), bars=bars, bar_diameter=0.02)
    rows = [(1e3 * y, 1e6 * area, 450.0, 650.0) for y, area, _ in bars]
    fibres = reference.Fibres(1500.0, lambda y: np.full_like(y, 300.0), 25.0, rows)
    for load, last in ((2000e3, 0.02), (0.0, 0.03)):
        curvature = last * np.linspace(0.01, 1.0, 14) ** 1.5
        expected = fibres.moments(load, curvature / 1e3) / 1e3
        moment = moment_curvature(section, load, curvature)
        np.testing.assert_allclose(moment, expected, rtol=5e-4, atol=2e-4 * expected.max())
        assert (np.diff(expected) < 0).any()


def test_laws_are_those_of_the_reference():
    strain = np.linspace(-0.004, 0.012, 4001)
    for fc in (15.0, 30.0, 80.0):
        law = Concrete(fc * 1e6)
        for tension in TENSION:
            expected = 1e6 * reference.concrete(strain, fc, tension)
            np.testing.assert_allclose(law.stress(strain, tension), expected, atol=1.0)
    strain = np.linspace(-0.12, 0.12, 4001)
    np.testing.assert_allclose(
        STEEL.stress(strain), 1e6 * reference.steel(strain, 450.0, 650.0), atol=1.0
    )


def test_strips_converge():
    """The moment with n strips comes to its limit at least linearly, and is within 0.1 per cent."""
    curvature = np.array([0.004, 0.015, 0.05])
    moments = [
        moment_curvature(tied(strips=strips), 8e5, curvature) for strips in (50, 100, 400, 6400)
    ]
    errors = [np.abs(m / moments[-1] - 1.0).max() for m in moments[:-1]]
    assert errors[2] < 3e-4
    assert errors[0] > errors[1] > errors[2]


def test_confinement_only_helps_past_the_peak():
    section = tied()
    curvature = np.array([0.001, 0.08])
    plain = moment_curvature(section, 1e6, curvature)
    core = moment_curvature(section, 1e6, curvature, confined=True)
    assert core[0] == pytest.approx(plain[0], rel=0.03)
    assert core[1] > 1.3 * plain[1]
    found = section.confinement
    assert found.width == pytest.approx(0.33)
    assert found.fcc > 30e6
    assert found.eps_cu == pytest.approx(0.004 + 1.4 * found.ratio * 400e6 * 0.1 / found.fcc)
    assert RectangularSection(0.4, 0.4, Concrete(30e6)).confinement is None


def test_layouts():
    """section.md section 3: n/4 + 1 bars a face, y = h/2 - cover - d_t - d_b/2."""
    rows = [y for y, _, _ in Layout(12, 0.016, STEEL).rectangular(0.4, 0.013 + 0.007)]
    edge = 0.2 - 0.020 - 0.008
    expected = [edge] * 4 + [edge / 3] * 2 + [-edge / 3] * 2 + [-edge] * 4
    np.testing.assert_allclose(rows, expected, rtol=1e-12)
    layout = Layout(
        10, 0.02, STEEL, face=4, between_diameter=0.012, between_steel=Steel(300e6, 400e6)
    )
    bars = layout.rectangular(0.5, 0.04)
    assert len(bars) == 10
    # Bars between the corners touch the same tie.
    assert [round(y, 6) for y, _, _ in bars[:5]] == [0.2, 0.2, 0.204, 0.204, 0.0]
    assert sum(area for _, area, _ in bars) == pytest.approx(
        math.pi / 4 * (4 * 0.02**2 + 6 * 0.012**2)
    )
    circle = CircularSection(0.5, Concrete(30e6), layout=Layout(6, 0.02, STEEL), cover=0.04)
    expected = (0.25 - 0.04 - 0.01) * np.cos(np.arange(6) * np.pi / 3)
    np.testing.assert_allclose([y for y, _, _ in circle.bars], expected, atol=1e-15)


def test_what_follows_from_others_follows_their_changes():
    layout, thicker = Layout(8, 0.02, STEEL), Layout(8, 0.025, STEEL)
    given = {"cover": 0.04, "layout": layout, "ties": Ties(0.01, 0.1, STEEL)}
    section = RectangularSection(0.4, 0.4, Concrete(30e6), **given)
    for changes in ({"ties": None}, {"layout": thicker}, {"cover": 0.05}):
        other = RectangularSection(0.4, 0.4, Concrete(30e6), **given | changes)
        assert dataclasses.replace(section, **changes) == other != section
        assert hash(dataclasses.replace(section, **changes)) == hash(other)
    assert dataclasses.replace(section, layout=None).bar_diameter == pytest.approx(0.02)
    # What was given stays; bars and a layout contradict each other as before.
    own = dataclasses.replace(section, bar_diameter=0.018)
    assert dataclasses.replace(own, layout=thicker).bar_diameter == 0.018
    assert dataclasses.replace(section, side_cover=0.03, cover=0.05).side_cover == 0.03
    assert dataclasses.replace(Steel(400e6), fy=500e6) == Steel(500e6)
    assert dataclasses.replace(Steel(400e6, 550e6), fy=500e6).fu == 550e6
    # Hardening begins after yield, also where nobody says when, as in hoops of 1451 MPa.
    assert (Steel(400e6).eps_sh, Steel(1451e6).eps_sh) == (0.007, 1451e6 / 200e9)
    assert Steel(1451e6).stress(0.00726) == pytest.approx(1451e6, rel=1e-3)
    assert dataclasses.replace(Steel(1451e6), fy=500e6).eps_sh == 0.007
    assert dataclasses.replace(section, layout=None).bars == section.bars
    with pytest.raises(InputError, match="give bars or layout"):
        dataclasses.replace(section, bars=[(0.1, 2e-4, STEEL)])


@pytest.mark.parametrize("shape", ["rectangle", "circle"])
@pytest.mark.parametrize("seed", range(3))
def test_sections_turned(shape, seed):
    """Turned twice a section is as it was; what knows no direction stays."""
    section = strategies.section(np.random.default_rng(seed), shape)
    if shape == "circle":
        section = dataclasses.replace(section, layout=Layout(7 + 2 * seed, 0.02, STEEL))
    turned = section.mirrored
    assert turned is not section
    rows, again = (sorted(one.bars, key=lambda b: b[:2]) for one in (section, turned.mirrored))
    assert [bar[0] for bar in again] == pytest.approx([bar[0] for bar in rows], abs=1e-15)
    assert [bar[1:] for bar in again] == [bar[1:] for bar in rows]
    assert turned.axial_capacity == pytest.approx(section.axial_capacity)
    moments = moment_curvature(section, 1e5, [-0.02, 0.02])
    assert moment_curvature(turned, 1e5, [0.02, -0.02]) == pytest.approx(-moments)
    assert turned.bar_diameter == section.bar_diameter
    assert tied().mirrored is not turned
    assert tied().symmetric


HOOPS = {"diameter": 0.012, "spacing": 0.1, "steel": STEEL}
BOX = RectangularSection(
    2.0,
    3.0,
    Concrete(35e6),
    layout=Layout(40, 0.025, STEEL, face=9),
    inner_layout=Layout(28, 0.02, STEEL, face=6),
    ties=Ties(**HOOPS, legs=4),
    cover=0.04,
    wall=0.4,
    side_wall=0.3,
)
RING = CircularSection(
    2.5,
    Concrete(35e6),
    layout=Layout(40, 0.025, STEEL),
    inner_layout=Layout(30, 0.02, STEEL),
    spiral=Spiral(**HOOPS),
    cover=0.04,
    wall=0.35,
)


def test_sizes_of_hollow_sections_in_closed_form():
    """The core lies between the hoops' centre lines, 46 mm from both surfaces."""
    pi = math.pi
    for section, area, inertia, web, core, inner in (
        (
            BOX,
            2.0 * 3.0 - 1.4 * 2.2,
            (2.0 * 3.0**3 - 1.4 * 2.2**3) / 12,
            0.6,
            1.908 * 2.908 - 1.492 * 2.292,
            1.1 + 0.04 + 0.012 + 0.01,
        ),
        (
            RING,
            pi / 4 * (2.5**2 - 1.8**2),
            pi / 64 * (2.5**4 - 1.8**4),
            0.7,
            pi / 4 * (2.408**2 - 1.892**2),
            0.9 + 0.04 + 0.012 + 0.01,
        ),
    ):
        assert section.gross_area == pytest.approx(area)
        assert section.inertia == pytest.approx(inertia)
        assert section.web_width == pytest.approx(web)
        strips = strips_of(section, 2000)
        assert sum(strip.area for strip in strips.core) == pytest.approx(core, rel=1e-9)
        around = [y for y, a, _ in section.bars if a == pytest.approx(pi / 4 * 0.02**2)]
        assert len(around) == section.inner_layout.number
        assert max(around) == pytest.approx(inner)
        # Its walls are not confined.
        assert (*strips.confining_stress, section.confinement.lateral_stress) == (0.0, 0.0, 0.0)
        assert section.confinement.fcc == pytest.approx(35e6)
        # The part near a face is what the strips have there.
        pieces = [(strip.y, strip.area) for strip in (*strips.core, *strips.cover)]
        for depth in np.array([0.05, 0.13, 0.4, 0.77, 1.0]) * section.depth:
            inside = [(y, a) for y, a in pieces if y < depth - 0.5 * section.depth]
            found, first = section.part(depth)
            assert found == pytest.approx(sum(a for _, a in inside), rel=5e-3)
            assert first == pytest.approx(sum(a * y for y, a in inside), rel=5e-3, abs=5e-3)
    assert BOX.shear_area == pytest.approx(5 / 6 * 0.6 * 3.0)


@pytest.mark.parametrize("section", [BOX, RING], ids=["box", "ring"])
def test_everything_that_a_hollow_section_can_be_asked(section):
    load = 0.05 * 35e6 * section.gross_area
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="hollow"):
        column = rbsdem.section.column(section, 12.0, axial_load=load)
    loop = rbsdem.cyclic(column, displacement=12.0 * rbsdem.protocol([0.005, 0.01]))
    # The strength of the column is that of its section, less the second-order moment.
    peak = diagram(section, load).moment.max()
    assert abs(loop.summary["peak_force"]) * 12.0 + load * 0.12 == pytest.approx(peak, rel=0.15)
    steel = section.steel_area
    assert rbsdem.section.interaction(section, "aci318").axial_load[-1] == pytest.approx(
        0.85 * 35e6 * (section.gross_area - steel) + 450e6 * steel
    )
    strength = rbsdem.section.shear_strength(section, 12.0, load)
    assert 0.0 < strength < 0.25 * 35e6 * section.web_width * 3.0
    assert rbsdem.section.springs(section, 12.0, load).flexure.k_c > 0
    with pytest.raises(InputError, match="hollow"):
        rbsdem.codes.code_values(section, 12.0, load)


def test_events_of_a_diagram():
    section = tied()
    found = diagram(section, 6e5, confined=False, ultimate="drop")
    names = ("cracking", "yielding", "peak", "ultimate")
    at = {name: getattr(found.events, name) for name in names}
    order = [at[name].curvature for name in names]
    assert order == sorted(order)
    for point in at.values():
        # The points are on the curve, and among those of the diagram.
        on = moment_curvature(section, 6e5, point.curvature)
        assert np.shape(on) == ()
        assert on == pytest.approx(point.moment, rel=1e-7)
        assert point.curvature in found.curvature
    law = section.concrete_law
    edge = at["cracking"].strain - 0.2 * at["cracking"].curvature
    assert edge == pytest.approx(-law["ft"] / law["ec"], rel=1e-9)
    bar = max(y for y, _, _ in section.bars)
    stretched = at["yielding"].curvature * bar - at["yielding"].strain
    assert stretched == pytest.approx(450e6 / 200e9, rel=1e-9)
    assert at["ultimate"].moment == pytest.approx(0.8 * at["peak"].moment, rel=1e-6)
    assert found.moment.max() <= at["peak"].moment * (1 + 1e-12)
    near = moment_curvature(section, 6e5, at["peak"].curvature * np.array([0.999, 1.001]))
    assert (near <= at["peak"].moment).all()


def test_rules_of_the_ultimate_point():
    section = tied()
    cover = diagram(section, 6e5, ultimate="cover", eps_cover=0.004).events.ultimate
    assert cover.strain + 0.2 * cover.curvature == pytest.approx(0.004, rel=1e-9)
    mander = diagram(section, 6e5, confined=True, ultimate="mander").events.ultimate
    core = section.confinement
    edge = mander.strain + 0.5 * core.depth * mander.curvature
    assert edge == pytest.approx(core.eps_cu, rel=1e-9)
    steel = diagram(section, 1e5, confined=True, ultimate="steel").events.ultimate
    bar = max(y for y, _, _ in section.bars)
    assert steel.curvature * bar - steel.strain == pytest.approx(0.1, rel=1e-6)
    first = diagram(section, 2.5e6, yielding="first").events.yielding
    assert first.strain + 0.2 * first.curvature == pytest.approx(0.002, rel=1e-9)


@pytest.mark.parametrize("section", [EIGHT_BARS, TWELVE_BARS], ids=["rectangle", "circle"])
def test_two_lines_in_place_of_a_diagram(section):
    """Both go through the first yield; one has equal areas, the other the strains of its moment."""
    load = 0.2 * 30e6 * section.gross_area
    found = diagram(section, load, points=2000)
    assert found.confined
    mander, steel = (diagram(section, load, ultimate=rule).events for rule in ("mander", "steel"))
    both = [one.ultimate.curvature for one in (mander, steel) if one.ultimate]
    assert found.events.ultimate.curvature == min(both)
    end, first = found.events.ultimate, found.events.yielding
    line = found.idealise("caltrans")
    assert line.stiffness == pytest.approx(first.moment / first.curvature, rel=1e-12)
    assert line.yield_moment == pytest.approx(line.stiffness * line.yield_curvature, rel=1e-12)
    at = (found.curvature >= first.curvature) & (found.curvature <= end.curvature)
    straight = np.minimum(line.stiffness * found.curvature[at], line.yield_moment)
    straight = np.trapezoid(straight, found.curvature[at])
    assert straight == pytest.approx(np.trapezoid(found.moment[at], found.curvature[at]), rel=1e-5)
    line = found.idealise("priestley")
    bar = max(y for y, _, _ in section.bars)
    crushed = (found.strain + 0.5 * section.depth * found.curvature) / 0.004
    reached = np.maximum(crushed, (found.curvature * bar - found.strain) / 0.015)
    row = np.flatnonzero(reached >= 1.0)[0]
    nominal = np.interp(1.0, reached[row - 1 : row + 1], found.moment[row - 1 : row + 1])
    assert line.yield_moment == pytest.approx(nominal, rel=1e-4)
    assert line.ductility == pytest.approx(end.curvature / line.yield_curvature)


def test_displacement_capacity_is_the_integral_of_the_curvatures():
    """Linear up to yield and a block of l_p beyond it; l_p of a published example, 0.506 m."""
    found = diagram(EIGHT_BARS, 1750e3)
    for method in ("caltrans", "priestley"):
        line = found.idealise(method)
        given = line.capacity(1.5)
        assert given.hinge_length == pytest.approx(0.506, rel=1e-9)
        slip = 0.0 if method == "caltrans" else 0.253
        lever = 1.5 + slip
        elastic = line.ultimate_moment / line.stiffness
        x = np.linspace(0.0, lever, 200_001)
        block = np.where(x <= given.hinge_length, line.ultimate.curvature - elastic, 0.0)
        curvature = elastic * (1.0 - x / lever) + block
        moved = np.trapezoid(curvature * (lever - x), x)
        assert given.displacement == pytest.approx(moved, rel=1e-4)
        at_yield = line.yield_curvature * lever**2 / 3.0
        assert given.ductility == pytest.approx(given.displacement / at_yield)
    with pytest.raises(InputError, match='must be "caltrans" or "priestley"'):
        found.idealise("best")


def test_no_bars_no_load_no_tension():
    plain = RectangularSection(0.4, 0.4, Concrete(30e6))
    curvature = np.linspace(0, 0.05, 6)
    none = moment_curvature(plain, 0.0, curvature, tension="zero")
    np.testing.assert_array_equal(none, 0.0)
    assert moment_curvature(plain, 0.0, []).shape == (0,)
    # The moment of a block that rocks stays below N h/2.
    rocking = moment_curvature(plain, 5e5, curvature[1:], tension="zero")
    assert ((rocking > 0.07e6) & (rocking < 5e5 * 0.2)).all()
    assert rbsdem.section.strength.shear_strength_mcft(plain, 1.0, 1e5) == 0.0


DOORS = {
    "moment_curvature": lambda section, load: moment_curvature(section, load, 0.01),
    "diagram": diagram,
    "paper": lambda s, load: rbsdem.section.column(s, 1.6, axial_load=load, model="paper"),
    "layered": lambda s, load: rbsdem.section.column(s, 1.6, axial_load=load),
    **{
        call.__name__: lambda section, load, call=call: call(section, 1.6, load)
        for call in (
            rbsdem.section.springs,
            rbsdem.section.shear_diagram,
            rbsdem.section.shear_strength,
            rbsdem.codes.code_values,
        )
    },
}


@pytest.mark.parametrize("door", DOORS)
def test_axial_load_over_capacity(door):
    section = tied()
    least, most = section.axial_capacity
    assert least == pytest.approx(-section.steel_area * 650e6, rel=1e-4)
    for load, kind in ((1.3 * most, "more compression"), (1.05 * least, "tension")):
        with pytest.raises(InputError, match=f"axial_load = .* {kind}.*; compression is positive"):
            DOORS[door](section, load)


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
def test_axial_load_near_capacity():
    section = tied()
    least, most = section.axial_capacity
    held = moment_curvature(section, 0.9 * least, 0.0)
    assert held == pytest.approx(0.0, abs=1.0)
    with pytest.raises(SolveError, match="no longer carries the axial load"):
        moment_curvature(section, 0.9 * most, 0.05)
    assert diagram(section, 0.9 * most).end.curvature < 0.05
    with pytest.raises(InputError, match="controlled by compression"):
        rbsdem.section.springs(section, 1.6, 3e6)
    springs = rbsdem.section.springs(section, 1.6, 3e6, yield_rule="first", shear="none")
    assert springs.flexure.d_y > springs.flexure.d_c
    cracked = moment_curvature(section, -8e5, np.array([0.002, 0.01, 0.05]))
    assert (np.diff(cracked) > 0).all()
    assert cracked[1] < moment_curvature(section, 0.0, 0.01)
    with pytest.raises(InputError, match="the axial load alone cracks"):
        rbsdem.section.springs(section, 1.6, -8e5)
