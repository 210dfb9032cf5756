"""Shear of a section: layers against an independent solution, the four columns, strengths by hand.

The stresses of layers are found here again from the tensors of strain and stress, with the laws
written down a second time.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem.model.materials import Concrete, Layout, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection
from rbsdem.section import strength
from rbsdem.section.shear import closed_form_shear, fit_shear_spring, shear_diagram

MPA = 1e6
# By an independent program of the same laws and rules: K_y [N/m], D_y [m], K_u [N/m], V_y [kN],
# gamma_u [mm/m]; curvature at 0.003 in the extreme fibre without tension stiffening [1/m], strength
# by the simplified MCFT [N], and what coupling leaves of the moment at yield.
REFERENCE = {
    "soesianawati_1": (7.0806e8, 1.2895e-4, 1.8737e7, 91.3, 3.65, 0.03329, 292e3, 0.94),
    "tanaka_park_1": (5.6768e8, 1.5171e-4, 4.0512e7, 86.1, 1.37, 0.02094, 405e3, 0.97),
    "tanaka_park_5": (1.1286e9, 1.4929e-4, 4.7981e7, 168.5, 2.88, 0.02203, 608e3, 0.94),
    "zahn_7": (5.8831e8, 1.7618e-4, 3.5179e7, 103.6, 1.67, 0.02100, 400e3, 0.96),
}
KEYS = tuple(REFERENCE)
PAPER = rbsdem.peer.paper_sections()


def column(key: str) -> tuple[RectangularSection, float, float]:
    """Section, length and axial load of a column of table 2."""
    return PAPER[key].section, PAPER[key].length, PAPER[key].axial_load


FC, FYT = 32.0, 325.0  # MPa


def concrete_mpa(strain: float, cracked: float) -> float:
    """Stress [MPa], tension positive; `cracked` is the strain that softens compression."""
    ec = 3320.0 * math.sqrt(FC) + 6900.0
    ft = 0.45 * FC**0.4
    if strain >= 0.0:
        return ec * strain if strain <= ft / ec else ft / (1.0 + math.sqrt(500.0 * strain))
    n = 0.8 + FC / 17.0
    x = -strain / (FC / ec * n / (n - 1.0))
    k = 1.0 if x <= 1.0 else max(1.0, 0.67 + FC / 62.0)
    soft = min(1.0, 1.0 / (0.8 + 170.0 * cracked)) if cracked > ft / ec else 1.0
    return -soft * FC * n * x / (n - 1.0 + x ** (n * k))


def layer_stresses(eps_x: float, eps_z: float, gamma: float, rho: float) -> np.ndarray:
    """Concrete stresses and stirrups as a 2 by 2 tensor [MPa]."""
    strain = np.array([[eps_x, 0.5 * gamma], [0.5 * gamma, eps_z]])
    values, axes = np.linalg.eigh(strain)
    stress = [concrete_mpa(e, values[1]) for e in values]
    tensor = axes @ np.diag(stress) @ axes.T
    tensor[1, 1] += rho * np.clip(2e5 * eps_z, -FYT, FYT)
    return tensor


@pytest.mark.parametrize("curvature", [2e-3, 6e-3, 0.02])
def test_layers_are_in_equilibrium_by_an_independent_solution(curvature: float) -> None:
    steel = Steel(FYT * MPA, 1.5 * FYT * MPA, eps_sh=0.02)
    ties = Ties(0.012, 0.11, steel, legs=4)
    section = RectangularSection(
        0.5, 0.5, Concrete(FC * MPA), layout=Layout(12, 0.02, Steel(450e6)), ties=ties, cover=0.04
    )
    diagram = shear_diagram(section, 1.2, 500e3, [curvature])
    layers = diagram.layers
    core = np.abs(layers.y) < 0.5 * 0.5 - 0.04 - 0.012
    cover = np.abs(layers.y) > 0.5 * 0.5 - 0.04
    share = 4 * 0.25 * math.pi * 0.012**2 / (0.5 * 0.11)
    for inside, rho in ((core, share), (cover, 0.0)):
        assert inside.any()
        states = zip(layers.eps_x[inside], layers.eps_z[inside], layers.gamma[inside], strict=True)
        stress = np.array([layer_stresses(*state, rho) for state in states])
        # Nothing presses across a layer.
        np.testing.assert_allclose(stress[:, 1, 1], 0.0, atol=1e-6)
        np.testing.assert_allclose(stress[:, 0, 1], layers.tau[inside] / MPA, atol=1e-6)


def test_coupled_layers_and_bars_carry_all_three_forces() -> None:
    """Axial load, moment and shear force from the strains, with the laws written down again.

    Far out the span is so long that there is no shear: flexure alone.
    """
    section, length, load = column("tanaka_park_5")
    curvature = 0.4e-3 * np.arange(1, 21)
    diagram = shear_diagram(section, length, load, curvature, coupled=True)
    layers, strip = diagram.layers, section.width * section.depth / diagram.layers.y.size
    rho = 4 * 0.25 * math.pi * 0.012**2 / (section.width * 0.11)
    inside = np.abs(layers.y) < 0.5 * section.depth - section.cover
    states = zip(layers.eps_x, layers.eps_z, layers.gamma, rho * inside, strict=True)
    stress = MPA * np.array([layer_stresses(*state) for state in states])
    along = stress[:, 0, 0]
    axial, moment = -(along * strip).sum(), (along * strip * layers.y).sum()
    for y, area, steel in section.bars:
        eps, around = (np.interp(y, layers.y, values) for values in (layers.eps_x, along))
        force = (np.clip(steel.es * eps, -steel.fy, steel.fy) - around) * area
        axial, moment = axial - force, moment + force * y
    assert axial == pytest.approx(load, rel=1e-3)
    assert moment == pytest.approx(diagram.moment[-1], rel=1e-3)
    assert (stress[:, 0, 1] * strip).sum() == pytest.approx(diagram.force[-1], rel=1e-4)
    slender = shear_diagram(section, 100.0, load, curvature, coupled=True).moment
    flexure = rbsdem.section.moment_curvature(section, load, curvature)
    np.testing.assert_allclose(slender, flexure, rtol=1e-3)


@pytest.mark.parametrize("key", KEYS)
def test_shear_spring_agrees_with_the_reference(key: str) -> None:
    """So do its closed form, the strength, and the moment of the coupled analysis.

    The reference couples without tension stiffening, which adds up to 2 per cent.
    """
    section, length, load = column(key)
    *lines, ultimate, largest, at_yield = REFERENCE[key]
    found = fit_shear_spring(section, length, load, ultimate)
    spring = found.spring
    values = (spring.k, spring.d_y, spring.k_post, found.knee.force / 1e3, 1e3 * found.end.strain)
    np.testing.assert_allclose(values, lines, rtol=0.015)
    assert found.warnings == ()
    assert not found.governs
    k, d_y = closed_form_shear(
        section, length, rbsdem.section.diagram(section, load).events.cracking.moment
    )
    assert (k, k * d_y) == (
        pytest.approx(spring.k, rel=2e-3),
        pytest.approx(spring.k * spring.d_y, rel=0.03),
    )
    strong = strength.shear_strength_mcft(section, length, load)
    assert strong == pytest.approx(largest, rel=0.05)
    curvature = np.linspace(0.0, ultimate, 61)[1:]
    coupled, plain = (
        shear_diagram(section, length, load, curvature, coupled=coupled).moment
        for coupled in (True, False)
    )
    yielding = rbsdem.peer.paper_columns()[key].flexure.d_y
    yielding /= 0.08 * length + 0.022e-6 * section.bars[0][2].fy * section.bar_diameter
    ratio = coupled / plain
    assert np.interp(yielding, curvature, ratio) == pytest.approx(at_yield + 0.01, abs=0.015)
    assert 0.95 <= ratio[-1] <= 0.98


def test_springs_of_a_section_have_the_shear_spring() -> None:
    section, length, load = column("tanaka_park_5")
    springs = rbsdem.section.springs(section, length, load)
    direct = fit_shear_spring(section, length, load, springs.events.ultimate.curvature)
    assert springs.shear == direct.spring


def circle(**changes) -> CircularSection:
    given = {
        "diameter": 0.5,
        "concrete": Concrete(30e6),
        "layout": Layout(12, 0.02, Steel(450e6)),
        "spiral": Spiral(0.01, 0.08, Steel(400e6)),
        "cover": 0.03,
    }
    return CircularSection(**(given | changes))


def test_moment_is_that_of_the_section_and_force_is_moment_over_length() -> None:
    section, length, load = column("zahn_7")
    curvature = np.array([1e-3, 5e-3, 0.02])
    diagram = shear_diagram(section, length, load, curvature)
    np.testing.assert_allclose(
        diagram.moment, rbsdem.section.moment_curvature(section, load, curvature), rtol=2e-3
    )
    np.testing.assert_allclose(diagram.force, diagram.moment / length, rtol=1e-12)
    layers = diagram.layers
    total = np.sum(layers.tau) * section.width * section.depth / layers.tau.size
    assert total == pytest.approx(diagram.force[-1], rel=1e-4)
    assert np.mean(layers.gamma) == pytest.approx(diagram.strain[-1], rel=1e-12)


@pytest.mark.parametrize("kind", [RectangularSection, CircularSection])
@pytest.mark.parametrize("wall", [None, 0.15])
def test_before_cracking(kind, wall) -> None:
    """V/gamma is E_c A/2, and the shear stress of a solid rectangle the parabola V S/(I b)."""
    sizes = (0.55, 0.55) if kind is RectangularSection else (0.55,)
    bars = [(y, 1e-9, Steel(511e6)) for y in (-0.2, 0.2)]
    section = kind(*sizes, Concrete(32e6), bars=bars, bar_diameter=0.02, cover=0.04, wall=wall)
    diagram = shear_diagram(section, 1.65, 0.0, [1e-7])
    stiffness = 0.5 * section.concrete_law["ec"] * section.gross_area
    assert diagram.force[0] / diagram.strain[0] == pytest.approx(stiffness, rel=1e-12)
    assert diagram.stiffness == pytest.approx(stiffness, rel=1e-12)
    assert diagram.knee is None
    if len(sizes) == 2 and not wall:
        y, tau = diagram.layers.y, diagram.layers.tau
        parabola = 1.5 * diagram.force[0] / section.gross_area * (1 - (2 * y / 0.55) ** 2)
        np.testing.assert_allclose(tau, parabola, atol=1e-3 * tau.max())


def test_circle_has_a_knee_and_an_end() -> None:
    found = fit_shear_spring(circle(), 2.0, 600e3, 0.025)
    k = 0.48 * 0.5 * circle().concrete_law["ec"] * circle().gross_area / 2.0
    assert found.spring.k == pytest.approx(k, rel=1e-3)
    assert 0.0 < found.spring.k_post < found.spring.k
    assert not found.governs


def test_shear_diagram_does_not_depend_on_its_points() -> None:
    section, length, load = column("soesianawati_1")
    few = shear_diagram(section, length, load, furthest=0.03, points=10)
    many = shear_diagram(section, length, load, furthest=0.03, points=150)
    assert few.knee.strain == pytest.approx(many.knee.strain, rel=3e-3)
    assert few.end.strain == pytest.approx(many.end.strain, rel=1e-6)


def test_short_column_without_ties_is_governed_by_shear() -> None:
    section = RectangularSection(
        0.4, 0.4, Concrete(30e6), layout=Layout(8, 0.025, Steel(450e6)), cover=0.04
    )
    found = fit_shear_spring(section, 0.8, 100e3, 0.03)
    assert found.governs
    assert "shear governs" in found.warnings[0]
    flexure = rbsdem.section.moment_curvature(section, 100e3, 0.03) / 0.8
    assert found.end.force < 0.7 * flexure
    assert found.end.force == pytest.approx(found.strength, rel=1e-6)
    ends = [shear_diagram(section, 0.8, 100e3, np.linspace(0, 0.03, n)[1:]).end for n in (14, 302)]
    for name in ("curvature", "force", "strain"):
        few, many = (getattr(end, name) for end in ends)
        assert few == pytest.approx(many, rel=2e-2 if name == "strain" else 2e-3)
    coupled = shear_diagram(section, 0.8, 100e3, furthest=0.03, coupled=True)
    assert coupled.sheared
    simplified = strength.shear_strength_mcft(section, 0.8, 100e3)
    assert coupled.end.force == pytest.approx(simplified, rel=0.1)


def test_section_without_a_knee_has_one_line() -> None:
    section, length, load = column("zahn_7")
    found = fit_shear_spring(section, length, load, 1e-4)
    assert "no knee" in found.warnings[0]
    assert found.spring.k_post == 0.0
    assert found.spring.k * found.spring.d_y == pytest.approx(found.end.force)


def plain(**changes) -> RectangularSection:
    """A section of round numbers: d = 0.45 m, 1000 mm2 in tension, ties 157 mm2 at 100 mm."""
    steel = Steel(400e6)
    given = {
        "bars": [(0.2, 1000e-6, steel), (-0.2, 1000e-6, steel)],
        "bar_diameter": 0.02,
        "ties": Ties(0.01, 0.1, Steel(300e6), legs=2),
        "cover": 0.03,
    }
    return RectangularSection(0.3, 0.5, Concrete(25e6), **(given | changes))


def test_sizes_of_a_section() -> None:
    sizes = strength.shear_sizes(plain())
    assert sizes.d == pytest.approx(0.45)
    assert sizes.tension_steel == pytest.approx(1000e-6)
    assert sizes.tie_area == pytest.approx(157.08e-6, rel=1e-5)
    assert sizes.core_depth == pytest.approx(0.43)
    # A row at mid-depth counts half for the steel, not for the depth.
    middle = plain(bars=[(0.2, 1e-3, Steel(400e6)), (0.0, 4e-4, Steel(400e6))])
    assert strength.shear_sizes(middle).tension_steel == pytest.approx(1.2e-3)
    assert strength.shear_sizes(middle).d == pytest.approx(0.45)
    round_sizes = strength.shear_sizes(circle())
    assert round_sizes.d == pytest.approx(0.4)
    assert round_sizes.tie_area == pytest.approx(2 * 0.25 * math.pi * 0.01**2)


def test_sezen_moehle_2004_by_hand() -> None:
    # sqrt(25) = 5 MPa: 2.5/3 sqrt(1 + 375e3/(2.5 150e3)) 0.8 150e3 N, a/d = 1.35/0.45 = 3.
    v_c = 2.5 / 3.0 * math.sqrt(2.0) * 0.8 * 150e3
    v_s = 2 * 0.25 * math.pi * 100.0 * 300.0 * 450.0 / 100.0
    assert strength.shear_strength_sezen(plain(), 1.35, 375e3) == pytest.approx(v_c + v_s)
    for ductility, k in ((2.0, 1.0), (4.0, 0.85), (6.0, 0.7), (9.0, 0.7)):
        found = strength.shear_strength_sezen(plain(), 1.35, 375e3, ductility)
        assert found == pytest.approx(k * (v_c + v_s))
    short = strength.shear_strength_sezen(plain(), 0.5, 375e3)
    assert short == pytest.approx(v_c * 1.5 + v_s)  # a/d not below 2
    torn = strength.shear_strength_sezen(plain(), 1.35, -1e6)
    assert torn == pytest.approx(v_s)


def test_simplified_mcft_solves_its_own_equation() -> None:
    v = strength.shear_strength_mcft(plain(), 1.35, 150e3) / 1e3
    # By hand at that V: M/V = L - d = 0.9 m, z = 405 mm, s_ze = 300 mm.
    eps = (v * 0.9 / 0.45 + v - 75.0) * 1e3 / (2 * 200e3 * 1000)
    beta = 0.4 / (1 + 1500 * eps)
    theta = math.radians(29 + 7000 * eps)
    v_s = 157.08 * 300 * 405 / math.tan(theta) / 100
    assert (beta * 5 * 300 * 405 + v_s) / 1e3 == pytest.approx(v, rel=1e-4)
    # Without ties: s_ze = 35 z/(16 + 19) = 405 mm.
    v = strength.shear_strength_mcft(plain(ties=None), 1.35, 150e3) / 1e3
    eps = (v * 3.0 - 75.0) * 1e3 / (2 * 200e3 * 1000)
    beta = 0.4 / (1 + 1500 * max(eps, 0.0)) * 1300 / 1405
    assert beta * 5 * 300 * 405 / 1e3 == pytest.approx(v, rel=1e-4)
    # As much as the concrete struts bear.
    heavy = plain(ties=Ties(0.02, 0.05, Steel(500e6), legs=4))
    assert strength.shear_strength_mcft(heavy, 1.35, 2e6) <= 0.25 * 25e6 * 0.3 * 0.405 * 1.000001


def test_drifts_of_elwood_and_moehle_2005_by_hand() -> None:
    ratio = 157.0796 / (300 * 100)
    drift = 0.03 + 4 * ratio - (200e3 / 135e3) / (40 * 5.0) - 375e3 / (40 * 150e3 * 25)
    found = strength.shear_failure_drift(plain(), 200e3, 375e3)
    assert found == pytest.approx(drift, rel=1e-5)
    assert strength.shear_failure_drift(plain(ties=None), 1e6, 2e6) == 0.01
    assert strength.axial_failure_drift(plain(ties=None), 375e3) == 0.0


def test_crack_spacing_without_ties_has_the_floor_of_the_theory():
    """35 z/(16 + aggregate) is not below 0.85 z: above 25.2 mm the aggregate has no effect."""
    plain = replace(PAPER["zahn_7"].section, ties=None)
    found = [
        strength.shear_strength_mcft(plain, 1.6, 5e5, aggregate=size)
        for size in (0.010, 0.020, 0.026, 0.040)
    ]
    assert found[0] < found[1] < found[2] == found[3]
