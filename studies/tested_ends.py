"""Double-curvature tests as cantilevers and as they were built: the numbers of docs/peer.md.

    python studies/tested_ends.py FOLDER

FOLDER holds the histories and the table of the tests. Each is computed as the equivalent cantilever
and with a hinge and a shear spring at both ends (`rbsdem.peer.column`, ends="tested"), along the
measured displacement.
"""

from __future__ import annotations

import sys
import warnings

import numpy as np

import rbsdem
from rbsdem import peer

warnings.simplefilter("ignore")
rows = []
for specimen in peer.read_specimens(sys.argv[1]).with_history():
    if specimen.config != "DC":
        continue
    test = specimen.test()
    half, whole = (peer.column(specimen, ends=ends) for ends in ("equivalent", "tested"))
    one = rbsdem.cyclic(half, displacement=test.displacement)
    both = rbsdem.cyclic(whole, displacement=2 * test.displacement)
    apart = float(np.abs(both.force - one.force).max() / np.abs(one.force).max())
    slips = np.abs(both.slip[:, [0, -1]]).max(axis=0)
    loops = [(test.displacement, result.force) for result in (one, both)]
    scores = [rbsdem.compare(loop, test).nrmse for loop in loops]
    rows.append((apart, specimen.name, *slips, *scores))
rows.sort(key=lambda row: -row[0])
print("| test | forces apart | slip at foot, mm | at top, mm | nrmse, equivalent | tested |")
print("| --- " * 6 + "|")
other = [row for row in rows if row[0] > 1e-5]
for apart, name, foot, top, *scores in other:
    cells = (f"{apart:.2g}", f"{1e3 * foot:.1f}", f"{1e3 * top:.1f}", *(f"{s:.3f}" for s in scores))
    print(f"| {name} | {' | '.join(cells)} |")
means = [float(np.mean([row[place] for row in other])) for place in (4, 5)]
print(f"{len(other)} of {len(rows)} differ; mean nrmse {means[0]:.3f} and {means[1]:.3f}")
