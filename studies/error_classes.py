"""What class of error each method has at its own setting, and what a step costs.

    python studies/error_classes.py

Forty responses with P-Delta, and the same with exact rotations: the four columns of the paper and
chains of 2 and 6 bodies, with a storey on top, elastic, yielding, softening, pinching and layered
hinges, with and without damping, under the
ground motion of examples/03-ground-motion at several sizes and under sines near the first
frequency. The reference is RK5(4) at a tolerance of 1e-12; cases in which RK4 with located events
at a tenth of its step does not agree with it to 1e-7 are left out and counted. The error is the
largest of those of the table of `trade`: rms of response and base moment, energy, peak.

The classes stand in src/case/methods.f90, with the times of steps.
"""

from __future__ import annotations

import dataclasses
import time as clock
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import rbsdem
from rbsdem.methods.ladder import Setting as Way
from rbsdem.methods.ladder import study_case
from rbsdem.run.accuracy import Answer, answer_of, errors_of
from rbsdem.springs import Elastic, PeakOriented, Pinching

ROOT = Path(__file__).resolve().parents[1]
MOTION = ROOT / "examples" / "03-ground-motion" / "ground.csv"
GRAVITY = 9.80665

#: Methods as a user calls them, without any setting.
WAYS = {
    "rk4": {"method": "rk4"},
    "rk4, located": {"method": "rk4", "events": "located"},
    "rk45": {"method": "rk45"},
    "newmark": {"method": "newmark"},
    "hht": {"method": "hht"},
    "generalised_alpha": {"method": "generalised_alpha"},
    "auto": {"method": "auto"},
}

CAPPED = {"d_y": 2.7e-3, "f_y": 2.3e5, "d_cap": 1.2e-2, "f_cap": 2.6e5, "d_pc": 0.06, "f_res": 4e4}
CAPPED |= {"d_c": 3.2e-4, "f_c": 8e4, "b0": 0.3}


def columns() -> Iterator[tuple[str, rbsdem.Column]]:
    """Yield names and columns, each with a storey."""
    for key, column in rbsdem.peer.paper_columns("pdelta").items():
        storey = column.axial_load / GRAVITY
        yield key, dataclasses.replace(column, top_mass=storey)
    paper = rbsdem.peer.paper_columns("pdelta", top_mass=75.9e3)["soesianawati_1"]
    hinges = {
        "elastic": Elastic(2.5e8),
        "softening": PeakOriented(**CAPPED, lambda_s=150.0),
        "pinching": Pinching(**CAPPED, kappa_f=0.3, kappa_d=0.4),
    }
    for name, hinge in hinges.items():
        yield name, dataclasses.replace(paper, flexure=hinge)
    yield "damped", dataclasses.replace(paper, damping=rbsdem.Damping(stiffness=5e-4))
    section = rbsdem.peer.paper_sections()["soesianawati_1"].section
    layered = rbsdem.section.column(section, 1.6, axial_load=744e3)
    yield "layered", dataclasses.replace(layered, top_mass=75.9e3)
    for n in (2, 6):
        flexure = [paper.flexure, *[Elastic(2.5e8 * n)] * (n - 1)]
        shear = paper.shear.split(n)
        yield f"chain {n}", dataclasses.replace(paper, n=n, shear=shear, flexure=flexure)


def motions(column: rbsdem.Column) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Yield names, times and accelerations of the ground."""
    time, acceleration = np.loadtxt(MOTION, delimiter=",", skiprows=2, unpack=True)
    for size in (0.5, 1.0):
        yield f"ground x {size:g}", time, size * GRAVITY * acceleration
    first = rbsdem.modes(column).frequency[0]
    # Below the first frequency, as the column softens.
    time = np.linspace(0.0, 12.0 / first, 1201)
    for size in (1.0, 4.0):
        yield f"sine {size:g}", time, size * np.sin(2 * np.pi * 0.8 * first * time)


def answer(scene, keywords) -> tuple[Answer, rbsdem.Result, float]:
    """Return the compared part of a result, the result and its wall time [s]."""
    begin = clock.perf_counter()
    run = rbsdem.time_history(scene.column, scene.time, **scene.loads, **keywords)
    seconds = clock.perf_counter() - begin
    return answer_of(run, scene.time), run, seconds


def errors(kinematics: str) -> None:
    """Print the errors of all methods at their own settings."""
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in WAYS}
    left_out = cases = 0
    for name, drawn in columns():
        column = dataclasses.replace(drawn, kinematics=kinematics)
        for motion, time, acceleration in motions(column):
            scene = study_case(column, time, {"ground_acceleration": acceleration}, None, None)
            try:
                reference, *_ = answer(scene, {"method": "rk45", "tolerance": 1e-12})
                step = Way("rk4", column.kinematics)
                fine = 0.02 * rbsdem.modes(column).stable_step
                parts = int(np.ceil((time[1] - time[0]) / fine))
                step = {"method": "rk4", "events": "located", "dt": (time[1] - time[0]) / parts}
                second, *_ = answer(scene, step)
            except rbsdem.SolveError as error:
                print(f"{name}, {motion}: {error}")
                left_out += 1
                continue
            if errors_of(second, reference).largest > 1e-7:
                left_out += 1
                continue
            cases += 1
            for way, keywords in WAYS.items():
                try:
                    one, run, _ = answer(scene, keywords)
                except rbsdem.SolveError:
                    found[way].append((np.inf, np.inf))
                    continue
                residual = run.summary["relative_energy_residual"]
                found[way].append((errors_of(one, reference).largest, residual))
    print(
        f"{kinematics}: {cases} cases; {left_out} left out, as two methods do not agree to 1e-7\n"
    )
    print("| method | error, median | 9 of 10 | largest | energy residual, median | largest |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    for way, values in found.items():
        error, residual = np.array(values).T
        shown = (np.median(error), np.quantile(error, 0.9), error.max())
        shown = (*shown, np.median(residual), residual.max())
        print(f"| {way} | " + " | ".join(f"{value:.1e}" for value in shown) + " |")
    print()


def costs() -> None:
    """Print the wall time of a step, for one body and the slope with the number of bodies."""
    paper = rbsdem.peer.paper_columns("pdelta", top_mass=75.9e3)["soesianawati_1"]
    time = np.linspace(0.0, 2.0, 201)
    print("| method | kinematics | one body, ns a step | each further body, ns |")
    print("| --- | --- | ---: | ---: |")
    for kinematics in ("pdelta", "finite"):
        for way, keywords in WAYS.items():
            implicit = keywords["method"] in ("newmark", "hht", "generalised_alpha")
            if way == "auto":
                continue
            spent = {}
            for n in (1, 50):
                flexure = [paper.flexure, *[Elastic(2.5e8 * n)] * (n - 1)]
                column = dataclasses.replace(
                    paper, n=n, kinematics=kinematics, flexure=flexure, shear=paper.shear.split(n)
                )
                limit = rbsdem.modes(column).stable_step
                end = min(2.0, 4000 * limit) if n > 1 and not implicit else 2.0
                load = 6.0 * np.sin(2 * np.pi * 2.0 * time)
                per = []
                for _ in range(5):
                    begin = clock.perf_counter()
                    run = rbsdem.time_history(
                        column, np.linspace(0.0, end, 201), ground_acceleration=load, **keywords
                    )
                    per.append((clock.perf_counter() - begin) / run.summary["steps"])
                spent[n] = 1e9 * float(np.median(per))
            slope = (spent[50] - spent[1]) / 49
            print(f"| {way} | {kinematics} | {spent[1]:.0f} | {slope:.0f} |")


if __name__ == "__main__":
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    for kinematics in ("pdelta", "finite"):
        errors(kinematics)
    costs()
