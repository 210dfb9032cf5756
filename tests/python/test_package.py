"""The package as a whole: names, documentation, versions, files, what is loaded and what is not."""

from __future__ import annotations

import importlib.metadata
import inspect
import os
import re
import subprocess
import sys
from dataclasses import fields, replace
from importlib.resources import files
from pathlib import Path

import pytest
from conftest import REPOSITORY

import rbsdem
from rbsdem import errors, springs

PUBLIC = [getattr(rbsdem, name) for name in rbsdem.__all__] + [
    thing
    for module in (errors, springs)
    for name, thing in vars(module).items()
    if getattr(thing, "__module__", "").startswith("rbsdem.") and name[0] != "_"
]


def test_the_surface_is_small_and_in_order():
    assert rbsdem.__all__ == sorted(rbsdem.__all__)
    # 39 for columns, 4 for frames, 1 for buildings, 4 for walls, `verify`, and `examples`.
    assert len(set(rbsdem.__all__)) == len(rbsdem.__all__) <= 48
    offered = [
        name
        for file in ("__init__.pyi", "[c-s]*.py", "c*/__init__.py", "motions/__init__.py",
                     "section/__init__.py")
        for path in Path(rbsdem.__file__).parent.glob(file)
        for name in re.findall(r"^from rbsdem.*import (\w+) as \1$", path.read_text(), re.MULTILINE)
    ]  # fmt: skip
    assert len(offered) + sum(isinstance(one, type) for one in vars(errors).values()) <= 218
    names: dict[str, object] = {}
    exec("from rbsdem import *", names)
    assert set(names) - {"__builtins__"} == set(rbsdem.__all__)
    reference = "".join(page.read_text() for page in (REPOSITORY / "docs").glob("*.md"))
    assert ".. automodule:: rbsdem.plot\n   :members:\n   :imported-members:\n" in reference
    figures = {name for name, thing in vars(rbsdem.plot).items() if callable(thing)}
    for name in set(offered) - figures:
        assert name.isupper() or re.search(rf"[ .]{name}(\.\w+)?$", reference, re.MULTILINE), name


@pytest.mark.parametrize(
    "thing",
    [one for one in PUBLIC if inspect.isfunction(one) or "__dataclass_fields__" in vars(one)],
    ids=lambda thing: thing.__name__,
)
def test_parameters_and_fields_are_documented(thing):
    text = inspect.getdoc(thing)
    if not inspect.isfunction(thing):
        names = [field.name for field in fields(thing)]
    else:
        names = list(inspect.signature(thing).parameters)
    for name in names:
        assert re.search(rf"^(\w+, )*(\*\*)?{name}(, \w+)*( : .*)?$", text, re.MULTILINE), name


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


def test_a_warning_names_the_line_of_the_caller():
    """Through two wrappers of an analysis, and through the `__init__` of a dataclass."""
    column = rbsdem.peer.paper_columns()["zahn_7"]
    for call in (
        lambda: rbsdem.pushover(column, drift=0.8),
        lambda: rbsdem.cyclic(column, displacement=[1.3]),
        lambda: replace(column, axial_load=1500.0),
    ):
        with pytest.warns(rbsdem.errors.AccuracyWarning) as told:
            call()
        assert told[0].filename == __file__
