"""Random search for motions whose answers by different methods do not converge to one.

    python studies/dynamic_search.py [motions] [seed]

The same column under the same ground motion, force and axial load goes through rk4 with and without
located events, rk45 and the implicit methods, each with a coarse and a finer setting. The fine
answers must be one, or come nearer to it than the coarse ones. A motion that a change of loading
by 1e-8 alters a thousand times as much is set aside: it tells nothing of the methods. Uses the
installed package alone and two processors; prints the failures, then one line of counts.
"""

from __future__ import annotations

import itertools
import multiprocessing
import sys
import warnings

import numpy as np
from static_search import Generator, spring

import rbsdem
from rbsdem.methods import IMPLICIT

#: Change of the loading by which a motion is found to be sensitive, and what it may amplify.
CHANGE, AMPLIFIED = 1e-8, 1e3

#: Difference of the accurate methods, and of the others where they do not converge, in shares of
#: the largest displacement.
ACCURATE, ROUGH = 1e-5, 2e-3


def problem(rng: Generator) -> tuple[rbsdem.Column, dict[str, object]]:
    """Return a column and its loading in time."""
    n = int(rng.choice([1, 1, 2, 3]))
    height = rng.uniform(1.0, 4.0)
    moment = 10 ** rng.uniform(4.5, 6)
    kinematics = str(rng.choice(["small", "pdelta", "finite", "finite"]))
    softens = bool(rng.random() < 0.2)

    def some(force: float, low: float, high: float) -> list[rbsdem.Spring]:
        return [
            spring(rng, force * rng.uniform(0.7, 2), 10 ** rng.uniform(low, high), softens=softens)
            for _ in range(n)
        ]

    opens = rng.random() < 0.15
    column = rbsdem.Column(
        height,
        mass := 10 ** rng.uniform(2, 4),
        some(2 * moment / height, -3.0, -1.5),
        some(moment, -2.7, -1.5),
        n=n,
        kinematics=kinematics,
        axial_load=0.0 if rng.random() < 0.5 else moment / height * rng.uniform(0, 3),
        rotary_inertia=mass / n * height**2 * rng.uniform(0.05, 0.3),
        axial_spring=rbsdem.Elastic(moment / height * rng.uniform(50, 500)) if opens else None,
        damping=rbsdem.Damping(mass=rng.uniform(0, 2), stiffness=1e-3 * rng.uniform(0, 1))
        if rng.random() < 0.5
        else None,
    )  # fmt: skip
    period = 2 * np.pi / rbsdem.modes(column).omega[0]
    time = np.linspace(0, rng.uniform(1, 4) * period, 41)
    wave = np.sin(2 * np.pi * time / (period * rng.uniform(0.5, 2))) + rng.uniform(-1, 1, time.size)
    strength = moment / height * 10 ** rng.uniform(-0.5, 1.5)
    loading = {"time": time}
    if rng.random() < 0.7:
        loading["ground_acceleration"] = strength / mass * wave
    else:
        loading["force"] = strength * wave
    if kinematics != "small" and rng.random() < 0.2:
        loading["axial_load"] = column.axial_load + strength * rng.uniform(-1, 1, time.size)
    return column, loading


def answer(
    column: rbsdem.Column, loading: dict[str, object], **settings: object
) -> np.ndarray | None:
    """Return the displacements of the top, None where the run did not end well."""
    try:
        return rbsdem.time_history(column, **loading, **settings).displacement
    except rbsdem.SolveError:
        return None


def settings(column: rbsdem.Column, loading: dict[str, object]) -> dict[str, list[dict]]:
    """Return the coarse and the fine setting of each method."""
    interval = float(loading["time"][1])
    stable = rbsdem.modes(column).stable_step
    parts = int(np.ceil(interval / (0.1 * stable)))
    steps = [{"dt": interval / parts}, {"dt": interval / (4 * parts)}]
    found = {
        "rk4 located": [{"method": "rk4", "events": "located", **step} for step in steps],
        "rk45": [{"method": "rk45", "tolerance": size} for size in (1e-7, 1e-10)],
        "rk4": [{"method": "rk4", **step} for step in steps],
    }
    for name in IMPLICIT:
        found[name] = [{"method": name, **step} for step in steps]
    return found


def judge(seed: tuple[int, int]) -> tuple[str, str]:
    """Follow one motion by all methods; return its class and what is to be said of it."""
    rng = np.random.default_rng(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            column, loading = problem(rng)
        except rbsdem.InputError:
            return "no column", ""
        try:
            return compare(column, loading)
        except rbsdem.InputError as error:
            return "refused", str(error)


def compare(column: rbsdem.Column, loading: dict[str, object]) -> tuple[str, str]:
    """Compare the answers of all methods."""
    runs = settings(column, loading)
    one = answer(column, loading, **runs["rk4 located"][1])
    drive = "force" if "force" in loading else "ground_acceleration"
    other = {**loading, drive: loading[drive] * (1 + CHANGE)}
    moved = answer(column, other, **runs["rk4 located"][1])
    if one is None or moved is None:
        ends = [
            name for name, pair in runs.items() if answer(column, loading, **pair[1]) is not None
        ]
        return "ends" if not ends else "ENDS FOR SOME", " ".join(ends)
    largest = np.max(np.abs(one), initial=1e-300)
    drift = largest / column.height
    if np.max(np.abs(moved - one)) > AMPLIFIED * CHANGE * largest or drift > 3:
        return "sensitive", ""
    worst = []
    for name, pair in runs.items():
        errors = []
        for how in pair:
            found = answer(column, loading, **how)
            errors.append(np.inf if found is None else np.max(np.abs(found - one)) / largest)
        allowed = ACCURATE if name in ("rk4 located", "rk45") else ROUGH
        if errors[1] > allowed and not errors[1] < 0.4 * errors[0]:
            worst.append(f"{name} {errors[0]:.1e} {errors[1]:.1e}")
    if worst:
        return (
            "NOT ONE ANSWER",
            f"{column.kinematics} n={column.n} drift {drift:.2g}: {'; '.join(worst)}",
        )
    return "one answer", ""


def main(count: int = 2000, first: int = 1) -> None:
    """Follow the motions and print what was found."""
    seeds = list(zip(itertools.repeat(first), range(count), strict=False))
    classes: dict[str, int] = {}
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for seed, (kind, text) in zip(seeds, pool.imap(judge, seeds, chunksize=10), strict=True):
            classes[kind] = classes.get(kind, 0) + 1
            if text:
                print(seed, kind, text, flush=True)
    print(", ".join(f"{kind} {number}" for kind, number in sorted(classes.items())))


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
