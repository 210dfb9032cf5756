"""Incremental dynamic analysis of a column, and its fragility curves.

    python examples/08-ida/case.py [--no-plot]

Ten synthetic records; the same by the command: rbsdem ida case.nml synthetic:10
"""

import sys
from pathlib import Path

import export
import numpy as np

import rbsdem
from rbsdem import fragility, motions, plot

case = rbsdem.read_case(Path(__file__).with_name("case.nml"))
records = motions.synthetic(10)
found = rbsdem.ida(case.column, records, intensity="sa_t1", method="newmark")

print(f"{found.runs.measure.label}, {len(found.runs)} runs")
for record, value in zip(records, found.collapse_intensity[0], strict=True):
    print(f"{record.name}  collapse at {value:6.2f} m/s2")

limits = {"yield": ("first_yield", None), "1 % drift": 0.01, "collapse": ("collapse", None)}
curves = found.fragilities(limits)
hazard = fragility.Hazard([0.5, 1, 2, 5, 10, 20], [0.1, 0.04, 0.012, 2e-3, 3e-4, 2e-5])
print()
for name, curve in curves.items():
    rate = curve.mean_annual_frequency(hazard)
    print(f"{name:10s} theta {curve.theta:5.2f} m/s2  beta {curve.beta:.2f}  {rate:.1e} a year")

# A cloud of the same column: a straight line through ln(drift) over ln(Sa), without collapses.
scales = [0.1, 0.2, 0.4, 0.8]
rows = rbsdem.ensemble(
    case.column, records, scales=scales, method="newmark", collapse_drift=0.1
).to_pandas()
period = 1 / rbsdem.modes(case.column).frequency[0]
sa = rows["scale"] * [records[int(name[-2:]) - 1].sa(period) for name in rows["motion"]]
standing = rows["status"] == "completed"
x, y = np.log(sa[standing]), np.log(rows["peak_drift"][standing])
slope, intercept = np.polyfit(x, y, 1)
scatter = np.std(y - intercept - slope * x, ddof=2)
print(f"\ncloud of {standing.sum()} runs: drift = {np.exp(intercept):.2g} Sa^{slope:.2f}")
theta = np.exp((np.log(0.01) - intercept) / slope)
print(f"1 % drift: theta {theta:.2f} m/s2, beta {scatter / slope:.2f}")

if "--no-plot" not in sys.argv:
    plot.save(plot.ida(found), "ida.png")
    plot.save(plot.fragilities(curves), "fragility.png")
    export.write_nrml("pier.xml", curves, found.runs.measure, "pier")
    export.write_pelicun("pier.csv", curves, found.runs.measure, "pier")
    print("wrote ida.png, fragility.png, pier.xml, pier.csv")
