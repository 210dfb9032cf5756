"""The strength that paths of a joint reach is the interaction of its fibres.

Rectangles of perfectly plastic layers have it in closed form, M = M_p (1 - (N/N_p)^2), and the
polygon of a finite number of fibres follows by counting: all fibres on one side of the neutral axis
yield in tension, the others in compression, and one between may carry anything. Sections of
concrete and bars are followed to their largest moments, and compared with the diagram that
`rbsdem.section` finds from the laws of the materials.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered

FIBRES, WIDTH, DEPTH, STRESS, STRAIN = 40, 0.3, 0.5, 30e6, 1e-6
PLACES = DEPTH * ((np.arange(FIBRES) + 0.5) / FIBRES - 0.5)
FORCE = STRESS * WIDTH * DEPTH / FIBRES
N_P, M_P = STRESS * WIDTH * DEPTH, STRESS * WIDTH * DEPTH**2 / 4
SHARES = np.array([-0.95, -0.6, -0.21, 0.0, 0.1, 0.5, 0.77, 0.98])


def plastic_joint() -> Layered:
    """Return a rectangle of perfectly plastic layers, that yield soon."""
    return Layered([(y, Bilinear(k=FORCE / STRAIN, d_y=STRAIN, k_post=0.0)) for y in PLACES])


def fibre_moment(
    load: np.ndarray, places: np.ndarray, tension: np.ndarray, compression: np.ndarray
) -> np.ndarray:
    """Return the plastic moments of fibres with the strengths that they have in both directions.

    From the side that opens down, fibres pass from compression to tension one after the other.
    """
    order = np.argsort(-places)
    y, pull, push = places[order], tension[order], compression[order]
    axial = np.concatenate([[push.sum()], push.sum() - np.cumsum(push + pull)])
    moment = np.concatenate([[-(push * y).sum()], -(push * y).sum() + np.cumsum((push + pull) * y)])
    return np.interp(load, axial[::-1], moment[::-1])


def column(joint: Layered, **fields: object) -> rbsdem.Column:
    """Return a cantilever of 2 m whose displacement is the rotation of its foot."""
    return rbsdem.Column(2.0, 1.0, Elastic(1e13), joint, kinematics="small", **fields)


def capacity(load: np.ndarray) -> np.ndarray:
    """Return the plastic moment of the fibres of the rectangle."""
    strength = np.full(FIBRES, FORCE)
    return fibre_moment(load, PLACES, strength, strength)


def test_fibres_tend_to_the_closed_form() -> None:
    """The polygon is within 1/m^2 of the parabola, on which all its corners lie."""
    load = SHARES * N_P
    parabola = M_P * (1 - SHARES**2)
    assert np.abs(capacity(load) - parabola).max() <= M_P / FIBRES**2 * (1 + 1e-9)
    corners = N_P * (1 - 2 * np.arange(FIBRES + 1) / FIBRES)
    np.testing.assert_allclose(
        capacity(corners), M_P * (1 - (corners / N_P) ** 2), rtol=0, atol=1e-12 * M_P
    )


@pytest.mark.parametrize(
    ("share", "ratio"),
    [*((share, 0.0) for share in SHARES), *((0.3, r) for r in (-4.0, -1.0, 0.5, 1.5, 4.0))],
)
@pytest.mark.parametrize("side", [1, -1])
def test_pushed_far_beyond_yield(share: float, ratio: float, side: int) -> None:
    """The end of the path is where the line N = N_0 + r F meets the interaction of the fibres."""
    about = column(plastic_joint(), axial_load=share * N_P, axial_force_ratio=ratio)
    result = rbsdem.cyclic(about, displacement=[side * 0.1])
    force = result.force[-1]
    assert result.moment[-1, 0] == pytest.approx(2.0 * force, rel=1e-9)
    load = share * N_P + ratio * force
    assert abs(2.0 * force) == pytest.approx(capacity(load), rel=1e-9)


def test_the_moment_follows_a_load_that_varies() -> None:
    """While the joint rotates on, N(t) goes through the whole range and M stays on the surface."""
    load = N_P * np.r_[0.0, 0.9 * np.sin(np.linspace(0, 4 * np.pi, 401))]
    rotation = 1e-4 * (1 + np.arange(402))
    result = rbsdem.cyclic(column(plastic_joint()), displacement=2 * rotation, axial_load=load)
    assert result.summary["status"] == "completed"
    # At the first point the fibres next to the neutral axis are elastic still.
    np.testing.assert_allclose(result.moment[1:, 0], capacity(load)[1:], rtol=1e-9)


def test_concrete_and_bars() -> None:
    """Concrete without tension and bars: the largest moment is the plastic one.

    The softening is so slow that it takes less than 0.2 % of the strength on the way there.
    """
    crushing, bar = 0.9 * FORCE, 4.0 * FORCE
    concrete = ConcreteSpring(
        k=1.0001 * crushing / STRAIN,
        f_peak=crushing,
        d_peak=STRAIN,
        k_soft=0.02 * crushing,
        f_res=0.5 * crushing,
    )
    steel = Bilinear(k=bar / STRAIN, d_y=STRAIN, k_post=0.0)
    at = np.array([-0.2, 0.0, 0.2])
    joint = Layered([*((y, concrete) for y in PLACES), *((y, steel) for y in at)])
    places = np.concatenate([PLACES, at])
    tension = np.concatenate([np.zeros(FIBRES), np.full(3, bar)])
    compression = np.concatenate([np.full(FIBRES, crushing), np.full(3, bar)])
    for share in (-0.15, 0.0, 0.2, 0.45, 0.7):
        load = share * N_P
        path = np.geomspace(2e-5, 0.1, 60)
        result = rbsdem.cyclic(column(joint, axial_load=load), displacement=path)
        expected = fibre_moment(np.array(load), places, tension, compression)
        assert result.moment.max() == pytest.approx(float(expected), rel=2e-3)
