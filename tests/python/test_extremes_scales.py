"""Extremes of the units: a change of the units of length, mass and time must not change a bit.

With factors that are powers of two every product and sum of the program scales exactly; wherever
a number without the right dimension is hidden (a tolerance in metres, a least force), bits differ.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rbsdem

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

IMPLICIT = ("newmark", "hht", "generalised_alpha")

METHODS = ("rk4", "located", "rk45", *IMPLICIT, "auto")
SOLVERS = [(level, method) for level in ("small", "pdelta") for method in METHODS]
SOLVERS += [("finite", method) for method in METHODS if method not in IMPLICIT]

#: Units of length, mass and time: far up, far down, and all mixed.
UNITS = [
    (2.0**40, 1.0, 1.0), (2.0**-40, 1.0, 1.0), (1.0, 2.0**60, 1.0), (1.0, 2.0**-60, 1.0),
    (1.0, 1.0, 2.0**30), (1.0, 1.0, 2.0**-30), (2.0**-20, 2.0**50, 2.0**-15),
]  # fmt: skip


def keywords(method: str) -> dict[str, str]:
    located = {"method": "rk4", "events": "located"}
    return located if method == "located" else {"method": method}


def scaled_spring(spring, force: float, way: float):
    """Return the spring in other units; `way` is 1 for rotations."""
    changed = {
        name: getattr(spring, name) * force / way
        for name in ("k", "k_post", "k_c", "k_y", "k_u")
        if hasattr(spring, name)
    }
    changed |= {
        name: getattr(spring, name) * way for name in ("d_y", "d_c") if hasattr(spring, name)
    }
    return replace(spring, **changed)


def scaled(column: rbsdem.Column, length: float, mass: float, time: float) -> rbsdem.Column:
    force = mass * length / time**2

    def each(name, size, way):
        return [scaled_spring(s, size, way) for s in column.joints(name)] or None

    return replace(
        column,
        height=column.height * length,
        lengths=[value * length for value in column.lengths],
        masses=[value * mass for value in column.masses],
        shear=each("shear", force, length),
        flexure=each("flexure", force * length, 1.0),
        axial_spring=each("axial_spring", force, length),
        axial_load=column.axial_load * force,
        gravity=column.gravity * length / time**2,
        top_mass=column.top_mass * mass,
        top_inertia=column.top_inertia * mass * length**2,
        depth=column.depth * length,
        damping=rbsdem.Damping(
            mass=column.damping.mass / time, stiffness=column.damping.stiffness * time
        ),
    )


def walker(kinematics: str, *, opens: bool = False) -> rbsdem.Column:
    """Three bodies that yield, crack and (if they open) lift off."""
    shear = [rbsdem.Bilinear(4e6, 4e-3, 2e5), rbsdem.Bilinear(3e6, 4e-3, 0.0), rbsdem.Elastic(2e6)]
    flexure = [
        rbsdem.Takeda(9e6, 5e-4, 3e6, 4e-3, 3e5, b1=0.4), rbsdem.Takeda(7e6, 5e-4, 3e6, 4e-3, 3e5),
        rbsdem.Bilinear(5e6, 3e-3, 1e5),
    ]  # fmt: skip
    axial = [rbsdem.Compression(5e7), rbsdem.Elastic(4e7), rbsdem.Bilinear(3e7, 1e-2, 1e6)]
    return rbsdem.Column(
        2.25, None, shear, flexure, n=3, lengths=[1.0, 0.5, 0.75], masses=[500.0, 200.0, 300.0],
        kinematics=kinematics, axial_load=2e4, self_weight=True, top_mass=400.0, top_inertia=20.0,
        depth=0.25, axial_spring=axial if opens else None,
        damping=rbsdem.Damping(mass=0.25, stiffness=2.0**-12),
    )  # fmt: skip


def compare(one: rbsdem.Result, other: rbsdem.Result, length: float, mass: float, time: float):
    """All rows and figures, in both units, to the last bit."""
    force, energy = mass * length / time**2, mass * length**2 / time**2
    sizes = {
        "displacement": length, "force": force, "slip": length, "rotation": 1.0, "opening": length,
        "shear": force, "moment": energy, "axial_force": force, "top": length,
    }  # fmt: skip
    for name, size in sizes.items():
        if getattr(one, name) is None:
            continue
        assert np.array_equal(getattr(one, name) * size, getattr(other, name)), name
    for name, values in one.energy.items():
        assert np.array_equal(values * energy, other.energy[name]), name
    for name in ("steps", "events", "cut_steps", "peak_rotation", "status"):
        assert one.summary[name] == other.summary[name], name


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("level", ["small", "pdelta", "finite"])
@pytest.mark.parametrize("opens", [False, True], ids=["closed", "opening"])
def test_static_path_in_other_units(level, opens, units):
    length, mass, time = units
    column = walker(level, opens=opens)
    other = scaled(column, *units)
    rng = np.random.default_rng(3)
    path = rng.uniform(-0.08, 0.08, 30)
    compare(
        rbsdem.cyclic(column, displacement=path),
        rbsdem.cyclic(other, displacement=path * length), *units,
    )  # fmt: skip
    force = rng.uniform(-9e3, 9e3, 30)
    compare(
        rbsdem.cyclic(column, force=force),
        rbsdem.cyclic(other, force=force * mass * length / time**2), *units,
    )  # fmt: skip


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize(("level", "method"), SOLVERS)
@pytest.mark.parametrize("opens", [False, True], ids=["closed", "opening"])
def test_response_in_other_units(level, method, opens, units):
    column = walker(level, opens=opens)
    other = scaled(column, *units)
    times = np.arange(0, 65) / 64
    rng = np.random.default_rng(4)
    ground, vertical, axial = (rng.uniform(-1, 1, 65) * size for size in (6.0, 3.0, 1e3))
    runs = []
    for which, unit, clock in ((column, (1.0, 1.0, 1.0), times), (other, units, times * units[2])):
        size = unit[0] / unit[2] ** 2
        loads = {"ground_acceleration": ground * size, "force": ground * 1e3 * unit[1] * size}
        if level != "small" or opens:
            loads |= {
                "vertical_acceleration": vertical * size,
                "axial_load": axial * unit[1] * size,
            }
        runs.append(rbsdem.time_history(which, clock, **loads, **keywords(method)))
    assert runs[0].summary["events"] > 20
    compare(*runs, *units)


def smaller(column: rbsdem.Column, size: float) -> rbsdem.Column:
    """Return the column that yields, cracks and opens at deformations of another size."""

    def each(name):
        springs = column.joints(name)
        return [scaled_spring(scaled_spring(s, 1.0, size), size, 1.0) for s in springs] or None

    return replace(
        column,
        shear=each("shear"),
        flexure=each("flexure"),
        axial_spring=each("axial_spring"),
    )


@pytest.mark.filterwarnings("ignore:the rotation of a body")
@pytest.mark.parametrize("size", [2.0**-100, 2.0**-40, 2.0**20, 2.0**100])
@pytest.mark.parametrize("level", ["small", "pdelta"])
@pytest.mark.parametrize("method", ["static", *METHODS])
def test_amplitude_does_not_matter_with_small_rotations(level, method, size):
    """Loads and deformations at which springs change their lines from 1e-30 to 1e30 times."""
    column = walker(level)
    other = smaller(column, size)
    rng = np.random.default_rng(5)
    if method == "static":
        path = rng.uniform(-0.08, 0.08, 60)
        runs = [
            rbsdem.cyclic(column, displacement=path),
            rbsdem.cyclic(other, displacement=path * size),
        ]
    else:
        times, ground = np.arange(0, 65) / 64, rng.uniform(-6, 6, 65)
        runs = [
            rbsdem.time_history(which, times, ground_acceleration=motion, **keywords(method))
            for which, motion in ((column, ground), (other, ground * size))
        ]
    assert runs[0].summary["events"] > 20
    one, two = runs
    for name in ("displacement", "slip", "rotation", "shear", "moment"):
        assert np.array_equal(getattr(one, name) * size, getattr(two, name)), name
    for name, values in one.energy.items():
        assert np.array_equal(values * size**2, two.energy[name]), name


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("level", ["small", "pdelta"])
def test_modes_and_limits_in_other_units(level, units):
    column = walker(level, opens=True)
    one, other = rbsdem.modes(column), rbsdem.modes(scaled(column, *units))
    np.testing.assert_allclose(other.omega * units[2], one.omega, rtol=1e-14)
    assert other.stable_step / units[2] == pytest.approx(one.stable_step, rel=1e-14)
