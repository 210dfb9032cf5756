"""What the rooms refuse, by `refusals.txt`: what no file says, and what no key says by itself."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from samples import SECTION, SPECIMEN, STEEL

import rbsdem
from rbsdem import calibration, codes, curves, fragility, peer, plot
from rbsdem.section import shear, strength
from rbsdem.section.parameters import parameters
from rbsdem.springs import (
    Compression,
    ConcreteSpring,
    Elastic,
    Gauge,
    Layered,
    PeakOriented,
)

C30 = rbsdem.Concrete(30e6)
COLUMN = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
PATH = 1.6 * rbsdem.protocol([0.002, 0.005, 0.01], points=6)
TIME = 0.02 * np.arange(50)
MOTION = rbsdem.GroundMotion(np.sin(9 * TIME), 0.02, name="m")
LAYERED = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
BOX = {
    "layout": rbsdem.Layout(40, 0.025, STEEL, face=9),
    "inner_layout": rbsdem.Layout(28, 0.02, STEEL, face=6),
    "ties": rbsdem.Ties(0.012, 0.1, STEEL, legs=4),
    "cover": 0.04,
    "wall": 0.4,
}


def counts(level: list, number: list, failures: list) -> fragility.Fragility:
    failed = np.full((len(level), max(number)), np.nan)
    for i, (n, k) in enumerate(zip(number, failures, strict=True)):
        failed[i, :n] = np.arange(n) < k
    return fragility.fit_fragility("x", fragility.Counts(np.array(level, float), failed, False))


def capacities(low: list, high: list) -> fragility.Fragility:
    return fragility.fit_fragility("x", fragility.Capacities(np.array(low), np.array(high)))


def column(**given: object) -> rbsdem.Column:
    plain = {"height": 2.0, "mass": 9.0, "shear": Elastic(1e8), "flexure": Elastic(1e8)}
    return rbsdem.Column(**plain | given)


def moved(**given: object) -> rbsdem.Result:
    """Move a column; what is none of its fields goes to the analysis."""
    names = ("time", "force", "ground_acceleration", "initial")
    loads = {"time": [0.0, 1.0], "method": "rk4"}
    loads |= {name: given.pop(name) for name in names if name in given}
    if len(loads) == 2:
        loads["force"] = np.zeros(np.size(loads["time"]))
    return rbsdem.time_history(column(**given), **loads)


def broken(result: rbsdem.Result) -> float:
    raise KeyError(result.summary["status"])


#: What the lines may name besides what `import rbsdem` brings.
NAMES = {name: getattr(rbsdem, name) for name in rbsdem.__all__} | {
    "BOX": BOX,
    "BLOCKS": Layered([(y, ConcreteSpring(2e9, 1e6, 8e-4, 1e8)) for y in (-0.2, 0.0, 0.2)]),
    "C30": C30,
    "CONTACTS": Layered([(-0.2, Compression(1e9)), (0.2, Compression(1e9))]),
    "E": Elastic(1e8),
    "COLUMN": COLUMN,
    "broken": broken,
    "CURVE": capacities([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
    "Envelope": curves.Envelope,
    "GOOD": [0.0, 1.0, 2.0],
    "Gauge": Gauge,
    "IDA": rbsdem.ida(COLUMN, MOTION, levels=[1e-4], method="newmark", dt=0.02),
    "LAYERED": LAYERED,
    "LAYERED_RESULT": rbsdem.cyclic(LAYERED, displacement=[0.0, 0.001], openings=True),
    "MOTION": MOTION,
    "PAIR": Layered([(-0.1, Elastic(1e9)), (0.1, Elastic(1e9))]),
    "PATH": PATH,
    "RESULT": rbsdem.cyclic(COLUMN, displacement=PATH),
    "SECTION": SECTION,
    "SPECIMEN": SPECIMEN,
    "SPRINGS": rbsdem.section.springs(SECTION, 1.6, 1e6, yield_rule="first"),
    "STEEL": STEEL,
    "WORKED": curves.Envelope(1, np.array([0.0, 0.06]), np.array([0.0, 2e5])),
    "array": np.array,
    "box": lambda **more: rbsdem.RectangularSection(2.0, 3.0, C30, **BOX | more),
    "calibration": calibration,
    "capacities": capacities,
    "capped": lambda **more: PeakOriented(
        **{"d_y": 1.0, "f_y": 100.0, "d_cap": 3.0, "f_cap": 120.0, "d_pc": 12.0} | more
    ),
    "codes": codes,
    "column": column,
    "counts": counts,
    "curves": curves,
    "drawn": lambda **more: replace(SECTION, **{"bars": ()} | more),
    "ensemble": lambda **more: rbsdem.ensemble(**{"columns": COLUMN, "motions": MOTION} | more),
    "fit": lambda **more: rbsdem.calibrate(
        **{"column": COLUMN, "test": (PATH, PATH), "free": ["flexure.k_y"]} | more
    ),
    "fragility": fragility,
    "ida": lambda motions=MOTION, **more: rbsdem.ida(
        **{"column": COLUMN, "motions": motions, "method": "newmark"} | more
    ),
    "inf": math.inf,
    "moved": moved,
    "nan": math.nan,
    "parameters": parameters,
    "peer": peer,
    "plot": plot,
    "replace": replace,
    "row": lambda **more: replace(SPECIMEN, **more),
    "section": rbsdem.section,
    "shear": shear,
    "strength": strength,
}
TEXT = Path(__file__).with_name("refusals.txt").read_text("utf-8")
LINES = [line for line in TEXT.splitlines() if line and not line.startswith("#")]


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize("line", LINES)
def test_refusal(line: str) -> None:
    """Words that stand apart in a message are parted by three points."""
    call, words = line.split(" => ")
    with pytest.raises(rbsdem.InputError) as caught:
        eval(call, dict(NAMES))
    for part in words.split(" ... "):
        assert part in str(caught.value)
