"""Hostile arguments: every argument of every public call, and values that it is not made for.

A call refuses them by an `InputError`, or takes them where they have a meaning; it never ends in
another exception. A file that is not there is an `OSError`.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import rbsdem
from rbsdem import _arguments, fragility, motions, peer
from rbsdem import curves as comparison
from rbsdem.calibration import free_names, undetermined
from rbsdem.errors import InputError, RbsdemError
from rbsdem.many.runs import RunOptions
from rbsdem.section.parameters import parameters
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Gauge,
    Layered,
    PeakOriented,
    Pinching,
    SteelSpring,
    Takeda,
)

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
BILINEAR = Bilinear(1e8, 1e-3, 1e6)
COLUMN = rbsdem.Column(1.6, 614.4, SPRING, BILINEAR)
STEEL = rbsdem.Steel(400e6, 600e6)
CONCRETE = rbsdem.Concrete(35e6)
TIES = rbsdem.Ties(0.01, 0.08, STEEL)
LAYOUT = rbsdem.Layout(8, 0.02, STEEL)
SECTION = rbsdem.RectangularSection(0.4, 0.4, CONCRETE, layout=LAYOUT, ties=TIES, cover=0.03)
PATH = np.array([0.0, 0.002, -0.002, 0.004])
RESULT = rbsdem.cyclic(COLUMN, displacement=PATH)
TIME = 0.02 * np.arange(50)
SHAKEN = np.sin(9 * TIME)
MOTION = rbsdem.GroundMotion(SHAKEN, 0.02, name="m")
TEST = SimpleNamespace(displacement=RESULT.displacement, force=RESULT.force)
ENSEMBLE = rbsdem.ensemble(COLUMN, MOTION, method="newmark")
LAYERED = rbsdem.cyclic(
    rbsdem.section.column(SECTION, 1.6, axial_load=5e5), displacement=[0.0, 0.01], openings=True
)
COUNTS = fragility.Counts(
    np.array([1.0, 2.0, 3.0]), np.array([[0, 0, 1, 0], [0, 1, 1, 0], [1, 0, 1, 1]]), True
)
FRAGILITY = fragility.fit_fragility("a", COUNTS)
HAZARD = fragility.Hazard([1.0, 2.0], [0.1, 0.01])
UNCERTAIN = fragility.Uncertain(lambda k: COLUMN, {"k": fragility.lognormal(1.0, 0.2)})

CAPPED = {"d_y": 1e-3, "f_y": 1e5, "d_cap": 1e-2, "f_cap": 1.2e5, "d_pc": 0.1}
HISTORY = {"time": TIME, "ground_acceleration": SHAKEN, "dt": 0.02, "method": "newmark"}
MANY = {"method": "newmark", "dt": 0.02, "jobs": 1}

#: Public calls with arguments that are taken, and others that they have.
#: The keywords that a call takes together.
OPTIONS = {f"Unpack[{kind.__name__}]": kind.__annotations__ for kind in (rbsdem.Solver, RunOptions)}

CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "Elastic": (Elastic, {"k": 1e8}),
    "Bilinear": (Bilinear, {"k": 1e8, "d_y": 1e-3, "k_post": 1e6}),
    "Takeda": (
        Takeda,
        {"k_c": 2e8, "d_c": 3e-4, "k_y": 6e7, "d_y": 3e-3, "k_u": 7e6},
    ),
    "PeakOriented": (PeakOriented, CAPPED),
    "Pinching": (Pinching, CAPPED | {"kappa_f": 0.5, "kappa_d": 0.5}),
    "Compression": (Compression, {"k": 1e8}),
    "ConcreteSpring": (
        ConcreteSpring,
        {"k": 1e8, "f_peak": 1e6, "d_peak": 0.02, "k_soft": 1e6},
    ),
    "SteelSpring": (SteelSpring, {"k": 1e8, "f_y": 1e5, "k_post": 1e6}),
    "Layered": (Layered, {"layers": [(-0.1, SPRING), (0.1, SPRING)]}),
    "Spring.response": (BILINEAR.response, {"deformation": PATH}),
    "Spring.split": (BILINEAR.split, {"n": 2}),
    "Damping": (rbsdem.Damping, {"mass": 0.1}),
    "Damping.rayleigh": (
        rbsdem.Damping.rayleigh,
        {"ratio": 0.02, "frequency_1": 1.0, "frequency_2": 5.0},
    ),
    "Footing": (rbsdem.Footing, {"shear": SPRING, "flexure": SPRING}),
    "Column": (rbsdem.Column, {"height": 1.6, "mass": 614.4, "shear": SPRING, "flexure": SPRING}),
    "Column.joints": (COLUMN.joints, {"name": "shear"}),
    "Column.place_of": (COLUMN.place_of, {"joint": 1}),
    "double_curvature": (COLUMN.double_curvature, {}),
    "cyclic": (rbsdem.cyclic, {"column": COLUMN, "displacement": PATH}),
    "cyclic by force": (rbsdem.cyclic, {"column": COLUMN, "force": PATH}),
    "time_history": (rbsdem.time_history, {"column": COLUMN} | HISTORY),
    "modes": (rbsdem.modes, {"column": COLUMN}),
    "matrices": (rbsdem.matrices, {"column": COLUMN}),
    "protocol": (rbsdem.protocol, {"amplitudes": [0.01, 0.02], "cycles": 2}),
    "read_case": (rbsdem.read_case, {"path": "x"}),
    "read_peer": (rbsdem.peer.read_peer, {"path": "x"}),
    "read_test": (rbsdem.read_test, {"path": "x"}),
    "read_result": (rbsdem.read_result, {"path": "x"}),
    "paper_columns": (rbsdem.peer.paper_columns, {}),
    "Result.at": (RESULT.at, {"time": 1}),
    "Result.idealise": (RESULT.idealise, {}),
    "Result.strength_loss": (RESULT.strength_loss, {}),
    "Result.hinge": (RESULT.hinge, {}),
    "Result.envelope": (RESULT.envelope, {}),
    "Result.to_csv": (RESULT.to_csv, {"path": "/nowhere/x.csv"}),
    "Result.save": (RESULT.save, {"path": "/nowhere/x"}),
    "Result.save_state": (RESULT.save_state, {"path": "/nowhere/x"}),
    "compare": (rbsdem.compare, {"result": RESULT, "test": TEST}),
    "envelope": (rbsdem.curves.envelope, {"curve": RESULT}),
    "comparison.energy": (comparison.energy, {"displacement": PATH, "force": PATH}),
    "half_cycles": (comparison.half_cycles, {"displacement": PATH, "force": PATH}),
    "strength_loss": (comparison.strength_loss, {"displacement": PATH, "force": PATH}),
    "secant_stiffness": (comparison.secant_stiffness, {"displacement": PATH, "force": PATH}),
    "turning_points": (comparison.turning_points, {"displacement": PATH}),
    "summarise": (comparison.summarise, {"displacement": PATH, "force": PATH}),
    "resample": (comparison.resample, {"driver": PATH}),
    "displacement_metrics": (
        comparison.displacement_metrics,
        {"force": PATH, "test_displacement": PATH, "model_displacement": PATH},
    ),
    "Concrete": (rbsdem.Concrete, {"fc": 35e6}),
    "Concrete.stress": (CONCRETE.stress, {"strain": PATH}),
    "Steel": (rbsdem.Steel, {"fy": 400e6}),
    "Steel.stress": (STEEL.stress, {"strain": PATH}),
    "Ties": (rbsdem.Ties, {"diameter": 0.01, "spacing": 0.1, "steel": STEEL}),
    "Spiral": (rbsdem.Spiral, {"diameter": 0.01, "spacing": 0.1, "steel": STEEL}),
    "Layout": (rbsdem.Layout, {"number": 8, "diameter": 0.02, "steel": STEEL}),
    "RectangularSection": (
        rbsdem.RectangularSection,
        {
            "width": 0.4,
            "depth": 0.4,
            "concrete": CONCRETE,
            "layout": LAYOUT,
            "ties": TIES,
            "cover": 0.03,
        },
    ),
    "CircularSection": (
        rbsdem.CircularSection,
        {"diameter": 0.4, "concrete": CONCRETE, "layout": LAYOUT, "cover": 0.03},
    ),
    "HollowRectangularSection": (
        rbsdem.RectangularSection,
        {
            "width": 1.0,
            "depth": 1.0,
            "concrete": CONCRETE,
            "layout": LAYOUT,
            "ties": TIES,
            "cover": 0.03,
            "wall": 0.2,
        },
    ),
    "HollowCircularSection": (
        rbsdem.CircularSection,
        {"diameter": 1.0, "concrete": CONCRETE, "layout": LAYOUT, "cover": 0.03, "wall": 0.2},
    ),
    "section.diagram": (rbsdem.section.diagram, {"section": SECTION, "axial_load": 5e5}),
    "section.moment_curvature": (
        rbsdem.section.moment_curvature,
        {"section": SECTION, "curvature": [0.001], "axial_load": 5e5},
    ),
    "section.strains": (
        rbsdem.section.strains,
        {"section": SECTION, "curvature": [0.001], "axial_load": 5e5},
    ),
    "section.interaction": (rbsdem.section.interaction, {"section": SECTION, "points": 5}),
    "codes.code_values": (
        rbsdem.codes.code_values,
        {"section": SECTION, "height": 1.6, "axial_load": 5e5},
    ),
    "section.springs": (
        rbsdem.section.springs,
        {"section": SECTION, "length": 1.6, "axial_load": 5e5},
    ),
    "section.column": (
        rbsdem.section.column,
        {"section": SECTION, "height": 1.6, "axial_load": 5e5},
    ),
    "section.shear_diagram": (
        rbsdem.section.shear_diagram,
        {"section": SECTION, "length": 1.6, "axial_load": 5e5},
    ),
    "section.shear_strength": (
        rbsdem.section.shear_strength,
        {"section": SECTION, "length": 1.6, "axial_load": 5e5},
    ),
    "GroundMotion": (rbsdem.GroundMotion, {"acceleration": SHAKEN, "dt": 0.02}),
    "GroundMotion.scaled": (MOTION.scaled, {"factor": 2.0}),
    "GroundMotion.spectrum": (MOTION.spectrum, {}),
    "GroundMotion.sa": (MOTION.sa, {"period": 0.5}),
    "read_motion": (motions.read_motion, {"path": "x"}),
    "read_motions": (motions.read_motions, {"folder": "x"}),
    "resampled": (motions.resampled, {"motion": MOTION, "dt": 0.01}),
    "corrected": (motions.corrected, {"motion": MOTION}),
    "sequence": (motions.sequence, {"motions": [MOTION, MOTION]}),
    "synthetic": (motions.synthetic, {"n": 1}),
    "ensemble": (rbsdem.ensemble, {"columns": COLUMN, "motions": MOTION} | MANY),
    "ida": (
        rbsdem.ida,
        {"column": COLUMN, "motions": MOTION, "levels": [0.1, 0.2]} | MANY,
    ),
    "stripes": (
        rbsdem.fragility.stripes,
        {"column": COLUMN, "motions": MOTION, "levels": [0.1, 0.2]} | MANY,
    ),
    "cloud": (
        rbsdem.fragility.cloud,
        {"column": COLUMN, "motions": [MOTION] * 1, "scales": [0.1, 0.2, 0.3]} | MANY,
    ),
    "Hunt": (fragility.Hunt, {}),
    "Hazard": (fragility.Hazard, {"intensity": [1.0, 2.0], "frequency": [0.1, 0.01]}),
    "Hazard.frequency_of": (
        HAZARD.frequency_of,
        {"mu": 0.0, "beta": 0.4},
    ),
    "Hazard.exceeded": (HAZARD.exceeded, {"intensity": 1.5}),
    "Fragility.probability": (FRAGILITY.probability, {"intensity": 1.5}),
    "Fragility.samples": (FRAGILITY.samples, {"n": 10}),
    "Fragility.band": (FRAGILITY.band, {"intensity": 1.5, "n": 10}),
    "Fragility.mean_annual_frequency": (FRAGILITY.mean_annual_frequency, {"hazard": HAZARD}),
    "Uncertain.sample": (UNCERTAIN.sample, {"n": 2}),
    "Uncertain.values": (UNCERTAIN.values, {"n": 2}),
    "Ensemble.history": (ENSEMBLE.history, {"run": 0}),
    "GroundMotion.duration": (MOTION.duration, {}),
    "GroundMotion.sa_avg": (MOTION.sa_avg, {"periods": [0.5, 1.0]}),
    "GroundMotion.to_csv": (MOTION.to_csv, {"path": "/nowhere/x"}),
    "Envelope.idealise": (RESULT.envelope().idealise, {}),
    "Result.strains": (LAYERED.strains, {}),
    "Result.layer_deformation": (LAYERED.layer_deformation, {}),
    "net_force": (
        peer.net_force,
        {"displacement": PATH, "force": PATH, "code": 1, "axial_load": 1e5, "length": 1.6},
    ),
    "read_specimens": (peer.read_specimens, {"path": "x"}),
    "section.parameters": (parameters, {}),
    "plot.history": (rbsdem.plot.history, {"result": RESULT}),
    "Uncertain": (
        fragility.Uncertain,
        {"make": lambda k: COLUMN, "variables": {"k": fragility.lognormal(1.0, 0.2)}},
    ),
    "lognormal": (fragility.lognormal, {"median": 1.0, "beta": 0.2}),
    "variance_split": (fragility.variance_split, {"capacity": np.ones((2, 3))}),
    "fit_fragility": (fragility.fit_fragility, {"name": "a", "data": COUNTS}),
    "calibrate": (
        rbsdem.calibrate,
        {"column": COLUMN, "test": TEST, "free": ["flexure.k"], "evaluations": 3},
    ),
    "undetermined": (undetermined, {"column": COLUMN, "test": TEST, "free": ["flexure.k"]}),
    "free_names": (free_names, {"column": COLUMN}),
    "trade": (
        rbsdem.compare_methods,
        {"column": COLUMN, "displacement": PATH, "budget": 0.01},
    ),
    "Gauge": (Gauge, {"part": ("cover",), "length": (0.1,)}),
}


@pytest.mark.parametrize("call", CALLS)
def test_hostile_values_are_refused_or_taken(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some are the name of a file that is written."""
    monkeypatch.chdir(tmp_path)
    function, given = CALLS[call]
    names: list[str] = []
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind == parameter.VAR_KEYWORD:
            names += OPTIONS.get(parameter.annotation, {})
        elif parameter.kind != parameter.VAR_POSITIONAL:
            names.append(name)
    wrong = {}
    for argument in dict.fromkeys([*names, *given]):
        for name, value in HOSTILE.items():
            try:
                function(**given | {argument: value})
            except (RbsdemError, OSError, ImportError):
                pass
            except Exception as error:
                wrong[argument, name] = f"{type(error).__name__}: {error}"[:100]
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
    assert wrong == {}


@pytest.mark.parametrize("name", ["masked", "datetimes", "timedeltas", "bytes", "list of words"])
def test_what_is_no_array_of_numbers(name: str) -> None:
    """It would be read through its mask, or as a count of seconds."""
    with pytest.raises(InputError, match="masked values" if name == "masked" else "array of num"):
        _arguments.vector(HOSTILE[name], "a")


def test_masks_without_a_masked_value_are_taken() -> None:
    values = np.ma.masked_array([0.001, 0.002], [False, False])
    assert _arguments.vector(values, "a").tolist() == [0.001, 0.002]


@pytest.mark.parametrize("value", [np.datetime64(1, "s"), np.timedelta64(1, "s"), True, "1", 1j])
def test_what_is_no_number(value: Any) -> None:
    for kind in (_arguments.number, _arguments.whole):
        with pytest.raises(InputError, match=r"a = .* must be a (whole )?number"):
            kind(value, "a")


def test_a_large_value_is_named_short() -> None:
    """Also where it cannot be written at all, as a whole number of 5000 digits."""
    for value in (10**400, 10**5000):
        with pytest.raises(InputError, match=r"^a = an int is too large$"):
            _arguments.number(value, "a")
