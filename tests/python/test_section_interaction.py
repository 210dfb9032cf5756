"""Interaction of axial load and moment: closed forms, another program's points, own laws."""

from __future__ import annotations

import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from samples import BAR
from samples import EIGHT_BARS as SQUARE
from samples import MILD as STEEL
from samples import TWELVE_BARS as ROUND

import rbsdem
from rbsdem import InputError
from rbsdem.section import strength
from rbsdem.section.curvature import _moments
from rbsdem.springs import SteelSpring

PLAIN = {"concrete": rbsdem.Concrete(30e6), "cover": 0.03}


def test_aci_ends_in_closed_form():
    diagram = rbsdem.section.interaction(SQUARE, "aci318")
    steel = 8 * BAR
    squash = 0.85 * 35e6 * (0.25 - steel) + 460e6 * steel
    assert diagram.axial_load[[0, -1]] == pytest.approx([-460e6 * steel, squash])
    assert diagram.moment[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert diagram.design_axial_load[-1] == pytest.approx(0.65 * 0.80 * squash)
    assert diagram.design_axial_load[0] == pytest.approx(-0.9 * 460e6 * steel)
    # Without axial load: another program has 367.62 to 367.71 kN m.
    assert diagram.moment_at(0.0) == pytest.approx(367.7e3, rel=1e-3)


def test_aci_factor_goes_from_ties_to_tension():
    """phi = 0.65 up to yield, 0.9 from 0.003 beyond it, in a straight line between."""
    diagram = rbsdem.section.interaction(SQUARE, "aci318", points=200)
    inside = diagram.axial_load < 0.8 * diagram.axial_load[-1]
    inside &= np.abs(diagram.moment) > 1.0
    inside[len(diagram.design_moment) - 2 :] = False
    factor = diagram.design_moment[: inside.size][inside[: len(diagram.design_moment)]]
    factor = factor / diagram.moment[inside]
    expected = 0.65 + 0.25 * np.clip((diagram.tension_strain[inside] - 0.0023) / 0.003, 0.0, 1.0)
    assert factor == pytest.approx(expected, rel=1e-12)


def test_ec_2_ends_and_pure_bending_in_closed_form():
    """Two rows that yield: lambda x from equilibrium, M by arms about mid-depth."""
    area = 1e-3
    section = rbsdem.RectangularSection(
        0.3, 0.5, bars=[(0.2, area, STEEL)], bar_diameter=0.02, **PLAIN
    )
    diagram = rbsdem.section.interaction(section, "ec2", points=400)
    squash = 30e6 * (0.15 - area) + min(460e6, 0.00175 * 200e9) * area
    assert diagram.axial_load[[0, -1]] == pytest.approx([-460e6 * area, squash])
    for factor_c, factor_s, design in ((1.0, 1.0, False), (1 / 1.5, 1 / 1.15, True)):
        force = 460e6 * factor_s * area
        deep = force / (30e6 * factor_c * 0.3)
        expected = force * (0.45 - 0.5 * deep)
        assert diagram.moment_at(0.0, design=design) == pytest.approx(expected, rel=1e-4)


def test_ec_2_above_50_mpa():
    """f_ck = 70 MPa in table 3.1: eps_c3 = 2.025e-3, eps_cu3 = 2.656e-3; eta = 0.9 (3.1.7(3))."""
    area, concrete = 1e-3, rbsdem.Concrete(70e6)
    section = rbsdem.RectangularSection(
        0.3, 0.5, bars=[(0.2, area, STEEL)], bar_diameter=0.02, **PLAIN | {"concrete": concrete}
    )
    diagram = rbsdem.section.interaction(section, "ec2")
    squash = 0.9 * 70e6 * (0.15 - area) + 0.002025 * 200e9 * area
    assert diagram.axial_load[-1] == pytest.approx(squash)
    axis, strain = diagram.neutral_axis[1:-1], diagram.tension_strain[1:-1]
    inside = axis <= 0.5
    expected = 0.002656 * (0.45 / axis - 1.0)
    assert strain[inside] == pytest.approx(expected[inside], abs=1e-12)
    # Wholly in compression the fibre at (1 - eps_c3/eps_cu3) h keeps eps_c3 (figure 6.1).
    fixed = 0.5 * (1.0 - 2.025 / 2.656)
    expected = 0.002025 * (0.45 - axis) / (axis - fixed)
    assert (~inside).any()
    assert strain[~inside] == pytest.approx(expected[~inside], abs=1e-12)


def test_circles():
    """Spirals have other factors; in EN 1992-1-1 a narrowing width costs a tenth."""
    spiral = rbsdem.section.interaction(ROUND, "aci318")
    assert spiral.design_axial_load[-1] == pytest.approx(0.75 * 0.85 * spiral.axial_load[-1])
    ring = rbsdem.section.interaction(ROUND, "ec2")
    gross = ROUND.gross_area - ROUND.steel_area
    assert ring.axial_load[-1] == pytest.approx(
        0.9 * 30e6 * gross + 0.00175 * 200e9 * ROUND.steel_area, rel=1e-9
    )


def largest_on_a_grid(section, load, confined=False):
    """Return the largest moment at 300 curvatures until hoops or a bar break."""
    largest = 0.0
    for curvature in np.geomspace(1e-4, 0.4, 300) / section.depth:
        try:
            moment, strain = _moments(section, load, curvature, "ts", confined)
        except rbsdem.SolveError:
            break
        edge = 0.5 * section.depth - section.cover - 0.5 * section.ties.diameter
        stretched = max(curvature * y - strain for y, _, _ in section.bars)
        if stretched > 0.1 or (confined and strain + curvature * edge > section.confinement.eps_cu):
            break
        largest = max(largest, moment)
    return largest


@pytest.mark.parametrize("confined", [False, True])
def test_own_laws_are_those_of_moment_curvature(confined):
    """From bars that break to concrete that is crushed."""
    diagram = rbsdem.section.interaction(SQUARE, points=12, confined=confined)
    for load, moment in list(zip(diagram.axial_load, diagram.moment, strict=True))[1:-1:3]:
        assert moment == pytest.approx(largest_on_a_grid(SQUARE, load, confined), rel=5e-3)
    # All bars at their strength, with what is left of the tension between the cracks at 0.1.
    residual = SQUARE.concrete_law["ft"] / (1 + math.sqrt(500 * 0.1)) * 0.25
    assert diagram.axial_load[0] == pytest.approx(-SQUARE.steel_area * 575e6 - residual, rel=2e-3)
    assert diagram.moment[[0, -1]] == pytest.approx([0.0, 0.0], abs=1.0)
    if confined:
        # Without its cover the core carries more than the whole section does without hoops.
        assert diagram.axial_load[-1] > SQUARE.axial_capacity[1]
    else:
        assert diagram.axial_load[-1] == SQUARE.axial_capacity[1]
    # Strain hardening and the fuller curve of concrete carry more than the block of the code.
    code = rbsdem.section.interaction(SQUARE, "aci318")
    loads = np.linspace(0.0, 0.7 * code.axial_load[-1], 8)
    assert np.all(diagram.moment_at(loads) > 0.97 * code.moment_at(loads))


@pytest.mark.filterwarnings("ignore:axial_load = .* is tension")
def test_the_drop_after_cracking_is_no_end():
    """A circle that hangs on bars that yield is bent until the first of them breaks."""
    steel = rbsdem.Steel(460e6, 600e6)
    section = rbsdem.CircularSection(
        1.2,
        rbsdem.Concrete(35e6),
        layout=rbsdem.Layout(28, 0.032, steel),
        spiral=rbsdem.Spiral(0.016, 0.09, steel),
        cover=0.05,
    )
    end = rbsdem.section.diagram(section, -11e6).end
    assert end.strain - end.curvature * section.bars[0][0] == pytest.approx(-0.1, rel=0.03)
    assert rbsdem.section.interaction(section, points=40).moment_at(-11e6) == pytest.approx(
        end.moment, rel=0.02
    )


def test_ends_of_a_section_that_is_not_symmetric():
    """All bars at their strength have a moment about mid-depth."""
    section = rbsdem.RectangularSection(0.3, 0.5, bars=[(0.2, 1e-3, STEEL)], **PLAIN)
    diagram = rbsdem.section.interaction(section, points=5)
    assert diagram.moment[0] == pytest.approx(575e6 * 1e-3 * 0.2, rel=2e-3)
    assert diagram.moment[-1] < 0.0


def test_joint_of_a_column_carries_what_its_paths_do():
    """First loading reaches the diagram; at its lower end all bars yield in tension."""
    column = rbsdem.section.column(
        rbsdem.peer.paper_sections()["soesianawati_1"].section, 1.6, axial_load=744e3
    )
    joint = column.joints("flexure")[0]
    diagram = column.interaction(rotation=0.03)
    pushed = rbsdem.cyclic(column, displacement=np.linspace(0.0, 0.06, 200))
    moment = pushed.moment[:, 0][pushed.rotation[:, 0] <= 0.03]
    assert diagram.moment_at(744e3) == pytest.approx(moment.max(), rel=5e-3)
    bars = [spring for _, spring in joint.layers if isinstance(spring, SteelSpring)]
    concrete = [spring for _, spring in joint.layers if not isinstance(spring, SteelSpring)]
    yielding = sum(bar.f_y for bar in bars)
    assert diagram.axial_load[0] == pytest.approx(-yielding)
    assert diagram.axial_load[-1] <= yielding + sum(layer.f_peak for layer in concrete)
    assert diagram.moment[-1] == pytest.approx(0.0, abs=1e3)
    ax = rbsdem.plot.interaction(diagram)
    assert ax.get_legend_handles_labels()[1] == ["joint of the model"]
    plt.close(ax.figure)
    with pytest.raises(InputError, match="rotation = 2 rad"):
        column.interaction(rotation=2.0)


def test_utilisation():
    diagram = rbsdem.section.interaction(SQUARE, "aci318")
    strength = diagram.moment_at(1e6, design=True)
    assert diagram.utilisation(1e6, -0.5 * strength) == pytest.approx(0.5)
    assert diagram.utilisation([2e7, -1e7], [0.0, 1.0]).tolist() == [math.inf, math.inf]
    nominal = diagram.utilisation([0.0, 1e6], [1e5, 1e5], design=False)
    assert nominal == pytest.approx(1e5 / diagram.moment_at([0.0, 1e6]))


def test_unlike_faces_have_a_strength_each():
    """Hogging on a beam with its bars below: the side that is pulled counts, not the larger one."""
    beam = rbsdem.RectangularSection(
        0.3, 0.5, bars=[(-0.2, 15e-4, STEEL), (0.2, 3e-4, STEEL)], **PLAIN
    )
    diagram = rbsdem.section.interaction(beam, "aci318")
    hogs, sags = (
        float(each.moment_at(0.0, design=True)) for each in (diagram, diagram.upside_down)
    )
    assert sags > 2.5 * hogs
    assert diagram.utilisation(0.0, 0.9 * sags) == pytest.approx(0.9 * sags / hogs)
    assert diagram.utilisation(0.0, -0.9 * sags) == pytest.approx(0.9)
    # Upside down the same with the other sign.
    turned = rbsdem.section.interaction(beam.mirrored, "aci318")
    for load, moment in ((0.0, 1e5), (1e6, -2e5), (-3e5, 4e4)):
        assert turned.utilisation(load, -moment) == pytest.approx(diagram.utilisation(load, moment))
    # Near its strength in tension the section holds its load with a moment only.
    load = 0.98 * diagram.design_axial_load[0]
    least, most = diagram.moment_range(load, design=True)
    assert least < most < 0
    assert diagram.utilisation(load, 0.0) > 1
    assert diagram.utilisation(load, 0.5 * (least + most)) == pytest.approx(0.0)
    assert diagram.utilisation(load, [least, most]) == pytest.approx([1.0, 1.0])
    ax = rbsdem.plot.interaction(diagram, demand=[(0.0, -0.9 * sags)])
    assert ax.get_xlim()[0] < -1e-3 * sags
    assert ax.lines[-3].get_xdata()[0] == pytest.approx(-0.9e-3 * sags)
    plt.close(ax.figure)


@pytest.mark.parametrize(
    ("fc", "share"),
    [(20e6, 0.85), (28e6, 0.85), (35e6, 0.80), (42e6, 0.75), (56e6, 0.65), (70e6, 0.65)],
)
def test_depth_of_the_aci_block_is_that_of_its_table(fc, share):
    """ACI 318-19, table 22.2.2.4.3: the largest depth of the block over that of the section.

    Without bars the neutral axis at the far face carries 0.85 f'c over the share of the depth.
    """
    block = strength._aci_block(replace(SQUARE, concrete=rbsdem.Concrete(fc)))
    assert block.share == pytest.approx(share, abs=1e-12)
    assert block.stress == pytest.approx(0.85 * fc)
