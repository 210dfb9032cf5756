"""Results as tables and files."""

from __future__ import annotations

import json
import pickle
import sys

import numpy as np
import pytest
from conftest import REPOSITORY

import rbsdem
from rbsdem import InputError
from rbsdem.springs import Bilinear, Elastic, PeakOriented

sys.path.insert(0, str(REPOSITORY / "examples" / "12-lumped-hinge"))
import lumped

TIME = np.arange(0.0, 1.0, 0.01)
MOTION = 3.0 * np.sin(8 * TIME)


def layered() -> rbsdem.Column:
    section = rbsdem.RectangularSection(
        0.4,
        0.4,
        rbsdem.Concrete(40e6),
        layout=rbsdem.Layout(8, 0.02, rbsdem.Steel(450e6, 650e6)),
        ties=rbsdem.Ties(0.01, 0.08, rbsdem.Steel(400e6), legs=3),
        cover=0.02,
    )
    return rbsdem.section.column(section, 1.6, axial_load=7e5)


def results() -> dict[str, rbsdem.Result]:
    paper = rbsdem.peer.paper_columns()["zahn_7"]
    damped = rbsdem.Column(
        1.6,
        600.0,
        paper.shear,
        paper.flexure,
        n=3,
        damping=0.02,
        axial_load=1e5,
        kinematics="pdelta",
    )
    opening = rbsdem.Column(
        1.6, 600.0, Elastic(1e9), Elastic(1e9), axial_spring=Elastic(1e9), n=2, kinematics="pdelta"
    )
    path = 1.6 * rbsdem.protocol([0.005, 0.01], points=5)
    return {
        "static": rbsdem.cyclic(paper, displacement=path),
        "force": rbsdem.cyclic(paper, force=[0.0, 1e4, -2e4]),
        "dynamic": rbsdem.time_history(
            damped, TIME, ground_acceleration=MOTION, initial={"slip": [1e-5, 0, 0]}, every=3
        ),
        "opening": rbsdem.time_history(opening, TIME, vertical_acceleration=MOTION),
    }


RESULTS = results()


@pytest.mark.parametrize("name", RESULTS)
def test_saved_result_comes_back_bit_for_bit(tmp_path, name):
    path = tmp_path / f"{name}.npz"
    RESULTS[name].save(path)
    back = rbsdem.read_result(path)
    assert back == RESULTS[name]
    assert pickle.loads(pickle.dumps(back)) == back
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_layers_and_a_case_come_back_too(tmp_path):
    column = layered()
    path = column.height * rbsdem.protocol([0.01], points=5)
    kept = rbsdem.cyclic(column, displacement=path, openings=True)
    kept.save(tmp_path / "a.npz")
    back = rbsdem.read_result(tmp_path / "a.npz")
    assert back == kept  # with the drawing of its column
    assert list(back.limit_states()) == list(kept.limit_states())
    assert np.array_equal(back.layer_deformation(), kept.layer_deformation())
    case = tmp_path / "case.nml"
    case.write_text(
        f"&case title = 'a pier' /\n{column.to_namelist()}\n"
        "&loading drive = 'displacement', amplitudes = 0.01, points = 3 /\n"
    )
    run = rbsdem.read_case(case).run()
    run.save(tmp_path / "b.npz")
    assert rbsdem.read_result(tmp_path / "b.npz") == run


@pytest.mark.parametrize("name", RESULTS)
def test_frame_has_the_columns_of_the_csv(tmp_path, name):
    pytest.importorskip("pandas")
    result = RESULTS[name]
    frame = result.to_pandas()
    result.to_csv(tmp_path / "a.csv")
    names = (tmp_path / "a.csv").read_text().splitlines()[3].split(",")
    assert list(frame.columns) == names
    assert np.array_equal(frame["displacement_m"], result.displacement)
    last = result.column.n
    assert np.array_equal(frame[f"moment_{last}_Nm"], result.moment[:, -1])


@pytest.mark.parametrize("ending", [".txt", "", ".nc"])
def test_other_endings_are_refused(tmp_path, ending):
    with pytest.raises(InputError, match=r"ends in \.npz"):
        RESULTS["static"].save(tmp_path / f"a{ending}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 nonsense", b"CDF\x01nonsense"])
def test_foreign_file_is_told(tmp_path, content):
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match="no saved result"):
        rbsdem.read_result(path)


def test_missing_later_and_damaged_files_are_told(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        rbsdem.read_result(tmp_path / "none.npz")
    path = tmp_path / "a.npz"
    RESULTS["static"].save(path)
    with np.load(path) as file:
        arrays = dict(file)
    about = json.loads(str(arrays["about"]))

    def written(**changes) -> None:
        np.savez(path, **(arrays | changes))

    written(about=np.array(json.dumps(about | {"format_version": 99})))
    with pytest.raises(InputError, match="later format"):
        rbsdem.read_result(path)
    written(about=np.array(json.dumps(about | {"format": "another"})))
    with pytest.raises(InputError, match="no saved result"):
        rbsdem.read_result(path)
    del arrays["channels/slip"]
    written()
    with pytest.raises(InputError, match="slip"):
        rbsdem.read_result(path)


def test_a_frame_that_loses_a_member_in_time_is_read_back(tmp_path):
    """Its losses are refused in a static case, by which the structure of a file was read."""
    kind = rbsdem.FrameMember(3e10, 0.16, 2e-3)
    given = {"columns": kind, "beams": kind, "floor_mass": 1e4, "beam_load": 2e4}
    frame = rbsdem.Frame.grid([3.0, 3.0], [5.0], losses={"C-2-2": 0.05}, **given)
    time = np.linspace(0.0, 0.1, 11)
    result = rbsdem.time_history(frame, time, ground_acceleration=np.sin(50.0 * time))
    result.save(tmp_path / "a.npz")
    assert rbsdem.read_result(tmp_path / "a.npz") == result


def test_state_between_rows_is_linear():
    result = RESULTS["dynamic"]
    middle = 0.5 * (result.time[4] + result.time[5])
    state = result.at(middle)
    assert state["displacement"] == pytest.approx(result.displacement[4:6].mean(), rel=1e-12)
    assert state["moment"] == pytest.approx(result.moment[4:6].mean(axis=0), rel=1e-12)
    assert result.at(result.time[-1])["energy"]["spring"] == result.energy["spring"][-1]
    for outside in (-0.1, 2.0):
        with pytest.raises(InputError, match="outside"):
            result.at(outside)


def test_residual_drift_of_a_static_path_is_at_the_last_zero_of_force():
    """An elastic and perfectly plastic spring: what is beyond yield is left."""
    spring = Bilinear(k=1e6, d_y=0.01, k_post=0.0)
    column = rbsdem.Column(2.0, 100.0, spring, Elastic(1e12))
    path = rbsdem.cyclic(column, displacement=[0.0, 0.03, 0.015])
    assert path.residual_drift == pytest.approx(0.02 / 2.0, rel=1e-5)
    held = rbsdem.cyclic(column, displacement=[0.0, 0.03])
    assert np.isnan(held.residual_drift)
    released = rbsdem.cyclic(column, force=[0.0, 5e3, 0.0])
    assert released.residual_drift == pytest.approx(0.0, abs=1e-15)


def test_residual_drift_in_time_is_that_of_an_ensemble():
    spring = Bilinear(k=1e6, d_y=0.002, k_post=1e4)
    column = rbsdem.Column(2.0, 5000.0, spring, Elastic(1e12), damping=0.05)
    time = np.arange(0.0, 3.0, 0.01)
    motion = np.where(time < 1.0, 4.0 * np.sin(9 * time), 0.0)
    shaken = rbsdem.time_history(column, time, ground_acceleration=motion)
    runs = rbsdem.ensemble(column, [(time, motion)], method="auto")
    assert abs(shaken.residual_drift) == runs.to_pandas()["residual_drift"][0] > 1e-4
    assert shaken.drift == pytest.approx(shaken.displacement / 2.0)


def test_lumped_hinge_of_a_capped_hinge(tmp_path):
    """A column that is such a hinge: backbone, Lambda and loop come back; a push has the cap."""
    lasting = dict.fromkeys(("lambda_s", "lambda_c", "lambda_k", "lambda_a"), 40.0)
    own = PeakOriented(d_y=0.005, f_y=2e5, d_cap=0.03, f_cap=2.4e5, d_pc=0.06, **lasting)
    column = rbsdem.Column(2.0, 1e3, Elastic(1e13), own, axial_load=3e5, kinematics="pdelta")
    drifts = rbsdem.protocol([0.003, 0.008, 0.015, 0.025, 0.045])
    hinge = rbsdem.cyclic(column, displacement=2.0 * drifts, every=7)
    hinge = lumped.lumped_hinge(hinge)
    hinge.to_csv(tmp_path / "hinge.csv")
    lines = (tmp_path / "hinge.csv").read_text().splitlines()
    assert lines[0].endswith("K_e_N_m/rad,M_y_N_m,M_c/M_y,theta_y_rad,theta_p_rad,theta_pc_rad,"
                             "theta_u_rad")  # fmt: skip
    assert [line.split(",")[0] for line in lines[1:]] == ["cyclic"] * 2 + ["monotonic"] * 2
    for line in lines[3:]:
        wanted = [4e7, 2e5, 1.2, 0.005, 0.025, 0.06, 0.0675]
        assert [float(word) for word in line.split(",")[3:]] == pytest.approx(wanted, rel=1e-5)
    assert hinge.endurance == pytest.approx(40.0 * 0.005, rel=1e-3)
    assert hinge.nrmse("IMKPeakOriented") < 1e-3
    assert hinge.nrmse("Hysteretic") < 0.1
    for material in lumped.MATERIALS:
        tcl, py = (hinge.opensees(material, language) for language in ("tcl", "py"))
        command = next(line for line in tcl.splitlines() if line.startswith("uniaxialMaterial"))
        called = next(line for line in py.splitlines() if line.startswith("ops.uniaxialMaterial"))
        given = [float(word) for word in called[21:-1].replace("'", "").split(", ")[2:]]
        assert [float(word) for word in command.split()[3:]] == given
        compile(py, "cantilever", "exec")
        assert f"nrmse {hinge.nrmse(material):.3f}" in tcl


def test_hysteretic_is_that_of_opensees():
    """Moments of OpenSees 3.7.1 (testUniaxialMaterial) at turning points, in the same steps."""
    points = [(100.0, 0.005), (120.0, 0.02), (60.0, 0.06)]
    points += [(90.0, 0.006), (110.0, 0.025), (40.0, 0.07)]
    turns = [0.004, -0.003, 0.012, -0.010, 0.012, -0.010, 0.030, -0.022, 0.005, -0.028, 0.032,
             0.010, 0.045, -0.05, 0.05, -0.075, 0.02]  # fmt: skip
    theirs = [80.0, -42.5, 109.333333, -94.210526, 108.937969, -93.835333, 105.0, -106.842105,
              23.474742, -105.333333, 102.0, -14.200326, 82.5, -71.111111, 75.0, -40.0,
              37.11678]  # fmt: skip
    ours = lumped._hysteretic(points, (0.6, 0.3, 0.05, 0.4), np.array(turns))
    assert ours == pytest.approx(theirs, abs=1e-6)


def test_lumped_hinge_is_that_of_a_cantilever_on_a_static_path():
    with pytest.raises(InputError, match="static path"):
        lumped.lumped_hinge(RESULTS["dynamic"])
    both = rbsdem.Column(2.0, 1e3, Elastic(1e9), Bilinear(1e7, 0.01, 1e5), top="fixed")
    with pytest.raises(InputError, match="cantilever"):
        lumped.lumped_hinge(rbsdem.cyclic(both, displacement=[0.01, -0.01]))
