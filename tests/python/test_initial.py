"""Analyses that begin in the state another result ended in.

A clock of binary fractions has no round-off, so that an analysis in two pieces is the one in one
piece to the last bit. Elsewhere expected values are those of closed forms.
"""

from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered, Pinching, SteelSpring, Takeda

SHEAR = Bilinear(k=7.0387e8, d_y=1.2960e-4, k_post=8.3185e6)
TAKEDA = Takeda(k_c=2.5428e8, d_c=3.1891e-4, k_y=6.2937e7, d_y=2.7183e-3, k_u=7.5772e6, b1=0.22)
CAPPED = {"f_y": 1.8e5, "d_y": 3e-3, "f_cap": 2.2e5, "d_cap": 2e-2, "d_pc": 0.2, "f_res": 1e4}
PINCHING = Pinching(**CAPPED, kappa_f=0.4, kappa_d=0.5, lambda_s=60.0)
STEEL = [(y, SteelSpring(k=2e8, f_y=4e5, k_post=2e6, endurance=300.0)) for y in (-0.15, 0.0, 0.15)]
STRIPS = [
    (
        y,
        ConcreteSpring(
            k=4e8, f_peak=4e5, d_peak=2e-3, k_soft=2e7, f_res=4e4, misfit=0.1, friction=0.3
        ),
    )
    for y in np.linspace(-0.18, 0.18, 6)
]
LAYERED = Layered(layers=STEEL + STRIPS)


def column(flexure=TAKEDA, kinematics="pdelta", n=1, **other):
    loaded = kinematics != "small" or flexure is LAYERED
    given = {"axial_load": 4e5 if loaded else 0.0, "mass": 6144.0, "shear": SHEAR} | other
    return rbsdem.Column(1.6, flexure=flexure, n=n, kinematics=kinematics, **given)


def random_walk(seed, m, step):
    return step * np.cumsum(np.random.default_rng(seed).normal(size=m))


def assert_goes_on(part, whole, cut, state=True):
    for name in ("displacement", "force", "slip", "rotation", "shear", "moment"):
        assert np.array_equal(getattr(part, name), getattr(whole, name)[cut:]), name
    for name, values in part.energy.items():
        assert np.array_equal(values, whole.energy[name][cut:]), name
    if state:
        assert np.array_equal(part.state, whole.state)


def test_steps_that_do_not_follow_the_times_go_on_from_their_origin():
    made = column(Elastic(k=1e8), "small")
    release = {"initial": {"slip": [0.0], "rotation": [0.001]}}
    whole = rbsdem.time_history(made, [0, 1], dt=2.0**-7 * 3, method="newmark", **release)
    cut = 12 * 3 * 2.0**-7
    first = rbsdem.time_history(made, [0, cut], dt=2.0**-7 * 3, method="newmark", **release)
    rest = rbsdem.time_history(made, [cut, 1], dt=2.0**-7 * 3, method="newmark", initial=first)
    assert np.array_equal(rest.time, whole.time[12:])
    assert_goes_on(rest, whole, 12, state=False)


def test_a_path_after_a_motion_begins_in_equilibrium_at_the_displacement_of_the_top():
    k, k_r, height = 1e7, 1e8, 1.6
    made = rbsdem.Column(height, 6144.0, Elastic(k=k), Elastic(k=k_r), axial_load=0.0)
    moved = rbsdem.time_history(
        made, [0, 0.37], initial={"slip": [0.004], "rotation": [0.001]}, method="newmark"
    )
    x = moved.displacement[-1]
    held = rbsdem.cyclic(made, displacement=[x], initial=moved)
    # Both joints in series: 1/k + h^2/k_r.
    assert held.force[0] == pytest.approx(x / (1 / k + height**2 / k_r), rel=1e-12)
    back = rbsdem.cyclic(made, force=[0.0], initial=moved)
    assert abs(back.displacement[0]) <= 1e-12 * abs(x)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
@pytest.mark.parametrize("flexure", [TAKEDA, LAYERED])
def test_joints_are_in_equilibrium_after_a_motion(flexure, kinematics):
    made = column(flexure, kinematics, 2, damping=rbsdem.Damping(mass=0.5))
    t = np.arange(80) * 0.01
    moved = rbsdem.time_history(
        made, t, ground_acceleration=random_walk(9, t.size, 2.0), method="newmark"
    )
    x = moved.displacement[-1]
    held = rbsdem.cyclic(made, displacement=[x], initial=moved)
    # With second-order moments the lowest joint carries P times the way of the top from it too.
    moment = held.force[0] * held.top[0, 1] if kinematics == "finite" else held.force[0] * 1.6
    if kinematics != "small":
        moment += 4e5 * (x - held.slip[0, 0])
    assert held.moment[0, 0] == pytest.approx(moment, rel=1e-9)
    assert held.summary["relative_energy_residual"] <= 1e-3


def test_a_column_that_was_pulled_and_let_go_keeps_its_energy():
    made = rbsdem.Column(1.6, 6144.0, Elastic(k=1e9), Elastic(k=1e8))
    pulled = rbsdem.cyclic(made, displacement=[0.01])
    let_go = rbsdem.time_history(made, [0, 1], method="rk4", initial=pulled)
    assert let_go.displacement[0] == 0.01
    stored = 0.5 * pulled.force[-1] * 0.01
    whole = let_go.energy["kinetic"] + let_go.energy["spring"]
    assert whole == pytest.approx(stored, rel=0.01)
    # Held by the force of the path it stays.
    held = rbsdem.time_history(
        made, [0, 1], force=[pulled.force[-1]] * 2, method="rk4", initial=pulled
    )
    assert np.abs(held.displacement - 0.01).max() <= 1e-12


def test_the_axial_load_may_be_another():
    k = 1e8
    elastic = {"shear": Elastic(k=7e8)}
    made = column(Elastic(k=k), axial_load=4e5, **elastic)
    pushed = rbsdem.cyclic(made, displacement=[0.01])
    more = rbsdem.cyclic(
        column(Elastic(k=k), axial_load=8e5, **elastic),
        displacement=[0.01],
        initial=pushed,
    )
    fresh = rbsdem.cyclic(column(Elastic(k=k), axial_load=8e5, **elastic), displacement=[0.01])
    assert more.force[0] == pytest.approx(fresh.force[0], rel=1e-11)
    # A layered joint: elastic layers end where they would be without the history.
    layers = [(y, Elastic(k=1e8)) for y in (-0.1, 0.0, 0.3)]
    one, two = (column(Layered(layers=layers), axial_load=p) for p in (4e5, 8e5))
    pushed = rbsdem.cyclic(one, displacement=[0.01], openings=True)
    more = rbsdem.cyclic(two, displacement=[0.02], initial=pushed, openings=True)
    assert more.opening[0, 0] - pushed.opening[0, 0] == pytest.approx(
        -4e5 / 3e8 - (more.rotation[0, 0] - pushed.rotation[0, 0]) * 0.2e8 / 3e8, rel=1e-9
    )


def test_a_result_and_its_files_begin_the_same_path(tmp_path):
    x = random_walk(3, 12, 0.006)
    first = rbsdem.cyclic(column(), displacement=x[:6])
    on = rbsdem.cyclic(column(), displacement=x[6:], initial=first)
    first.save(tmp_path / "first.npz")
    assert rbsdem.read_result(tmp_path / "first.npz") == first
    loaded = rbsdem.cyclic(
        column(), displacement=x[6:], initial=rbsdem.read_result(tmp_path / "first.npz")
    )
    first.save_state(tmp_path / "first.state")
    read = rbsdem.cyclic(column(), displacement=x[6:], initial=tmp_path / "first.state")
    assert np.array_equal(loaded.force, on.force)
    assert np.array_equal(read.force, on.force)


def damaged(state, place, value):
    other = state.copy()
    other[place] = value
    return other


def test_a_state_of_another_column_is_refused():
    first = rbsdem.cyclic(column(), displacement=[0.01])

    def begin(made, result=first):
        return rbsdem.cyclic(made, displacement=[0.02], initial=result)

    with pytest.raises(InputError, match="other springs or lengths"):
        begin(column(PINCHING))
    with pytest.raises(InputError, match="n = 1 bodies, this one has n = 2"):
        begin(column(n=2))
    with pytest.raises(InputError, match="kinematics = 'pdelta', this column has 'finite'"):
        begin(column(kinematics="finite"))
    begin(column(mass=1.0, axial_load=3e5, damping=rbsdem.Damping(mass=1.0)))


def test_a_state_that_is_damaged_is_refused(tmp_path):
    first = rbsdem.cyclic(column(), displacement=[0.01])
    size = first.state.size
    wrong = [
        (first.state[: size // 2], "damaged"),
        (first.state[:3], "damaged"),
        (damaged(first.state, size - 1, 3.0), "damaged"),
        (damaged(first.state, 40, np.nan), "damaged"),
        (damaged(first.state, 0, 7.0), "another version|a version of rbsdem"),
    ]
    for state, message in wrong:
        with pytest.raises(InputError, match=message):
            rbsdem.cyclic(column(), displacement=[0.02], initial=replace(first, state=state))
    with pytest.raises(InputError, match="no state at its end"):
        rbsdem.cyclic(column(), displacement=[0.02], initial=replace(first, state=None))
    path = tmp_path / "bad.state"
    path.write_text("# rbsdem state\n3\n1.0\n2.0\n")
    with pytest.raises(InputError, match="2 numbers of 3"):
        rbsdem.cyclic(column(), displacement=[0.02], initial=path)


def test_a_failed_analysis_has_no_state():
    with pytest.raises(rbsdem.SolveError) as failed:
        rbsdem.cyclic(column(Bilinear(k=1e8, d_y=1e-3, k_post=0.0)), force=[1e4, 1e6])
    assert failed.value.result.state is None
    collapsed = rbsdem.cyclic(column(), displacement=[0.01, 0.05, 0.1], collapse_drift=0.02)
    assert collapsed.summary["status"] == "collapsed"
    on = rbsdem.cyclic(column(), displacement=[0.1], initial=collapsed)
    whole = rbsdem.cyclic(column(), displacement=[0.01, 0.05, 0.1])
    assert on.force[0] == whole.force[-1]


CASE = """&column height = 1.6, mass = 6144.0, kinematics = 'pdelta', axial_load = 4e5 /
&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /
&flexure rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7,
         d_y = 2.7183e-3, k_u = 7.5772e6, b1 = 0.22 /
"""


def run_case(run_cli, folder, name, text, code=0):
    (folder / f"{name}.nml").write_text(CASE + text)
    done = run_cli(["run", "--quiet", f"{name}.nml"], cwd=folder)
    assert done.returncode == code, done.stderr
    return done.stderr


def test_both_doors_write_and_begin_in_the_same_state(run_cli, tmp_path):
    x = [0.01, -0.004, 0.02]
    values = ", ".join(map(repr, x))
    run_case(
        run_cli,
        tmp_path,
        "first",
        f"&loading drive = 'displacement', values = {values} /\n&output state = 'end.state' /\n",
    )
    first = rbsdem.cyclic(column(), displacement=x)
    first.save_state(tmp_path / "python.state")
    assert (tmp_path / "end.state").read_bytes() == (tmp_path / "python.state").read_bytes()
    run_case(
        run_cli,
        tmp_path,
        "second",
        "&loading drive = 'displacement', values = 0.0, 0.03 /\n"
        "&analysis initial = 'end.state' /\n",
    )
    on = rbsdem.cyclic(column(), displacement=[0.0, 0.03], initial=first)
    rows = np.loadtxt(tmp_path / "second.csv", delimiter=",", skiprows=4)
    assert np.array_equal(rows[:, 2], on.force)
    case = rbsdem.read_case(tmp_path / "second.nml")
    assert np.array_equal(case.run().force, on.force)
    # What cannot be begun in is said before anything is solved.
    (tmp_path / "end.state").write_text("nothing")
    said = run_case(
        run_cli,
        tmp_path,
        "third",
        "&loading drive = 'force', values = 0.0 /\n&analysis initial = 'end.state' /\n",
        code=2,
    )
    assert "is no state of rbsdem" in said


HELD = {"top": "fixed", "top_mass": 100.0, "axial_spring": Elastic(k=3e9)}


@pytest.mark.parametrize(
    ("kinematics", "ends"), [("pdelta", {}), ("finite", {}), ("finite", HELD), ("pdelta", HELD)]
)
def test_velocity_and_acceleration_are_derivatives_of_the_displacement(kinematics, ends):
    made = column(Elastic(k=1e8), kinematics, 2, shear=Elastic(k=7e8), **ends)
    rest = [0.0] if ends else []
    start = {"slip": [0.001, 0.0, *rest], "rotation": [0.05, 0.03] + [-0.08] * len(rest)}
    h = 1e-4 / (10 if ends else 1)
    time = h * np.arange(2000)
    run = {"method": "rk45", "tolerance": 1e-10, "motion": True}
    moved = rbsdem.time_history(made, time, initial=start, **run)
    x, v, a = moved.displacement, moved.velocity, moved.acceleration
    # Derivatives by differences of order 4.
    first = (x[:-4] - 8 * x[1:-3] + 8 * x[3:-1] - x[4:]) / (12 * h)
    second = (v[:-4] - 8 * v[1:-3] + 8 * v[3:-1] - v[4:]) / (12 * h)
    assert np.abs(first - v[2:-2]).max() <= 1e-5 * np.abs(v).max()
    assert np.abs(second - a[2:-2]).max() <= 1e-5 * np.abs(a).max()


def test_the_motion_of_the_top_in_tables_files_and_summary(tmp_path):
    t = np.arange(41) * 0.01
    ground = 3 * np.sin(20 * t)
    given = {"ground_acceleration": ground, "method": "newmark"}
    moved = rbsdem.time_history(column(LAYERED), t, motion=True, openings=True, **given)
    plain = rbsdem.time_history(column(LAYERED), t, openings=True, **given)
    assert np.array_equal(moved.force, plain.force)
    assert np.array_equal(moved.opening, plain.opening)
    floor = moved.acceleration + ground
    assert moved.absolute_acceleration == pytest.approx(floor, rel=1e-12, abs=1e-12)
    dense = rbsdem.time_history(column(LAYERED), t, motion=True, every=1, **given)
    peak = np.abs(dense.absolute_acceleration).max()
    assert moved.summary["peak_floor_acceleration"] == peak
    moved.save(tmp_path / "moved.npz")
    assert rbsdem.read_result(tmp_path / "moved.npz") == moved
    frame = moved.to_pandas()
    assert np.array_equal(frame["velocity_m/s"], moved.velocity)
    assert np.array_equal(frame["acceleration_m/s2"], moved.acceleration)
