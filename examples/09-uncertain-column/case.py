"""A column whose strengths are not known: the spread that it adds to that of the records.

    python examples/09-uncertain-column/case.py [--no-plot]

The column comes from a drawing, with the springs of the paper's model; concrete strength, yield
stress and mass on top are drawn from their distributions.
"""

import sys
from dataclasses import replace

import numpy as np
from scipy.stats import lognorm, qmc

import rbsdem
from rbsdem import (
    Concrete,
    Layout,
    RectangularSection,
    Steel,
    Ties,
    fragility,
    motions,
    plot,
)

RECORDS, COLUMNS = 5, 8


def make(concrete: float, steel: float, mass: float) -> rbsdem.Column:
    """Return the column for strengths [Pa] and a mass on top [kg]."""
    section = RectangularSection(
        0.4,
        0.4,
        Concrete(concrete),
        layout=Layout(12, 0.016, Steel(steel, 1.4 * steel)),
        ties=Ties(0.007, 0.085, Steel(364e6), legs=4),
        cover=0.013,
    )
    column = rbsdem.section.column(section, 1.6, axial_load=9.81 * mass, model="paper")
    return replace(column, top_mass=mass, kinematics="pdelta", damping=0.05)


median = make(46.5e6, 446e6, 75e3)
period = 1 / rbsdem.modes(median).frequency[0]
# Median and standard deviation of the logarithm; Sobol points fill the space evenly.
VARIABLES = {"concrete": (46.5e6, 0.15), "steel": (446e6, 0.07), "mass": (75e3, 0.10)}
points = qmc.Sobol(len(VARIABLES), rng=np.random.default_rng(1)).random(COLUMNS)
values = np.column_stack(
    [
        lognorm(beta, scale=middle).ppf(share)
        for (middle, beta), share in zip(VARIABLES.values(), points.T, strict=True)
    ]
)
columns = [make(*row) for row in values.tolist()]


def variances(capacity: np.ndarray) -> dict[str, float]:
    """Split the variance of ln(capacity), shape (columns, records): two crossed random factors."""
    logs = np.log(capacity)
    n, m = logs.shape
    rows, cols = logs.mean(axis=1), logs.mean(axis=0)
    rest = logs - rows[:, None] - cols + logs.mean()
    residual = (rest**2).sum() / ((n - 1) * (m - 1))
    parts = {
        "record": max(cols.var(ddof=1) - residual / n, 0.0),
        "model": max(rows.var(ddof=1) - residual / m, 0.0),
        "residual": residual,
    }
    return parts | {"total": sum(parts.values())}


records = motions.synthetic(RECORDS)
settings = {"method": "newmark", "dt": 0.005, "period": period, "collapse_drift": 0.05}

search = fragility.CollapseSearch(points=1)
found = rbsdem.ida(columns, records, levels=search, refine=[], **settings)
alone = rbsdem.ida(median, records, levels=search, refine=[], **settings)
print(f"{COLUMNS} columns, {RECORDS} records, {len(found.runs)} runs, Sa({period:.2f} s)")
for name, variance in variances(found.collapse_intensity).items():
    print(f"beta of {name:9s} {np.sqrt(variance):.2f}")
print(f"median drift of 5 %: {np.median(alone.collapse_intensity):.1f} m/s2 for the median column,")
print(f"{np.median(found.collapse_intensity):.1f} m/s2 for all")

# Stripes: all columns and records at four intensities.
levels = np.median(found.collapse_intensity) * np.array([0.4, 0.7, 1.0, 1.4])
stripes = rbsdem.fragility.stripes(columns, records, levels, **settings)
curve = stripes.fragility()
print(f"stripes: {curve.data.failures.tolist()} of {curve.data.number.tolist()} runs collapse")
print(f"theta {curve.theta:.1f} m/s2, beta {curve.beta:.2f}")

if "--no-plot" not in sys.argv:
    ax = plot.fragility(alone.fragility(), label="median column, records only")
    plot.fragility(curve, ax=ax, color="#c0392b", label="uncertain columns")
    with plot.style():
        ax.legend(loc="lower right")
        ax.set_title("")
    plot.save(ax, "uncertain.png")
    print("wrote uncertain.png")
