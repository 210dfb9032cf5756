"""Fragility curves written for pelicun, loaded by pelicun, and its probabilities beside ours.

    pip install pelicun
    python studies/exported_fragilities.py

Prints, for three spectral accelerations, the probabilities of no damage and of each limit state by
the curves, and by 20 000 samples of pelicun, whose standard error is 0.0035 at the most.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas
from pelicun.assessment import Assessment

from rbsdem import fragility
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem.many.runs import Intensity

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples" / "08-ida"))
import export

SAMPLES = 20_000
STATES = {"first_yield": (0.3, 0.25), "collapse": (1.2, 0.4)}


def curves() -> dict[str, fragility.Fragility]:
    """Return two curves, with medians in g."""
    values = np.array([1.0, 2.0])
    data = fragility.Capacities(values, values)
    return {
        name: fragility.Fragility(name, theta * STANDARD_GRAVITY, beta, np.zeros((2, 2)), data)
        for name, (theta, beta) in STATES.items()
    }


def by_pelicun(path: Path, level: float) -> np.ndarray:
    """Return the probabilities of the damage states at a spectral acceleration [g]."""
    rows = list(range(SAMPLES))
    found = Assessment({"PrintLog": False, "Seed": 1, "Verbose": False})
    demand = pandas.DataFrame({"SA_0.50-0-1": ["g", *([level] * SAMPLES)]}, index=["Units", *rows])
    found.demand.load_sample(demand)
    component = {"Units": ["ea"], "Location": ["0"], "Direction": ["1"], "Theta_0": ["1"]}
    component |= {"Family": [np.nan], "Blocks": ["1"]}
    found.asset.load_cmp_model({"marginals": pandas.DataFrame(component, index=["pier"])})
    found.asset.generate_cmp_sample(SAMPLES)
    found.damage.load_model_parameters([str(path)], set(found.asset.list_unique_component_ids()))
    found.damage.calculate()
    return found.damage.ds_model.probabilities().to_numpy().ravel()


def main() -> None:
    """Print the two beside each other."""
    given = curves()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fragility.csv"
        intensity = Intensity("sa_t1", 0.5, 0.05)
        export.write_pelicun(path, given, intensity, "pier")
        for level in (0.3, 0.9, 1.5):
            reached = [float(c.probability(level * STANDARD_GRAVITY)) for c in given.values()]
            ours = -np.diff([1.0, *reached, 0.0])
            print(f"{level} g: curves {np.round(ours, 4)}, pelicun {by_pelicun(path, level)}")


if __name__ == "__main__":
    main()
