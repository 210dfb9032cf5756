"""How well a model can follow measured columns: every test of a folder calibrated.

    python studies/calibration_table.py DIR [--model NAME] [--free NAME...] [--only NAME...]
        [--section KIND] [--failure MODE] [--loss LOSS] [--evaluations N] [--seconds S]
        [--every N] [--first N] [--jobs N] [--out FILE]

DIR has the histories and the table `specimens.csv`. Model "lumped" is one Takeda spring that starts
from the gross section. The other models are those of `rbsdem.peer.column`, whose parameters start
from the properties of the specimen. Without --free, all parameters that the model offers are free,
up to six; those that change no force of a test are left out for that test. It prints the scores of
each test, and medians with quartiles before and after.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

import numpy as np

import rbsdem
from rbsdem.errors import AccuracyWarning, RbsdemError
from rbsdem.peer import Specimen, read_specimens
from rbsdem.springs import Elastic, Takeda

TAKEDA = ("k_c", "k_y", "d_y", "k_u", "b0", "b1")
SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")

# Modulus of concrete over the root of its strength (ACI 318, MPa), good enough for a start.
MODULUS = 4700.0


def main() -> int:
    """Calibrate and print; 1 if a test failed."""
    options = _options()
    names = {key: value for key in ("section", "failure") if (value := getattr(options, key))}
    if "failure" in names:
        names["failure_mode"] = names.pop("failure")
    tests = read_specimens(options.folder).where(**names)
    tests = [test for test in tests if test.path and _wanted(test, options.only)]
    tests = tests[options.first :: options.every]
    fit = partial(
        one,
        model=options.model,
        free=options.free,
        loss=options.loss,
        evaluations=options.evaluations,
        seconds=options.seconds,
    )
    begin = time.perf_counter()
    rows: list[dict[str, Any]] = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for row in pool.map(fit, tests):
            rows.append(row)
            print(_line(row), flush=True)
    print(f"\n{len(rows)} tests in {time.perf_counter() - begin:.1f} s")
    _summary(rows)
    if options.out:
        keys = dict.fromkeys(key for row in rows for key in row)
        with open(options.out, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, keys, restval="")
            writer.writeheader()
            writer.writerows(rows)
    return int(any("error" in row for row in rows))


def one(
    specimen: Specimen,
    *,
    model: str,
    free: list[str] | None,
    loss: str,
    evaluations: int,
    seconds: float,
) -> dict[str, Any]:
    """Calibrate one test; an error is put into the row."""
    row: dict[str, Any] = {"name": specimen.name, "failure_mode": specimen.failure_mode}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        try:
            test = specimen.test()
            if model == "lumped":
                column, offered = lumped(specimen), [f"flexure.{name}" for name in TAKEDA]
            else:
                column = rbsdem.peer.column(specimen, model=model)
                offered = list(getattr(column, "parameters", ()))[:6]
                offered = offered or [f"flexure.{name}" for name in TAKEDA]
            names = free or offered
            fit = rbsdem.calibrate(
                column, test, names, loss=loss, evaluations=evaluations, seconds=seconds
            )
        except RbsdemError as error:
            return row | {"error": str(error)}
    for name in SCORES:
        row[f"{name}_before"] = getattr(fit.before, name)
        row[name] = getattr(fit.after, name)
    row |= {"evaluations": fit.evaluations, "seconds": fit.seconds, "status": fit.status}
    row["at_bound"] = sum(bool(number.at_bound) for number in fit.parameters)
    known = {each.name for each in fit.parameters if np.isfinite(each.standard_error)}
    row["left_out"] = " ".join(name for name in names if name not in known)
    return row | fit.values


def lumped(specimen: Specimen) -> rbsdem.Column:
    """Return one Takeda spring from the gross section, for tests of the calibration itself."""
    modulus = MODULUS * np.sqrt(specimen.concrete_strength * 1e-6) * 1e6
    inertia = specimen.width * specimen.depth**3 / 12
    k_c = 3 * modulus * inertia / specimen.length
    moment = 0.05 * specimen.width * specimen.depth**2 * specimen.concrete_strength
    moment += 0.4 * max(specimen.axial_load, 0.0) * specimen.depth
    return rbsdem.Column(
        height=specimen.length,
        mass=specimen.mass,
        shear=Elastic(k=100 * k_c / specimen.length**2),
        flexure=Takeda(
            k_c=k_c,
            d_c=0.2 * moment / k_c,
            k_y=0.4 * k_c,
            d_y=2.2 * moment / k_c,
            k_u=0.02 * k_c,
            b0=0.4,
            b1=0.5,
        ),
        axial_load=specimen.axial_load,
        kinematics="pdelta",
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Calibrate every test of a folder.")
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--model", default="layered")
    parser.add_argument("--free", nargs="+", metavar="NAME")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="parts of names of tests")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="each Nth test only")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="of those, from 0")
    parser.add_argument("--section", default="rectangular", help="'' for all")
    parser.add_argument("--failure", default="Flexure", help="'' for all")
    parser.add_argument("--loss", default="nrmse")
    parser.add_argument("--evaluations", type=int, default=800)
    parser.add_argument("--seconds", type=float, default=10.0, help="the most for a test")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", metavar="FILE", help="csv of all rows")
    return parser.parse_args()


def _wanted(specimen: Specimen, only: list[str] | None) -> bool:
    return not only or any(part.lower() in specimen.name.lower() for part in only)


def _line(row: dict[str, Any]) -> str:
    if "error" in row:
        return f"{row['name'][:40]:40s}  {row['error']}"
    return (
        f"{row['name'][:40]:40s}  {row['nrmse_before']:.3f} -> {row['nrmse']:.3f}  peak "
        f"{row['peak_ratio']:.2f}  energy {row['energy_ratio']:.2f}  {row['evaluations']:4d} "
        f"analyses  {row['seconds']:5.1f} s"
    )


def _summary(rows: list[dict[str, Any]]) -> None:
    done = [row for row in rows if "error" not in row]
    if not done:
        return
    print(f"{'':16s}{'before':>24s}{'after':>26s}")
    for name in SCORES:
        cells = []
        for key in (f"{name}_before", name):
            low, middle, high = np.nanpercentile([row[key] for row in done], [25, 50, 75])
            cells.append(f"{middle:8.3f} ({low:.3f} to {high:.3f})")
        print(f"{name:16s}{cells[0]:>26s}{cells[1]:>26s}")
    seconds = [row["seconds"] for row in done]
    print(f"time a fit: median {np.median(seconds):.2f} s, longest {max(seconds):.2f} s")
    print(f"failed: {len(rows) - len(done)} of {len(rows)}")


if __name__ == "__main__":
    sys.exit(main())
