"""Times of ensembles on this machine, goal and measured side by side. Nothing is asserted.

    python tests/benchmarks/ensembles.py [--quick] [--default] [--dask]

Processor time of one thread where nothing else is said, so that another load of the machine
disturbs little; what takes two threads is wall time, on a machine that does nothing else.
"""

from __future__ import annotations

import argparse
import dataclasses
import resource
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from benchmark import record_20_s
from rows import Row, show

import rbsdem
from rbsdem import _core
from rbsdem.many.inputs import Motion
from rbsdem.many.plan import Plan, compute

#: Runs of the largest ensemble.
MANY = 1_000_000


def pier() -> rbsdem.Column:
    """Return the paper's column with the mass that its axial load has."""
    column = rbsdem.peer.paper_columns()["soesianawati_1"]
    return dataclasses.replace(column, top_mass=744e3 / 9.81, axial_load=744e3, kinematics="pdelta")


def predicted() -> rbsdem.Column:
    """Return the layered column that is predicted from its drawing, with its mass."""
    paper = rbsdem.peer.paper_sections()["soesianawati_1"]
    column = rbsdem.section.column(paper.section, paper.length, axial_load=paper.axial_load)
    return dataclasses.replace(column, top_mass=paper.axial_load / 9.81)


def processor(action: Callable[[], Any], repeats: int) -> tuple[list[float], Any]:
    """Return processor times of some calls, and the last answer."""
    times, answer = [], None
    for _ in range(repeats):
        start = time.process_time()
        answer = action()
        times.append(time.process_time() - start)
    return times, answer


def lanes(repeats: int, runs: int) -> list[Row]:
    """Time lanes with and without events, and one run after the other."""
    time_, motion = record_20_s()
    place = np.zeros(runs, dtype=np.int32)
    rows = []
    for method, settings in (("rk4", {}), ("newmark", {"dt": 0.005})):
        goal = 15.0 if method == "newmark" else None
        for scale in (0.01, 0.25, 1.0):
            scales = scale * np.linspace(0.95, 1.05, runs)
            motions = [Motion("made up", time_, motion)]
            task = Plan([pier()], motions, {"method": method, **settings}, place, place, scales)
            few = dataclasses.replace(task, column=place[:8], motion=place[:8], scale=scales[:8])
            alone, _ = processor(lambda few=few: compute(few, kernel=-1), 1)
            times, answer = processor(lambda task=task: compute(task), repeats)
            numbers = dict(zip(_core.measures(), answer.values.sum(axis=1), strict=True))
            row = Row(f"{method}, lanes, record x {scale:g}", "ns/column-step", goal)
            row.values = [1e9 * t / numbers["steps"] for t in times]
            steps = numbers["steps"] * 8 / runs
            row.note = (
                f"{100 * numbers['events'] / numbers['steps']:.1f} % events; alone "
                f"{1e9 * alone[0] / steps:.0f} ns"
            )
            rows.append(row)
    return rows


def default(runs: int) -> list[Row]:
    """Time runs without settings, and compare their errors with those of "auto"."""
    motion = record_20_s()
    given: dict[str, Any] = {"scales": np.linspace(0.2, 1.0, runs), "jobs": 1}
    rows = []
    paper = rbsdem.peer.paper_columns("pdelta")["soesianawati_1"]
    for name, column in {"paper's column": paper, "with the mass of its load": pier()}.items():
        step = rbsdem.ensemble(column, motion).measures["time_step"][0]
        exact = {"method": "rk4", "events": "located", "dt": step / 8}
        reference = rbsdem.ensemble(column, motion, scales=given["scales"][::8], jobs=2, **exact)
        for method, how in {"no settings": {}, "auto": {"method": "auto"}}.items():
            times, found = processor(
                lambda c=column, h=how: rbsdem.ensemble(c, motion, **given, **h), 1
            )
            row = Row(f"{name}, {method}", "ms/run", 0.6, [1e3 * times[0] / runs])
            known = reference.measures["peak_drift"]
            error = np.abs(found.measures["peak_drift"][::8] / known - 1)
            row.note = f"peak drift off by {np.median(error):.0e} (median), {error.max():.0e}"
            rows.append(row)
    return rows


def damped_lanes(repeats: int, runs: int) -> list[Row]:
    """Time lanes of damped columns, over single runs."""
    time_, motion = record_20_s()
    place = np.zeros(runs, dtype=np.int32)
    rayleigh = rbsdem.Damping(mass=0.3, stiffness=1e-4)
    cases = {
        "one body, Rayleigh": dataclasses.replace(pier(), damping=rayleigh),
        "one body, modal": dataclasses.replace(pier(), damping=0.03),
    }
    rows = []
    for name, column in cases.items():
        for method, settings in (("rk4", {}), ("newmark", {"dt": 0.005})):
            points = 200 if method == "rk4" else time_.size
            motions = [Motion("made up", time_[:points], motion[:points])]
            scales = np.linspace(0.2, 0.3, runs)
            task = Plan([column], motions, {"method": method, **settings}, place, place, scales)
            few = dataclasses.replace(task, column=place[:8], motion=place[:8], scale=scales[:8])
            row = Row(f"{method}, {name}, lanes over single runs", "x")
            for _ in range(repeats):
                alone, _ = processor(lambda few=few: compute(few, kernel=-1), 1)
                lanes_, _ = processor(lambda task=task: compute(task), 1)
                row.values.append(lanes_[0] / alone[0] * 8 / runs)
            rows.append(row)
    return rows


def layered(repeats: int) -> Row:
    """Time an ensemble of the predicted column over single runs."""
    column = predicted()
    time_, motion = record_20_s()
    scales = np.linspace(0.2, 2.0, 10)
    given = {"method": "newmark"}

    def single() -> None:
        for scale in scales:
            rbsdem.time_history(column, time_, ground_acceleration=scale * motion, **given)

    def together() -> None:
        rbsdem.ensemble(column, (time_, motion), scales=scales, jobs=1, **given)

    pairs = [(processor(together, 1)[0][0], processor(single, 1)[0][0]) for _ in range(repeats)]
    row = Row("predicted column, ensemble over single runs", "x", 1.05, [a / b for a, b in pairs])
    row.note = f"{1e3 * min(b for _, b in pairs) / scales.size:.1f} ms a run"
    return row


def twenty_by_ten(repeats: int) -> Row:
    """Time an incremental dynamic analysis of the predicted column, by two threads."""
    column = predicted()
    motions = {f"motion {seed}": rotated(seed) for seed in range(20)}
    row = Row("predicted column, 20 records x 10 scales, two threads", "s", 1.5)
    for _ in range(repeats):
        found = rbsdem.ensemble(
            column,
            motions,
            scales=np.linspace(0.2, 2.0, 10),
            method="newmark",
            collapse_drift=0.1,
            jobs=2,
        )
        row.values.append(found.seconds)
    return row


def rotated(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the made-up record with other phases."""
    time_, motion = record_20_s()
    spectrum = np.fft.rfft(motion)
    phases = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, spectrum.size)
    envelope = np.minimum(time_ / 3, 1) * np.exp(-np.maximum(time_ - 8, 0) / 6)
    values = envelope * np.fft.irfft(np.abs(spectrum) * np.exp(1j * phases), motion.size)
    return time_, 0.4 * 9.81 * values / np.abs(values).max()


def threads(runs: int, with_dask: bool) -> list[Row]:
    """Time many runs by one and two threads, and by two workers of Dask."""
    motion = record_20_s()
    given = {"method": "newmark", "dt": 0.005, "collapse_drift": 0.1}

    def run(number: int, **how: Any) -> float:
        scales = np.linspace(0.01, 1.0, number)
        return rbsdem.ensemble(pier(), motion, scales=scales, **given, **how).seconds

    run(64, jobs=1)
    one, two = run(runs // 10, jobs=1), run(runs // 10, jobs=2)
    rows = [Row("two threads over one", "x", (1.9, 2.1), [one / two])]
    seconds = run(runs, jobs=2)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    many = Row("1e6 runs of one body, two threads", "s", 60, [seconds * MANY / runs])
    many.note = f"{runs} were run; largest memory {most:.0f} MB (goal 500)"
    rows.append(many)
    if with_dask:
        from distributed import Client, LocalCluster  # noqa: PLC0415

        options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0"}
        with LocalCluster(**options) as cluster, Client(cluster) as client:
            run(640, client=client)
            pairs = [(run(runs // 10, client=client), run(runs // 10, jobs=2)) for _ in range(3)]
        rows.append(
            Row("two workers of Dask over two threads", "x", 1.05, [a / b for a, b in pairs])
        )
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer repeats, fewer runs")
    parser.add_argument("--default", action="store_true", help="runs without settings alone")
    parser.add_argument("--dask", action="store_true", help="a Dask cluster too")
    given = parser.parse_args()
    repeats = 2 if given.quick else 5
    if given.default:
        show({"No settings, one thread": default(64)})
        return
    show(
        {
            "Lanes, one thread": lanes(repeats, 320),
            "Damped lanes, one thread": damped_lanes(repeats, 128),
            "Layered columns": [layered(repeats), twenty_by_ten(1 if given.quick else 3)],
            "Many runs": threads(20_000 if given.quick else MANY, given.dask),
        }
    )


if __name__ == "__main__":
    main()
