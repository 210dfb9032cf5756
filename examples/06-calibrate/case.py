"""The flexural spring of a tested column, fitted to the measured loop.

    python examples/06-calibrate/case.py [--no-plot]

The full history is taken from the folder that RBSDEM_PEER_DIR names; without it, the reversal
points that come with rbsdem are used, which show the strength but little of the loop between them.
"""

import sys
import warnings

import rbsdem
from rbsdem.peer import find_history, read_peer, shipped_reversals

KEY = "tanaka_park_1"

column = rbsdem.peer.paper_columns("pdelta")[KEY]
history = find_history(KEY)
test = read_peer(history) if history else shipped_reversals(KEY)
print(f"{len(test.force)} points of {test.name}\n")

with warnings.catch_warnings(record=True) as notes:  # the report has them too
    warnings.simplefilter("always")
    fit = rbsdem.calibrate(
        column,
        test,
        free=[f"flexure.{name}" for name in ("k_c", "k_y", "d_y", "k_u", "b0")],
        bounds={"flexure.b0": (0.0, 0.8)},
    )
print(fit.report)

(spring,) = fit.column.joints("flexure")
assert isinstance(spring, rbsdem.springs.Takeda)
print(f"\nyield moment {spring.k_c * spring.d_c + spring.k_y * (spring.d_y - spring.d_c):.4g} N m")

if "--no-plot" not in sys.argv:
    axes = rbsdem.plot.calibration(fit)
    rbsdem.plot.save(axes, "calibrate.png")
    print("wrote calibrate.png")
