"""Five jobs in rbsdem and in OpenSeesPy: answers, times and lines of code.

    pip install openseespy==3.7.1.2
    python studies/opensees_jobs.py [--write]

Each job has two programs in studies/opensees, which docs/opensees.md shows as they are. With
``--write`` the tables go to studies/opensees/results.md, which that page includes, and the answers
of OpenSees to studies/opensees/answers.json, to which a test holds those of rbsdem.

Times are processor time, the median of several runs that take turns, so that other work on the
machine disturbs both alike. Lines of code are those with a statement: no comments, docstrings,
blank lines and what prints the answer.
"""

from __future__ import annotations

import ast
import importlib
import io
import json
import math
import platform
import sys
import time
import tokenize
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

import rbsdem

FOLDER = Path(__file__).with_name("opensees")
sys.path.insert(0, str(FOLDER))

import given  # noqa: E402

JOBS = {
    "frequencies": "frequencies and stiffness",
    "section": "moment-curvature",
    "cyclic": "cyclic test",
    "earthquake": "20 s earthquake",
    "ida": "20 records at 10 intensities",
}
PROGRAMS = ("rbsdem", "opensees")


def inputs(job: str) -> tuple[Any, ...]:
    """Return the arguments of both programs of a job."""
    if job == "cyclic":
        return given.DRAWINGS["soesianawati_1"], turns("soesianawati_1").displacement
    return {"earthquake": (given.motion(),), "ida": (given.records(), given.LEVELS)}.get(job, ())


def turns(key: str) -> rbsdem.measured.tests.PeerTest:
    """Return the reversal points of a test."""
    return rbsdem.peer.shipped_reversals(key)


def program(job: str, of: str) -> Callable[..., Any]:
    """Return what solves a job."""
    return importlib.import_module(f"{job}_{of}").solve


def lines(job: str, of: str) -> int:
    """Return the number of lines with code, without docstrings and what prints the answer."""
    source = (FOLDER / f"{job}_{of}.py").read_text(encoding="utf-8")
    source = source.partition("\nif __name__")[0]
    blank = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
    found: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in (*blank, tokenize.ENDMARKER):
            found.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found -= set(range(node.lineno, node.end_lineno + 1))
    return len(found)


def timed(job: str, runs: int) -> tuple[dict[str, Any], dict[str, float]]:
    """Return the answers of both programs, and their processor times [s]."""
    given_now = inputs(job)
    solvers = {of: program(job, of) for of in PROGRAMS}
    answers = {of: solve(*given_now) for of, solve in solvers.items()}
    times: dict[str, list[float]] = {of: [] for of in PROGRAMS}
    for _ in range(runs):
        for of, solve in solvers.items():
            begin = time.process_time()
            solve(*given_now)
            times[of].append(time.process_time() - begin)
    return answers, {of: float(np.median(all_of)) for of, all_of in times.items()}


def seconds(value: float) -> str:
    """Return a time with two digits and a unit."""
    scale, unit = (1e3, "ms") if value < 1 else (1, "s")
    return f"{float(f'{scale * value:.2g}'):g} {unit}"


def overview(times: dict[str, dict[str, float]]) -> list[str]:
    """Return the table of times and lines."""
    rows = ["| job | lines: rbsdem | OpenSeesPy | time: rbsdem | OpenSeesPy | ratio |"]
    rows.append("| --- | ---: | ---: | ---: | ---: | ---: |")
    for job, of in times.items():
        count = " | ".join(str(lines(job, each)) for each in PROGRAMS)
        cells = " | ".join(seconds(of[each]) for each in PROGRAMS)
        rows.append(f"| {JOBS[job]} | {count} | {cells} | {of['opensees'] / of['rbsdem']:.2g} |")
    return rows


def numbers(answers: dict[str, Any], exact: dict[str, float] | None = None) -> list[str]:
    """Return the table of single numbers."""
    extra = exact or {}
    head = "| answer | rbsdem | OpenSeesPy | difference |" + (" continuum |" if extra else "")
    rows = [head, "| --- | ---: | ---: | ---: |" + (" ---: |" if extra else "")]
    for name, ours in answers["rbsdem"].items():
        theirs = answers["opensees"][name]
        if np.ndim(ours):
            gap = np.abs(ours - theirs).max() / np.abs(theirs).max()
            rows.append(f"| {name}: largest difference over the largest value | | | {gap:.1e} |")
            continue
        row = f"| {name} | {ours:.6g} | {theirs:.6g} | {ours / theirs - 1:+.1e} |"
        rows.append(row + (f" {extra[name]:.6g} |" if extra else ""))
    return rows


def continuum() -> dict[str, float]:
    """Return stiffness and frequencies of the beam of Timoshenko.

    GA (w'' - psi') + mu omega^2 w = 0 and EI psi'' + GA (w' - psi) + rho I omega^2 psi = 0;
    w = psi = 0 at the ground; psi' = 0 and GA (w' - psi) = M omega^2 w at the top.
    """
    of = importlib.import_module("frequencies_rbsdem")
    area, height = of.WIDTH * of.DEPTH, of.HEIGHT
    inertia = area * of.DEPTH**2 / 12
    ei, ga, mu = of.E * inertia, 5 / 6 * of.G * area, of.DENSITY * area

    def determinant(omega: float) -> float:
        a, turning = mu * omega**2 / ga, of.DENSITY * inertia * omega**2
        b, c = ei * a + turning, a * (turning - ga)
        squares = (-b + np.array([1, -1]) * math.sqrt(b**2 - 4 * ei * c)) / (2 * ei)
        roots = np.sqrt(squares.astype(complex))
        roots = np.concatenate([roots, -roots])
        psi = roots + a / roots
        # Columns are scaled, as the growing solution is large at the top.
        top = np.exp(roots * height - np.maximum(roots.real * height, 0))
        foot = np.exp(-np.maximum(roots.real * height, 0))
        shear = ga * (roots - psi) - of.TOP_MASS * omega**2
        rows = [foot, psi * foot, psi * roots * top, shear * top]
        return float((np.linalg.det(np.array(rows)) * 1j).real)

    grid = 2 * np.pi * np.linspace(0.5, 400, 4000)
    signs = np.sign([determinant(omega) for omega in grid])
    at = np.flatnonzero(signs[:-1] * signs[1:] < 0)[:3]
    f = [brentq(determinant, grid[i], grid[i + 1], xtol=1e-10) / (2 * np.pi) for i in at]
    stiffness = 1 / (height**3 / (3 * ei) + height / ga)
    return {"stiffness": stiffness, "f1": f[0], "f2": f[1], "f3": f[2]}


def from_zero() -> str:
    """Compare moments that OpenSees reaches in one step from the unloaded section."""
    job = importlib.import_module("section_opensees")
    ops = job.ops
    ours = program("section", "rbsdem")()["curve"]
    gaps = []
    for i in range(1, job.CURVATURE.size, 8):
        job.model()
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(2, -job.AXIAL_LOAD, 0.0, 0.0)
        ops.sp(2, 3, float(job.CURVATURE[i]))
        ops.constraints("Transformation")
        ops.numberer("Plain")
        ops.system("FullGeneral")
        ops.test("NormUnbalance", 1e-3, 100)
        ops.algorithm("Newton")
        ops.integrator("LoadControl", 1.0)
        ops.analysis("Static")
        if ops.analyze(1) != 0:
            raise RuntimeError(f"no equilibrium at {job.CURVATURE[i]:g} 1/m in one step")
        ops.reactions()
        gaps.append(abs(ours[i] / abs(ops.nodeReaction(2, 3)) - 1))
    return (
        f"Each of {len(gaps)} points reached in OpenSees in one step from the unloaded section: "
        f"largest difference {max(gaps):.0e}."
    )


def tests() -> list[str]:
    """Return the errors of both programs over four tests, at their reversal points."""
    rows = ["| test | points | rbsdem, nrmse | OpenSeesPy | rbsdem, peak over test | OpenSeesPy |"]
    rows.append("| --- |" + " ---: |" * 5)
    for key, drawing in given.DRAWINGS.items():
        test = turns(key)
        largest = np.abs(test.force).max()
        errors, peaks = [], []
        for of in PROGRAMS:
            force = program("cyclic", of)(drawing, test.displacement)
            errors.append(f"{np.sqrt(np.mean((force - test.force) ** 2)) / largest:.3f}")
            peaks.append(f"{np.abs(force).max() / largest:.2f}")
        rows.append(f"| {test.name} | {len(test.force)} | " + " | ".join(errors + peaks) + " |")
    return rows


def fractiles(answers: dict[str, Any]) -> list[str]:
    """Return the table of the incremental dynamic analysis."""
    rows = ["| peak acceleration [m/s²] | median drift: rbsdem | OpenSeesPy | collapses | |"]
    rows.append("| ---: | ---: | ---: | ---: | ---: |")
    for i, level in enumerate(given.LEVELS):
        median = [answers[of]["fractiles"][1][i] for of in PROGRAMS]
        cells = ["collapse" if np.isinf(d) else f"{100 * d:.3f} %" for d in median]
        cells += [str(answers[of]["collapses"][i]) for of in PROGRAMS]
        rows.append(f"| {level:g} | " + " | ".join(cells) + " |")
    ours, theirs = (answers[of]["drift"] for of in PROGRAMS)
    standing = np.isfinite(ours) & np.isfinite(theirs)
    gap = 100 * np.abs(ours[standing] / theirs[standing] - 1)
    alike = int((np.isinf(ours) == np.isinf(theirs)).sum())
    rows += [
        "",
        f"{alike} of {ours.size} runs have the same fate. Where both stand, drifts differ by "
        f"{np.median(gap):.2g} % in the median, by more than 1 % in {int((gap > 1).sum())} "
        f"of {gap.size} runs, by {gap.max():.2g} % at the most.",
    ]
    return rows


def machine() -> str:
    """Return a line on versions and processor."""
    name = platform.processor()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.partition(":")[2].strip()
                break
    return (
        f"rbsdem {version('rbsdem')}, openseespy {version('openseespy')}, Python "
        f"{platform.python_version()}, {platform.system()}, {name}."
    )


def plain(value: Any) -> Any:
    """Return an answer as json takes it; a collapse is null."""
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    if np.ndim(value):
        return [plain(each) for each in value]
    return float(f"{value:.7g}") if np.isfinite(value) else None


def main() -> None:
    """Print or write the tables."""
    answers, times = {}, {}
    for job in JOBS:
        answers[job], times[job] = timed(job, 5 if job == "ida" else 15)
    parts = {
        "times": [*overview(times), "", machine()],
        "frequencies": numbers(answers["frequencies"], continuum()),
        "section": [*numbers(answers["section"]), "", from_zero()],
        "cyclic": tests(),
        "earthquake": numbers(answers["earthquake"]),
        "ida": fractiles(answers["ida"]),
    }
    text = "".join(
        f"<!-- {name} -->\n\n" + "\n".join(rows) + "\n\n" for name, rows in parts.items()
    )
    print(text)
    if "--write" in sys.argv[1:]:
        (FOLDER / "results.md").write_text(text + "<!-- end -->\n", encoding="utf-8")
        theirs = {job: plain(of["opensees"]) for job, of in answers.items() if job != "cyclic"}
        rows = [f'"{job}": {json.dumps(of)}' for job, of in theirs.items()]
        text = "{\n" + ",\n".join(rows) + "\n}\n"
        (FOLDER / "answers.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
