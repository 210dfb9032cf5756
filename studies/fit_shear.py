"""Fit the parameters of the shear spring of the blind model, and score them on series left out.

    python studies/fit_shear.py FOLDER [--folds 5] [--evaluations 150] [--jobs 2]

FOLDER holds the histories and the table of the tests (docs/peer.md). Fitted is the mean nrmse of
the tests that failed in shear or in shear after flexure, all shapes, and what the spring adds to
the nrmse of flexural tests that come near the shear strength. Series, not tests, are left out.
"""

from __future__ import annotations

import argparse
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

import rbsdem
from rbsdem import peer
from rbsdem.calibration.misfit import Target, forces, rms
from rbsdem.measured.drawing import draw
from rbsdem.section.parameters import ShearParameters, parameters
from rbsdem.section.shear_model import shear_spring
from rbsdem.springs import Elastic

# Bounds of what is fitted; the others keep their values.
BOUNDS = {
    "strength": (0.6, 1.6),
    "hardening": (1.0, 1.6),
    "cap": (5e-4, 0.1),
    "softening": (0.02, 0.6),
    "endurance": (0.5, 500.0),
    "pinch_force": (0.02, 1.0),
    "pinch_slip": (0.02, 0.98),
}
LOW, HIGH = (np.log(side) for side in zip(*BOUNDS.values(), strict=True))

# A flexural test may come into the fit if its column reaches this share of its shear strength.
NEAR = 0.6

# Weight of a rise of their nrmse against the nrmse of the shear failures.
HARM = 1.0


class Case:
    """A test and its column, to which another shear spring can be given.

    Parameters
    ----------
    specimen : rbsdem.peer.Specimen
        The test.
    """

    def __init__(self, specimen: peer.Specimen) -> None:
        self.specimen, self.target = specimen, Target(specimen.test())
        self.column = peer.column(specimen)
        self.section = draw(specimen).section
        foot = self.column.shear[0]
        self.stiffness = foot.f_c / foot.d_c * specimen.length
        force = self.force(Elastic(foot.f_c / foot.d_c))
        self.without = rms(self.target.error(force))
        self.failed = specimen.failure_mode != "Flexure"
        strength = foot.f_y / parameters("2026.2").shear.strength
        self.near = float(np.max(np.abs(force), initial=0.0)) > NEAR * strength

    def force(self, foot: rbsdem.springs.Spring) -> np.ndarray:
        """Return the lateral force with a spring at the foot, as far as it was reached [N]."""
        column = replace(self.column, shear=[foot, *self.column.shear[1:]])
        return forces(column, self.target.displacement)[0]

    def score(self, given: ShearParameters) -> float:
        """Return the nrmse with other parameters of the shear spring."""
        s = self.specimen
        foot = shear_spring(self.section, s.length, s.axial_load, self.stiffness, given)
        return rms(self.target.error(self.force(foot)))


def parameters_at(place: np.ndarray) -> ShearParameters:
    """Return the parameters of a place from -inf to inf in each direction."""
    values = np.exp(LOW + (HIGH - LOW) / (1 + np.exp(-place)))
    return replace(parameters("2026.2").shear, **dict(zip(BOUNDS, values.tolist(), strict=True)))


def place_of(given: ShearParameters) -> np.ndarray:
    """Return the place of parameters."""
    values = np.log([getattr(given, name) for name in BOUNDS])
    share = np.clip((values - LOW) / (HIGH - LOW), 0.03, 0.97)
    return np.log(share / (1 - share))


def fit(cases: list[Case], evaluations: int) -> ShearParameters:
    """Return the parameters that fit the cases best, by the simplex of Nelder and Mead."""
    shear = [case for case in cases if case.failed]
    other = [case for case in cases if not case.failed and case.near]

    def loss(place: np.ndarray) -> float:
        given = parameters_at(place)
        harm = [max(0.0, case.score(given) - case.without) for case in other]
        return float(np.mean([case.score(given) for case in shear]) + HARM * np.mean(harm or [0.0]))

    start = place_of(parameters("2026.2").shear)
    simplex = np.vstack([start, start - 0.8 * np.diag(np.sign(start))])
    options = {"initial_simplex": simplex, "maxfev": evaluations, "adaptive": True}
    return parameters_at(minimize(loss, start, method="Nelder-Mead", options=options).x)


def _left_out(
    folder: str, series: list[str], evaluations: int
) -> list[tuple[str, float, float, ShearParameters]]:
    """Fit without some series; return name and nrmse of their tests without spring and with it."""
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    cases = load(folder)
    given = fit([c for c in cases if c.specimen.series not in series], evaluations)
    return [
        (c.specimen.name, c.without, c.score(given), given)
        for c in cases
        if c.specimen.series in series
    ]


def load(folder: str) -> list[Case]:
    """Return the cases of all tests of a folder that count."""
    cases = [Case(specimen) for specimen in peer.read_specimens(folder).with_history()]
    return [case for case in cases if case.failed or case.near]


def main() -> None:
    """Fit, leave out, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--evaluations", type=int, default=150)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()

    # The warnings are of rotations above 0.1 at the end of some tests.
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    cases = load(given.folder)
    names = sorted({case.specimen.series for case in cases})
    folds = [names[i :: given.folds] for i in range(given.folds)]
    with ProcessPoolExecutor(given.jobs) as pool:
        n = len(folds)
        rows = pool.map(_left_out, n * [given.folder], folds, n * [given.evaluations])
        found = {row[0]: row for fold in rows for row in fold}
    everything = fit(cases, given.evaluations)
    print("all series:", everything)
    print("left out in turn:")
    for name in BOUNDS:
        values = sorted({getattr(row[3], name) for row in found.values()})
        print(f"  {name:12s}", *(f"{value:.4g}" for value in values))
    print(f"{'median (mean) nrmse':44s} tests  without spring     left out         all fitted")
    for title, chosen in (
        ("rectangular, shear or flexure-shear", lambda s, f: f and s.section == "rectangular"),
        ("round, shear or flexure-shear", lambda s, f: f and s.section != "rectangular"),
        (f"flexural, above {NEAR:g} of the shear strength", lambda s, f: not f),
    ):
        group = [case for case in cases if chosen(case.specimen, case.failed)]
        columns = (
            [case.without for case in group],
            [found[case.specimen.name][2] for case in group],
            [case.score(everything) for case in group],
        )
        cells = (f"{np.median(v):.3f} ({np.mean(v):.3f})" for v in columns if v)
        print(f"{title:44s} {len(group):5d} ", *cells, sep="  ")


if __name__ == "__main__":
    main()
