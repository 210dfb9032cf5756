"""Moment-curvature of sections: reference programs, closed forms, symmetry, degenerate sections."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import reference_section as reference

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
    _core,
)

STEEL = Steel(450e6, 650e6)
TENSION = ("ts", "bare", "zero")


def asymmetric() -> tuple[RectangularSection, reference.Fibres]:
    bars = [(0.24, 1500e-6), (0.2, 500e-6), (-0.25, 600e-6)]
    section = RectangularSection(
        0.3, 0.6, Concrete(35e6), bars=[(*bar, STEEL) for bar in bars], bar_diameter=0.02
    )
    rows = [(1e3 * y, 1e6 * area, 450.0, 650.0) for y, area in bars]
    return section, reference.Fibres(600.0, lambda y: np.full_like(y, 300.0), 35.0, rows)


def deep() -> tuple[RectangularSection, reference.Fibres]:
    """Lightly reinforced; the moment drops at cracking and falls past the peak."""
    bars = [(0.7, 800e-6), (-0.7, 800e-6)]
    section = RectangularSection(
        0.3, 1.5, Concrete(25e6), bars=[(*bar, STEEL) for bar in bars], bar_diameter=0.02
    )
    rows = [(1e3 * y, 1e6 * area, 450.0, 650.0) for y, area in bars]
    return section, reference.Fibres(1500.0, lambda y: np.full_like(y, 300.0), 25.0, rows)


def circular() -> tuple[CircularSection, reference.Fibres]:
    section = CircularSection(
        0.5,
        Concrete(40e6),
        layout=Layout(11, 0.02, STEEL),
        spiral=Spiral(0.01, 0.05, Steel(400e6)),
        cover=0.03,
    )
    rows = [(1e3 * y, 1e6 * area, 450.0, 650.0) for y, area, _ in section.bars]
    fibres = reference.Fibres(
        500.0, lambda y: 2.0 * np.sqrt(np.maximum(0.0, 250.0**2 - y**2)), 40.0, rows
    )
    return section, fibres


def tied(**changes) -> RectangularSection:
    """A column of 400 x 400 mm with 8 bars of 20 mm."""
    given = {
        "layout": Layout(8, 0.02, STEEL),
        "ties": Ties(0.01, 0.1, Steel(400e6), legs=3),
        "cover": 0.03,
    }
    return RectangularSection(0.4, 0.4, Concrete(30e6), **(given | changes))


# ---- another program -----------------------------------------------------------------------------

CASES = [
    pytest.param(asymmetric, 400e3, 0.1, id="asymmetric"),
    pytest.param(asymmetric, 0.0, 0.1, id="asymmetric without load"),
    pytest.param(asymmetric, -200e3, 0.1, id="asymmetric in tension"),
    pytest.param(asymmetric, 400e3, -0.1, id="asymmetric, negative curvature"),
    pytest.param(deep, 2000e3, 0.02, id="deep past its peak"),
    pytest.param(deep, 0.0, 0.03, id="deep, lightly reinforced"),
    pytest.param(circular, 1500e3, 0.12, id="circular"),
    pytest.param(circular, 0.0, 0.12, id="circular without load"),
]


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
@pytest.mark.parametrize("tension", TENSION)
@pytest.mark.parametrize(("make", "load", "last"), CASES)
def test_moments_are_those_of_fibres(make, load, last, tension):
    """section.md asks for 0.2 per cent between programs."""
    section, fibres = make()
    fibres.tension = tension
    curvature = last * np.linspace(0.01, 1.0, 14) ** 1.5
    expected = fibres.moments(load, curvature / 1e3) / 1e3
    moment = rbsdem.section.moment_curvature(section, load, curvature, tension=tension)
    np.testing.assert_allclose(
        moment, expected, rtol=5e-4, atol=2e-4 * np.abs(expected).max(), strict=True
    )


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


# ---- properties ----------------------------------------------------------------------------------


def test_order_and_shape_of_the_curvatures_do_not_matter():
    section, _ = asymmetric()
    curvature = np.linspace(-0.08, 0.1, 37)
    moment = rbsdem.section.moment_curvature(section, 300e3, curvature)
    shuffled = np.random.default_rng(1).permutation(37)
    again = rbsdem.section.moment_curvature(section, 300e3, curvature[shuffled])
    np.testing.assert_allclose(again, moment[shuffled], rtol=1e-7)
    table = rbsdem.section.moment_curvature(section, 300e3, curvature[:36].reshape(3, 4, 3))
    assert table.shape == (3, 4, 3)
    np.testing.assert_allclose(table.ravel(), moment[:36], rtol=1e-7)
    alone = rbsdem.section.moment_curvature(section, 300e3, 0.1)
    assert np.shape(alone) == ()
    assert alone == pytest.approx(moment[-1], rel=1e-7)
    assert rbsdem.section.moment_curvature(section, 300e3, []).shape == (0,)


def test_strains_carry_the_axial_load():
    """The strains that come with the moments, put into the reference."""
    section, fibres = asymmetric()
    curvature = np.array([0.0, 0.003, 0.03])
    moment, strain = rbsdem.section.strains(section, 400e3, curvature)
    for phi, m, eps0 in zip(curvature, moment, strain, strict=True):
        n, expected = fibres.sums(eps0, phi / 1e3)
        assert n == pytest.approx(400e3, rel=2e-3)
        assert expected / 1e3 == pytest.approx(m, rel=1e-3, abs=50.0)


def test_a_section_upside_down_mirrors():
    bars = [(0.24, 1500e-6, STEEL), (-0.25, 600e-6, STEEL)]
    turned = [(-y, area, steel) for y, area, steel in bars]
    section, other = (
        RectangularSection(0.3, 0.6, Concrete(35e6), bars=b, bar_diameter=0.02)
        for b in (bars, turned)
    )
    curvature = np.array([0.0, 0.002, 0.01, 0.06])
    np.testing.assert_allclose(
        rbsdem.section.moment_curvature(other, 2e5, -curvature),
        -rbsdem.section.moment_curvature(section, 2e5, curvature),
        rtol=1e-8,
    )


def test_strips_converge():
    """The moment with n strips comes to its limit at least linearly, and is within 0.1 per cent."""
    curvature = np.array([0.004, 0.015, 0.05])
    moments = [
        rbsdem.section.moment_curvature(tied(strips=strips), 8e5, curvature)
        for strips in (50, 100, 400, 6400)
    ]
    errors = [np.abs(m / moments[-1] - 1.0).max() for m in moments[:-1]]
    assert errors[2] < 3e-4
    assert errors[0] > errors[1] > errors[2]


def test_scaling_by_size():
    """Twice the lengths: four times the forces, eight times the moments, half the curvatures."""
    small, large = (
        RectangularSection(
            0.3 * s,
            0.5 * s,
            Concrete(30e6),
            bars=[(0.2 * s, 1e-3 * s**2, STEEL), (-0.2 * s, 5e-4 * s**2, STEEL)],
            bar_diameter=0.02 * s,
        )
        for s in (1, 2)
    )
    curvature = np.array([0.001, 0.01, 0.05])
    np.testing.assert_allclose(
        rbsdem.section.moment_curvature(large, 4e5 * 4, curvature / 2),
        8 * rbsdem.section.moment_curvature(small, 4e5, curvature),
        rtol=1e-8,
    )


def test_bars_of_a_column_can_be_listed():
    section = tied()
    again = RectangularSection(
        0.4, 0.4, Concrete(30e6), bars=section.bars, ties=section.ties, cover=0.03
    )
    assert again.bar_diameter == pytest.approx(0.02)
    curvature = np.linspace(0, 0.05, 9)
    for confined in (False, True):
        np.testing.assert_array_equal(
            rbsdem.section.moment_curvature(again, 5e5, curvature, confined=confined),
            rbsdem.section.moment_curvature(section, 5e5, curvature, confined=confined),
        )


def test_confinement_only_helps_past_the_peak():
    section = tied()
    curvature = np.array([0.001, 0.08])
    plain = rbsdem.section.moment_curvature(section, 1e6, curvature)
    core = rbsdem.section.moment_curvature(section, 1e6, curvature, confined=True)
    assert core[0] == pytest.approx(plain[0], rel=0.03)
    assert core[1] > 1.3 * plain[1]
    found = section.confinement
    assert found.width == pytest.approx(0.33)
    assert found.fcc > 30e6
    assert found.eps_cu == pytest.approx(0.004 + 1.4 * found.ratio * 400e6 * 0.1 / found.fcc)
    assert RectangularSection(0.4, 0.4, Concrete(30e6)).confinement is None


# ---- bars ----------------------------------------------------------------------------------------


def test_layout_of_a_rectangle():
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


def test_what_follows_from_others_follows_their_changes():
    layout, thicker = Layout(8, 0.02, STEEL), Layout(8, 0.025, STEEL)
    given = {"cover": 0.04, "layout": layout, "ties": Ties(0.01, 0.1, STEEL)}
    section = RectangularSection(0.4, 0.4, Concrete(30e6), **given)
    for changes in ({"ties": None}, {"layout": thicker}, {"cover": 0.05}):
        assert dataclasses.replace(section, **changes) == RectangularSection(
            0.4, 0.4, Concrete(30e6), **given | changes
        )
    # What was given stays; bars and a layout contradict each other as before.
    own = dataclasses.replace(section, bar_diameter=0.018)
    assert dataclasses.replace(own, layout=thicker).bar_diameter == 0.018
    assert dataclasses.replace(section, side_cover=0.03, cover=0.05).side_cover == 0.03
    assert dataclasses.replace(Steel(400e6), fy=500e6) == Steel(500e6)
    assert dataclasses.replace(Steel(400e6, 550e6), fy=500e6).fu == 550e6
    assert dataclasses.replace(section, layout=None).bars == section.bars
    with pytest.raises(InputError, match="give bars or layout"):
        dataclasses.replace(section, bars=[(0.1, 2e-4, STEEL)])


def test_layout_of_a_circle():
    bars = CircularSection(
        0.5, Concrete(30e6), layout=Layout(6, 0.02, STEEL), cover=0.04, spiral=None
    ).bars
    radius = 0.25 - 0.04 - 0.01
    expected = radius * np.cos(np.arange(6) * np.pi / 3)
    np.testing.assert_allclose([y for y, _, _ in bars], expected, atol=1e-15)


# ---- events --------------------------------------------------------------------------------------


def test_events_of_a_diagram():
    section = tied()
    diagram = rbsdem.section.diagram(section, 6e5, ultimate="drop")
    events = diagram.events
    at = {name: getattr(events, name) for name in ("cracking", "yielding", "peak", "ultimate")}
    order = [at[name].curvature for name in ("cracking", "yielding", "peak", "ultimate")]
    assert order == sorted(order)
    for point in at.values():
        # The points are on the curve, and among those of the diagram.
        assert rbsdem.section.moment_curvature(section, 6e5, point.curvature) == pytest.approx(
            point.moment, rel=1e-7
        )
        assert point.curvature in diagram.curvature
    law = section.concrete_law
    edge = at["cracking"].strain - 0.2 * at["cracking"].curvature
    assert edge == pytest.approx(-law["ft"] / law["ec"], rel=1e-9)
    bar = max(y for y, _, _ in section.bars)
    assert at["yielding"].curvature * bar - at["yielding"].strain == pytest.approx(
        450e6 / 200e9, rel=1e-9
    )
    assert at["ultimate"].moment == pytest.approx(0.8 * at["peak"].moment, rel=1e-6)
    assert diagram.moment.max() <= at["peak"].moment * (1 + 1e-12)
    near = rbsdem.section.moment_curvature(
        section, 6e5, at["peak"].curvature * np.array([0.999, 1.001])
    )
    assert (near <= at["peak"].moment).all()


def test_rules_of_the_ultimate_point():
    section = tied()
    cover = rbsdem.section.diagram(section, 6e5, eps_cover=0.004).events.ultimate
    assert cover.strain + 0.2 * cover.curvature == pytest.approx(0.004, rel=1e-9)
    mander = rbsdem.section.diagram(section, 6e5, confined=True, ultimate="mander").events.ultimate
    core = section.confinement
    assert mander.strain + 0.5 * core.depth * mander.curvature == pytest.approx(
        core.eps_cu, rel=1e-9
    )
    steel = rbsdem.section.diagram(section, 1e5, confined=True, ultimate="steel").events.ultimate
    bar = max(y for y, _, _ in section.bars)
    assert steel.curvature * bar - steel.strain == pytest.approx(0.1, rel=1e-6)
    first = rbsdem.section.diagram(section, 2.5e6, yielding="first").events.yielding
    assert first.strain + 0.2 * first.curvature == pytest.approx(0.002, rel=1e-9)
    with pytest.raises(InputError, match=r"mander.*confined"):
        rbsdem.section.diagram(section, 6e5, ultimate="mander")
    with pytest.raises(InputError, match="did you mean 'cover'"):
        rbsdem.section.diagram(section, 6e5, ultimate="covr")


# ---- degenerate and wrong ------------------------------------------------------------------------


def test_no_bars_no_load_no_tension():
    plain = RectangularSection(0.4, 0.4, Concrete(30e6))
    curvature = np.linspace(0, 0.05, 6)
    np.testing.assert_array_equal(
        rbsdem.section.moment_curvature(plain, 0.0, curvature, tension="zero"), 0.0
    )
    # The moment of a block that rocks stays below N h/2.
    rocking = rbsdem.section.moment_curvature(plain, 5e5, curvature[1:], tension="zero")
    assert ((rocking > 0.07e6) & (rocking < 5e5 * 0.2)).all()
    with pytest.raises(InputError, match="no bars"):
        rbsdem.section.springs(plain, 1.6, 1e5)


def test_axial_load_over_capacity():
    section = tied()
    least, most = section.axial_capacity
    assert least == pytest.approx(-section.steel_area * 650e6, rel=1e-4)
    doors = (
        lambda load: rbsdem.section.moment_curvature(section, load, 0.01),
        lambda load: rbsdem.section.diagram(section, load),
        lambda load: rbsdem.section.springs(section, 1.6, load),
        lambda load: rbsdem.section.shear_diagram(section, 1.6, load),
        lambda load: rbsdem.section.shear_strength(section, 1.6, load),
        lambda load: rbsdem.section.column(section, 1.6, axial_load=load),
        lambda load: rbsdem.section.column(section, 1.6, axial_load=load, model="paper"),
        lambda load: rbsdem.codes.code_values(section, 1.6, load),
    )
    for load, kind in ((1.3 * most, "more compression"), (1.05 * least, "tension")):
        for door in doors:
            with pytest.raises(
                InputError, match=f"axial_load = .* {kind}.*; compression is positive"
            ):
                door(load)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="is tension; compression is positive"):
        held = rbsdem.section.moment_curvature(section, 0.9 * least, 0.0)
    assert held == pytest.approx(0.0, abs=1.0)
    with pytest.raises(SolveError, match="no longer carries the axial load"):
        rbsdem.section.moment_curvature(section, 0.9 * most, 0.05)
    diagram = rbsdem.section.diagram(section, 0.9 * most)
    assert diagram.end.curvature < 0.05


def test_controlled_by_compression():
    section = tied()
    with pytest.raises(InputError, match="controlled by compression"):
        rbsdem.section.springs(section, 1.6, 3e6)
    springs = rbsdem.section.springs(section, 1.6, 3e6, yield_rule="first", shear="none")
    assert springs.flexure.d_y > springs.flexure.d_c


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
def test_tension_axial_load():
    section = tied()
    cracked = rbsdem.section.moment_curvature(section, -8e5, np.array([0.002, 0.01, 0.05]))
    assert (np.diff(cracked) > 0).all()
    assert rbsdem.section.moment_curvature(section, -8e5, 0.01) < rbsdem.section.moment_curvature(
        section, 0.0, 0.01
    )
    with pytest.raises(InputError, match="the axial load alone cracks"):
        rbsdem.section.springs(section, 1.6, -8e5)


def box(**changes):
    given = {"wall": 0.25, "layout": Layout(12, 0.02, STEEL), "cover": 0.03} | changes
    return rbsdem.RectangularSection(1.0, 1.0, Concrete(30e6), **given)


def ring(**changes):
    given = {"wall": 0.25, "layout": Layout(12, 0.02, STEEL), "cover": 0.03} | changes
    return rbsdem.CircularSection(1.0, Concrete(30e6), **given)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Concrete(30), "30 MPa is fc = 30e6"),
        (lambda: Concrete(float("nan")), "finite"),
        (lambda: Concrete(30e6, ft=40e6), "below fc"),
        (lambda: Concrete(30e6, ec=25), "25 GPa"),
        (lambda: Concrete(30e6, eps0=2.0), "eps0"),
        (lambda: Concrete("30"), "must be a number"),
        (lambda: Steel(450, 600), "450 MPa is fy = 450e6"),
        (lambda: Steel(450e6, 400e6), "fu"),
        (lambda: Steel(450e6, 600e6, eps_sh=0.001), "eps_sh"),
        (lambda: Steel(450e6, 600e6, eps_u=0.005), "eps_u"),
        (lambda: Steel(450e6, es=200), "200 GPa"),
        (lambda: RectangularSection(400, 400, Concrete(30e6)), "400 mm is 0.4"),
        (lambda: RectangularSection(-0.4, 0.4, Concrete(30e6)), "above zero"),
        (lambda: RectangularSection(0.4, 0.4, 30e6), "must be a Concrete"),
        (lambda: tied(layout=None, bars=[(0.21, 2e-4, STEEL)]), "outside the concrete"),
        (lambda: tied(layout=None, bars=[(math.nan, 2e-4, STEEL)]), "finite"),
        (lambda: tied(layout=None, bars=[(0.1, 200, STEEL)]), "200e-6"),
        (lambda: tied(layout=None, bars=[(0.1, -2e-4, STEEL)]), "bars: area = -0.0002 m2"),
        (lambda: tied(layout=None, bars=[(0.1, 2e-4)]), "must be \\(y, area, steel\\)"),
        (lambda: tied(layout=None, bars=[(0.1, 2e-4, 450e6)]), "must be a Steel"),
        (lambda: tied(layout=None, bars=[(0.1, 9e-3, STEEL)]), "bar_diameter of one bar"),
        (lambda: tied(bars=[(0.1, 2e-4, STEEL)]), "not both"),
        (lambda: tied(cover=0.2), "no core"),
        (lambda: tied(cover=-0.01), "negative"),
        (lambda: tied(cover=1e308), "no core"),
        (lambda: RectangularSection(0.4, 0.4, Concrete(30e6), cover=0.2), "leave nothing"),
        (lambda: tied(cover=10**400), "cover = an int is too large"),
        (lambda: tied(ties=Ties(0.01, 0.1, STEEL, legs=2.0**53)), "legs = 9.00.* do not fit"),
        (lambda: tied(ties=Ties(0.01, 0.1, STEEL, legs_across=1e6)), "legs_across = 1e.06 bars"),
        (lambda: tied(strips=10**400), "strips"),
        (lambda: Layout(2**31 - 1, 0.02, STEEL), "must not be above 1000"),
        (lambda: tied(layout=Layout(8, 1e308, STEEL)), "no core"),
        (lambda: box(ties=1), "must be Ties"),
        (lambda: box(cover="a"), "must be a number"),
        (lambda: box(layout=1), "must be a Layout"),
        (lambda: ring(spiral=1), "must be a Spiral"),
        (lambda: tied(ties=Spiral(0.01, 0.05, STEEL)), "must be Ties"),
        (lambda: tied(layout=Layout(10, 0.02, STEEL)), "multiple of 4"),
        (lambda: tied(layout=Layout(9, 0.02, STEEL, face=3)), "even number"),
        (lambda: tied(strips=3), "strips"),
        (lambda: Ties(0.01, -0.1, STEEL), "spacing"),
        (lambda: Layout(8, 0.02, 450e6), "must be a Steel"),
        (lambda: rbsdem.section.moment_curvature(tied(), 0.0, 10.0), "10 mrad/m is 0.01"),
        (lambda: rbsdem.section.moment_curvature(tied(), 0.0, [0.0, math.inf]), "value 2 of 2"),
        (lambda: rbsdem.section.moment_curvature(tied(), math.nan, 0.01), "axial_load"),
        (
            lambda: rbsdem.section.moment_curvature(tied(), 0.0, 0.01, tension="full"),
            "zero, bare, ts",
        ),
        (
            lambda: rbsdem.section.moment_curvature(tied(ties=None), 0.0, 0.01, confined=True),
            "give the section",
        ),
        (lambda: CircularSection(0.5, Concrete(30e6), spiral=tied().ties), "must be a Spiral"),
    ],
)
def test_wrong_input_is_named(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_all_faults_of_a_section_come_at_once():
    with pytest.raises(InputError) as caught:
        RectangularSection(0.4, 0.4, Concrete(30e6), bars=[(0.3, 2e-4, STEEL), (-0.3, 2e-4, STEEL)])
    assert len(str(caught.value).splitlines()) == 2


def test_parameters_are_the_keys():
    """Each value has one name: that of its key."""
    keys = _core.keys()["section"]

    def names(group: str) -> set[str]:
        return {key["name"] for key in keys[group]}

    for record, group, more in (
        (Concrete, "concrete", set()),
        (Steel, "steel", {"id"}),
        (Ties, "ties", set()),
        (Spiral, "spiral", set()),
    ):
        assert {field.name for field in dataclasses.fields(record)} | more == names(group)
    given = {"shape", "cover", "side_cover", "bar_diameter", "strips"}
    assert names("section") == given
    assert names("rectangle") == {"width", "depth"}
    assert names("circle") == {"diameter"}


def test_sections_are_values():
    """They compare, hash, and take part in `dataclasses.replace`."""
    assert tied() == tied()
    assert hash(tied()) == hash(tied())
    assert tied() != tied(cover=0.035)
    assert (
        rbsdem.peer.paper_sections()["zahn_7"].section
        == rbsdem.peer.paper_sections()["zahn_7"].section
    )
