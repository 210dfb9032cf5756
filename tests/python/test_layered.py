"""A joint of layers: closed forms, symmetry, independence of increments, the axial load."""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem

ARM = 0.2  # m
K, FY, POST = 4e8, 4e5, 4e6  # N/m, N, N/m
LOAD = 8e5  # N


def steel(**changes: float) -> rbsdem.SteelSpring:
    return rbsdem.SteelSpring(k=K, f_y=FY, k_post=POST, **changes)


def concrete(**changes: float) -> rbsdem.ConcreteSpring:
    numbers = {"k": 2e9, "f_peak": 1e6, "d_peak": 8e-4, "k_soft": 1e8, "f_res": 2e5}
    return rbsdem.ConcreteSpring(**numbers | changes)


def joint(**changes: float) -> rbsdem.Layered:
    """A symmetric section: four layers of concrete between two of steel."""
    ys = np.array([-0.15, -0.05, 0.05, 0.15])
    layers = [(y, concrete(**changes)) for y in ys]
    return rbsdem.Layered([(-ARM, steel()), *layers, (ARM, steel())])


def wander(seed: int, points: int = 60) -> np.ndarray:
    growth = np.linspace(0.001, 0.02, points)
    return np.random.default_rng(seed).uniform(-1, 1, points) * growth


def test_two_elastic_layers_are_a_couple() -> None:
    pair = rbsdem.Layered([(-ARM, rbsdem.Elastic(K)), (ARM, rbsdem.Elastic(K))])
    np.testing.assert_allclose(
        pair.response([1e-3, -2e-3]), 2 * K * ARM**2 * np.array([1e-3, -2e-3])
    )


def test_unsymmetric_elastic_layers_turn_about_their_centre() -> None:
    one, two = rbsdem.Elastic(K), rbsdem.Elastic(3 * K)
    spring = rbsdem.Layered([(-ARM, one), (ARM, two)])
    about_centre = 4 * K * ARM**2 - (2 * K * ARM) ** 2 / (4 * K)
    np.testing.assert_allclose(
        spring.response([0.0, 2e-3], 1e5), [0.0, about_centre * 2e-3], atol=1e-6
    )


def test_bilinear_layers_have_the_plastic_moment() -> None:
    bar = rbsdem.Bilinear(k=K, d_y=FY / K, k_post=0.0)
    spring = rbsdem.Layered([(-ARM, bar), (ARM, bar)])
    assert spring.response([0.05])[-1] == pytest.approx(2 * FY * ARM)


def test_axial_load_raises_the_moment_of_an_open_joint() -> None:
    """Without tension layers the moment is at most the axial load times its arm."""
    block = rbsdem.Compression(1e9)
    spring = rbsdem.Layered([(-ARM, block), (ARM, block)])
    assert spring.response([0.05], axial_load=1e5)[-1] == pytest.approx(1e5 * ARM)


@pytest.mark.parametrize("seed", range(20))
def test_response_does_not_depend_on_increments(seed: int) -> None:
    path = wander(seed)
    corners = np.concatenate([[0.0], path])
    share = np.arange(1, 8) / 7
    fine = np.concatenate([a + (b - a) * share for a, b in zip(corners[:-1], path, strict=True)])
    fine[6::7] = path
    spring = joint(wear=0.03, contact=0.3, misfit=0.3)
    np.testing.assert_array_equal(spring.response(fine, LOAD)[6::7], spring.response(path, LOAD))


@pytest.mark.parametrize("seed", range(20))
def test_mirror(seed: int) -> None:
    path = wander(seed)
    spring = joint(wear=0.03, contact=0.3, misfit=0.3)
    there, mirrored = spring.response(path, LOAD), spring.response(-path, LOAD)
    np.testing.assert_allclose(mirrored, -there, atol=1e-7 * np.abs(there).max())


@pytest.mark.parametrize("seed", range(20))
def test_forces_are_continuous(seed: int) -> None:
    path = np.interp(np.arange(0, 20, 0.001), np.arange(21), np.append(0, wander(seed, 20)))
    spring = joint(wear=0.03, contact=0.3, misfit=0.3)
    moment = spring.response(path, LOAD)
    stiffest = 4 * 2e9 * 0.25**2 + 2 * K * ARM**2
    jump = np.abs(np.diff(moment)) - stiffest * np.abs(np.diff(path))
    assert jump.max() < 1e-6 * np.abs(moment).max()


@pytest.mark.parametrize("seed", range(50))
def test_steel_work_of_closed_cycles_is_not_negative(seed: int) -> None:
    path = np.random.default_rng(seed).uniform(-1, 1, 40) * 10 * FY / K
    path = np.concatenate([[0.0], np.repeat(path, 1), [0.0]])
    fine = np.interp(np.arange(0, path.size - 1, 0.002), np.arange(path.size), path)
    force = steel().response(fine)
    work = np.sum((force[1:] + force[:-1]) / 2 * np.diff(fine))
    assert work > 0


def test_steel_follows_menegotto_and_pinto() -> None:
    """The chords of the virgin branch lie within 2 % of the curve."""
    d = np.linspace(0, 10 * FY / K, 400)[1:]
    x, b, r = d * K / FY, POST / K, 20.0
    curve = FY * (b * x + (1 - b) * x / (1 + x**r) ** (1 / r))
    np.testing.assert_allclose(steel().response(d), curve, rtol=0.02)


def test_small_cycles_of_steel_do_not_overshoot() -> None:
    top = 6 * FY / K
    path = [top, top - 0.3 * FY / K, top, top - 0.3 * FY / K, 1.5 * top]
    straight = steel().response([1.5 * top])[-1]
    # The chords lie below the curve by up to 0.2 %; an overshoot would be 0.3 f_y and more.
    assert steel().response(path)[-1] == pytest.approx(straight, rel=2e-3)


def test_steel_that_turns_back_at_once_stays_where_it_is() -> None:
    d_y = FY / K
    path = [5 * d_y, -3 * d_y, 2 * d_y]
    there = np.nextafter(path[-1], 0)
    force = steel().response([*path, there, path[-1], there, path[-1], 4 * d_y])
    np.testing.assert_allclose(force[3:7], force[2])
    assert force[7] == pytest.approx(steel().response([*path, 4 * d_y])[-1])


def test_concrete_has_peak_residual_and_no_tension() -> None:
    closing = np.array([4e-4, 8e-4, 5e-3, 2e-2])
    force = concrete().response(-closing)
    assert force[1] == pytest.approx(-1e6)
    np.testing.assert_allclose(force[2:], [-1e6 + 1e8 * 4.2e-3, -2e5])
    assert concrete().response([-2e-3, 1e-3])[-1] == 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"f_peak": 2e6}, "f_peak"),
        ({"f_res": 2e6}, "f_res"),
        ({"wear": 1.0}, "wear"),
        ({"k": -1.0}, "k ="),
    ],
)
def test_concrete_refuses(changes: dict[str, float], message: str) -> None:
    with pytest.raises(rbsdem.InputError, match=message):
        concrete(**changes)


def column(spring: rbsdem.Layered, axial_load: float) -> rbsdem.Column:
    return rbsdem.Column(
        1.6, 600.0, rbsdem.Elastic(1e9), spring, kinematics="pdelta", axial_load=axial_load
    )


def test_axial_load_over_the_capacity_is_refused() -> None:
    blocks = rbsdem.Layered([(y, concrete()) for y in (-ARM, 0.0, ARM)])
    assert column(blocks, 2.9e6).n == 1
    with pytest.raises(rbsdem.InputError, match=r"cannot carry the axial load of 3\.1e\+06 N"):
        column(blocks, 3.1e6)
    with pytest.raises(rbsdem.InputError, match="cannot carry the axial load"):
        blocks.response([0.0], 3.1e6)


def test_static_path_is_the_response_of_the_joint() -> None:
    spring = joint()
    path = [0.004, -0.004, 0.008]
    rigid = rbsdem.Column(1.0, 600.0, rbsdem.Elastic(1e14), spring)
    result = rbsdem.cyclic(rigid, displacement=path)
    np.testing.assert_allclose(result.force, spring.response(path), rtol=1e-4)


def test_layers_refuse_what_is_no_normal_spring() -> None:
    takeda = rbsdem.Takeda(k_c=2.0, d_c=0.1, k_y=1.0, d_y=0.2, k_u=0.1)
    with pytest.raises(rbsdem.InputError, match="layer 2"):
        rbsdem.Layered([(0.1, rbsdem.Elastic(1.0)), (0.2, takeda)])
