"""Hostile arguments: every argument of every public call, and values that it is not made for.

A call refuses them by an `InputError`, or takes them where they have a meaning; it never ends in
another exception. A file that is not there is an `OSError`.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from samples import SECTION, STEEL
from strategies import GOOD

import rbsdem
from rbsdem import _arguments, calibration, curves, fragility, motions, peer
from rbsdem.errors import InputError, RbsdemError
from rbsdem.many.runs import RunOptions
from rbsdem.model.springs import SPRINGS
from rbsdem.springs import Bilinear, Elastic, Gauge

pytestmark = pytest.mark.filterwarnings("ignore")


class Refuses:
    """An object that takes no part in anything."""

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)


#: Values of every kind that an argument may be given by mistake.
HOSTILE: dict[str, Any] = {
    "True": True,
    "-1": -1,
    "0": 0,
    "nan": float("nan"),
    "inf": float("inf"),
    "1e308": 1e308,
    "10**400": 10**400,
    "-10**400": -(10**400),
    "2**31-1": 2**31 - 1,
    "1j": 1j,
    "Fraction": Fraction(1, 3),
    "word": "no such word",
    "empty word": "",
    "zero byte": "a\0b",
    "surrogate": "\udcff",
    "bytes": b"1.0",
    "empty list": [],
    "list": [1.0],
    "ragged": [1.0, [2.0, 3.0]],
    "list of words": ["a", "b"],
    "list of None": [None],
    "list of 10**400": [10**400, 1.0],
    "dict": {},
    "dict of numbers": {1: 2},
    "set": {1.0},
    "generator": iter(()),
    "object": object(),
    "refuses": Refuses(),
    "class": rbsdem.Column,
    "function": len,
    "module": rbsdem,
    "namespace": SimpleNamespace(time=1, acceleration="x", height=None),
    "array": np.array([1.0, 2.0]),
    "array of one": np.array([1.0]),
    "matrix": np.ones((2, 2)),
    "no dimension": np.array(1.0),
    "masked": np.ma.masked_array([0.001, 1e9], [False, True]),
    "datetime": np.datetime64("2020-01-01"),
    "datetimes": np.array(["2020-01-01", "2020-01-02"], dtype="datetime64[s]"),
    "timedeltas": np.array([1, 2], dtype="timedelta64[s]"),
    "objects": np.array([object()], dtype=object),
    "record array": np.zeros(2, dtype=[("a", float)]),
    "column": rbsdem.peer.paper_columns()["zahn_7"],
    "/dev/zero": "/dev/zero",
    "folder": "/",
    "spring": Elastic(1e8),
}

SPRING = Elastic(1e8)
COLUMN = rbsdem.Column(1.6, 614.4, SPRING, Bilinear(1e8, 1e-3, 1e6))
PATH = np.array([0.0, 0.002, -0.002, 0.004])
RESULT = rbsdem.cyclic(COLUMN, displacement=PATH)
MOTION = rbsdem.GroundMotion(np.sin(0.18 * np.arange(50)), 0.02, name="m")
MANY = {"method": "newmark", "dt": 0.02, "jobs": 1}
COUNTS = fragility.Counts(
    np.array([1.0, 2.0, 3.0]), np.array([[0, 0, 1, 0], [0, 1, 1, 0], [1, 0, 1, 1]]), True
)

#: Of few strips: what is asked of it hundreds of times need not be exact.
COARSE = replace(SECTION, strips=40)
#: What arguments of these names take.
USUAL: dict[str, Any] = {
    "acceleration": MOTION.acceleration, "amplitudes": [0.01, 0.02], "area": 1e-4,
    "axial_load": 5e5, "beta": 0.2, "capacity": np.ones((2, 3)), "code": 1, "column": COLUMN,
    "columns": COLUMN, "concrete": SECTION.concrete, "curvature": [0.001], "curve": RESULT,
    "data": COUNTS, "deformation": PATH, "depth": 0.4, "diameter": 0.01, "displacement": PATH,
    "driver": PATH, "dt": 0.01, "factor": 2.0, "fc": 35e6, "flexure": SPRING, "folder": "x",
    "force": PATH, "free": ["flexure.k"], "frequencies": [0.1, 0.01], "frequency_1": 1.0,
    "frequency_2": 5.0, "fy": 400e6, "hazard": fragility.Hazard([1.0, 2.0], [0.1, 0.01]),
    "height": 1.6, "intensities": [1.0, 2.0],
    "intensity": [1.0, 2.0], "joint": 1, "layers": [(-0.1, SPRING), (0.1, SPRING)],
    "length": 1.6, "levels": [0.1, 0.2], "make": lambda k: COLUMN, "mass": 614.4, "median": 1.0,
    "model_displacement": PATH, "motion": MOTION, "motions": MOTION, "mu": 0.0, "n": 2, "name": "a",
    "number": 8, "path": "/nowhere/x", "period": 0.5, "periods": [0.5, 1.0], "ratio": 0.02,
    "result": RESULT, "run": 0, "section": COARSE, "shear": SPRING, "spacing": 0.08,
    "steel": STEEL, "strain": PATH, "test": SimpleNamespace(displacement=PATH, force=RESULT.force),
    "test_displacement": PATH, "time": 1.0,
    "width": 0.4,
}  # fmt: skip
#: Objects whose methods are called.
OBJECTS = {
    "bilinear": COLUMN.flexure, "case": COLUMN, "damping": rbsdem.Damping, "result": RESULT,
    "concrete": SECTION.concrete, "steel": STEEL, "motion": MOTION, "hazard": USUAL["hazard"],
    "curve": RESULT.envelope(), "fragility": fragility.fit_fragility("a", COUNTS),
    "ensemble": rbsdem.ensemble(COLUMN, MOTION, method="newmark"),
    "layered": rbsdem.cyclic(
        rbsdem.section.column(SECTION, 1.6, axial_load=5e5), displacement=[0.0, 0.01],
        openings=True,
    ),
}  # fmt: skip
ROUND = {"diameter": 0.4, "layout": rbsdem.Layout(8, 0.02, STEEL), "cover": 0.03}
#: Arguments of calls beside those that they must have, or in their place.
OWN: dict[str, dict[str, Any]] = {
    "rbsdem.CircularSection": ROUND,
    "rbsdem.RectangularSection": {"layout": SECTION.layout, "ties": SECTION.ties, "cover": 0.03},
    "rbsdem.compare_methods": {"displacement": PATH[:2], "repeats": 1},
    "rbsdem.cyclic": {"displacement": PATH},
    "rbsdem.ensemble": MANY,
    "rbsdem.ida": {"levels": [0.1, 0.2]} | MANY,
    "rbsdem.calibrate": {"evaluations": 3},
    "rbsdem.read_test": {"path": "d_mm,F_kN\n0,0\n10,90\n-10,-90\n", "pdelta_code": 2},
    "rbsdem.section.diagram": {"points": 5},
    "rbsdem.section.interaction": {"points": 5},
    "rbsdem.time_history": {"ground_acceleration": MOTION, "dt": 0.02, "method": "newmark"},
    "fragility.stripes": {"levels": [0.1, 0.2]} | MANY,
    "motions.sequence": {"motions": [MOTION, MOTION]},
    "objects.fragility.band": {"n": 20},
    "objects.fragility.probability": {"intensity": 1.5},
    "objects.case.joints": {"name": "shear"},
    "objects.result.at": {"time": 1.0},
    "objects.hazard.exceeded": {"intensity": 1.5},
    "objects.motion.scaled": {"factor": 2.0},
}
CALLS = """
rbsdem.CircularSection rbsdem.Column rbsdem.Concrete rbsdem.Damping rbsdem.Footing
rbsdem.GroundMotion rbsdem.Layout rbsdem.RectangularSection rbsdem.Spiral rbsdem.Steel rbsdem.Ties
rbsdem.calibrate rbsdem.compare rbsdem.compare_methods rbsdem.cyclic rbsdem.ensemble rbsdem.ida
rbsdem.matrices rbsdem.modes rbsdem.protocol rbsdem.read_case rbsdem.read_result rbsdem.read_test
rbsdem.time_history rbsdem.codes.code_values rbsdem.plot.history rbsdem.section.column
rbsdem.section.diagram rbsdem.section.interaction rbsdem.section.parameters
rbsdem.section.moment_curvature rbsdem.section.shear_diagram rbsdem.section.shear_strength
rbsdem.section.springs rbsdem.section.strains calibration.free_names
curves.displacement_metrics curves.energy curves.envelope curves.half_cycles curves.resample
curves.secant_stiffness curves.strength_loss curves.summarise curves.turning_points
fragility.Hazard fragility.CollapseSearch fragility.fit_fragility fragility.stripes
motions.corrected motions.read_motion motions.read_motions motions.resampled motions.sequence
motions.synthetic peer.net_force peer.paper_columns peer.read_peer peer.read_specimens
objects.bilinear.response objects.bilinear.split objects.case.joints objects.case.index_of
objects.case.double_curvature objects.concrete.stress objects.curve.idealise
objects.damping.rayleigh objects.ensemble.history
objects.fragility.band objects.fragility.mean_annual_frequency objects.fragility.probability
objects.fragility.samples objects.hazard.exceeded objects.hazard.frequency_of
objects.layered.layer_deformation objects.layered.strains objects.motion.duration objects.motion.sa
objects.motion.sa_avg objects.motion.scaled objects.motion.spectrum objects.motion.to_csv
objects.result.at objects.result.envelope objects.result.hinge objects.result.idealise
objects.result.save objects.result.save_state objects.result.strength_loss objects.result.to_csv
objects.steel.stress
"""
ROOMS = SimpleNamespace(
    rbsdem=rbsdem, calibration=calibration, curves=curves, fragility=fragility, motions=motions,
    peer=peer, objects=SimpleNamespace(**OBJECTS),
)  # fmt: skip
#: The keywords that a call takes together.
OPTIONS = {f"Unpack[{kind.__name__}]": kind.__annotations__ for kind in (rbsdem.Solver, RunOptions)}


def refused_otherwise(function: Callable[..., Any], own: dict[str, Any]) -> dict[Any, str]:
    """Return the arguments and values that end in another exception than they should."""
    names, given = [], dict(own)
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind == parameter.VAR_KEYWORD:
            names += OPTIONS.get(str(parameter.annotation), {})
        elif parameter.kind != parameter.VAR_POSITIONAL:
            names.append(name)
            if parameter.default is parameter.empty and name not in given:
                given[name] = USUAL[name]
    wrong = {}
    if not {"path", "folder"} & set(given):
        function(**given)
    for argument in dict.fromkeys([*names, *given]):
        for name, value in HOSTILE.items():
            try:
                function(**given | {argument: value})
            except (RbsdemError, OSError, ImportError):
                pass
            except Exception as error:
                wrong[argument, name] = f"{type(error).__name__}: {error}"[:100]
    return wrong


@pytest.mark.parametrize("call", CALLS.split())
def test_hostile_values_are_refused_or_taken(call, tmp_path, monkeypatch):
    """Some are the name of a file that is written."""
    monkeypatch.chdir(tmp_path)
    assert refused_otherwise(attrgetter(call)(ROOMS), OWN.get(call, {})) == {}
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.mark.parametrize("rule", SPRINGS)
def test_hostile_parameters_of_springs(rule):
    assert refused_otherwise(SPRINGS[rule], GOOD.get(rule, {})) == {}


@pytest.mark.parametrize(
    ("kind", "own"),
    [
        (Gauge, {"part": ("cover",), "length": (0.1,)}),
        (rbsdem.RectangularSection, {
            "width": 1.0, "depth": 1.0, "layout": SECTION.layout, "cover": 0.03, "wall": 0.2,
        }),
        (rbsdem.CircularSection, ROUND | {"diameter": 1.0, "wall": 0.2}),
        (rbsdem.cyclic, {"force": PATH}),
    ],
    ids=["gauge", "hollow rectangle", "hollow circle", "path of forces"],
)  # fmt: skip
def test_hostile_values_of_other_forms(kind, own):
    assert refused_otherwise(kind, own) == {}


@pytest.mark.parametrize("name", ["masked", "datetimes", "timedeltas", "bytes", "list of words"])
def test_what_is_no_array_of_numbers(name: str) -> None:
    """It would be read through its mask, or as a count of seconds."""
    with pytest.raises(InputError, match="array of numbers"):
        _arguments.vector(HOSTILE[name], "a")


def test_masks_without_a_masked_value_are_taken() -> None:
    values = np.ma.masked_array([0.001, 0.002], [False, False])
    assert _arguments.vector(values, "a").tolist() == [0.001, 0.002]


@pytest.mark.parametrize("value", [np.datetime64(1, "s"), np.timedelta64(1, "s"), True, "1", 1j])
def test_what_is_no_number(value: Any) -> None:
    for kind in (_arguments.number, _arguments.integer):
        with pytest.raises(InputError, match=r"a = .* must be a (whole )?number"):
            kind(value, "a")


def test_a_large_value_is_named_short() -> None:
    """Also where it cannot be written at all, as a whole number of 5000 digits."""
    for value in (10**400, 10**5000):
        with pytest.raises(InputError, match=r"^a = an int is too large$"):
            _arguments.number(value, "a")
