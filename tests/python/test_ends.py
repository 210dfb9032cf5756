"""Ends of a column: a top fixed against rotation, and a footing on springs."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import Footing, peer
from rbsdem.springs import (
    Compression,
    Elastic,
    Layered,
    PeakOriented,
    SteelSpring,
    Takeda,
)

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

LEVELS = ("small", "pdelta", "finite")
RIGID = Elastic(1e17)  # slips far below the last digit of a rotation times the height

TAKEDA = Takeda(k_c=2.5e8, d_c=3e-4, k_y=6e7, d_y=2.7e-3, k_u=7e6, b1=0.3)
TWO_SIDED = PeakOriented(
    d_y=4e-3, f_y=2.3e5, d_cap=15e-3, f_cap=2.5e5, d_pc=0.06, f_res=4e4, lambda_s=60, d_y_neg=6e-3
)
CONTACTS = Layered([(y, Compression(1e9)) for y in (-0.2, -0.1, 0.0, 0.1, 0.2)])
UNEVEN = Layered(
    [
        (-0.15, Compression(2e9)),
        (0.0, Compression(1e9)),
        (0.2, Compression(1e9)),
        *((y, SteelSpring(k=8e8, f_y=7e5, k_post=8e6)) for y in (-0.1, 0.15)),
    ]
)
PATH = np.concatenate([np.linspace(a, b, 5) for a, b in ((0, 0.02), (0.02, -0.03), (-0.03, 0.01))])


def cantilever(flexure, *, kinematics="pdelta", shear=RIGID, n=1, **more):
    return rbsdem.Column(
        1.6, 600.0, shear, [flexure, *[Elastic(3e8)] * (n - 1)], n=n, kinematics=kinematics,
        axial_load=4e5, **more,
    )  # fmt: skip


@pytest.mark.parametrize("flexure", [TAKEDA, TWO_SIDED, UNEVEN], ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("kinematics", LEVELS)
def test_double_curvature_is_two_cantilevers(kinematics, flexure):
    """The same force at twice the displacement, and joints that do the same.

    Slips of the joints at both ends are along what the column stands on and hangs from.
    """
    shear = [Elastic(2e7), RIGID, RIGID]
    half = cantilever(
        flexure, kinematics=kinematics, n=3, shear=shear, lengths=[0.7, 0.5, 0.4],
        masses=[300.0, 100.0, 200.0],
    )  # fmt: skip
    whole = half.double_curvature()
    assert (whole.n, whole.height) == (5, 3.2)
    assert list(whole.joint_numbers) == [1, 2, 3, 4, 5, 6]
    one = rbsdem.cyclic(half, displacement=PATH)
    both = rbsdem.cyclic(whole, displacement=2 * PATH)
    scale = np.abs(one.force).max()
    # Newton's method ends at 1e-10 of the change.
    near = 1e-9 if kinematics == "finite" else 1e-11
    np.testing.assert_allclose(both.force, one.force, rtol=0, atol=near * scale)
    np.testing.assert_allclose(both.rotation[:, :3], one.rotation, rtol=0, atol=near * 0.02)
    np.testing.assert_allclose(both.rotation[:, 5:2:-1], -one.rotation, rtol=0, atol=near * 0.02)
    np.testing.assert_allclose(both.rotation.sum(axis=1), 0, atol=1e-13)
    # What holds the top is the moment at the foot with the other sign: F 2L + P x = 2 M.
    np.testing.assert_allclose(both.moment[:, -1], -both.moment[:, 0], rtol=0, atol=near * 1e6)
    np.testing.assert_allclose(both.energy["input"], 2 * one.energy["input"], atol=1e-8 * scale)


TIME = np.arange(0, 1.005, 0.01)
SHAKE = 3.0 * np.sin(9 * TIME) + 2.0 * np.sin(23 * TIME)
STEPS = {"newmark": 5e-4, "hht": 2e-4, "generalised_alpha": 2e-4}


def shaken(column, method, **loads):
    events = {"events": "located"} if method == "rk4" else {}
    return rbsdem.time_history(column, TIME, method=method, dt=STEPS.get(method), **events, **loads)


def test_stiffness_and_frequency_of_a_column_held_at_both_ends():
    """Springs k_i at levers h_i: F/x from x = F (sum h^2/k - (sum h/k)^2/(sum 1/k)) + F sum 1/k_V.

    With a mass at the top and bodies that have hardly any, omega^2 is that stiffness over the mass;
    the bodies move less than the top, and change it by no more than their share of the mass.
    """
    n, height, mass = 3, 3.0, 1e4
    k, shear = np.array([4e8, 2e8, 2.5e8, 1e8]), 5e8
    lever = height * np.arange(n, -1, -1) / n
    flexibility = (lever**2 / k).sum() - (lever / k).sum() ** 2 / (1 / k).sum() + (n + 1) / shear
    column = rbsdem.Column(
        height, 1e-4, Elastic(shear), [Elastic(x) for x in k], n=n, top="fixed", top_mass=mass
    )
    result = rbsdem.cyclic(column, force=[1e3])
    assert result.displacement[0] == pytest.approx(1e3 * flexibility, rel=1e-13)
    modes = rbsdem.modes(column)
    assert modes.omega.size == 2 * (n + 1) - 1
    assert modes.omega[0] ** 2 * mass * flexibility == pytest.approx(1, abs=1e-8)
    np.testing.assert_allclose(modes.shapes[n + 1 :].sum(axis=0), 0, atol=1e-12)


def test_critical_load_and_frequency_of_a_held_column():
    """One body on two joints has 2 k - P l against turning, and slips that do not lean.

    The mass at the top is all but alone.
    """
    length, k, shear, mass = 2.0, 1e8, 1e9, 2e4

    def column(load):
        return rbsdem.Column(
            length, 1e-4, Elastic(shear), Elastic(k), kinematics="pdelta", axial_load=load,
            top="fixed", top_mass=mass,
        )  # fmt: skip

    critical = 2 * k / length
    load = 0.7 * critical
    flexibility = 2 / shear + length**2 / (2 * k - load * length)
    modes = rbsdem.modes(column(load))
    assert modes.omega[0] ** 2 * mass * flexibility == pytest.approx(1, abs=1e-7)
    # The highest frequency is that without the load.
    highest = rbsdem.modes(column(0.0)).omega[-1]
    assert modes.stable_step == pytest.approx(2 * np.sqrt(2) / highest, rel=1e-9)
    rbsdem.modes(column((1 - 1e-9) * critical))
    with pytest.raises(rbsdem.InputError, match="beyond the critical load"):
        rbsdem.modes(column((1 + 1e-9) * critical))


@pytest.mark.parametrize("kinematics", LEVELS)
@pytest.mark.parametrize("opens", [False, True])
def test_methods_agree_on_a_column_with_both_ends(kinematics, opens):
    """Footing and fixed top at once, with joints that open or not: one response, one balance."""
    axial = {"axial_spring": Elastic(3e9)} if opens else {}
    column = cantilever(
        TAKEDA,
        kinematics=kinematics,
        shear=Elastic(4e8),
        footing=Footing(Elastic(6e8), CONTACTS, mass=3e3, inertia=2e3, height=0.4, **axial),
        top_mass=3e4,
        damping=rbsdem.Damping(mass=0.2, stiffness=1e-4),
        **axial,
    )
    column = dataclasses.replace(column, top="fixed", flexure=[TAKEDA, Elastic(1.5e8)])
    exact = shaken(column, "rk45", ground_acceleration=SHAKE)
    peak = np.abs(exact.displacement).max()
    assert exact.summary["events"] > 10
    for method, near in {
        "rk4": 1e-4,
        "newmark": 3e-3,
        "hht": 3e-3,
        "generalised_alpha": 3e-3,
    }.items():
        result = shaken(column, method, ground_acceleration=SHAKE)
        np.testing.assert_allclose(
            result.displacement, exact.displacement, rtol=0, atol=near * peak
        )
        np.testing.assert_allclose(result.rotation.sum(axis=1), 0, atol=1e-15)
        assert result.summary["relative_energy_residual"] < 1e-3


def test_a_footing_is_one_body_more():
    """The chain knows no difference: the same bits as a column whose first body is the footing."""
    springs = [Elastic(6e8), Elastic(4e8)], [Takeda(4e8, 4e-4, 1e8, 3e-3, 1e7), TAKEDA]
    common = {"kinematics": "pdelta", "axial_load": 4e5, "top_mass": 2e4, "self_weight": True}
    column = rbsdem.Column(
        1.6, 600.0, springs[0][1], springs[1][1], rotary_inertia=50.0,
        footing=Footing(springs[0][0], springs[1][0], mass=900.0, inertia=100.0, height=0.4),
        **common,
    )  # fmt: skip
    chain = rbsdem.Column(
        2.0, None, *springs, n=2, lengths=[0.4, 1.6], masses=[900.0, 600.0],
        rotary_inertia=[100.0, 50.0], **common,
    )  # fmt: skip
    for one, other in (
        (rbsdem.cyclic(c, displacement=PATH) for c in (column, chain)),
        (shaken(c, "rk45", ground_acceleration=SHAKE) for c in (column, chain)),
    ):
        for name in ("displacement", "force", "rotation", "moment", "base_moment", "top"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert list(column.joint_numbers) == [0, 1]
    assert len(column.joints("flexure")) == 2


def rocking(kinematics="pdelta", **more):
    """A stiff column of 4 m on a footing 1 m wide with two contacts at its edges."""
    edges = Layered([(-0.5, Compression(1e12)), (0.5, Compression(1e12))])
    footing = Footing(Elastic(1e13), edges, **more.pop("inertia", {}))
    return rbsdem.Column(
        4.0, 1e-3, Elastic(1e13), Elastic(1e13), kinematics=kinematics, axial_load=2e5,
        footing=footing, **more,
    )  # fmt: skip


@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_rocking_footing_tips_where_the_load_passes_its_edge(kinematics):
    """F = P (b/h - theta), or P (b - h sin theta)/(h cos theta), both ways; nothing is lost."""
    drift = np.array([0.02, 0.06, 0.124, 0.0, -0.06, -0.02, 0.0])
    result = rbsdem.cyclic(rocking(kinematics), displacement=4.0 * drift)
    if kinematics == "finite":
        force = 2e5 * (0.5 - 4.0 * np.abs(drift)) / (4.0 * np.sqrt(1 - drift**2))
    else:
        force = 2e5 * (0.125 - np.abs(drift))
    moving = drift != 0
    expected = np.sign(drift) * force
    np.testing.assert_allclose(result.force[moving], expected[moving], rtol=0, atol=0.5)
    np.testing.assert_allclose(result.rotation[moving, 0], np.arcsin(drift)[moving], rtol=3e-3)
    # The work of the force is all given back where the column stands upright again.
    assert abs(result.energy["input"][-1]) < 1e-6 * result.energy["input"].max()


def test_rocking_has_housners_quarter_period():
    """theta'' = p^2 (theta - alpha) from rest: upright after acosh(1/(1 - theta_0/alpha))/p."""
    mass = 2e5 / 9.80665
    inertia = {"mass": 1e-3, "inertia": 1e-3}
    column = rocking(top_mass=mass, inertia=inertia)
    p, alpha, start = np.sqrt(2e5 / (mass * 4.0)), 0.125, 0.05
    quarter = np.arccosh(1 / (1 - start / alpha)) / p
    time = np.linspace(0, quarter, 101)
    result = rbsdem.time_history(
        column, time, method="newmark", dt=quarter / 2000, initial={"rotation": [start, 0.0]}
    )
    theta = alpha - (alpha - start) * np.cosh(p * time)
    np.testing.assert_allclose(result.displacement, 4.0 * theta, rtol=0, atol=2e-4 * 4.0 * start)


def test_contact_with_a_gap():
    """It carries k (w + gap) where it has closed by more than the gap; two of them in a joint."""
    spring = Compression(1e8, gap=0.002)
    w = np.array([0.0, -0.001, -0.002, -0.005, -0.001, 0.01, -0.003])
    np.testing.assert_allclose(spring.response(w), 1e8 * np.minimum(w + 0.002, 0), atol=1e-6)
    # Beside a middle that carries the load P = 1e5 N, stops at 0.4 m close after 0.005 rad; then
    # the joint turns about the stop: the middle opens by 0.4 (theta - 0.005) less what it gave.
    joint = Layered([(0.0, Elastic(1e10)), (0.4, Compression(1e8, gap=2e-3)), (-0.4, spring)])
    moment = joint.response(np.array([0.0, 0.004, 0.006, -0.006, 0.0]), axial_load=1e5)
    stop = 1e8 / (1 + 1e8 / 1e10) * (0.4 * 0.006 - 0.002 + 1e5 / 1e10)
    np.testing.assert_allclose(moment, [0, 0, 0.4 * stop, -0.4 * stop, 0], rtol=1e-12, atol=1e-9)


CASE = """
&column n = 2, height = 3.0, mass = 900, kinematics = 'pdelta', axial_load = 2e5, top = 'fixed',
   top_mass = 2e4, footing_mass = 3e3, footing_inertia = 2e3, footing_height = 0.3 /
&shear rule = 'elastic', k = 4e8 /
&shear joint = 0, rule = 'bilinear', k = 4e8, d_y = 1e-3, k_post = 1e6 /
&flexure rule = 'elastic', k = 2e8 /
&flexure joint = 3, rule = 'elastic', k = 1e8 /
&flexure joint = 0, rule = 'layered' /
&layer_spring id = 1, rule = 'compression', k = 1e9, gap = 1e-4 /
&layer_spring id = 2, rule = 'compression', k = 2e9 /
&layers joint = 0, y = -0.4, -0.2, 0.2, 0.4, spring = 1, 2, 2, 1 /
&loading drive = 'displacement', amplitudes = 0.01, points = 3 /
"""


def test_rows_of_the_executable_name_all_joints(run_cli, read_csv, tmp_path: Path):
    (tmp_path / "ends.nml").write_text(CASE, "utf-8")
    result = rbsdem.read_case(tmp_path / "ends.nml").run()
    assert run_cli(["run", "--quiet", "ends.nml"], tmp_path).returncode == 0
    rows = read_csv(tmp_path / "ends.csv")
    assert np.array_equal(rows["moment_3_Nm"], result.moment[:, -1])
    assert np.array_equal(rows["rotation_0_rad"], result.rotation[:, 0])


def test_footing_keys_need_a_footing(tmp_path: Path):
    path = tmp_path / "case.nml"
    path.write_text(CASE.replace("joint = 0", "joint = 1"), "utf-8")
    with pytest.raises(rbsdem.InputError, match="footing_height need springs beneath the footing"):
        rbsdem.read_case(path)
    path.write_text(CASE.replace("joint = 3", "joint = 4"), "utf-8")
    with pytest.raises(rbsdem.InputError, match=r"joint = 4; joints are 0 to n \+ 1 = 3"):
        rbsdem.read_case(path)


@pytest.mark.parametrize("stronger", [0.0, 1e-9])
def test_two_shear_springs_that_soften_take_one_path_or_two(stronger):
    """Alike they fall together; where one is stronger by a trifle, it unloads and the other falls.

    F = f_cap (1 - (s_1 - d_cap)/d_pc) at the foot, F = f_cap - k (d_cap - s_2) at the top, and the
    body turns by F L^2/(2 K).
    """
    k, d_cap, d_pc, f_cap = 1e8, 6e-3, 0.03, 2.2e5

    def shear(more: float) -> PeakOriented:
        f = f_cap * (1 + more)
        return PeakOriented(d_y=2e-3, f_y=k * 2e-3, d_cap=d_cap, f_cap=f, d_pc=d_pc)

    column = rbsdem.Column(2.0, 100.0, [shear(0.0), shear(stronger)], Elastic(1e9), top="fixed")
    result = rbsdem.cyclic(column, displacement=np.linspace(0, 0.03, 61))
    foot, top = result.slip.T
    fallen = foot > d_cap
    assert fallen.sum() > 20
    force = result.force[fallen]
    if stronger:
        np.testing.assert_allclose(force, f_cap * (1 - (foot[fallen] - d_cap) / d_pc), rtol=1e-6)
        np.testing.assert_allclose(top[fallen], d_cap - (f_cap - force) / k, rtol=1e-6)
    else:
        np.testing.assert_allclose(foot, top, rtol=1e-14)
    np.testing.assert_allclose(foot + top + result.force * 4.0 / 2e9, result.displacement)


def test_double_curvature_specimens_are_their_equivalents():
    """A test as it was, twice as long with a hinge at each end, and the cantilever of the table.

    Joints above the hinge slip a thousandth of that one, and lean while they do. The shear spring
    does not soften here.
    """
    specimen = peer.Specimen(
        name="one", section="rectangular", length=0.9, width=0.3, depth=0.3,
        concrete_strength=30e6, axial_load=500e3, longitudinal_number=8, config="DC", cover=0.025,
        corner_diameter=0.019, intermediate_diameter=0.019, intermediate_perpendicular=1,
        intermediate_parallel=1, corner_yield_stress=400e6, intermediate_yield_stress=400e6,
        transverse_yield_stress=350e6, transverse_diameter=0.008, transverse_spacing=0.1,
        shear_legs=2, confinement="R",
    )  # fmt: skip
    drift = np.linspace(0, 0.03, 31)
    for model in ("layered", "paper"):
        half, whole = (peer.column(specimen, model, ends=ends) for ends in ("equivalent", "tested"))
        assert (whole.height, whole.top) == (1.8, "fixed")
        one = rbsdem.cyclic(half, displacement=drift * 0.9)
        both = rbsdem.cyclic(whole, displacement=drift * 1.8)
        np.testing.assert_allclose(both.force, one.force, rtol=0, atol=1e-6 * one.force.max())
    with pytest.raises(rbsdem.InputError, match="its flexible base is not in the table"):
        peer.column(dataclasses.replace(specimen, config="CFB"), ends="tested")
    with pytest.raises(rbsdem.InputError, match="it is one of equivalent, tested"):
        peer.column(specimen, ends="real")


def test_column_of_a_section_with_its_ends():
    """Hinges of half the height at both ends, whose strains are known; a footing beneath."""
    bars = rbsdem.Layout(12, 0.016, rbsdem.Steel(446e6, 702e6))
    ties = rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6, 521e6), legs=4)
    section = rbsdem.RectangularSection(
        0.4, 0.4, rbsdem.Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
    )
    footing = Footing(Elastic(1e9), Elastic(5e8))
    column = rbsdem.section.column(section, 3.2, axial_load=744e3, top="fixed", footing=footing)
    half = rbsdem.section.column(section, 1.6, axial_load=744e3)
    assert column.joints("flexure")[1] == half.joints("flexure")[0]
    assert column.mass == pytest.approx(2 * half.mass)
    assert column.warnings == half.warnings
    result = rbsdem.cyclic(column, displacement=[0.02, 0.05], openings=True)
    foot, head = result.strains(1), result.strains(column.n + 1)
    # The footing turns, so the head does more; layers at the one face here are at the other there.
    assert head.value.max() > foot.value.max() > 2e-3
    assert np.sign(foot.position[0]) == -np.sign(head.position[0])
    assert "first_yield" in [state.name for state in result.limit_states()]
