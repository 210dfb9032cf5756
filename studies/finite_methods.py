"""Print what the methods in time make of finite rotations: errors, energy, time.

    python studies/finite_methods.py

Three unequal bodies, elastic at a drift of 0.4, yielding at 0.1, against rk45 with a tolerance of
1e-11: error of the displacement of the top, relative to its peak, and residual of the energy, for a
step and its halves. Then chains of up to 400 bodies, elastic and yielding: time of a step and body.
Uses the installed package alone; takes some 10 s.
"""

from __future__ import annotations

import time as clock
import warnings

import numpy as np

import rbsdem
from rbsdem.run.solver import IMPLICIT
from rbsdem.springs import Bilinear, Elastic, Spring, Takeda

TIME = np.linspace(0.0, 1.0, 101)
WAVE = np.sin(20.0 * TIME)


def chain(n: int, *, yields: bool) -> rbsdem.Column:
    """Return a chain of n bodies with a mass at its top."""
    flexure: Spring = Elastic(1.5e6 * n)
    shear: Spring = Elastic(1e8 * n)
    if yields:
        flexure = Takeda(6e6 * n, 3e-3 / n, 1.5e6 * n, 1.5e-2 / n, 1.5e5 * n)
        shear = Bilinear(1e7 * n, 1e-3 / n, 2e5 * n)
    return rbsdem.Column(
        2.0, 1000.0, shear, flexure, n=n, kinematics="finite", axial_load=2e4, top_mass=2000.0,
        lengths=np.linspace(1.0, 1.5, n) * 2.0 / np.linspace(1.0, 1.5, n).sum(),
        damping=rbsdem.Damping(stiffness=1e-3) if yields else None,
    )  # fmt: skip


def errors(column: rbsdem.Column, force: np.ndarray) -> None:
    """Print errors and residuals of the energy for four steps."""
    exact = rbsdem.time_history(column, TIME, force=force, method="rk45", tolerance=1e-11)
    peak = np.max(np.abs(exact.displacement))
    for method in IMPLICIT:
        cells = []
        for parts in (5, 10, 20, 40):
            run = rbsdem.time_history(column, TIME, force=force, method=method, dt=0.01 / parts)
            apart = np.max(np.abs(run.displacement - exact.displacement)) / peak
            cells.append(f"{apart:.1e}, {abs(run.summary['relative_energy_residual']):.0e}")
        print(f"| `{method}` | " + " | ".join(cells) + " |")


def times(column: rbsdem.Column, force: np.ndarray) -> str:
    """Return the time of a step and body of average acceleration [us], and how often it was cut."""
    best = np.inf
    for _ in range(3):
        begin = clock.process_time()
        run = rbsdem.time_history(column, TIME, force=force, method="newmark", dt=0.005)
        best = min(best, clock.process_time() - begin)
    steps = run.summary["steps"]
    return f"{1e6 * best / steps / column.n:.1f} ({run.summary['cut_steps']})"


def main() -> None:
    """Print two Markdown tables."""
    warnings.simplefilter("ignore")
    for yields, size in ((False, 1e5), (True, 6e4)):
        print(f"\nerror and residual of the energy, {'yielding' if yields else 'elastic'}\n")
        print("| method | 2 ms | 1 ms | 0.5 ms | 0.25 ms |\n| --- | --- | --- | --- | --- |")
        errors(chain(3, yields=yields), size * WAVE)
    print("\ntime of a step of 5 ms and body [us] (steps that were cut)\n")
    print("| n | elastic | yielding |\n| --- | --- | --- |")
    for n in (1, 5, 25, 100, 400):
        cells = (times(chain(n, yields=yields), 6e4 * WAVE) for yields in (False, True))
        print(f"| {n} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
