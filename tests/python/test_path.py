"""What is measured on a static path does not depend on its rows.

A static path is straight between its events. Points put on the way, on the same lines, change
nothing of it; nor does what is kept of its rows. So each figure is the same, to round-off, of the
path through its turning points, of the path with more points, and with few of its rows kept.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import rbsdem
from rbsdem import curves as comparison
from rbsdem.springs import Bilinear, Elastic, PeakOriented, Pinching, SteelSpring, Takeda

Array = NDArray[np.float64]

SECTION = rbsdem.peer.paper_sections()["zahn_7"].section


def random_spring(rng: np.random.Generator, scale: float) -> rbsdem.springs.Spring:
    """A spring of a random rule that yields about 2 MN m at about `scale`."""
    d_y, f_y = scale * rng.uniform(0.5, 2.0), 2e6 * rng.uniform(0.5, 2.0)
    k = f_y / d_y
    capped: dict[str, Any] = {
        "d_y": d_y, "f_y": f_y, "d_cap": 5 * d_y, "f_cap": 1.1 * f_y, "d_pc": 20 * d_y,
        "lambda_s": 60.0, "d_c": 0.1 * d_y, "f_c": 0.3 * f_y,
    }  # fmt: skip
    kinds: list[Callable[[], rbsdem.springs.Spring]] = [
        lambda: Elastic(k),
        lambda: Bilinear(k, d_y, 0.05 * k),
        lambda: Takeda(3 * k, 0.2 * d_y, k, d_y, 0.03 * k),
        lambda: PeakOriented(**capped),
        lambda: Pinching(kappa_f=0.4, kappa_d=0.6, **capped),
        lambda: SteelSpring(k, f_y, 0.02 * k),
    ]
    return kinds[rng.integers(len(kinds))]()


def random_case(seed: int) -> tuple[rbsdem.Column, Array]:
    """A column and the turning points of a path."""
    rng = np.random.default_rng(seed)
    kinematics = ("small", "pdelta")[seed % 2]
    peaks = np.cumsum(rng.uniform(0.2, 1.0, 5)) * 0.015
    path = 1.6 * np.ravel(np.column_stack((peaks, -peaks * rng.uniform(0.5, 1.2, 5))))
    if seed % 4 == 3:
        load = 1e6 * rng.uniform(0.3, 1.0)
        return rbsdem.section.column(SECTION, 1.6, axial_load=load, n=int(rng.integers(2, 4))), path
    column = rbsdem.Column(
        1.6,
        1e3,
        random_spring(rng, 2e-3),
        random_spring(rng, 4e-3),
        n=int(rng.integers(1, 4)),
        axial_load=5e5 if kinematics == "pdelta" else 0.0,
        kinematics=kinematics,
    )
    return column, path


def with_points_on_the_way(values: Array, seed: int) -> Array:
    rng = np.random.default_rng(seed)
    ends = np.concatenate(([0.0], values))
    parts = [
        np.append(a + (b - a) * np.sort(rng.random(rng.integers(0, 6))), b)
        for a, b in pairwise(ends)
    ]
    return np.concatenate(([0.0], *parts))


def figures(
    column: rbsdem.Column, path: Array, driven: str = "displacement", **options: Any
) -> dict[str, float]:
    """Every number that a result tells of its loop; of a path that breaks off, up to there."""
    try:
        result = rbsdem.cyclic(column, **{driven: path}, **options)
    except rbsdem.SolveError as error:
        result = error.result
    cycles = result.half_cycles()
    told = {
        f"{name} {i}": value
        for name in ("displacement", "force", "peak_force", "energy", "stiffness", "damping")
        for i, value in enumerate(getattr(cycles, name))
    }
    for side in (1, -1):
        curve = result.envelope(side)
        told |= {
            f"peak {side}": curve.peak_force,
            f"peak at {side}": curve.displacement_at_peak,
            f"lost at {side}": curve.displacement_at(0.8, falling=True),
            f"0.7 at {side}": curve.displacement_at(0.7),
            f"0.3 at {side}": curve.displacement_at(0.3),
        }
    told |= {state.name: state.displacement for state in result.limit_states()}
    hinge = result.hinge()
    told |= {"ductility": hinge.ductility, "yields at": hinge.yield_rotation[0]}
    told |= {"residual": result.residual_drift, "loss": result.strength_loss()}
    names = ("peak_force", "peak_base_shear", "peak_rotation", "peak_displacement", "input_energy")
    told |= {name: result.summary[name] for name in names}
    return told


@pytest.mark.parametrize("seed", range(24))
def test_figures_do_not_depend_on_the_rows(seed: int) -> None:
    column, path = random_case(seed)
    told = figures(column, path)
    more = with_points_on_the_way(path, seed)
    for every in (None, 3, 100):
        again = figures(column, more, every=every)
        assert again == pytest.approx(told, rel=1e-7, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("seed", range(12))
def test_figures_under_a_driven_force_do_not_depend_on_the_rows(seed: int) -> None:
    column, path = random_case(seed)
    peak = np.abs(rbsdem.cyclic(column, displacement=path[:4]).force).max()
    force = 0.6 * peak * np.sign(path) * np.linspace(0.3, 1.0, path.size)
    told = figures(column, force, "force")
    again = figures(column, with_points_on_the_way(force, seed), "force", every=7)
    assert again == pytest.approx(told, rel=1e-7, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("seed", range(8))
def test_figures_of_exact_rotations_depend_on_the_rows_by_their_strides(seed: int) -> None:
    """The path bends between the events: lines from stride to stride stand for it."""
    column, path = random_case(4 * seed + 1)
    bent = rbsdem.Column(
        1.6, 1e3, column.shear, column.flexure, n=column.n, axial_load=5e5, kinematics="finite"
    )
    told = figures(bent, path)
    again = figures(bent, with_points_on_the_way(path, seed), every=3)
    assert again.keys() == told.keys()
    for name, value in told.items():
        # What an elastic cycle dissipates is round-off of what it stores.
        near = 1e-4 * told["input_energy"] if name.startswith("energy") else 1e-5
        assert again[name] == pytest.approx(value, rel=2e-3, abs=near, nan_ok=True)


def test_a_plastic_hinge_by_hand():
    """A rigid column of 2 m on an elastoplastic hinge: the residual drift is what did not spring
    back, and the half-cycles hold the work from zero force to zero force."""
    k, d_y, top = 1e8, 4e-3, 0.05
    flexure = Bilinear(k=k, d_y=d_y, k_post=0.0)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    result = rbsdem.cyclic(column, displacement=[top, -top])
    # The force that yields, k d_y/2, springs back by 2 d_y; seen from the last zero.
    assert result.residual_drift == pytest.approx(top / 2.0 - d_y, rel=1e-6)
    plastic = top - 2.0 * d_y
    # The second one ends loaded, with what is stored.
    energy = k * d_y / 2.0 * np.array([plastic, 2.0 * plastic + 0.5 * 2.0 * d_y])
    assert result.half_cycles().energy == pytest.approx(energy, rel=1e-6)
    assert result.path.time == pytest.approx([-1.0, 0.16 - 1.0, 0.0, 0.16, 1.0], rel=1e-6)
    assert result.path.path is result.path


def test_a_path_that_goes_on_begins_where_the_other_one_ended(tmp_path):
    column, path = random_case(1)
    first = rbsdem.cyclic(column, displacement=path[:5])
    second = rbsdem.cyclic(column, displacement=path[5:], initial=first)
    whole = rbsdem.cyclic(column, displacement=path)
    assert second.residual_drift == whole.residual_drift
    assert np.array_equal(second.path.force[1:], whole.path.force[-second.path.time.size + 1 :])
    # A saved result finds its path again.
    second.save(tmp_path / "second.npz")
    assert rbsdem.read_result(tmp_path / "second.npz").path == second.path


def test_a_path_that_breaks_off_has_corners_up_to_there():
    flexure = Bilinear(k=1e8, d_y=4e-3, k_post=0.0)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e9), flexure)
    with pytest.raises(rbsdem.SolveError) as raised:
        rbsdem.cyclic(column, force=[1e5, 3e5])
    result = raised.value.result
    assert result.path.force[-1] == result.force[-1] == pytest.approx(2e5)
    assert result.limit_states()["first_yield"].drift == pytest.approx(result.drift[-1])


@pytest.mark.parametrize("seed", range(12))
def test_figures_of_a_curve_do_not_depend_on_points_on_its_lines(seed: int) -> None:
    """Of a measured curve too: the same straight lines, with more points."""
    rng = np.random.default_rng(seed)
    amplitude = np.repeat(np.linspace(1.0, 6.0, 8), 2) * np.tile([1.0, -1.0], 8)
    d = np.ravel(np.column_stack((0.6 * amplitude, amplitude, 0.3 * amplitude)))
    f = (
        np.sign(d)
        * np.abs(d) ** 0.3
        * np.linspace(1.0, 0.4, d.size)
        * rng.uniform(0.8, 1.2, d.size)
    )
    rows = np.sort(np.concatenate((np.arange(d.size), rng.uniform(0, d.size - 1, 60))))
    more = tuple(np.interp(rows, np.arange(d.size), values) for values in (d, f))
    loop, again = (comparison.summarise(*curve) for curve in ((d, f), more))
    for name in loop.__slots__:
        assert getattr(again, name) == pytest.approx(getattr(loop, name), nan_ok=True)
    assert comparison.strength_loss(*more) == pytest.approx(
        comparison.strength_loss(d, f), nan_ok=True
    )
    for name in ("displacement", "force", "peak_force", "energy", "stiffness", "damping"):
        of = [getattr(comparison.half_cycles(*curve), name) for curve in ((d, f), more)]
        assert of[1] == pytest.approx(of[0], nan_ok=True)
    for side in (1, -1):
        one, other = (rbsdem.curves.envelope(curve, side) for curve in ((d, f), more))
        for share in (0.3, 0.7, 0.9, 1.0):
            assert other.displacement_at(share) == pytest.approx(one.displacement_at(share))
        lost = [curve.displacement_at(0.8, falling=True) for curve in (one, other)]
        assert lost[1] == pytest.approx(lost[0], nan_ok=True)
