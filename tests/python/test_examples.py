"""Every example of examples/ and the code blocks of the README run as they stand."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import rbsdem
from rbsdem.output import style

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLES = sorted(path for path in (REPOSITORY / "examples").iterdir() if path.is_dir())
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def run(command: list[str | Path]) -> None:
    result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    assert result.returncode == 0, f"{command}\n{result.stderr[-2000:]!r}"


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_there_are_examples():
    assert EXAMPLES
    for folder in EXAMPLES:
        assert re.fullmatch(r"\d\d-[a-z0-9-]+", folder.name)
        assert (folder / "README.md").is_file(), f"{folder.name} has no README.md"
        assert list(folder.glob("*.py")) + list(folder.glob("*.nml")), f"{folder.name} is empty"


@pytest.fixture
def program(tmp_path, monkeypatch, capsys):
    """program(script, *words) runs it in an empty folder, and returns what it prints.

    In this process, and with figures of few dots: to load the libraries for each of twenty, and to
    paint for print, takes as long as all that they compute.
    """
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setattr(style, "DPI", 60)

    def run_program(script, *words):
        monkeypatch.setattr(sys, "argv", [str(script), *words])
        monkeypatch.syspath_prepend(script.parent)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            runpy.run_path(str(script), run_name="__main__")
        plt.close("all")
        return capsys.readouterr().out

    return run_program


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_example_runs_in_a_clone(executable, folder, tmp_path, monkeypatch, program):
    """Scripts and cases of a copy, with their figures, without the histories of the database.

    Nothing is written beside them but what is there already, and that comes out the same. The
    figures that the gallery of the documentation shows are among those that are written.
    """
    monkeypatch.delenv("RBSDEM_PEER_DIR", raising=False)
    copy = tmp_path / "a" / "clone" / "examples" / folder.name
    shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("__pycache__"))
    before = contents(copy)
    for script in sorted(copy.glob("*.py")):
        assert program(script).strip() or script.name not in ("run.py", "case.py")
    for case in sorted(copy.glob("*.nml")):
        output = Path(f"{case.stem}-rows.csv")
        run([executable, "check", case])
        run([executable, "run", case, "--output", output])
        assert output.read_text("utf-8").startswith("# rbsdem ")
    assert contents(copy) == before
    figures = {path.stem for path in Path().rglob("*.png") if path.stat().st_size > 2000}
    assert figures or not list(copy.glob("*.py"))
    page = (REPOSITORY / "docs" / "gallery.md").read_text("utf-8")
    shown = set(re.findall(rf"\(_gallery/{folder.name}_(\w+)\.png\)", page))
    assert shown, "docs/gallery.md shows nothing of it"
    assert shown <= figures


def test_example_without_figures(program):
    script = REPOSITORY / "examples" / "02-cyclic-protocol" / "case.py"
    assert program(script, "--no-plot").strip()
    assert not list(Path().iterdir())


def test_numbers_of_the_readme_stand_in_the_pages_it_names():
    """Accuracy and speed are measured by scripts, whose tables are on those pages."""
    text = (REPOSITORY / "README.md").read_text("utf-8")
    section = text.partition("## How good, how fast")[2].partition("\n## ")[0]
    points = re.findall(r"^\| (.*)", section, re.MULTILINE)[2:]
    counted = 0
    for point in points:
        page = (REPOSITORY / re.findall(r"\((docs/\w+\.md)", point)[-1]).read_text("utf-8")
        numbers = re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?:e-\d)?(?![\w.])", point)
        missing = [number for number in numbers if number not in page]
        assert not missing, point
        counted += len(numbers)
    assert counted >= 8


def test_ready_models_are_those_of_the_readme():
    """The house of the README is that of `rbsdem.examples`, to the last bit of its push-over."""
    text = (REPOSITORY / "README.md").read_text("utf-8")
    drawn = next(block for kind, block in BLOCK.findall(text) if kind == "python")
    program = drawn[: drawn.index("push = ")]
    scope: dict[str, object] = {}
    exec(program, scope)
    pushes = [rbsdem.pushover(one, drift=0.01) for one in (scope["house"], rbsdem.examples.house())]
    assert np.array_equal(*(push.base_shear for push in pushes))


def test_ready_models_answer():
    """Each stands under its dead load, and sways at a period of a building of its height."""
    for model, longest in ((rbsdem.examples.portal(), 1.0), (rbsdem.examples.pier(), 2.0)):
        period = 1 / rbsdem.modes(model).frequency[0]
        assert 0.1 < period < longest
        assert rbsdem.pushover(model, drift=0.01).summary["status"] == "completed"
