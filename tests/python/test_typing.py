"""Users' programs, as the README and the examples, pass ``mypy --strict``; it finds slips."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

pytest.importorskip("mypy", reason="the extra 'test' brings mypy")

PROGRAM = '''
"""A column, pushed and shaken."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import rbsdem


def pushed(column: rbsdem.Column) -> rbsdem.Result:
    """Follow a cyclic test."""
    drifts = rbsdem.protocol([0.0025, 0.005, 0.01, 0.02], cycles=2)
    return rbsdem.cyclic(column, displacement=column.height * drifts)


shear = rbsdem.springs.Bilinear(k=7.0387e8, d_y=1.2960e-4, k_post=8.3185e6)
flexure = rbsdem.springs.Takeda(
    k_c=2.5428e8, d_c=3.1891e-4, k_y=6.2937e7, d_y=2.7183e-3, k_u=7.5772e6, b1=0.22, inner="kc"
)
column = rbsdem.Column(1.6, 614.4, shear, flexure, axial_load=744e3, kinematics="pdelta")
result = pushed(column)
peak: float = result.summary["peak_force"]
worst = float(np.max(np.abs(result.rotation[:, 0])))
print(peak, worst, result.column.height, result.case, result.energy["spring"][-1])

time = np.arange(0.0, 2.0, 0.01)
motion = 0.1 * np.sin(31.4 * time)
pier = replace(column, top_mass=75e3, damping=rbsdem.Damping.rayleigh(0.03, 2.0, 50.0), n=2)
shaken = rbsdem.time_history(pier, time, ground_acceleration=motion, collapse_drift=0.1)
forced = rbsdem.time_history(
    pier, time, force=1e3 * motion, method="newmark", dt=0.005, initial={"slip": [0.0, 0.0]}
)
located = rbsdem.time_history(pier, time, force=motion, method="rk4", events="located", every=2)
print(shaken.summary["method"], forced.top[-1, 0], located.time.size, shaken == forced)
print(rbsdem.modes(pier).frequency[0], rbsdem.matrices(pier).mass[0, 0])

bar, strip = rbsdem.springs.SteelSpring(8e8, 7e5, 8e6), rbsdem.springs.Elastic(1e8)
layers = rbsdem.springs.Layered([(-0.1, bar), (0.1, strip)])
print(layers.response([0.001, -0.001], axial_load=1e4)[-1], layers.split(2), shear.split(2).k)
print([spring.response([1e-3])[0] for spring in pier.joints("flexure")])

section = rbsdem.RectangularSection(
    width=0.4,
    depth=0.4,
    concrete=rbsdem.Concrete(fc=46.5e6),
    layout=rbsdem.Layout(12, 0.016, rbsdem.Steel(fy=446e6, fu=702e6)),
    ties=rbsdem.Ties(0.007, 0.085, rbsdem.Steel(fy=364e6), legs=4),
    cover=0.013,
)
springs = rbsdem.section.springs(section, 1.6, axial_load=744e3)
assert springs.shear is not None
made = rbsdem.Column(1.6, 614.4, springs.shear, springs.flexure)
drawn = rbsdem.section.column(section, 1.6, axial_load=744e3)
print(pushed(made).summary["status"], pushed(drawn).force[-1])

record = rbsdem.motions.synthetic(2)[0]
quake = rbsdem.GroundMotion(record.acceleration[:500], record.dt, "part").scaled(pga=2.0)
print(quake.time[-1], quake.pgv, quake.spectrum([0.5]).pseudo_acceleration[0] + 1.0)
swayed = rbsdem.time_history(pier, ground_acceleration=quake)
found = rbsdem.ida(pier, [quake, record], levels=[2.0, 40.0], method="newmark", dt=0.01)
light = found.fragility("peak_drift", 0.005)
print(swayed.displacement[-1], light.theta * 2, light.probability([1.0])[0], found.upper.min())

Path("column.nml").write_text(column.to_namelist() + "&loading drive = 'force', amplitudes = 1e3 /")
case = rbsdem.read_case("column.nml")
print(case.run(every=2).displacement[-1], case.column == column, case.to_namelist())

try:
    rbsdem.cyclic(column, force=[1e5, 1e5])
except rbsdem.SolveError as error:
    print(error, error.result)
except rbsdem.InputError as error:
    print(error)
'''

SLIPS = [
    ('rbsdem.Column(1.6, 1.0, s, s, kinematics="finit")', "arg-type"),
    ('rbsdem.springs.Takeda(2, 1, 1, 2, 0, inner="k_c")', "arg-type"),
    ("rbsdem.cyclic(c, [0.1])", "call-arg"),  # loads are keywords
    ('rbsdem.time_history(c, [0.0, 1.0], force=[0.0, 1.0], method="rk5")', "arg-type"),
    ('rbsdem.time_history(c, [0.0], force=[0.0], method="rk4", events="never")', "arg-type"),
    ('c.joints("bending")', "arg-type"),
    ("rbsdem.Column(1.6, 1.0, s, s, axial=s)", "call-arg"),
    ("rbsdem.cyclic(c, displacement=[0.1]).forces", "attr-defined"),
    ('rbsdem.matrices(c, "papers")', "arg-type"),
    ('rbsdem.ida(c, rbsdem.motions.synthetic(), intensity="sa")', "arg-type"),
]


def mypy(folder: Path, programs: dict[str, str]) -> list[str]:
    """Check programs by the names of their files; return what is said, line by line.

    With the settings of pyproject.toml, so that the linters' cache has the package and numpy.
    """
    for name, text in programs.items():
        (folder / name).write_text(text, "utf-8")
    files = [folder / name for name in programs]
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-error-summary", *files],
        cwd=REPOSITORY, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert checked.stderr == ""
    return [line.rpartition(f"{folder.name}/")[2] for line in checked.stdout.splitlines()]


def test_types_of_a_user_program(tmp_path):
    """Sound programs pass, and slips are found: loads by keyword, words out of a list, names."""
    pages = [REPOSITORY / name for name in ("README.md", "docs/tutorials.md", "docs/frames.md")]
    text = "\n".join(page.read_text("utf-8") for page in pages)
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 12
    head = "import rbsdem\ns = rbsdem.springs.Elastic(1.0)\nc = rbsdem.Column(1.6, 1.0, s, s)\n"
    # One run for all, as most of it goes into reading the package.
    programs = {"program.py": PROGRAM} | {f"block_{i}.py": text for i, text in enumerate(blocks)}
    # Here, not under `files` of pyproject.toml: scripts of one name cannot be checked in one run.
    scripts = sorted((REPOSITORY / "examples").glob("*/*.py"))
    assert len(scripts) >= 11
    for script in scripts:
        # A script that another one imports keeps its name.
        name = script.stem
        if name in ("case", "run"):
            name = re.sub(r"\W", "_", f"example_{script.parent.name}_{name}")
        programs[f"{name}.py"] = script.read_text("utf-8")
    slips = head + "".join(f"{slip}\n" for slip, _ in SLIPS)
    said = mypy(tmp_path, programs | {"slips.py": slips})
    assert [line for line in said if not line.startswith("slips.py:")] == []
    for number, (slip, kind) in enumerate(SLIPS, head.count("\n") + 1):
        own = [line for line in said if line.startswith(f"slips.py:{number}: error")]
        assert own, slip
        # Analyses take columns and frames, so that mypy looks for a variant.
        kinds = (kind, "misc", "call-overload")
        assert any(one in line for one in kinds for line in own), (slip, own)


def test_program_of_a_user_runs(tmp_path):
    (tmp_path / "program.py").write_text(PROGRAM, "utf-8")
    run = subprocess.run(
        [sys.executable, "-W", "error", "program.py"],
        cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (run.returncode, run.stderr) == (0, "")
