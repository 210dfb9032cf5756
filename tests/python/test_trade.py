"""Time against accuracy: errors, front, choice and reference of a trade, parts of the model, files.

The speed of the machine is not tested: wall times only have to be there.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from reference_chain import Linear, chain

import rbsdem
from rbsdem import compare_methods
from rbsdem.frames import Frame, FrameMember
from rbsdem.methods import ladder, study
from rbsdem.methods.ladder import study_case
from rbsdem.methods.study import MethodStudy, split_bodies
from rbsdem.output.methods import report
from rbsdem.run.accuracy import Answer, at_times, common_interval, errors_of
from rbsdem.springs import Bilinear, Compression, Elastic

LENGTH, MASS = 1.6, 614.4
SHEAR, BENDING = 7.0387e8, 2.5428e8
ELASTIC = rbsdem.Column(LENGTH, MASS, Elastic(SHEAR), Elastic(BENDING))
PAPER = rbsdem.peer.paper_columns("pdelta", top_mass=75000.0)["soesianawati_1"]
TIME = np.arange(0.0, 1.0001, 0.005)
MOTION = 4.0 * np.sin(2 * np.pi * 2.0 * TIME) * np.minimum(TIME / 0.3, 1.0)
CYCLES = LENGTH * rbsdem.protocol([0.005, 0.01, 0.02], cycles=1)


@pytest.fixture(autouse=True)
def _short_runs_are_run_once(monkeypatch):
    monkeypatch.setattr(ladder, "SHORT", 0.0)


@pytest.fixture(scope="module")
def shaken() -> MethodStudy:
    """The column of the paper with a storey, under a short motion."""
    return compare_methods(
        PAPER, TIME, ground_acceleration=MOTION, tolerance=1e-3, repeats=1, budget=30.0
    )


def rows_of(found: MethodStudy, method: str, kinematics: str, events: str | None = None) -> list:
    wanted = (method, events, kinematics)
    return [row for row in found.rows if row.setting.family[:3] == wanted]


def answer(response, moment, taken) -> Answer:
    rows = np.arange(float(len(response)))
    return Answer(rows, *map(np.array, (response, moment, taken)), "completed")


def test_errors_are_relative_to_the_peaks_of_the_other():
    one = answer([0.0, 1.0, -3.0], [0.0, 3.0, -10.0], [0.0, 9.0, 7.0])
    other = answer([0.0, 2.0, -4.0], [0.0, 0.0, -10.0], [0.0, 10.0, 8.0])
    errors = errors_of(one, other)
    assert errors.response_rms == pytest.approx(math.sqrt(2 / 3) / 4)
    assert errors.response_max == pytest.approx(1 / 4)
    assert errors.moment == pytest.approx(math.sqrt(3.0) / 10)
    assert errors.energy == pytest.approx(0.1)
    assert errors.peak == pytest.approx(0.25)
    assert errors.largest == pytest.approx(0.25)


def test_values_between_rows_are_exact_for_cubics():
    time = np.cumsum([0.0, 0.2, 0.1, 0.3, 0.25, 0.15])
    wanted = np.linspace(0.0, 1.0, 33)
    cubic = np.polynomial.Polynomial([1.0, -2.0, 3.0, -4.0])
    np.testing.assert_allclose(at_times(wanted, time, cubic(time)), cubic(wanted), atol=1e-13)


def test_common_interval_divides_what_can_be_divided():
    assert common_interval(np.arange(0.0, 1.0001, 0.01)) == (pytest.approx(0.01), True)
    assert common_interval(np.array([0.0, 0.02, 0.05, 0.07])) == (pytest.approx(0.01), True)
    interval, regular = common_interval(np.array([0.0, 0.1, 0.1 + 0.1 * math.sqrt(2), 0.5]))
    assert not regular
    assert interval == pytest.approx(0.1 * math.sqrt(2))


def test_a_loading_of_few_times_is_the_same_at_more_of_them():
    made = study_case(ELASTIC, [0.0, 1.0, 3.0], {"force": [0.0, 2.0, -2.0]}, None, None)
    assert made.time.size > ladder.LEAST_ROWS
    assert {0.0, 1.0, 3.0} <= set(made.time)
    expected = np.interp(made.time, [0.0, 1.0, 3.0], [0.0, 2.0, -2.0])
    np.testing.assert_allclose(made.loads["force"], expected, atol=1e-15)


def test_reference_and_orders_of_free_vibration():
    """The reference against the modal solution; errors fall with the orders of the methods."""
    found = compare_methods(
        ELASTIC,
        [0.0, 0.2],
        initial={"slip": [1e-3]},
        methods=["rk4", "newmark"],
        repeats=1,
        digits=9,
    )
    reference = found.reference
    assert reference.reached
    assert reference.digits >= 9
    times = reference.answer.time
    linear = Linear(ELASTIC)
    rows = linear.solve(times, np.zeros((times.size, 2)), [1e-3, 0.0, 0.0, 0.0])
    exact = rows[:, :2] @ linear.arm
    difference = np.abs(reference.answer.response - exact).max() / np.abs(exact).max()
    assert difference < 3 * 10**-reference.digits
    for method, events, order in (("rk4", "step", 4), ("newmark", None, 2)):
        coarser, finer = rows_of(found, method, "small", events)[-3:-1]
        for name in ("response_rms", "moment"):
            ratio = getattr(coarser, name) / getattr(finer, name)
            assert math.log2(ratio) == pytest.approx(order, abs=0.15), (method, name)
    assert found.response == "displacement"


def test_reference_of_the_paper_column_has_two_methods(shaken):
    reference = shaken.reference
    assert reference.reached
    assert reference.first.split(",")[0] != reference.second.split(",")[0]
    assert min(reference.moment_digits, reference.energy_digits, reference.peak_digits) > 6
    assert 0 < reference.resolution < 1e-6
    # A method of another kind, implicit instead of explicit, tends to the same answer.
    implicit = rows_of(shaken, "newmark", "pdelta")
    assert implicit[-1].error < implicit[0].error / 30
    assert any("of another kind" in note for note in shaken.warnings)


def test_settings_of_all_kinds_are_there(shaken):
    families = {row.setting.family[:3] for row in shaken.rows}
    for method in ("newmark", "hht", "generalised_alpha", "rk45", "auto"):
        assert (method, None, "pdelta") in families
    for level in ("small", "pdelta"):
        assert ("rk4", "step", level) in families
    assert ("rk4", "located", "pdelta") in families
    for row in shaken.rows:
        if row.status == "completed":
            assert row.seconds > 0
            assert row.error == max(row.response_rms, row.moment, row.energy, row.peak)
            assert row.response_rms <= row.response_max
    chosen = next(row for row in shaken.rows if row.setting.method == "auto")
    assert chosen.reason.split(":")[0] in rbsdem.run.solver.IN_TIME


def test_a_step_beyond_the_limit_stays_in_the_table(shaken):
    refused = [row for row in shaken.rows if row.status == "refused"]
    assert len(refused) == 1
    limit = rbsdem.modes(PAPER).stable_step
    assert refused[0].setting.dt > limit
    assert "stability limit" in refused[0].reason
    assert math.isnan(refused[0].error)
    next_one = shaken.rows[shaken.rows.index(refused[0]) + 1]
    assert limit / 2 < next_one.setting.dt <= limit


def test_steps_divide_the_interval_of_the_loading(shaken):
    for row in shaken.rows:
        if row.setting.dt:
            parts = 0.005 / row.setting.dt
            assert parts == pytest.approx(round(parts), rel=1e-9)


def test_front_is_what_no_other_beats(shaken):
    done = [
        (row.seconds, max(row.error, shaken.reference.resolution), row.pareto)
        for row in shaken.rows
        if math.isfinite(row.error)
    ]
    for seconds, error, pareto in done:
        beaten = any(s <= seconds and e <= error and (s, e) != (seconds, error) for s, e, _ in done)
        assert pareto == (not beaten)
    assert sum(pareto for _, _, pareto in done) >= 3


def test_choice_is_the_cheapest_within_the_tolerance(shaken):
    for tolerance in (1e-2, 1e-3, 1e-5):
        row = shaken.cheapest(tolerance)
        assert row.error <= tolerance
        for other in shaken.rows:
            if other.error <= tolerance and other.seconds < row.seconds:
                finer = [
                    r
                    for r in shaken.rows
                    if r.setting.family == other.setting.family
                    and (r.setting.dt or r.setting.tolerance)
                    < (other.setting.dt or other.setting.tolerance)
                ]
                assert any(r.error > tolerance for r in finer)
    assert shaken.cheapest(1e-15) is None
    choice = shaken.choice
    assert choice.row == shaken.cheapest(1e-3)
    assert choice.finer.setting.family == choice.row.setting.family
    assert choice.move.largest == choice.row.move
    assert choice.row.move <= choice.row.error + choice.finer.error + 1e-12
    assert str(choice.row.setting) in str(choice)


def test_lower_kinematics_err_by_what_the_physics_table_says(shaken):
    small = rows_of(shaken, "rk4", "small", "step")[-1]
    effect = next(e for e in shaken.physics.effects if e.part == "kinematics small")
    assert small.response_rms == pytest.approx(effect.history, rel=0.01)
    assert small.peak == pytest.approx(abs(effect.peak), rel=0.02)


def test_a_setting_of_the_user_is_measured(shaken):
    found = compare_methods(
        PAPER,
        TIME,
        ground_acceleration=MOTION,
        methods=["newmark"],
        setting={"method": "hht", "dt": 0.00125, "rho_infinity": 0.9},
        repeats=1,
    )
    own = found.rows[0]
    assert own.setting.own
    assert own.setting.method == "hht"
    assert 1e-9 < own.error < 0.1
    with pytest.raises(rbsdem.InputError, match="setting: 'step' is not known"):
        compare_methods(PAPER, TIME, ground_acceleration=MOTION, setting={"step": 1.0})


def test_collapse_ends_the_comparison():
    found = compare_methods(
        PAPER,
        TIME,
        ground_acceleration=3 * MOTION,
        collapse_drift=0.01,
        methods=["rk4"],
        repeats=1,
    )
    own = rows_of(found, "rk4", "pdelta", "located")
    assert {row.status for row in own} == {"collapsed"}
    assert found.reference.answer.time[-1] < TIME[-1]
    assert own[-1].error < 1e-3


def long_chain() -> rbsdem.Column:
    spring = Bilinear(2.0e10, 2e-5, 2.0e9)
    return rbsdem.Column(
        1.6, 614.4, Elastic(7e10), spring, n=20, top_mass=75000.0, gravity=0.0,
        damping=rbsdem.Damping(stiffness=1e-5),
    )  # fmt: skip


def test_what_does_not_fit_into_the_budget_is_left_out_and_told(monkeypatch):
    """A step of rk4 takes 100 ms here, whatever the machine is."""
    look = ladder.Probe(0.3, 0.005, True, 1e-5, 1e-1, 1e-4)
    monkeypatch.setattr(study, "probe", lambda case: look)
    found = compare_methods(
        long_chain(), TIME[:61], ground_acceleration=MOTION[:61], methods=["rk4", "newmark"],
        digits=2, repeats=1,
    )  # fmt: skip
    skipped = [row for row in found.rows if row.status == "skipped"]
    assert {row.setting.method for row in skipped} == {"rk4"}
    assert all("would take about" in row.reason for row in skipped)
    assert any("did not fit" in note for note in found.warnings)
    # Implicit methods do it in time, and then make up the reference.
    assert any(row.setting.method == "newmark" and row.error < 0.05 for row in found.rows)
    assert found.reference.warning.endswith("share the solver of the equations")


def test_no_time_at_all():
    with pytest.raises(rbsdem.InputError, match="budget is too small for any setting"):
        compare_methods(long_chain(), TIME, ground_acceleration=MOTION, budget=1e-6)


@pytest.mark.filterwarnings("ignore:column. axial_load ")
@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_static_path_and_its_inverse(kinematics):
    column = dataclasses.replace(PAPER, kinematics=kinematics)
    found = compare_methods(column, displacement=CYCLES, tolerance=1e-3)
    assert found.response == "force"
    assert found.reference.digits > 8
    assert "driven by force" in found.reference.second
    given = next(row for row in found.rows if row.setting.parts == 1)
    assert given.error < 1e-8
    turns = next(row for row in found.rows if row.setting.parts == 0)
    assert turns.peak < 1e-8
    assert turns.energy < 1e-8
    assert turns.response_rms > 1e-2
    assert found.choice.row is not None
    assert not [e for e in found.physics.effects if "inertia" in e.part]


def test_the_inverse_adds_what_was_lost_on_the_way():
    """Of an elastic column: forces too large by 1e-6 move the top too far by as much."""
    case = study_case(ELASTIC, None, {"displacement": CYCLES}, None, None)
    there = case.run(ladder.Setting("static", "small", parts=1)).answer
    more = dataclasses.replace(there, response=there.response * (1 + 1e-6))
    back = study._inverse(case, more, 1).answer
    assert back.response == pytest.approx(there.response * (1 + 2e-6), rel=1e-9, abs=1e-6)


def test_costs_are_those_of_the_first_hundred_intervals(monkeypatch):
    """Also of a record that does not begin at time zero."""
    lengths = {}
    monkeypatch.setattr(
        ladder, "_seconds", lambda case, setting: lengths.update({setting.method: case.time}) or 1.0
    )
    late = study_case(ELASTIC, 50.0 + TIME, {"ground_acceleration": MOTION}, None, None)
    assert ladder.probe(late).implicit == pytest.approx(0.01)
    assert lengths["newmark"] == pytest.approx(50.0 + TIME[:101])


def test_falling_force_cannot_be_driven_back():
    """Past its peak: increments are compared instead."""
    column = rbsdem.Column(
        1.6,
        614.4,
        Elastic(1e9),
        Bilinear(1e8, 1e-3, 1e5),
        kinematics="pdelta",
        axial_load=1e6,
    )
    found = compare_methods(column, displacement=np.linspace(0.0, 0.02, 50))
    assert "increments are compared" in found.reference.warning
    assert found.reference.digits > 10


def effect_of(found: MethodStudy, part: str):
    return next(effect for effect in found.physics.effects if effect.part == part)


def test_effect_of_the_axial_load_on_an_elastic_column():
    """Without P the force is that of two springs in series; with it k_M is less by P l."""
    load = 0.1 * BENDING / LENGTH
    column = dataclasses.replace(ELASTIC, kinematics="pdelta", axial_load=load)
    found = compare_methods(column, displacement=CYCLES)

    def flexibility(axial_load: float) -> float:
        return 1 / SHEAR + LENGTH**2 / (BENDING - axial_load * LENGTH)

    change = flexibility(load) / flexibility(0.0) - 1
    for part in ("kinematics small", "no axial load"):
        effect = effect_of(found, part)
        assert effect.peak == pytest.approx(change, rel=1e-9)
        assert effect.matters
    assert effect_of(found, "kinematics finite").peak == pytest.approx(0.0, abs=1e-3)


def test_effect_of_two_bodies_on_an_elastic_column():
    """Half of the joint's rotation takes place at half of the height."""
    found = compare_methods(ELASTIC, force=np.linspace(0.0, 1e5, 20))
    one = 1 / SHEAR + LENGTH**2 / BENDING
    two = 1 / SHEAR + (LENGTH**2 + (LENGTH / 2) ** 2) / (2 * BENDING)
    assert effect_of(found, "2 bodies").peak == pytest.approx(two / one - 1, rel=1e-9)
    assert not effect_of(found, "kinematics pdelta").matters


def test_effects_of_a_column_with_everything():
    column = rbsdem.Column(
        1.6, 614.4, Elastic(7e8), PAPER.flexure, kinematics="pdelta", axial_load=744e3,
        self_weight=True, axial_spring=Compression(3e9), top_mass=75000.0, top_inertia=2000.0,
        depth=0.4, damping=rbsdem.Damping(mass=0.2, stiffness=1e-5),
    )  # fmt: skip
    found = compare_methods(
        column, TIME, ground_acceleration=MOTION, vertical_acceleration=0.3 * MOTION,
        methods=["rk45"], repeats=1, digits=5, budget=30.0,
    )  # fmt: skip
    effects = {effect.part: effect for effect in found.physics.effects}
    assert set(effects) == {
        "kinematics small", "kinematics finite", "no axial load", "no self-weight",
        "joints do not open", "no top mass", "no inertia of top", "bodies without depth",
        "no damping", "no vertical_acceleration", "rotary inertia x 0.01",
        "damping of tangent stiffness", "2 bodies",
    }  # fmt: skip
    assert effects["no top mass"].peak < -0.5
    assert effects["no top mass"].matters
    assert not effects["no self-weight"].matters
    assert 0 < found.physics.resolution < 1e-3


def test_split_bodies_keeps_mass_height_and_inertia():
    inertia = [100 * 0.8**2 / 12, 300 * 1.2**2 / 12]
    column = chain([0.8, 1.2], [100.0, 300.0], [1e8, 1e8], [1e8, 2e8], rotary_inertia=inertia)
    halves = split_bodies(column)
    assert halves.lengths == (0.4, 0.4, 0.6, 0.6)
    assert halves.masses == (50.0, 50.0, 150.0, 150.0)
    expected = [m * length**2 / 12 for m, length in zip(halves.masses, halves.lengths, strict=True)]
    assert halves.rotary_inertia == pytest.approx(expected)
    assert [spring.k for spring in halves.flexure] == [2e8, 2e8, 4e8, 4e8]


def test_methods_of_a_frame_have_their_order():
    kind = FrameMember(modulus=3e10, area=0.16, inertia=2e-3)
    frame = Frame.grid(
        [3.2], [6.0], columns=kind, beams=kind, beam_load=8e4, floor_mass=5e4, damping=0.05
    )
    time = np.arange(0.0, 2.001, 0.01)
    found = compare_methods(
        frame, time, ground_acceleration=np.sin(12 * time), methods=("newmark", "rk4"), digits=6
    )
    errors = [run.error for run in found.rows if run.setting.method == "newmark"][:4]
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.05)
    refused = [run for run in found.rows if run.setting.method == "rk4"]
    assert refused
    assert all("unknowns without mass" in run.reason for run in refused)
    parts = {effect.part: effect for effect in found.physics.effects}
    assert list(parts) == ["kinematics pdelta", "no damping"]
    # The dead load is 3 % of what buckles the frame; undamped it sways further.
    assert 0 < abs(parts["kinematics pdelta"].peak) < 0.1 < parts["no damping"].peak


def test_what_no_setting_can_solve():
    """A force beyond what the column bears; an axial load above the critical one."""
    column = rbsdem.Column(1.6, 614.4, Elastic(1e9), Bilinear(1e8, 1e-3, 0.0))
    with pytest.raises(rbsdem.SolveError, match="no setting solves the case"):
        compare_methods(column, force=np.linspace(0.0, 1e6, 20))
    column = dataclasses.replace(ELASTIC, kinematics="pdelta", axial_load=2 * BENDING / LENGTH)
    with pytest.raises(rbsdem.InputError, match="axial"):
        compare_methods(column, TIME, ground_acceleration=MOTION)


def read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_tables_and_figure(shaken, capsys):
    console = pytest.importorskip("rich.console")
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    out = console.Console(record=True, width=140, file=io.StringIO())
    report(shaken, "A case")
    out.print(rbsdem.plot.table(shaken))
    out.print(rbsdem.plot.table(shaken.physics))
    text = out.export_text() + capsys.readouterr().out
    for word in ("rk4, located, pdelta", "tolerance = 1e-06", "refused", "To finer", "no top mass"):
        assert word in text
    ax = rbsdem.plot.methods(shaken)
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    front = next(line for line in ax.get_lines() if line.get_label() == "Pareto front")
    assert np.all(np.diff(front.get_xdata()) > 0)
    assert np.all(np.diff(front.get_ydata()) < 0)
    assert rbsdem.plot.methods(shaken, ax=ax) is ax
    matplotlib.pyplot.close("all")


CASE = """\
&case title = 'a [short] motion' /
&column height = 1.6, mass = 614.4, kinematics = 'pdelta', top_mass = 75000, axial_load = 744e3 /
&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /
&flexure rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7, d_y = 2.7183e-3,
         k_u = 7.5772e6, b1 = 0.22 /
&loading drive = 'ground_acceleration', amplitudes = 3.0, cycles = 2, period = 0.4, points = 20 /
&analysis method = 'hht', dt = 0.0025 /
"""


def command(*arguments: object, before: str = "") -> subprocess.CompletedProcess[str]:
    """Run `rbsdem trade` in a process of its own, after some lines of Python."""
    code = (
        f"import sys; {before}\nfrom rbsdem.__main__ import main\n"
        f"sys.argv[1:] = {['trade', *map(str, arguments)]!r}\nsys.exit(main())"
    )
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=100, check=False
    )


def test_command_writes_its_files(tmp_path):
    case = tmp_path / "case.nml"
    case.write_text(CASE, "utf-8")
    done = command(case, "--tolerance", "0.01", "--budget", "20", "--methods", "newmark,rk4")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    for word in ("a [short] motion", "They agree to", "hht, pdelta (as given)", "Tolerance 0.01: "):
        assert word in done.stdout
    folder = tmp_path / "case-trade"
    assert {path.name for path in folder.iterdir()} == {
        "contents.txt", "trade.csv", "physics.csv", "trade.png",
    }  # fmt: skip
    assert (folder / "trade.png").stat().st_size > 5000
    rows = read(folder / "trade.csv")
    assert rows[0]["method"] == "hht"
    assert float(rows[0]["dt_s"]) == 0.0025
