"""Columns of layered joints under an axial load that varies (docs/interaction.md).

The expected points come from an independent return mapping with Newton's method (100 and 1000
increments, equal to 12 digits). Equilibrium, energy and symmetry: `test_invariants.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Layered, Spring

DRIVEN = (0.012, -0.012, 0.03, -0.03, 0.045, 0.0)


def joint(share: float = 1.0) -> Layered:
    """Return a joint of three pairs of bilinear layers."""
    pairs = ((0.18, 1e-3), (0.11, 1.3e-3), (0.04, 0.9e-3))
    return Layered(
        [
            (side * y, Bilinear(k=2.5e8 * share, d_y=d_y, k_post=5e6 * share))
            for y, d_y in pairs
            for side in (1, -1)
        ]
    )


def one_body(**fields: object) -> rbsdem.Column:
    """Return a cantilever of one body with that joint."""
    given = {"kinematics": "pdelta", "axial_load": 3e5} | fields
    return rbsdem.Column(1.5, 2e4, Elastic(4e7), joint(), **given)


def two_bodies(kinematics: str, **fields: object) -> rbsdem.Column:
    """Return a cantilever of two bodies."""
    return rbsdem.Column(
        1.5,
        2e4,
        [Elastic(4e7), Elastic(3e7)],
        [joint(), joint(0.8)],
        n=2,
        lengths=[0.8, 0.7],
        kinematics=kinematics,
        axial_load=3e5,
        **fields,
    )


def test_one_body_whose_axial_load_follows_the_force() -> None:
    """On a line of all layers the force is a hyperbola in the rotation."""
    result = rbsdem.cyclic(one_body(axial_force_ratio=1.5), displacement=DRIVEN)
    np.testing.assert_allclose(
        result.force[[0, 2, 5]], [8.2336451340e4, 9.8998673723e4, -1.1297168395e5], rtol=1e-9
    )
    np.testing.assert_allclose(
        result.rotation[[0, 2, 5], 0],
        [6.6277258110e-3, 1.8350022105e-2, 1.8828613991e-3],
        rtol=1e-9,
    )
    assert result.summary["energy_residual"] < 1e-12 * result.summary["input_energy"]


@pytest.mark.parametrize(
    ("kinematics", "rows", "points"),
    [
        (
            "small",
            [2, 5],
            [
                (1.0337512514e5, 2.5843781284e-3, 1.3993343783e-2, 4.2568124173e-3),
                (-8.9848133718e4, -2.2462033430e-3, 4.7833260660e-3, -2.7626399505e-3),
            ],
        ),
        (
            "pdelta",
            [0, 2, 5],
            [
                (6.2656912817e4, 1.5664228204e-3, 4.3673335483e-3, 2.4809393988e-3),
                (9.5861402701e4, 2.3965350675e-3, 1.4143384460e-2, 4.2625486765e-3),
                (-9.0884720038e4, -2.2721180009e-3, 4.8390004047e-3, -2.8332748320e-3),
            ],
        ),
    ],
)
def test_two_bodies_whose_axial_load_follows_the_force(
    kinematics: str, rows: list[int], points: list[tuple[float, ...]]
) -> None:
    """Two layered joints and two slips, small rotations and P-Delta."""
    result = rbsdem.cyclic(two_bodies(kinematics, axial_force_ratio=1.5), displacement=DRIVEN)
    found = np.column_stack([result.force, result.slip[:, 0], result.rotation])[rows]
    np.testing.assert_allclose(found, points, rtol=1e-9)
    # With P-Delta the force is a curve, and the works of each stride may miss 1e-13 of the energy.
    share = 1e-12 if kinematics == "pdelta" else 1e-13
    assert result.summary["energy_residual"] < share * result.summary["input_energy"]


UNSYMMETRIC = [
    (-0.15, Bilinear(8e8, 1.5e-3, 1.6e7)),
    (-0.06, Bilinear(5e8, 1e-3, 5e6)),
    (0.03, Bilinear(5e8, 1e-3, 5e6)),
    (0.15, Bilinear(6e8, 2e-3, 1.2e7)),
]
#: Shear spring that hardly slips beside the joint.
STIFF = 1e16


def through(
    layers: list[tuple[float, Spring]], rotation: np.ndarray, load: np.ndarray
) -> rbsdem.Result:
    """Return the path of a joint straight from point to point, but for the slip."""
    column = rbsdem.Column(1.0, 1.0, Elastic(STIFF), Layered(layers))
    return rbsdem.cyclic(column, displacement=rotation, axial_load=load, openings=True)


@pytest.mark.parametrize(
    ("layers", "rest", "points"),
    [
        (
            [(y, Compression(100.0)) for y in (-3, -1, 1, 3)],
            0.0,
            [
                (0, 8, -1 / 50, 0),
                (0.01, 8, -1 / 60, 16),
                (0.02, 4, 1 / 50, 12),
                (0.02, 12, -1 / 50, 28),
                (-0.01, 7, -1 / 75, -15),
                (0, 0.5, -1 / 800, 0),
            ],
        ),
        (
            UNSYMMETRIC,
            -2.279202279e-4,
            [
                (0.006, 4e5, -5.4166666667e-05, 2.0493750000e05),
                (0.012, 9e5, -4.0731489741e-04, 3.3636768599e05),
                (-0.004, 1.2e6, -8.3231489741e-04, -1.8450731401e05),
                (-0.015, 3e5, -7.1933130972e-04, -3.8428613266e05),
                (-0.015, 1e6, -1.2063224154e-03, -3.1394608088e05),
                (0.02, -2e5, 4.7088016094e-04, 3.9822044665e05),
                (0.0, 5e5, -1.9578650573e-04, -2.4677955335e05),
            ],
        ),
    ],
)
def test_points_of_a_joint(
    layers: list[tuple[float, Spring]], rest: float, points: list[tuple[float, ...]]
) -> None:
    """Four contacts by hand; unsymmetric layers, whose rotations count from those without load."""
    rotation, load, opening, moment = np.array(points).T
    run = through(layers, rotation - rest + moment / STIFF, load)
    np.testing.assert_allclose(run.opening[:, 0], opening, rtol=1e-9)
    np.testing.assert_allclose(run.moment[:, 0], moment, rtol=1e-9, atol=1e-9 * moment.max())


def test_a_second_pass_of_a_closed_path_gives_no_energy() -> None:
    """Work of the moment and of the axial load on the opening, along random loops."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        loop = np.column_stack([rng.uniform(-1e-2, 1e-2, 4), rng.uniform(-3e5, 1e6, 4)])
        corners = np.vstack([loop, loop, loop[:1]])
        share = np.linspace(0, 8, 401)
        rotation, load = (np.interp(share, range(9), values) for values in corners.T)
        run = through(UNSYMMETRIC, rotation, load)
        lifted = 0.5 * (load[1:] + load[:-1]) * np.diff(run.opening[:, 0])
        assert run.energy["input"][-1] - run.energy["input"][200] - lifted[200:].sum() > -1.0


def test_the_work_on_the_openings_under_the_first_load() -> None:
    """A load that varies begins with the work N w = -N^2/k on an elastic axial spring."""
    column = rbsdem.Column(1.5, 600.0, Elastic(4e7), Elastic(5e6), axial_spring=Elastic(3e9))
    run = rbsdem.cyclic(column, displacement=[0.0, 0.01], axial_load=[3e5, 4e5])
    np.testing.assert_allclose(run.energy["axial"][0], -(3e5**2) / 3e9, rtol=1e-12)
    assert run.summary["relative_energy_residual"] < 1e-12


def test_response_in_time() -> None:
    """Ground motion and a history of the axial load together, by average acceleration."""
    time = np.linspace(0, 1, 101)
    load = 3e5 + 2e5 * np.sin(6.2 * np.pi * time)
    ground = 14 * np.sin(4 * np.pi * time) * np.minimum(time / 0.3, 1)
    column = one_body()
    keywords = {"ground_acceleration": ground, "axial_load": load}
    with pytest.warns(rbsdem.errors.AccuracyWarning, match=r"0\.1"):
        result = rbsdem.time_history(column, time, method="newmark", dt=0.005, **keywords)
    rows = [25, 50, 100]
    np.testing.assert_allclose(
        result.slip[rows, 0], [-1.6421049083e-3, 4.2036475281e-3, 4.7127207049e-3], rtol=1e-8
    )
    np.testing.assert_allclose(
        result.rotation[rows, 0], [-4.6414136183e-3, 1.0375057296e-1, 6.8941562590e-2], rtol=1e-8
    )


def test_vertical_motion_reaches_the_joints() -> None:
    """Vertical motion of the ground acts like the axial load that it makes of the mass."""
    time = np.linspace(0, 1, 201)
    up = 3 * np.sin(25 * time)
    ground = 7 * np.sin(8 * time)
    column = one_body(kinematics="small")
    vertical = rbsdem.time_history(
        column, time, method="newmark", ground_acceleration=ground, vertical_acceleration=up
    )
    pushed = rbsdem.time_history(
        column, time, method="newmark", ground_acceleration=ground, axial_load=3e5 + 2e4 * up
    )
    plain = rbsdem.time_history(column, time, method="newmark", ground_acceleration=ground)
    np.testing.assert_allclose(vertical.rotation, pushed.rotation, rtol=0, atol=1e-12)
    assert np.abs(vertical.rotation - plain.rotation).max() > 1e-5


def test_a_load_that_buckles_the_column_ends_the_path() -> None:
    """Driven by its force, an elastic body has no equilibrium beyond N l = k."""
    column = rbsdem.Column(1.5, 600.0, Elastic(1e9), Elastic(5e6), kinematics="finite")
    critical = 5e6 / 1.5
    with pytest.raises(rbsdem.SolveError, match=r"no equilibrium|capacity"):
        rbsdem.cyclic(column, force=[0.0, 0.0], axial_load=[0.0, 1.01 * critical])
    rbsdem.cyclic(column, force=[0.0, 0.0], axial_load=[0.0, 0.99 * critical])


def plastic(axial_load: float) -> rbsdem.Column:
    """Return a column of four plastic layers that carry 4 MN in all."""
    layers = [(y, Bilinear(k=1e9, d_y=1e-3, k_post=0.0)) for y in (-0.15, -0.05, 0.05, 0.15)]
    return rbsdem.Column(1.5, 1e3, Elastic(1e9), Layered(layers), axial_load=axial_load)


def test_loss_of_the_axial_load_ends_a_static_path() -> None:
    """The path ends where all layers have yielded: 4 MN, and the status says so."""
    result = rbsdem.cyclic(
        plastic(2e6), displacement=[0.01, 0.02, 0.03], axial_load=[2e6, 3e6, 5e6]
    )
    assert result.summary["status"] == "axial_failure"
    assert result.summary["lost_joint"] == 1
    assert len(result.displacement) == 3
    # Half of the way from 3 to 5 MN.
    assert result.displacement[-1] == pytest.approx(0.025, rel=1e-9)


def test_layers_carry_moment_and_axial_load() -> None:
    """The deformations of the layers, on elastic lines, give back N and M of the joint."""
    places, stiffness = np.array([-0.2, -0.05, 0.1]), np.array([1e9, 2e9, 5e8])
    layers = [(y, Elastic(k)) for y, k in zip(places, stiffness, strict=True)]
    column = rbsdem.Column(1.5, 1e3, Elastic(4e7), Layered(layers), axial_load=3e5)
    load = np.array([2e5, 4e5, -1e5])
    result = rbsdem.cyclic(
        column, displacement=[0.001, 0.002, -0.001], axial_load=load, openings=True
    )
    forces = stiffness * result.layer_deformation()
    np.testing.assert_allclose(forces.sum(axis=1), -load, rtol=1e-9)
    np.testing.assert_allclose(forces @ places, result.moment[:, 0], rtol=1e-9)
    assert result.elongation[0] < 0
    time = np.linspace(0, 0.2, 21)
    moving = rbsdem.time_history(
        column,
        time,
        ground_acceleration=np.sin(60 * time),
        axial_load=1e5 * (1 + time),
        openings=True,
    )
    forces = stiffness * moving.layer_deformation()
    np.testing.assert_allclose(forces.sum(axis=1), -1e5 * (1 + time), rtol=1e-9)


def test_the_case_file_says_the_same(tmp_path) -> None:
    """A static case with a history of the axial load, written and read back."""
    load = [3e5, 6e5, -1e5, 5e5, 8e5, 2e5]
    column = two_bodies("pdelta", axial_force_ratio=0.5)
    here = rbsdem.cyclic(column, displacement=DRIVEN, axial_load=load)
    path = tmp_path / "exterior.nml"
    values = {"displacement": DRIVEN, "axial_load": load}
    groups = "\n".join(
        f"&loading drive = '{name}', values = {', '.join(map(repr, map(float, numbers)))} /"
        for name, numbers in values.items()
    )
    path.write_text(f"{column.to_namelist()}\n{groups}\n&analysis method = 'static' /\n")
    case = rbsdem.read_case(path)
    assert case.column == column
    again = case.run()
    np.testing.assert_array_equal(again.force, here.force)
    path.write_text(case.to_namelist())
    assert rbsdem.read_case(path) == case


def test_high_axial_load_ends_the_path() -> None:
    """A column at 0.9 of f'c A loses its axial load; one at 0.1 does not."""
    bars = rbsdem.Layout(12, 0.016, rbsdem.Steel(446e6, 702e6))
    ties = rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6), legs=4)
    section = rbsdem.RectangularSection(
        0.4, 0.4, rbsdem.Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
    )
    path = 1.6 * rbsdem.protocol([0.0025, 0.005, 0.01, 0.02], cycles=2)
    columns = {0.1: rbsdem.section.column(section, 1.6, axial_load=0.1 * 46.5e6 * 0.16)}
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="axial load ratio = 0.9 is outside"):
        columns[0.9] = rbsdem.section.column(section, 1.6, axial_load=0.9 * 46.5e6 * 0.16)
    ends = {}
    for share in (0.1, 0.9):
        column = columns[share]
        ends[share] = rbsdem.cyclic(column, displacement=path)
    assert ends[0.1].summary["status"] == "completed"
    lost = ends[0.9]
    assert lost.summary["status"] == "axial_failure"
    assert lost.time.size < path.size
    assert np.abs(lost.displacement[-1]) < 0.01 * 1.6


def test_peak_force_is_that_of_the_loading_side() -> None:
    """Second-order moments drive the column on: the force that holds it back is no strength."""
    column = rbsdem.Column(
        2.0, 1.0, Elastic(1e12), Bilinear(1e8, 1e-3, 0.0), axial_load=2e6, kinematics="pdelta"
    )
    result = rbsdem.cyclic(column, displacement=[0.003, 0.19])
    # M_y = 1e5 N m = F h + P d
    assert result.force[-1] == pytest.approx((1e5 - 2e6 * 0.19) / 2, rel=1e-5)
    assert result.summary["peak_force"] == pytest.approx((1e5 - 2e6 * 0.002) / 2, rel=1e-5)
