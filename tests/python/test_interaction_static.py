"""Static paths under a varying axial load with exact rotations, and with axial springs.

Expected values are closed forms of elastic columns, equilibrium on the deformed column, and the
solver for a constant axial load, which is another one.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Layered

HEIGHT, K_V, K_M, RATIO = 1.5, 4e7, 5e6, 1.5
WIDE = np.array([0.2, -0.3, 0.6, 0.9, 1.2, 0.1])
LOAD = np.array([3e5, 2e5, 6e5, -1e5, 3e5, 1e5])


def joint(share: float = 1.0) -> Layered:
    """Return a joint of three pairs of bilinear layers."""
    pairs = ((0.18, 1e-3), (0.11, 1.3e-3), (0.04, 0.9e-3))
    return Layered(
        [
            (side * y, Bilinear(k=2.5e8 * share, d_y=d_y, k_post=5e6 * share))
            for y, d_y in pairs
            for side in (1, -1)
        ]
    )


def chain(kinematics: str, **fields: object) -> rbsdem.Column:
    """Return two bodies with layered joints and, unless told otherwise, axial springs."""
    given = {"axial_spring": Bilinear(k=3e9, d_y=1e-4, k_post=1e9)} | fields
    return rbsdem.Column(
        HEIGHT,
        2e4,
        [Elastic(4e7), Elastic(3e7)],
        [joint(), joint(0.8)],
        n=2,
        lengths=[0.8, 0.7],
        kinematics=kinematics,
        axial_load=3e5,
        **given,
    )


@pytest.mark.parametrize("load", [None, LOAD])
def test_an_elastic_body_with_exact_rotation(load: np.ndarray | None) -> None:
    """The moment about the joint is F l cos(phi) + N l sin(phi), with N = N_0 + r F."""
    column = rbsdem.Column(
        HEIGHT,
        600.0,
        Elastic(K_V),
        Elastic(K_M),
        kinematics="finite",
        axial_load=3e5,
        axial_force_ratio=RATIO,
    )
    result = rbsdem.cyclic(column, displacement=WIDE, axial_load=load)
    force, turn = result.force, result.rotation[:, 0]
    press = (3e5 if load is None else load) + RATIO * force
    about = force * HEIGHT * np.cos(turn) + press * HEIGHT * np.sin(turn)
    np.testing.assert_allclose(K_M * turn, about, rtol=1e-12)
    np.testing.assert_allclose(force / K_V + HEIGHT * np.sin(turn), WIDE, rtol=1e-12)
    assert result.summary["relative_energy_residual"] < 1e-10


def test_a_force_as_drive_with_exact_rotation() -> None:
    """Driven by the force found before, the column stands where it was driven to."""
    column = chain("finite", axial_spring=None, axial_force_ratio=RATIO)
    path = 0.02 * np.array([1.0, -1.0, 2.0, -2.0])
    driven = rbsdem.cyclic(column, displacement=path)
    again = rbsdem.cyclic(column, force=driven.force)
    np.testing.assert_allclose(again.displacement, path, rtol=1e-8)
    assert again.summary["relative_energy_residual"] < 1e-10


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_axial_springs_carry_the_axial_load(kinematics: str) -> None:
    """With small rotations an axial spring opens by -N/k, whatever else the joint does."""
    column = chain(kinematics, axial_spring=Elastic(2e8), axial_force_ratio=RATIO)
    result = rbsdem.cyclic(column, displacement=WIDE / 20, axial_load=LOAD)
    press = LOAD + RATIO * result.force
    np.testing.assert_allclose(result.opening, -press[:, None] / [2e8, 2e8], rtol=1e-12)
    assert result.summary["relative_energy_residual"] < 1e-11
    # What the springs in the axis do has no part in bending.
    free = rbsdem.cyclic(
        chain(kinematics, axial_spring=None, axial_force_ratio=RATIO),
        displacement=WIDE / 20,
        axial_load=LOAD,
    )
    np.testing.assert_allclose(result.force, free.force, rtol=1e-11)


@pytest.mark.parametrize("axial_spring", [None, Bilinear(k=3e9, d_y=1e-4, k_post=1e9)])
def test_layered_joints_with_exact_rotations_stand_in_equilibrium(
    axial_spring: rbsdem.Spring | None,
) -> None:
    """Moments and shears balance the loads on the deformed chain at every point."""
    column = chain("finite", axial_spring=axial_spring, axial_force_ratio=RATIO)
    result = rbsdem.cyclic(column, displacement=WIDE / 10, axial_load=LOAD)
    force = result.force
    press = LOAD + RATIO * force
    slip, turn = result.slip, np.cumsum(result.rotation, axis=1)
    opening = np.zeros_like(slip) if axial_spring is None else result.opening
    # Way of the top from the upper joint, then from the lower one.
    s, c = np.sin(turn), np.cos(turn)
    upper = np.stack([0.7 * s[:, 1], 0.7 * c[:, 1]])
    lower = upper + np.stack(
        [
            0.8 * s[:, 0] + slip[:, 1] * c[:, 0] + opening[:, 1] * s[:, 0],
            0.8 * c[:, 0] - slip[:, 1] * s[:, 0] + opening[:, 1] * c[:, 0],
        ]
    )
    moment = np.stack([force * arm[1] + press * arm[0] for arm in (lower, upper)], axis=1)
    np.testing.assert_allclose(result.moment, moment, rtol=1e-9, atol=1e-3)
    shear = np.stack([force, force * c[:, 0] + press * s[:, 0]], axis=1)
    np.testing.assert_allclose(result.shear, shear, rtol=1e-9, atol=1e-3)
    assert result.summary["relative_energy_residual"] < 1e-10


@pytest.mark.parametrize("axial_spring", [None, Bilinear(k=3e9, d_y=1e-4, k_post=1e9)])
def test_a_constant_history_is_the_constant_load_with_exact_rotations(
    axial_spring: rbsdem.Spring | None,
) -> None:
    """The solver for a varying axial load and that for a constant one give the same path."""
    column = chain("finite", axial_spring=axial_spring)
    path = HEIGHT * rbsdem.protocol([0.005, 0.01, 0.02], cycles=2, points=5)
    constant = rbsdem.cyclic(column, displacement=path)
    history = rbsdem.cyclic(column, displacement=path, axial_load=np.full(path.size, 3e5))
    np.testing.assert_allclose(history.force, constant.force, rtol=1e-9, atol=1e-4)
    np.testing.assert_allclose(history.top, constant.top, rtol=1e-10)


def test_a_load_that_buckles_the_column_ends_the_path() -> None:
    """Driven by its force, an elastic body has no equilibrium beyond N l = k."""
    column = rbsdem.Column(HEIGHT, 600.0, Elastic(1e9), Elastic(K_M), kinematics="finite")
    critical = K_M / HEIGHT
    with pytest.raises(rbsdem.SolveError, match=r"no equilibrium|capacity"):
        rbsdem.cyclic(column, force=[0.0, 0.0], axial_load=[0.0, 1.01 * critical])
    rbsdem.cyclic(column, force=[0.0, 0.0], axial_load=[0.0, 0.99 * critical])
