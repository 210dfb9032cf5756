"""Figures of a summary belong to the column and to all steps.

They do not change with springs that cannot matter, nor with the rows that are kept.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem

#: A shear spring whose softening follows the work of the hinge of its joint.
SHEAR = rbsdem.PeakOriented(
    d_y=5e-4, f_y=6e4, d_cap=6e-3, f_cap=7.5e4, d_pc=4e-2, lambda_h=2.0, s_min=0.2
)
FLEXURE = rbsdem.Bilinear(k=6.3e7, d_y=1.5e-3, k_post=2e6)
PATH = 1.6 * rbsdem.protocol([0.005, 0.01, 0.015, 0.02], cycles=3, points=10)
TIME = np.arange(0.0, 1.0, 0.01)
MOTION = 9.0 * np.sin(2 * np.pi * 3.0 * TIME) * np.sin(np.pi * TIME)

#: Analyses, by what they are called with.
ANALYSES = {
    "static": {},
    "rk4": {"method": "rk4", "dt": 2e-4},
    "located": {"method": "rk4", "dt": 2e-4, "events": "located"},
    "rk45": {"method": "rk45", "tolerance": 1e-8},
    "newmark": {"method": "newmark", "dt": 1e-3},
    "hht": {"method": "hht", "dt": 1e-3},
}
KINEMATICS = ("small", "pdelta", "finite")


def column(n: int = 2, **more) -> rbsdem.Column:
    return rbsdem.Column(1.6, 2e4, SHEAR, FLEXURE, n=n, **more)


def solve(analysis: str, subject: rbsdem.Column, **more) -> rbsdem.Result:
    if analysis == "static":
        return rbsdem.cyclic(subject, displacement=PATH, **more)
    return rbsdem.time_history(
        subject, TIME, ground_acceleration=MOTION, **ANALYSES[analysis], **more
    )


@pytest.mark.parametrize("kinematics", KINEMATICS)
@pytest.mark.parametrize("analysis", ANALYSES)
def test_axial_springs_that_stay_still_change_nothing(analysis, kinematics):
    """Without axial load they feel nothing with small rotations; else they open by F theta/k.

    That is 1e5 N times 0.02 over 1e10 N/m, 1e-7 m of slips of 1e-2 m.
    """
    subject = {"kinematics": kinematics}
    plain = solve(analysis, column(**subject))
    inert = solve(analysis, column(axial_spring=rbsdem.Elastic(1e10), **subject))
    exact = kinematics != "finite" and analysis != "rk45"
    close = {"rel": 1e-12 if exact else 1e-3}
    for name in ("peak_displacement", "peak_base_shear", "peak_rotation", "spring_energy"):
        assert inert.summary[name] == pytest.approx(plain.summary[name], **close), name
    assert inert.summary["spring_energy"] > 1e3
    if exact:
        assert inert.summary["events"] == plain.summary["events"]
