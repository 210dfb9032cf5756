"""The package as a whole: names, documentation, types, versions, errors, immutability."""

from __future__ import annotations

import importlib
import importlib.metadata
import inspect
import operator
import os
import pickle
import re
import subprocess
import sys
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Takeda

MODULES = [
    "codes", "curves", "errors", "fragility", "motions", "peer", "plot", "springs",
]  # fmt: skip

ELASTIC = Elastic(1e6)
BILINEAR = Bilinear(1e6, 1e-3, 0.0)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
COLUMN = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA)
ROOT = Path(__file__).resolve().parents[2]
NAMES = [f"rbsdem.{name}" for name in rbsdem.__all__] + [
    f"rbsdem.{module}.{name}"
    for module in ("errors", "springs")
    for name, thing in vars(importlib.import_module(f"rbsdem.{module}")).items()
    if getattr(thing, "__module__", "").startswith("rbsdem.") and name[0] != "_"
]
PUBLIC = [operator.attrgetter(name.partition(".")[2])(rbsdem) for name in NAMES]
FUNCTIONS = [thing for thing in PUBLIC if inspect.isfunction(thing)]
CLASSES = [thing for thing in PUBLIC if inspect.isclass(thing)]


def peer_test(folder: Path) -> rbsdem.peer.PeerTest:
    (folder / "test.txt").write_text("Test\n2\n0\t0\n1\t2\n")
    return rbsdem.peer.read_peer(folder / "test.txt")


def solve_error() -> rbsdem.SolveError:
    with pytest.raises(rbsdem.SolveError) as error:
        rbsdem.cyclic(rbsdem.Column(1.6, 1.0, BILINEAR, ELASTIC), force=[0.0, 500.0, 2000.0])
    return error.value


# ---- names and documentation ---------------------------------------------------------------------


def test_the_surface_is_small_and_in_order():
    assert rbsdem.__all__ == sorted(rbsdem.__all__)
    assert len(set(rbsdem.__all__)) == len(rbsdem.__all__) <= 36


def test_star_import_gives_what_is_public_and_no_more():
    names: dict[str, object] = {}
    exec("from rbsdem import *", names)
    assert set(names) - {"__builtins__"} == set(rbsdem.__all__)


@pytest.mark.parametrize("name", [*rbsdem.__all__, *MODULES])
def test_public_name_is_documented(name):
    thing = getattr(rbsdem, name)
    text = inspect.getdoc(thing)
    assert text
    first = text.splitlines()[0]
    assert first[0].isupper()
    assert first.endswith((".", ":")), first


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__name__)
def test_function_is_typed_and_its_parameters_are_documented(function):
    signature = inspect.signature(function)
    assert signature.return_annotation is not inspect.Signature.empty
    text = inspect.getdoc(function)
    for name, parameter in signature.parameters.items():
        assert parameter.annotation is not inspect.Parameter.empty, name
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            assert f"\n**{name}\n" in text
        else:
            assert re.search(rf"^(\w+, )*{name}(, \w+)* : ", text, re.MULTILINE), name
    if signature.parameters:
        assert "Parameters\n----------" in text


@pytest.mark.parametrize("one", CLASSES, ids=lambda one: one.__name__)
def test_class_says_what_its_fields_are(one):
    text = inspect.getdoc(one)
    if is_dataclass(one):
        for field in fields(one):
            assert re.search(rf"^(\w+, )*{field.name}(, \w+)* : ", text, re.MULTILINE), field.name
    for name, method in inspect.getmembers(one, inspect.isfunction):
        if not name.startswith("_"):
            assert inspect.getdoc(method), name


@pytest.mark.parametrize("one", [Elastic, Bilinear, Takeda, rbsdem.Column])
def test_signature_is_the_promised_one(one):
    """Python: names and defaults that independent checks use."""
    promised = {
        "Elastic": "(k)",
        "Bilinear": "(k, d_y, k_post)",
        "Takeda": "(k_c, d_c, k_y, d_y, k_u, b0=0.4, b1=1.0, inner='kc')",
        "Column": "(height, mass, shear, flexure, n=1, axial_load=0.0, kinematics='small', "
        "lengths=None, masses=None, self_weight=False, gravity=9.80665, axial_spring=None, "
        "top_mass=0.0, top_inertia=0.0, depth=0.0, "
        "rotary_inertia=None, axial_follows=False, force_follows=False, damping=None, "
        "axial_height=None, axial_force_ratio=0.0, model='', top='free', footing=None)",
    }[one.__name__]
    signature = inspect.signature(one)
    bare = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in signature.parameters.values()
    ]
    text = str(inspect.Signature(bare))
    assert text.startswith(promised)


def test_signatures_of_the_analyses_are_the_promised_ones():
    def names(function):
        return list(inspect.signature(function).parameters)

    assert names(rbsdem.cyclic)[:3] == ["column", "displacement", "force"]
    assert names(rbsdem.time_history) == [
        "column", "time", "force", "ground_acceleration", "initial", "vertical_acceleration",
        "axial_load", "collapse_drift", "every", "openings", "motion", "solver",
    ]  # fmt: skip
    assert list(rbsdem.Solver.__annotations__) == [
        "method", "dt", "events", "tolerance", "rho_infinity", "allow_unstable", "max_seconds"
    ]  # fmt: skip
    assert names(rbsdem.matrices) == ["column", "form"]
    assert names(rbsdem.modes) == ["column", "count"]


# ---- files and versions --------------------------------------------------------------------------


def test_version_is_the_same_everywhere(run_cli):
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*", rbsdem.__version__)
    assert importlib.metadata.version("rbsdem") == rbsdem.__version__
    assert run_cli(["--version"]).stdout.split() == ["rbsdem", rbsdem.__version__]


def test_package_has_marker_of_types_data_and_executable():
    folder = files("rbsdem")
    assert folder.joinpath("py.typed").is_file()
    program = folder.joinpath("bin", "rbsdem")
    assert program.is_file()
    assert os.access(str(program), os.X_OK)
    names = {path.name for path in folder.joinpath("data").iterdir()}
    reversals = {f"reversals_{key}.csv" for key in rbsdem.peer.paper_columns()}
    assert names >= {"paper_table_2.csv", "paper_table_3.csv", "measured_loops.csv", *reversals}


def test_metadata_names_licence_python_and_command():
    about = importlib.metadata.metadata("rbsdem")
    assert about["License-Expression"] == "BSD-3-Clause"
    assert about["Requires-Python"] == ">=3.10"
    scripts = importlib.metadata.entry_points(group="console_scripts", name="rbsdem")
    assert [script.value for script in scripts] == ["rbsdem.__main__:main"]


def test_import_is_quick_and_loads_no_plotting():
    """matplotlib, rich, scipy and pandas are loaded when they are used, not by `import rbsdem`."""
    code = (
        "import sys; sys.modules.update(matplotlib=None, scipy=None, rich=None, pandas=None)\n"
        "import rbsdem\n"
        "column = rbsdem.peer.paper_columns()['zahn_7']\n"
        "run, modes = rbsdem.cyclic(column, displacement=[0.01]), rbsdem.modes(column)\n"
        "print(run.force[0] > 0, modes.frequency[0] > 0)"
    )
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )
    assert (result.stdout.strip(), result.stderr) == ("True True", "")


def test_package_works_from_a_folder_with_files_of_its_name(tmp_path):
    """A case file or a folder called rbsdem beside the user must not disturb the command."""
    (tmp_path / "rbsdem").mkdir()
    result = subprocess.run(
        [sys.executable, "-m", "rbsdem", "--version"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )
    assert result.stdout == f"rbsdem {rbsdem.__version__}\n"


# ---- errors --------------------------------------------------------------------------------------


def test_errors_have_one_base_and_are_also_the_builtin_kind():
    assert issubclass(rbsdem.errors.RbsdemError, Exception)
    assert issubclass(rbsdem.InputError, rbsdem.errors.RbsdemError)
    assert issubclass(rbsdem.SolveError, rbsdem.errors.RbsdemError)
    assert issubclass(rbsdem.InputError, ValueError)
    assert issubclass(rbsdem.SolveError, RuntimeError)
    assert not issubclass(rbsdem.SolveError, rbsdem.InputError)
    assert not issubclass(rbsdem.InputError, rbsdem.SolveError)


def test_solve_error_holds_the_path_up_to_there():
    error = solve_error()
    assert "beyond the capacity" in str(error)
    assert isinstance(error.result, rbsdem.Result)
    np.testing.assert_allclose(error.result.force, [0.0, 500.0, 1000.0], rtol=1e-12)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_errors_survive_pickling(protocol):
    error = solve_error()
    back = pickle.loads(pickle.dumps(error, protocol))
    assert type(back) is rbsdem.SolveError
    assert str(back) == str(error)
    assert np.array_equal(back.result.displacement, error.result.displacement)
    assert np.array_equal(back.result.moment, error.result.moment)
    assert back.result.summary == error.result.summary
    bare = pickle.loads(pickle.dumps(rbsdem.SolveError("text"), protocol))
    assert (str(bare), bare.result) == ("text", None)
    wrong = pickle.loads(pickle.dumps(rbsdem.InputError("text"), protocol))
    assert (type(wrong), str(wrong)) == (rbsdem.InputError, "text")


def test_columns_and_results_survive_pickling():
    """For pools of processes."""
    column = replace(COLUMN, n=2, kinematics="pdelta", axial_load=1e5)
    back = pickle.loads(pickle.dumps(column))
    assert back == column
    run = rbsdem.cyclic(column, displacement=[0.01, -0.01])
    again = pickle.loads(pickle.dumps(rbsdem.cyclic(back, displacement=[0.01, -0.01])))
    assert np.array_equal(run.force, again.force)
    assert run.summary == again.summary


# ---- immutability --------------------------------------------------------------------------------


def test_records_cannot_be_changed(tmp_path):
    run = rbsdem.cyclic(COLUMN, displacement=[0.001])
    records = [ELASTIC, BILINEAR, TAKEDA, COLUMN, run, rbsdem.modes(COLUMN), peer_test(tmp_path)]
    records.append(rbsdem.Damping())
    for record in records:
        assert is_dataclass(record)
        for field in fields(record):
            with pytest.raises(FrozenInstanceError):
                setattr(record, field.name, 1.0)
        with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
            record.another = 1.0


def test_column_does_not_change_with_the_lists_it_was_made_of():
    lengths, masses = np.array([0.5, 0.5]), [100.0, 200.0]
    springs = [ELASTIC, Elastic(2e6)]
    column = rbsdem.Column(1.0, None, springs, springs, n=2, lengths=lengths, masses=masses)
    before = rbsdem.modes(column).omega.copy()
    lengths[:] = [0.1, 0.9]
    masses[0] = 1.0
    springs[0] = Elastic(1.0)
    assert column.lengths == (0.5, 0.5)
    assert column.masses == (100.0, 200.0)
    assert column.shear == (ELASTIC, Elastic(2e6))
    assert np.array_equal(rbsdem.modes(column).omega, before)


def test_changed_copies_are_checked_again():
    assert replace(BILINEAR, k=2e6).k == 2e6
    with pytest.raises(rbsdem.InputError, match="k_post"):
        replace(BILINEAR, k_post=1e9)
    with pytest.raises(rbsdem.InputError, match="height"):
        replace(COLUMN, height=-1.0)


def test_equal_records_are_equal_and_have_one_hash():
    assert Elastic(1e6) == ELASTIC
    assert hash(Elastic(1000000)) == hash(ELASTIC)
    assert Elastic(2e6) != ELASTIC
    twin = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA)
    assert twin == COLUMN
    assert hash(twin) == hash(COLUMN)
    assert len({COLUMN, twin, replace(COLUMN, n=2)}) == 2


def test_analyses_leave_their_arrays_alone():
    time = np.linspace(0.0, 0.1, 11)
    force = np.sin(60 * time) * 500.0
    arrays = [time, force]
    copies = [array.copy() for array in arrays]
    rbsdem.time_history(COLUMN, time, force=force, ground_acceleration=force * 1e-3, method="rk4")
    rbsdem.cyclic(COLUMN, force=force)
    rbsdem.cyclic(COLUMN, displacement=force * 1e-5)
    TAKEDA.response(force * 1e-5)
    for array, copy in zip(arrays, copies, strict=True):
        assert np.array_equal(array, copy)


def test_arrays_of_any_layout_and_kind_are_taken():
    path = np.array([0.0, 0.004, -0.004, 0.002])
    expected = rbsdem.cyclic(COLUMN, displacement=path).force
    spread = np.zeros((4, 3))
    spread[:, 1] = path
    kinds = [
        path.tolist(),
        tuple(path),
        spread[:, 1],
        path[::-1].copy()[::-1],
        path.astype(">f8"),
        path.astype(object).astype(float),
    ]
    path.flags.writeable = False
    for kind in [*kinds, path]:
        assert np.array_equal(rbsdem.cyclic(COLUMN, displacement=kind).force, expected)
    whole = Elastic(2).response(np.array([1, -2, 3], dtype=np.int16))
    assert np.array_equal(whole, [2.0, -4.0, 6.0])
    with pytest.raises(rbsdem.InputError, match="displacement is empty; give at least one point"):
        rbsdem.cyclic(COLUMN, displacement=[])
    assert TAKEDA.response([]).shape == (0,)


@pytest.mark.parametrize(
    ("package", "extra", "what"),
    [
        ("pyarrow", "ensembles", "rbsdem.ensemble(column, ([0, 1], [0, 1]), store='nowhere')"),
        ("xarray", "netcdf", "rbsdem.cyclic(column, displacement=[0.001]).to_xarray()"),
    ],
)
def test_extra_that_is_missing_is_named(package, extra, what):
    """The line for pip names an extra that pyproject.toml has, and the README knows it."""
    code = f"""
import sys
sys.modules[{package!r}] = None
import rbsdem
column = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
try:
    {what}
except ImportError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert f'{package} is not installed: pip install "rbsdem[{extra}]"' in done.stdout
    project = (ROOT / "pyproject.toml").read_text()
    assert re.search(rf'^{extra} = \["{package}>=', project, re.M)
    assert f".[{extra}]" in (ROOT / "README.md").read_text()
