"""Directions in the space of the parameters, along which a column follows a measured loop best.

A factor f along a direction multiplies each of its parameters by f to an exponent. The directions
were found on a fourth of the flexural rectangular tests, and judged on half of them
(`studies/calibration_directions.py`, docs/calibration.md). They have no meaning of their own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

__all__ = ["DIRECTIONS", "factors"]

DIRECTIONS: dict[str, dict[str, float]] = {
    "direction_1": {
        "steel_strength": -0.07,
        "hardening": 0.19,
        "r0": 0.96,
        "cr1": 0.12,
        "cr2": 0.66,
        "isotropic_hardening": -0.22,
        "fatigue": -0.38,
        "concrete_strength": 0.08,
        "peak_strain": -0.17,
        "confinement": -0.75,
        "core_softening": -0.4,
        "cover_softening": 0.07,
        "compression_length": 0.12,
        "slip_length": -0.28,
        "stiffness": 0.64,
        "shear_stiffness": -0.13,
        "plastic": 1.36,
        "misfit": 0.82,
        "contact": 0.65,
        "wear": 0.14,
        "friction": -0.14,
        "shear_strength": -0.13,
        "shear_endurance": 0.35,
        "shear_decay": 0.1,
        "shear_pinch_force": 0.17,
    },
    "direction_2": {
        "steel_strength": 0.16,
        "hardening": -0.31,
        "r0": 1.09,
        "cr2": -0.19,
        "fatigue": 0.6,
        "peak_strain": 0.11,
        "confinement": -0.2,
        "core_softening": 1.29,
        "cover_softening": -0.29,
        "hinge_length": 0.07,
        "slip_length": 0.2,
        "stiffness": -0.18,
        "shear_stiffness": -0.61,
        "plastic": 0.06,
        "misfit": -0.19,
        "contact": 0.13,
        "wear": 0.64,
        "friction": 0.33,
        "shear_endurance": 0.35,
        "shear_pinch_force": -0.53,
    },
    "direction_3": {
        "hardening": 0.97,
        "cr1": -0.06,
        "cr2": 0.31,
        "isotropic_hardening": 0.17,
        "fatigue": 0.09,
        "confinement": 0.86,
        "cover_softening": -0.17,
        "hinge_length": 0.54,
        "compression_length": -0.34,
        "slip_length": 0.9,
        "stiffness": -0.06,
        "plastic": 0.36,
        "misfit": 0.35,
        "contact": 0.16,
        "wear": -0.35,
        "friction": 0.37,
        "shear_strength": 0.08,
        "shear_endurance": -0.24,
        "shear_pinch_force": -0.7,
    },
    "direction_4": {
        "steel_strength": 0.2,
        "hardening": 0.27,
        "r0": 0.52,
        "isotropic_hardening": -0.15,
        "fatigue": -0.16,
        "confinement": 0.43,
        "core_softening": -0.95,
        "cover_softening": -0.57,
        "hinge_length": -0.63,
        "compression_length": 0.35,
        "slip_length": 0.2,
        "stiffness": 0.53,
        "shear_stiffness": 0.08,
        "plastic": -0.25,
        "misfit": -0.51,
        "contact": -0.08,
        "wear": 0.06,
        "friction": 0.38,
        "shear_strength": -0.17,
        "shear_endurance": 0.34,
        "shear_decay": -0.36,
        "shear_pinch_force": -0.17,
    },
    "direction_5": {
        "steel_strength": 0.08,
        "hardening": -0.12,
        "r0": 0.35,
        "cr1": 0.06,
        "cr2": 0.36,
        "isotropic_hardening": 0.1,
        "fatigue": 0.85,
        "concrete_strength": 0.11,
        "peak_strain": -0.29,
        "confinement": 0.31,
        "core_softening": -0.09,
        "cover_softening": 0.85,
        "hinge_length": -0.07,
        "compression_length": 0.28,
        "slip_length": -0.24,
        "stiffness": -0.55,
        "shear_stiffness": 0.32,
        "plastic": 0.06,
        "misfit": -0.07,
        "contact": 0.11,
        "wear": -0.6,
        "friction": 0.12,
        "shear_strength": -0.07,
        "shear_decay": -0.2,
        "shear_pinch_force": 0.11,
    },
    "direction_6": {
        "hardening": 0.29,
        "cr1": 0.05,
        "cr2": -0.33,
        "isotropic_hardening": 0.21,
        "fatigue": -0.27,
        "concrete_strength": 0.06,
        "confinement": 0.24,
        "core_softening": 0.77,
        "cover_softening": -0.23,
        "hinge_length": -0.45,
        "slip_length": -0.52,
        "stiffness": 0.43,
        "shear_stiffness": 0.25,
        "plastic": 0.26,
        "misfit": -0.1,
        "contact": -0.15,
        "wear": -0.63,
        "friction": 0.17,
        "shear_strength": 0.09,
        "shear_decay": -0.37,
        "shear_pinch_force": 0.13,
    },
}
"""Exponents of the parameters by direction. A factor e is a usual one."""

#: Factors beyond which a parameter does not go, however far along a direction.
ENDS: dict[str, tuple[float, float]] = {
    "steel_strength": (0.7, 1.5),
    "hardening": (0.05, 5.0),
    "r0": (0.2, 5.0),
    "cr1": (0.3, 1.06),
    "cr2": (0.1, 10.0),
    "isotropic_hardening": (0.02, 5.0),
    "fatigue": (0.02, 20.0),
    "concrete_strength": (0.6, 1.7),
    "peak_strain": (0.4, 3.0),
    "confinement": (0.1, 5.0),
    "core_softening": (0.1, 50.0),
    "cover_softening": (0.1, 20.0),
    "hinge_length": (0.2, 4.0),
    "compression_length": (0.3, 3.0),
    "slip_length": (0.1, 5.0),
    "stiffness": (0.2, 4.0),
    "shear_stiffness": (0.05, 5.0),
    "plastic": (0.2, 3.0),
    "misfit": (0.05, 3.0),
    "contact": (0.1, 3.0),
    "wear": (0.05, 8.0),
    "friction": (0.02, 2.2),
    "shear_strength": (0.5, 2.0),
    "shear_softening": (0.1, 10.0),
    "shear_endurance": (0.02, 50.0),
    "shear_decay": (0.02, 10.0),
    "shear_pinch_force": (0.1, 3.0),
}


def factors(along: Mapping[str, float]) -> dict[str, float]:
    """Return the factors of the parameters.

    Parameters
    ----------
    along : mapping of str to float
        Factors along directions, above zero.
    """
    logs: dict[str, float] = {}
    for direction, factor in along.items():
        for name, exponent in DIRECTIONS[direction].items():
            logs[name] = logs.get(name, 0.0) + exponent * math.log(factor)
    return {
        name: min(max(math.exp(value), ENDS[name][0]), ENDS[name][1])
        for name, value in logs.items()
    }
