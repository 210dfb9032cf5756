"""Fit the parameters of the layered hinge of the blind model, and score them on series left out.

    python studies/fit_hinge.py FOLDER [--folds 5] [--evaluations 10] [--jobs 2] [--out FILE]
        [--present] [--fitted-before]

FOLDER holds the histories and the table of the tests (docs/peer.md). Fitted are all flexural tests
of rectangular columns with one set of parameters, from values as in the literature, on which a weak
prior keeps them. A test counts by n^2/(n^2 + s^2), n its nrmse: those that no parameter mends do
not pull. Series, not tests, are left out: the columns of a series are much alike. With `--present`
the search starts at the newest version of the parameters; the prior stays. With `--fitted-before`
the tests are those that version 2026.2 was fitted to (`studies/blind_table.py` lists the others).
"""

from __future__ import annotations

import argparse
import csv
import math
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from blind_table import NOT_FITTED
from scipy.optimize import least_squares

import rbsdem
from rbsdem import peer
from rbsdem.calibration.misfit import Target, forces
from rbsdem.section.parameters import HingeParameters, ModelParameters, parameters


class Fitted(NamedTuple):
    """A parameter; `spread` is relative for positive ones, absolute for exponents."""

    start: float
    spread: float
    low: float
    high: float


PARAMETERS = {
    "steel_strength": Fitted(1.05, 0.1, 0.9, 1.2),
    "hardening": Fitted(1.0, 0.5, 0.3, 2.0),
    "r0": Fitted(10.0, 0.5, 3.0, 25.0),
    "r0_axial": Fitted(0.0, 2.0, -4.0, 4.0),
    "cr1": Fitted(0.85, 0.1, 0.5, 0.97),
    "cr2": Fitted(0.4, 0.5, 0.05, 1.5),
    "isotropic_hardening": Fitted(0.05, 1.0, 0.005, 0.3),
    "fatigue": Fitted(0.001, 1.0, 5e-5, 0.02),
    "concrete_strength": Fitted(0.9, 0.15, 0.6, 1.2),
    "concrete_size": Fitted(0.0, 0.1, -0.3, 0.4),
    "peak_strain": Fitted(1.1, 0.3, 0.7, 2.0),
    "confinement": Fitted(1.0, 0.3, 0.3, 2.0),
    "core_softening": Fitted(1.0, 1.0, 0.05, 10.0),
    "cover_softening": Fitted(1.0, 0.7, 0.1, 10.0),
    "residual": Fitted(0.3, 0.5, 0.05, 0.8),
    "hinge_length": Fitted(0.8, 0.4, 0.2, 2.0),
    "hinge_axial": Fitted(0.0, 1.5, -4.0, 3.0),
    "hinge_depth": Fitted(0.1, 1.0, 0.01, 0.6),
    "compression_length": Fitted(1.5, 0.4, 0.5, 3.0),
    "slip_length": Fitted(0.015, 0.5, 0.003, 0.05),
    "slip_axial": Fitted(0.0, 1.5, -4.0, 3.0),
    "stiffness": Fitted(0.9, 0.3, 0.3, 2.0),
    "stiffness_axial": Fitted(1.0, 1.0, 0.0, 4.0),
    "shear_stiffness": Fitted(0.7, 0.4, 0.2, 1.0),
    "plastic": Fitted(1.5, 0.4, 0.5, 3.0),
    "misfit": Fitted(0.3, 0.5, 0.05, 0.8),
    "contact": Fitted(0.3, 0.5, 0.05, 0.8),
    "contact_axial": Fitted(0.0, 1.5, -4.0, 4.0),
    "wear": Fitted(0.05, 0.7, 0.005, 0.3),
}

# nrmse of a test that counts half.
HALF = 0.13
# What an error of 1 in the ratio of peaks, or of energies, counts as nrmse.
PEAK, ENERGY = 0.3, 0.08
# Weight of the prior: of one spread, against the mean over the tests.
PRIOR = 1e-3
# Classes of the printed scores.
AXIAL_LOAD_RATIOS = (-1.0, 0.05, 0.15, 0.3, 0.45, 1.0)
# One of this many points along the path is used.
EVERY = 5


def value(parameter: Fitted, place: float) -> float:
    """Return the value at a place, which counts spreads from the start."""
    if parameter.low > 0:
        return parameter.start * math.exp(parameter.spread * place)
    return parameter.start + parameter.spread * place


def bounds() -> tuple[list[float], list[float]]:
    """Return the bounds of the places."""
    sides = ([], [])
    for one in PARAMETERS.values():
        for side, end in zip(sides, (one.low, one.high), strict=True):
            way = math.log(end / one.start) if one.low > 0 else end - one.start
            side.append(way / one.spread)
    return sides


def present() -> np.ndarray:
    """Return the places of the newest version."""
    values, places = parameters("2026.2").values, []
    for name, one in PARAMETERS.items():
        now = min(max(values[name], one.low), one.high)
        way = math.log(now / one.start) if one.low > 0 else now - one.start
        places.append(way / one.spread)
    return np.array(places)


def at(places: np.ndarray) -> ModelParameters:
    """Return the parameters of the model with the hinge of places."""
    items = zip(PARAMETERS.items(), places.tolist(), strict=True)
    hinge = HingeParameters(**{name: value(one, place) for (name, one), place in items})
    return replace(parameters("2026.2"), hinge=hinge)


class Case:
    """A test, and the parts of its column that do not change.

    Parameters
    ----------
    specimen : rbsdem.peer.Specimen
        The test.
    """

    def __init__(self, specimen: peer.Specimen) -> None:
        self.specimen, self.target = specimen, Target(specimen.test())

    def error(self, given: ModelParameters) -> np.ndarray:
        """Return the errors along the path and, last, those of the two ratios."""
        column = peer.column(self.specimen, model_parameters=given)
        force = forces(column, self.target.displacement)[0]
        error = self.target.error(force)[::EVERY]
        peak, energy = self.target.ratios(force)
        ratios = np.clip([PEAK * (peak - 1), ENERGY * (energy - 1)], -HALF, HALF)
        return np.append(error / math.sqrt(len(error)), ratios)

    def residual(self, given: ModelParameters) -> np.ndarray:
        """Return the errors so that their square sum is the bounded loss."""
        error = self.error(given)
        return error / math.sqrt(error @ error + HALF**2)


_cases: list[Case] = []


def _begin(folder: str, fitted_before: bool) -> None:
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    _cases[:] = load(folder, fitted_before)


def _one(task: tuple[int, np.ndarray]) -> np.ndarray:
    number, places = task
    return _cases[number].residual(at(places))


def _slopes(task: tuple[int, np.ndarray]) -> np.ndarray:
    """Return the change of the residual of a test by each parameter, by differences."""
    number, places = task
    _, high = bounds()
    here, columns = _one(task), []
    for i in range(len(places)):
        step = 0.15 if places[i] + 0.15 <= high[i] else -0.15
        moved = places.copy()
        moved[i] += step
        columns.append((_one((number, moved)) - here) / step)
    return np.column_stack(columns)


def load(folder: str, fitted_before: bool) -> list[Case]:
    """Return the flexural tests of rectangular columns."""
    tests = peer.read_specimens(folder).where(section="rectangular", failure_mode="Flexure")
    return [
        Case(specimen)
        for specimen in tests.with_history()
        if not (fitted_before and (specimen.file or "").startswith(NOT_FITTED))
    ]


def fit(
    pool: ProcessPoolExecutor, numbers: list[int], evaluations: int, start: np.ndarray
) -> np.ndarray:
    """Return the places that fit the given tests best."""
    weight, prior = 1 / math.sqrt(len(numbers)), math.sqrt(PRIOR)

    def residual(places: np.ndarray) -> np.ndarray:
        rows = pool.map(_one, [(i, places) for i in numbers], chunksize=6)
        return np.concatenate([*(weight * row for row in rows), prior * places])

    def slopes(places: np.ndarray) -> np.ndarray:
        rows = pool.map(_slopes, [(i, places) for i in numbers], chunksize=2)
        return np.vstack([*(weight * row for row in rows), prior * np.eye(len(places))])

    low, high = bounds()
    start = np.clip(start, np.add(low, 1e-6), np.subtract(high, 1e-6))
    found = least_squares(residual, start, slopes, (low, high), ftol=1e-3, max_nfev=evaluations)
    return found.x


def scores(cases: list[Case], given: ModelParameters) -> dict[str, list[float]]:
    """Return scores of tests by their names."""
    tests = [case.specimen for case in cases]
    names = ("nrmse", "peak_ratio", "energy_ratio")
    return {
        row.specimen.name: [row.score(name) for name in names]
        for row in peer.predict(tests, model_parameters=given)
    }


def show(what: str, found: dict[str, list[float]]) -> None:
    """Print medians of the scores."""
    rows = np.array(list(found.values()))
    quarter, median, three = np.percentile(rows[:, 0], [25, 50, 75])
    print(
        f"{what}: nrmse {median:.4f} (quartiles {quarter:.3f}, {three:.3f}), "
        f"peak ratio {np.nanmedian(rows[:, 1]):.3f}, energy ratio {np.nanmedian(rows[:, 2]):.3f}, "
        f"{len(rows)} tests",
        flush=True,
    )


def main() -> None:
    """Fit, leave out, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--evaluations", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, metavar="FILE", help="csv of the scores left out")
    parser.add_argument("--present", action="store_true", help="start at the newest version")
    parser.add_argument("--fitted-before", action="store_true", help="the tests of version 2026.2")
    given = parser.parse_args()

    source = given.folder, given.fitted_before
    _begin(*source)
    start = present() if given.present else np.zeros(len(PARAMETERS))
    show("parameters 2026.2", scores(_cases, parameters("2026.2")))
    names = sorted({case.specimen.series for case in _cases})
    # The order of the alphabet has nothing to do with the tests.
    folds = [names[i :: given.folds] for i in range(given.folds)]
    with ProcessPoolExecutor(given.jobs, initializer=_begin, initargs=source) as pool:
        places = fit(pool, list(range(len(_cases))), given.evaluations, start)
        show("all series, fitted to them", scores(_cases, at(places)))
        for (name, one), place in zip(PARAMETERS.items(), places, strict=True):
            print(f"    {name}={value(one, place):.3g},", flush=True)
        left_out: dict[str, list[float]] = {}
        for fold in folds:
            inside = [i for i, c in enumerate(_cases) if c.specimen.series not in fold]
            outside = [c for c in _cases if c.specimen.series in fold]
            places = fit(pool, inside, given.evaluations, start)
            found = scores(outside, at(places))
            show(f"without {', '.join(fold)}", found)
            left_out |= found
    show("every series left out once", left_out)
    for low, high in pairwise(AXIAL_LOAD_RATIOS):
        members = [c.specimen for c in _cases if low <= c.specimen.axial_load_ratio < high]
        what = f"of these axial load ratio {low:g} to {high:g}"
        show(what, {member.name: left_out[member.name] for member in members})
    print("of these the columns of the paper:")
    for case in _cases:
        path = case.specimen.path
        if path and any(path.name in names for names in peer.HISTORY_FILES.values()):
            print(f"    {case.specimen.name}: nrmse {left_out[case.specimen.name][0]:.3f}")
    if given.out:
        with given.out.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["name", "nrmse", "peak_ratio", "energy_ratio"])
            writer.writerows([name, *row] for name, row in left_out.items())


if __name__ == "__main__":
    main()
