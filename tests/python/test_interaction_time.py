"""Layered joints under an axial load that varies, in time.

Their layers change their lines at the ends of steps: the responses of an explicit and an implicit
method, which are independent of each other, tend to the same one. Steps that stop at events are for
springs under a constant axial load.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Layered

TIME = np.linspace(0, 0.5, 51)
LOAD = 3e5 + 2e5 * np.sin(6.2 * np.pi * TIME)
GROUND = 8 * np.sin(4 * np.pi * TIME) * np.minimum(TIME / 0.3, 1)
LIFT = 5 * np.sin(9 * np.pi * TIME)


def joint(share: float = 1.0, k_post: float = 2e7) -> Layered:
    """Return a joint of three pairs of bilinear layers."""
    pairs = ((0.18, 4e-4), (0.11, 5e-4), (0.04, 6e-4))
    return Layered(
        [
            (side * y, Bilinear(k=2.5e8 * share, d_y=d_y, k_post=k_post * share))
            for y, d_y in pairs
            for side in (1, -1)
        ]
    )


def column(n: int, kinematics: str) -> rbsdem.Column:
    """Return a cantilever with layered joints."""
    joints = [joint(), joint(0.8)][:n]
    return rbsdem.Column(1.5, 2e4, Elastic(4e7), joints, n=n, kinematics=kinematics, axial_load=3e5)


def run(
    about: rbsdem.Column, load: np.ndarray = LOAD, lift: np.ndarray | None = None, **options: object
) -> rbsdem.Result:
    """Return the response to the ground motion and the axial load."""
    return rbsdem.time_history(
        about,
        TIME,
        ground_acceleration=GROUND,
        axial_load=load,
        vertical_acceleration=lift,
        **options,
    )


def distance(one: rbsdem.Result, other: rbsdem.Result) -> float:
    """Return the largest difference of the displacements over the largest of them."""
    return float(
        np.abs(one.displacement - other.displacement).max() / np.abs(other.displacement).max()
    )


CASES = [(1, "pdelta", None), (2, "pdelta", LIFT), (2, "small", None), (1, "finite", LIFT)]


@pytest.mark.parametrize(("n", "kinematics", "lift"), CASES)
def test_explicit_and_implicit_steps_tend_to_one_response(
    n: int, kinematics: str, lift: np.ndarray | None
) -> None:
    """A quarter of the step, a quarter of the distance or less, and of the error of the energy."""
    about = column(n, kinematics)
    distances, balances = [], []
    for dt in (5e-4, 1.25e-4, 3.125e-5):
        found = run(about, lift=lift, method="rk4", dt=dt)
        distances.append(distance(found, run(about, lift=lift, method="newmark", dt=dt)))
        balances.append(found.summary["relative_energy_residual"])
    assert found.summary["events"] >= 12
    assert distances[-1] < 1e-3
    assert distances[-1] < distances[0] / 4
    assert balances[-1] < balances[0] / 4


@pytest.mark.parametrize("settings", [{"method": "rk4", "events": "located"}, {"method": "rk45"}])
def test_steps_that_stop_at_events_are_refused(settings: dict[str, str]) -> None:
    about = column(1, "pdelta")
    with pytest.raises(rbsdem.InputError, match="layers of a joint whose axial load varies; use"):
        run(about, **settings)
    assert run(about).summary["method"] == "rk4"
    assert run(column(1, "finite")).summary["method"] in ("rk4", "generalised_alpha")


def test_layers_that_fail_end_the_run_at_that_time() -> None:
    """Plastic layers fail where N(t) reaches the sum of their yield forces, within a step."""
    pairs = [(y, Bilinear(k=1e8, d_y=1e-3, k_post=0.0)) for y in (-0.1, 0.1)]
    about = rbsdem.Column(1.5, 2e4, Elastic(4e7), Layered(pairs), kinematics="small")
    load = np.linspace(0, 3e5, TIME.size)
    for method in ("rk4", "newmark"):
        lost = rbsdem.time_history(about, TIME, axial_load=load, method=method, dt=1e-4)
        assert lost.summary["status"] == "axial_failure"
        assert lost.time[-1] == pytest.approx(0.5 * 2 / 3, abs=2e-4)


def test_a_spring_in_equilibrium_on_its_yield_line_does_not_chatter() -> None:
    """Where a spring at rest has no acceleration but round-off, a step ends.

    The sign of that round-off is another one on either side of the end of a line; the steps
    became ever shorter.
    """
    about = rbsdem.Column(
        1.6,
        2e4,
        Elastic(7e8),
        Elastic(1e8),
        n=3,
        kinematics="finite",
        axial_spring=Bilinear(k=3e9, d_y=1e-4, k_post=1e9),
    )
    load = np.interp(TIME, [0, 0.1, 0.2, 0.3, 0.4, 0.5], np.array([36, -4, 4, -9, 46, 17]) * 1e4)
    found = rbsdem.time_history(
        about, TIME, ground_acceleration=GROUND, axial_load=load, method="rk4", events="located"
    )
    assert found.summary["status"] == "completed"
    assert found.summary["cut_steps"] < 200


@pytest.mark.parametrize("method", [{"method": "rk4", "events": "located"}, {"method": "rk45"}])
def test_a_layered_joint_at_rest_begins_to_move(method: dict[str, str]) -> None:
    """A ground motion that begins at zero: the moment at rest is round-off, as is its sign."""
    bars = rbsdem.Layout(12, 0.016, rbsdem.Steel(446e6, 702e6))
    ties = rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6), legs=4)
    section = rbsdem.RectangularSection(
        0.4, 0.4, rbsdem.Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
    )
    about = dataclasses.replace(
        rbsdem.section.column(section, 1.6, axial_load=744e3), top_mass=75.9e3
    )
    time = np.linspace(0, 0.06, 4)
    found = rbsdem.time_history(about, time, ground_acceleration=[0, 2e-5, 2e-4, 6e-4], **method)
    assert found.summary["status"] == "completed"
    assert found.displacement[-1] < 0
