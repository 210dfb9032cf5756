"""What must not change an answer: each relation over random columns of all rules.

`relations.relation` says how they are tried. "Bits" means equal to the last one: nothing that is
added up changes its size or its order. Elsewhere the tolerance is a multiple of round-off, for a
reason that stands beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import strategies
from reference_chain import Linear, as_initial, bodies_of
from relations import Discard, Rng, ended, relation
from strategies import (
    MOST_STEPS,
    any_column,
    between,
    may_vary,
    motion,
    rules,
    scaled_spring,
    static_path,
    two_sided,
    walk,
    waves,
)

import rbsdem
from rbsdem import _core
from rbsdem.model.springs import SPRINGS
from rbsdem.springs import Elastic, Layered, Spring

ARRAYS = ("time", "displacement", "force", "slip", "rotation", "opening", "shear", "moment")
ARRAYS += ("base_shear", "base_moment", "axial_force", "top", "rest")
#: How the top moves, where it was kept.
MOTION = ("velocity", "acceleration", "ground_acceleration")
EVERY = ARRAYS + MOTION

#: Arrays that two results are compared in but for round-off.
SIZED = ("displacement", "force", "slip", "rotation", "shear", "moment")

#: Figures of a summary that do not depend on which rows are kept.
FIGURES = ("status", "steps", "events", "cut_steps", "peak_displacement", "peak_force")
FIGURES += ("displacement_at_peak_force", "peak_base_shear", "peak_rotation")


#: Figures that are those of the rows, and say so.
BY_ROW = ("rows", "energy_residual", "relative_energy_residual", "peak_floor_acceleration")


def follow(column: rbsdem.Column, loading: dict[str, Any], **more: Any) -> rbsdem.Result:
    """Follow a static path, or what there is of it."""
    return ended(lambda: rbsdem.cyclic(column, **loading, **more))


def move(column: rbsdem.Column, loading: dict[str, Any], **more: Any) -> rbsdem.Result:
    """Follow a motion, or what there is of it."""
    return ended(lambda: rbsdem.time_history(column, **loading, **more))


def value(run: rbsdem.Result, name: str) -> np.ndarray | None:
    """Return an array of a result; None where it was not kept."""
    return run.channels.get(name) if name in MOTION else getattr(run, name)


def same_bits(one: rbsdem.Result, other: rbsdem.Result, names: tuple[str, ...] = EVERY) -> None:
    """Hold two results to the same rows, energies and figures."""
    for name in names:
        a, b = value(one, name), value(other, name)
        assert (a is None) == (b is None), name
        assert a is None or np.array_equal(a, b, equal_nan=True), difference(name, a, b)
    for name, values in one.energy.items():
        assert np.array_equal(values, other.energy[name]), difference(
            name, values, other.energy[name]
        )
    for name in FIGURES:
        a, b = one.summary.get(name), other.summary.get(name)
        assert np.array_equal(a, b, equal_nan=isinstance(a, float)), f"{name}: {a} {b}"


def difference(name: str, one: np.ndarray, other: np.ndarray) -> str:
    """Return where and by how much two arrays differ."""
    if one.shape != other.shape:
        return f"{name}: {one.shape} {other.shape}"
    size = np.abs(one).max()
    share = np.abs(one - other) / (size or 1)
    row = np.unravel_index(np.argmax(share), share.shape)[0]
    return f"{name}: by {share.max():.1e} of {size:.3g} in row {row} of {len(one)}"


@relation(300, judged=0.9)
def test_springs_alone(rng: Rng) -> None:
    """Waiting, a path cut short, other units, the other side: bits.

    Round-off: more points, halves in series, and layers from the other side, which are a sum.
    """
    rule = str(rng.choice([name for name in SPRINGS if name]))
    sizes = 1e5, between(rng, 1e-4, 1e-2)
    one = strategies.spring(rng, rule, *sizes, options=0.5)
    path = walk(rng, sizes[1] * between(rng, 0.3, 20), 40)
    if rule == "layered" and not any(layer.rule != "compression" for _, layer in one.layers):
        raise Discard  # contacts without a load carry nothing
    force = one.response(path)
    largest = np.abs(force).max()
    assert np.array_equal(one.response(np.repeat(path, 3)), np.repeat(force, 3)), "waiting"
    cut = int(rng.integers(0, path.size))
    assert np.array_equal(one.response(path[:cut]), force[:cut]), "cut short"
    parts = int(rng.integers(2, 6))
    apart = np.abs(one.response(put_between(path, parts))[parts - 1 :: parts] - force).max()
    assert apart <= 1e-9 * largest, f"{rule}: points on the way, {apart / largest:.1e}"
    apart = np.abs(one.split(2).response(path / 2) - force).max()
    assert apart <= 1e-9 * max(largest, 1e-6), f"{rule}: two in series, {apart / largest:.1e}"
    size, way = 2.0 ** rng.integers(-20, 20, 2)
    if rule != "layered":
        other = scaled_spring(one, size, way).response(path * way)
        assert np.array_equal(other, size * force), f"{rule}: other units"
    if rule not in ("compression", "concrete") and not getattr(one, "d_buckle", None):
        apart = np.abs(one.mirrored().response(-path) + force).max()
        assert apart <= (rule == "layered") * 1e-9 * largest, f"{rule}: mirror, {apart:.1e}"


def layered(column: rbsdem.Column) -> bool:
    """Return whether a joint has layers."""
    return any(isinstance(spring, Layered) for spring in column.joints("flexure"))


def axial_matters(column: rbsdem.Column) -> bool:
    """Return whether an axial load that varies does anything in a column."""
    return column.kinematics != "small" or layered(column) or column.opens


def static_case(
    rng: Rng, *, varying: bool = True, **fixed: Any
) -> tuple[rbsdem.Column, dict[str, Any]]:
    """Return a column and its path, some under an axial load that varies or follows the force."""
    column = any_column(rng, damping=None, **fixed)
    if varying and rng.random() < 0.05 and axial_matters(column):
        column = replace(column, axial_force_ratio=rng.uniform(-2, 2))
    loading: dict[str, Any] = static_path(rng, column)
    if varying and rng.random() < 0.15 and axial_matters(column) and column.axial_load:
        share = 1 + 0.5 * rng.uniform(-1, 1, points(loading))
        loading["axial_load"] = column.axial_load * share
    return column, loading


def points(loading: dict[str, Any]) -> int:
    return len(next(iter(loading.values())))


def places(column: rbsdem.Column, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the way of the top, the height of the axial load, and those of the weights.

    Columns of `q` are slips, rotations and openings of all joints. A joint moves along what it
    stands on, or hangs from. Small rotations: heights to second order, or openings alone.
    """
    fixed = column.top == "fixed"
    beneath = [] if column.footing is None else [column.footing.height]
    lengths = np.concatenate([beneath, bodies_of(column)[0], [0.0] * fixed])
    slip, rotation, opening = np.split(q, 3, axis=1)
    turn = np.cumsum(rotation, axis=1)
    below = turn - rotation
    if fixed:
        below[:, -1] = 0.0
    if column.kinematics == "finite":
        across = slip * np.cos(below) + opening * np.sin(below)
        swing, drop = lengths * np.sin(turn), lengths * (1 - np.cos(turn))
        down = slip * np.sin(below) - opening * np.cos(below)
    else:
        across, swing = slip, lengths * turn
        second = column.kinematics == "pdelta"
        drop, down = second * lengths * turn**2 / 2, second * slip * below - opening
    lowered = np.cumsum(down + drop, axis=1)
    top = -lowered[:, -1]
    if column.axial_height:
        top = top * column.axial_height / column.height
    bodies = slice(len(beneath) + column.n)
    return (across + swing).sum(axis=1), top, (drop / 2 - lowered)[:, bodies]


@relation(250, judged=0.85)
def test_a_path_is_in_balance(rng: Rng) -> None:
    """The top is where its joints bring it, each joint holds the loads, energy comes from nowhere.

    The forces of the joints are those of virtual work. To 1e-10 and 1e-9 of the largest value, as
    each of many lines adds its round-off; with exact rotations to 1e-7, the tolerance of their
    equilibrium.
    """
    column, loading = static_case(rng)
    run = follow(column, loading)
    rows = run.time.size
    if run.summary["status"] != "completed" and len(loading) > 1:
        rows -= 1  # which ended between two points, under a load that only the solver knows
    if not rows:
        raise Discard
    finite = column.kinematics == "finite"
    opening = run.opening if column.opens else np.zeros_like(run.slip)
    q, force = np.hstack([run.slip, run.rotation, opening])[:rows], run.force[:rows]
    size = np.abs(run.slip).max() + np.abs(run.rotation).max() * column.height
    across, height, _ = places(column, q)
    apart = np.abs(run.displacement[:rows] - across).max()
    assert apart <= 1e-10 * size, f"displacement by {apart:.1e} m"
    if not column.axial_height:
        base = column.height + (column.footing.height if column.footing is not None else 0.0)
        apart = np.abs(run.top[:rows, 1] - base - height).max()
        assert apart <= 1e-10 * (size + base), f"height by {apart:.1e} m"
    load = loading.get("axial_load", np.full(rows, column.axial_load))[:rows]
    load = load + column.axial_force_ratio * force
    masses = [column.footing.mass] if column.footing is not None else []
    weight = np.append(masses, bodies_of(column)[1]) * column.gravity * column.self_weight
    held = np.zeros(q.shape)
    for unknown in range(q.shape[1]):
        bent = q + 1e-30j * np.eye(q.shape[1])[unknown]
        way, high, heights = (part.imag / 1e-30 for part in places(column, bent))
        held[:, unknown] = force * way - load * high - heights @ weight
    joints = [run.shear, run.moment] + [run.axial_force] * column.opens
    off = held[:, : len(joints) * run.shear.shape[1]] - np.hstack(joints)[:rows]
    slips, turns, openings = np.split(np.pad(off, ((0, 0), (0, q.shape[1] - off.shape[1]))), 3, 1)
    if column.top == "fixed":
        turns = turns - turns[:, -1:]  # as the rotations add up to zero
    most = max(np.abs(slips).max(), np.abs(openings).max(), np.abs(turns).max() / column.height)
    share = most / (sizes_of(run)["force"] + np.abs(load).max() + weight.sum())
    assert share <= (1e-7 if finite else 1e-9), f"a joint by {most:.1e} N, {share:.1e}"
    most = (
        np.abs(run.base_shear - run.force).max(),
        np.abs(run.base_moment - run.moment[:, 0]).max(),
    )
    assert max(most) <= 1e-9 * (1e-9 + np.abs(run.moment).max() + np.abs(run.shear).max()), most
    residual, limit = run.summary["relative_energy_residual"], 1e-7 if finite else 1e-9
    nothing = run.summary["energy_residual"] < 1e-20  # contacts that carry nothing do no work
    assert residual <= limit or nothing, f"energy by {residual:.1e}"


def mirrored(column: rbsdem.Column) -> rbsdem.Column:
    """Return the column whose left is the right of another one."""

    def sides(name: str) -> list[Spring] | None:
        springs = column.joints(name)[column.footing is not None :]
        return None if not springs else [one.mirrored() for one in springs]

    beneath = column.footing
    if beneath is not None:
        beneath = replace(
            beneath, shear=beneath.shear.mirrored(), flexure=beneath.flexure.mirrored()
        )
    return replace(column, shear=sides("shear"), flexure=sides("flexure"), footing=beneath)


def turns(column: rbsdem.Column) -> rbsdem.Column:
    """Return the mirrored column, where its springs can be mirrored."""
    try:
        return mirrored(column)
    except rbsdem.InputError as error:
        if "buckles on one side" in str(error):
            raise Discard from None
        raise


@relation(75, judged=0.5)
def test_springs_of_a_path_are_on_their_rules(rng: Rng) -> None:
    """Where all joints go the way of the force, its turns are theirs: round-off.

    With second-order moments they may turn by themselves, unseen by less than a step of a row.
    """
    column, loading = static_case(rng, varying=False, footing=None, shear=None, flexure=None)
    parts = 1 if column.kinematics == "small" else 200
    run = follow(column, {name: put_between(values, parts) for name, values in loading.items()})
    if run.summary["status"] != "completed":
        raise Discard
    for name, way, force in (
        ("shear", run.slip, run.shear),
        ("flexure", run.rotation, run.moment),
    ):
        for i, spring in enumerate(column.joints(name)):
            apart = np.abs(spring.response(way[:, i]) - force[:, i]).max()
            size = np.abs(force[:, i]).max()
            near = 1e-9 if parts == 1 and column.top == "free" else 1e-3
            assert apart <= near * size, f"{name} {i}, {spring.rule}: by {apart / size:.1e}"


@relation(200, judged=0.8)
def test_mirror(rng: Rng) -> None:
    """Left and right are names: round-off."""
    column, loading = static_case(rng)
    other = replace(turns(column), axial_force_ratio=-column.axial_force_ratio)
    back = {name: v if name == "axial_load" else -v for name, v in loading.items()}
    same_but_round_off(
        lambda: follow(column, loading),
        lambda: turned_back(follow(other, back)),
        lambda: follow(column, changed(loading)),
    )


def with_channels(run: rbsdem.Result, values: dict[str, np.ndarray]) -> rbsdem.Result:
    """Return a result with other values in some of its channels."""
    return replace(run, channels=run.channels | values)


def turned_back(run: rbsdem.Result) -> rbsdem.Result:
    """Return the result of the mirrored column as that of the column."""
    return with_channels(run, {name: -getattr(run, name) for name in SIZED})


def scaled(
    column: rbsdem.Column, length: float, mass: float, time: float, amplitude: float
) -> rbsdem.Column:
    """Return the column in other units, whose springs change their lines at another amplitude."""
    force = mass * length / time**2

    def one(spring: Spring | None, name: str) -> Spring | None:
        if isinstance(spring, Layered):
            return Layered([(y * length, one(layer, "layer")) for y, layer in spring.layers])
        if spring is None:
            return None
        size, way = (force * length, 1.0) if name == "flexure" else (force, length)
        return scaled_spring(spring, size * amplitude, way * amplitude)

    names = ("shear", "flexure", "axial_spring")
    changes: dict[str, Any] = {
        name: [one(s, name) for s in column.joints(name)[column.footing is not None :]] or None
        for name in names
    }
    if column.footing is not None:
        springs = {name: one(getattr(column.footing, name), name) for name in names}
        changes["footing"] = rbsdem.Footing(
            **springs,
            mass=column.footing.mass * mass,
            inertia=column.footing.inertia * mass * length**2,
            height=column.footing.height * length,
        )
    if isinstance(column.damping, rbsdem.Damping):
        changes["damping"] = replace(
            column.damping,
            mass=column.damping.mass / time,
            stiffness=column.damping.stiffness * time,
        )
    sizes = {"height": length, "depth": length, "axial_height": length, "mass": mass}
    sizes |= {"top_mass": mass, "top_inertia": mass * length**2, "axial_load": force}
    sizes |= {"gravity": length / time**2}
    several = {"lengths": length, "masses": mass, "rotary_inertia": mass * length**2}
    for name, size in sizes.items():
        if getattr(column, name) is not None:
            changes[name] = getattr(column, name) * size
    for name, size in several.items():
        if getattr(column, name) is not None:
            changes[name] = [value * size for value in getattr(column, name)]
    return replace(column, **changes)


#: Powers of two at the most by which units of length, mass and time, and amplitudes, differ.
POWERS = (20, 40, 15, 30)


def units(
    rng: Rng, column: rbsdem.Column, loading: dict[str, Any]
) -> tuple[float, float, float, float]:
    """Return units of length, mass and time, and an amplitude where nothing but springs bends."""
    drawn = [2.0 ** int(rng.integers(-most, most + 1)) for most in POWERS]
    bends = column.kinematics == "finite" or column.opens or layered(column)
    varies = {"axial_load", "vertical_acceleration"} & set(loading) or column.axial_force_ratio
    return drawn[0], drawn[1], drawn[2], 1.0 if bends or varies else drawn[3]


def in_units(
    loading: dict[str, Any], length: float, mass: float, time: float, amplitude: float
) -> dict[str, Any]:
    """Return a loading in other units and of another amplitude."""
    force = mass * length / time**2
    sizes = {"time": time, "displacement": length * amplitude, "force": force * amplitude}
    sizes |= {"ground_acceleration": length / time**2 * amplitude}
    sizes |= {"vertical_acceleration": length / time**2, "axial_load": force}
    return {name: values * sizes[name] for name, values in loading.items()}


def unscaled(
    run: rbsdem.Result, length: float, mass: float, time: float, amplitude: float
) -> rbsdem.Result:
    """Return a result in the units and of the amplitude before."""
    force = mass * length / time**2 * amplitude
    sizes = {"displacement": length * amplitude, "slip": length * amplitude, "rotation": amplitude}
    sizes |= {"force": force, "shear": force, "moment": force * length}
    return with_channels(run, {name: getattr(run, name) / size for name, size in sizes.items()})


@relation(200, judged=0.9)
def test_powers_of_two(rng: Rng) -> None:
    """Units are names, and with small rotations an amplitude is one: round-off.

    No digit changes, but which of two equations is solved first is a question of their numbers.
    """
    column, loading = static_case(rng)
    scale = units(rng, column, loading)
    same_but_round_off(
        lambda: follow(column, loading),
        lambda: unscaled(follow(scaled(column, *scale), in_units(loading, *scale)), *scale),
        lambda: follow(column, changed(loading)),
    )


@relation(60, judged=0.8)
def test_modes_in_powers_of_two(rng: Rng) -> None:
    """Units are names for the modes too: round-off, of the largest frequency for the smallest."""
    column = any_column(rng)
    length, mass, time, _ = units(rng, column, {})
    try:
        one, other = (
            rbsdem.modes(which) for which in (column, scaled(column, length, mass, time, 1.0))
        )
    except rbsdem.InputError:
        raise Discard from None
    assert np.abs(other.omega * time - one.omega).max() <= 1e-9 * one.omega[-1]
    assert abs(other.stable_step / time - one.stable_step) <= 1e-9 * one.stable_step


def put_between(values: np.ndarray, parts: int, start: float = 0.0) -> np.ndarray:
    """Return a path with more points on its straight lines; the old ones are kept."""
    whole = np.concatenate([[start], values])
    put = np.interp(np.arange(values.size * parts + 1) / parts, np.arange(whole.size), whole)
    put[::parts] = whole
    return put[1:]


@relation(200, judged=0.85)
def test_points_on_the_way(rng: Rng) -> None:
    """A path is a line, not its points: round-off, with exact rotations that of equilibrium."""
    column, loading = static_case(rng)
    parts = int(rng.integers(2, 6))
    fine = {
        name: put_between(values, parts, values[0] if name == "axial_load" else 0.0)
        for name, values in loading.items()
    }

    def coarse() -> rbsdem.Result:
        run = follow(column, fine)
        return with_channels(run, {name: getattr(run, name)[parts - 1 :: parts] for name in SIZED})

    one = follow(column, loading)
    if one.summary["status"] != "completed":
        raise Discard
    curved = column.kinematics == "finite" or len(loading) > 1 or column.axial_force_ratio != 0
    same_but_round_off(
        lambda: one, coarse, lambda: follow(column, changed(loading)), 1e-6 if curved else ROUND_OFF
    )


@relation(75, judged=0.4)
def test_a_constant_axial_history(rng: Rng) -> None:
    """A load is stated as a number or as a history, for which there is another solver: round-off.

    With exact rotations to the tolerance of their equilibrium.
    """
    column, loading = static_case(rng, varying=False)
    if not axial_matters(column) or not column.axial_load:
        raise Discard
    history = loading | {"axial_load": np.full(points(loading), column.axial_load)}
    other = replace(column, axial_load=float(rng.choice([0.0, 0.5, 1.0])) * column.axial_load)
    one = follow(column, loading)
    if one.summary["status"] != "completed":
        raise Discard
    same_but_round_off(
        lambda: one, lambda: follow(other, history), lambda: follow(column, changed(loading)), 1e-7
    )
    size = max(np.abs(values).max() for values in one.energy.values())
    for name, values in follow(other, history).energy.items():
        apart = np.abs(values - one.energy[name]).max()
        assert apart <= 1e-5 * size, f"{name}: by {apart} J of {size}"


@relation(150, judged=0.8)
def test_cut_and_restart(rng: Rng) -> None:
    """A path that goes on in the state of another one is one path: bits."""
    column, loading = static_case(rng)
    whole = follow(column, loading)
    # One point has one axial load, under which its path is that of a constant one: round-off.
    fewest = 2 if "axial_load" in loading else 1
    if points(loading) <= fewest:
        raise Discard
    cut = int(rng.integers(fewest, points(loading)))
    first = follow(column, {name: values[:cut] for name, values in loading.items()})
    if first.state is None or first.summary["status"] != "completed":
        raise Discard
    rest = follow(column, {name: values[cut:] for name, values in loading.items()}, initial=first)
    for name in ("displacement", "force", "slip", "rotation", "shear", "moment", "axial_force"):
        a, b = getattr(rest, name), getattr(whole, name)
        if a is not None:
            assert np.array_equal(a, b[cut:]), difference(name, a, b[cut:])
    for name, values in rest.energy.items():
        assert np.array_equal(values, whole.energy[name][cut:]), name
    assert rest.summary["status"] == whole.summary["status"]


def few_rows(whole: rbsdem.Result, kept: rbsdem.Result, every: int) -> None:
    """Hold a result to the rows and to all figures of the one that has every row."""
    last = whole.time.size - 1
    places = sorted({*range(0, last + 1, every), last})
    for name in EVERY:
        a, b = value(whole, name), value(kept, name)
        assert a is None or np.array_equal(a[places], b, equal_nan=True), difference(
            name, a[places], b
        )
    for name, a in whole.summary.items():
        b = kept.summary[name]
        same = np.array_equal(a, b, equal_nan=isinstance(a, float))
        assert name in BY_ROW or same, f"{name}: {a} {b}"
    assert whole.reached is None or np.array_equal(whole.reached, kept.reached, equal_nan=True)


@relation(100, judged=0.8)
def test_few_rows(rng: Rng) -> None:
    """Which rows are kept is of no weight: bits, and the same figures."""
    column, loading = static_case(rng)
    every = int(rng.choice([2, 3, 1000]))
    whole, kept = follow(column, loading), follow(column, loading, every=every)
    if whole.time.size == 0 or whole.summary["status"] == "failed":
        raise Discard
    few_rows(whole, kept, every)


def figures(result: rbsdem.Result) -> dict[str, float]:
    """Return every number that a result tells of its loop."""
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
            f"lost at {side}": curve.displacement_at(0.8, falling=True),
            f"0.7 at {side}": curve.displacement_at(0.7),
            f"0.3 at {side}": curve.displacement_at(0.3),
        }
    told |= {state.name: state.displacement for state in result.limit_states()}
    hinge = result.hinge()
    told |= {"ductility": hinge.ductility, "yields at": hinge.yield_rotation[0]}
    told |= {"residual": result.residual_drift, "loss": result.strength_loss()}
    names = ("peak_force", "peak_base_shear", "peak_rotation", "peak_displacement", "input_energy")
    return told | {name: abs(result.summary[name]) for name in names}


@relation(75, judged=0.3)
def test_figures_do_not_depend_on_the_rows(rng: Rng) -> None:
    """Points on the same lines, and rows that are not kept, change nothing that is measured.

    Where a plateau ends, or which of two peaks is the larger, is a question of the last digits.
    With second-order moments the largest force may lie where the top passes zero.
    """
    fixed = {"n": int(rng.integers(1, 4)), "kinematics": str(rng.choice(["small", "pdelta"]))}
    column, _ = static_case(
        rng, varying=False, footing=None, top="free", axial_spring=None, **fixed
    )
    peaks = column.height * between(rng, 2e-3, 0.02) * np.cumsum(rng.uniform(0.2, 1.0, 5))
    loading = {"displacement": np.outer(peaks, [1, -rng.uniform(0.5, 1.2)]).ravel()}
    fine = {name: put_between(values, 4) for name, values in loading.items()}
    runs = [follow(column, loading), follow(column, fine, every=int(rng.choice([1, 3, 100])))]
    runs += [follow(column, changed(loading, share)) for share in (1e-10, -1e-10)]
    size = np.abs(runs[0].force)
    if not size.size or size[-2:].min() <= 1e-9 * size.max():
        raise Discard  # all strength is lost: nothing springs back
    try:
        told, *others = [figures(run) for run in runs]
    except rbsdem.InputError:
        raise Discard from None

    def apart(other: dict[str, float]) -> str:
        if other.keys() != told.keys():
            return f"{other.keys() ^ told.keys()}"
        for name, value in told.items():
            near = 1e-7 * abs(value) + (1e-9 if "energy" not in name else 1e-9 * most)
            if not abs(other[name] - value) <= near and not np.isnan([other[name], value]).all():
                return f"{name}: {value} {other[name]}"
        return ""

    most = abs(told["input_energy"])
    if (found := apart(others[0])) and any(apart(other) for other in others[1:]):
        raise Discard
    assert not found, found


def each_stated(column: rbsdem.Column) -> rbsdem.Column:
    """Return the column that states the spring of each joint, and of each layer, by itself."""
    other = replace(column)
    text, numbers = [], []

    def put(part: _core.Statement) -> None:
        text.append(part.text)
        numbers.extend(part.numbers)

    skipped = ("shear", "flexure", "axial_spring", "layers", "layer_spring")
    for name, values in _core.groups(column._statement):
        if name not in skipped:
            put(_core.group(name, values))
    ids = 0
    for name in ("shear", "flexure", "axial_spring"):
        for joint, spring in zip(column.joint_numbers, column.joints(name), strict=False):
            put(spring.statement(name, joint=[joint]))
            if isinstance(spring, Layered):
                places = [y for y, _ in spring.layers]
                own = list(range(ids + 1, ids + 1 + len(places)))
                for at, (_, layer) in zip(own, spring.layers, strict=True):
                    put(layer.statement("layer_spring", id=at))
                put(_core.group("layers", {"joint": [joint], "y": places, "spring": own}))
                ids = own[-1]
    object.__setattr__(other, "_made", _core.Made(_core.Statement("\n".join(text), numbers)))
    return other


@relation(75, judged=0.8)
def test_springs_stated_once_or_each(rng: Rng) -> None:
    """A spring that several joints have is theirs one by one: bits."""
    column, loading = static_case(rng)
    same_bits(follow(column, loading), follow(each_stated(column), loading))


def relayered(rng: Rng, column: rbsdem.Column) -> rbsdem.Column:
    """Return the column with the layers of its joints in another order, some cut into halves."""

    def other(spring: Spring) -> Spring:
        if not isinstance(spring, Layered):
            return spring
        layers: list[tuple[float, Spring]] = []
        for y, layer in spring.layers:
            halves = 2 if rng.random() < 0.5 else 1
            layers += [(y, scaled_spring(layer, 1 / halves, 1.0))] * halves
        return Layered([layers[i] for i in rng.permutation(len(layers))])

    springs = [other(spring) for spring in column.joints("flexure")]
    beneath = column.footing
    if beneath is not None:
        beneath = replace(beneath, flexure=springs.pop(0))
    return replace(column, flexure=springs, footing=beneath)


@relation(100, judged=0.8)
def test_layers_in_another_order_and_in_halves(rng: Rng) -> None:
    """Layers side by side are a sum: round-off."""
    column, loading = static_case(rng, flexure=["layered"])
    same_but_round_off(
        lambda: follow(column, loading),
        lambda: follow(relayered(rng, column), loading),
        lambda: follow(column, changed(loading)),
    )


#: Round-off of a path, in shares of the largest value, and what it may have grown to.
ROUND_OFF, CHANGE, GROWN = 1e-9, 1e-12, 1e3


def changed(loading: dict[str, Any], share: float = CHANGE) -> dict[str, Any]:
    """Return a loading that differs by a share, by default little more than round-off."""
    return {
        name: values if name in ("time", "axial_load") else values * (1 + share)
        for name, values in loading.items()
    }


def sizes_of(run: rbsdem.Result) -> dict[str, float]:
    """Return what the differences of two results are held against.

    Of lengths and forces the largest of their kind: forces that balance have round-off of them all.
    """

    def largest(*names: str) -> float:
        return max(np.abs(getattr(run, name)).max(initial=0) for name in names)

    height = run.column.height
    rotation = largest("rotation")
    length = max(largest("displacement", "slip", "opening"), rotation * height)
    force = max(largest("force", "shear"), largest("moment") / height)
    # A force of no size in a stiff column, where only contacts that are open stand against a load.
    force = max(force, 1e-6 * length * stiffest(run.column), 1e-300)
    sizes = dict.fromkeys(("displacement", "slip"), max(length, 1e-300))
    sizes |= {"rotation": max(length / height, 1e-300), "moment": force * height}
    return sizes | dict.fromkeys(("force", "shear"), force)


def resists(run: rbsdem.Result) -> bool:
    """Return whether forces are more than the round-off of what stiff springs would carry."""
    column = run.column
    force = max(np.abs(run.force).max(initial=0), np.abs(run.moment).max(initial=0) / column.height)
    length = max(np.abs(run.displacement).max(initial=0), np.abs(run.slip).max(initial=0))
    return force > 1e-12 * length * stiffest(column)


def distance(one: rbsdem.Result, other: rbsdem.Result) -> tuple[float, str]:
    """Return the largest difference of two results, in shares of the largest value, and where."""
    worst, where = 0.0, ""
    if one.summary["status"] != other.summary["status"]:
        return np.inf, f"{one.summary['status']}, {other.summary['status']}"
    # Where on a plateau a path ends that fails is a question of its search.
    kept = slice(-1) if one.summary["status"] == "failed" else slice(None)
    for name, size in sizes_of(one).items():
        a, b = getattr(one, name)[kept], getattr(other, name)[kept]
        if a.shape != b.shape:
            return np.inf, difference(name, a, b)
        share = np.abs(a - b).max(initial=0) / size
        if share > worst:
            worst, where = float(share), f"{share:.1e}; {difference(name, a, b)}"
    return worst, where


def same_but_round_off(
    one: Callable[[], rbsdem.Result],
    other: Callable[[], rbsdem.Result],
    moved: Callable[[], rbsdem.Result],
    tolerance: float = ROUND_OFF,
) -> None:
    """Hold two results to one answer, but for round-off.

    A case whose answer a change of the loading by 1e-12 moves as far says nothing, nor does the end
    of a path on which nothing resists: its forces are round-off.
    """
    first, second = one(), other()
    apart, where = distance(first, second)
    if apart <= tolerance:
        return
    if apart == np.inf and not any(resists(run) for run in (first, second)):
        raise Discard
    if distance(first, moved())[0] > min(apart / GROWN, tolerance):
        raise Discard
    raise AssertionError(where)


def with_huge_axial_springs(column: rbsdem.Column, stiffness: float) -> rbsdem.Column:
    springs = Elastic(stiffness)
    beneath = column.footing
    if beneath is not None:
        beneath = replace(beneath, axial_spring=springs)
    return replace(column, axial_spring=springs, footing=beneath)


def stiffest(column: rbsdem.Column) -> float:
    """Return a stiffness [N/m] above those of all springs of a column, moments over its height."""
    found = [1.0]
    for name in ("shear", "flexure"):
        for spring in column.joints(name):
            whole = [s for _, s in spring.layers] if isinstance(spring, Layered) else [spring]
            for part in whole:
                force, way = np.abs(part.response([1e-9])[0]), 1e-9
                found.append(2 * force / way / min(1.0, column.height) ** 2 + 1)
    return max(found)


@relation(150, judged=0.7)
def test_huge_axial_springs_change_nothing(rng: Rng) -> None:
    """Joints that hardly open are joints that do not: to the share of the stiffnesses, 1e-7."""
    kinematics = str(rng.choice(["small", "pdelta"]))
    rules_of_joints = [name for name in rules("flexure") if name != "layered"]
    column, loading = static_case(
        rng, varying=False, kinematics=kinematics, axial_spring=None, axial_height=None,
        flexure=rules_of_joints,
    )  # fmt: skip
    other = with_huge_axial_springs(column, 1e9 * stiffest(column))
    same_but_round_off(
        lambda: follow(column, loading),
        lambda: follow(other, loading),
        lambda: follow(column, changed(loading)),
        1e-7,
    )


@relation(100, judged=0.6)
def test_a_huge_footing_changes_nothing(rng: Rng) -> None:
    """A footing that hardly moves is the ground: to the share of the stiffnesses, 1e-6."""
    column, loading = static_case(rng, footing=None, axial_height=None)
    contacts = {s.rule for s in column.joints("axial_spring")} & {"compression", "concrete"}
    if contacts and not column.axial_load > 0:
        raise Discard  # a contact without load stands on the corner of its curve
    stiff = Elastic(1e8 * stiffest(column) * max(1.0, column.height) ** 2)
    beneath = rbsdem.Footing(
        stiff, stiff, stiff if column.opens else None, mass=1.0, inertia=1.0, height=0.0
    )
    other = replace(column, footing=beneath)

    def upper() -> rbsdem.Result:
        run = follow(other, loading)
        names = ("slip", "rotation", "shear", "moment")
        return with_channels(run, {name: getattr(run, name)[:, 1:] for name in names})

    same_but_round_off(
        lambda: follow(column, loading), upper, lambda: follow(column, changed(loading)), 1e-6
    )


@relation(150, judged=0.3)
def test_driven_by_its_own_force(rng: Rng) -> None:
    """Where the force grows all the way, it brings the displacement back: round-off over slope."""
    column, loading = static_case(
        rng, varying=False, axial_spring=None, footing=None, shear=None, flexure=None
    )
    if "force" in loading:
        raise Discard
    whole = put_between(loading["displacement"], 8)
    run = follow(column, {"displacement": whole})
    # Up to the point at which more displacement takes no more force.
    ways = np.diff(run.displacement, prepend=0.0)
    slopes = np.diff(run.force, prepend=0.0)[ways != 0] / ways[ways != 0]
    if run.summary["status"] != "completed" or not slopes.size:
        raise Discard
    if slopes.min() < 1e-3 * slopes.max():
        raise Discard
    same_but_round_off(
        lambda: run,
        lambda: follow(column, {"force": run.force}),
        lambda: follow(column, changed({"displacement": whole})),
        1e-6,
    )


def motion_case(
    rng: Rng, *, settings: dict[str, Any] | None = None, **fixed: Any
) -> tuple[rbsdem.Column, dict[str, Any], dict[str, Any]]:
    """Return a column, its loading in time, and the method."""
    column = any_column(rng, in_time=True, **fixed)
    if column.top == "fixed" and not column.top_mass:
        raise Discard
    try:
        found = motion(rng, column, settings=settings)
    except rbsdem.InputError:
        found = None
    if found is None:
        raise Discard
    loading, chosen = found
    points = loading["time"].size
    if axial_matters(column) and may_vary(column, chosen) and rng.random() < 0.2:
        loading["vertical_acceleration"] = 2 * waves(rng, points)
        if column.axial_load:
            loading["axial_load"] = column.axial_load * (1 + 0.3 * waves(rng, points))
    return column, loading, chosen


def round_off(settings: dict[str, Any]) -> float:
    """Return the tolerance of round-off in time: rk45 chooses its steps by it."""
    return 1e-4 if settings["method"] == "rk45" else ROUND_OFF


@relation(60, judged=0.4)
def test_elastic_columns_respond_as_the_equation_of_motion(rng: Rng) -> None:
    """Methods with steps are held to their recursions, `rk45` to the exact response.

    To 1e-5, as round-off grows with the square of the step times the largest frequency.
    """
    column, loading, chosen = motion_case(
        rng, kinematics=str(rng.choice(["small", "pdelta"])), shear=["elastic"],
        flexure=["elastic"], axial_spring=None, footing=None, top="free", axial_height=None,
    )  # fmt: skip
    time, force, ground = (
        loading.get(name, np.zeros(loading["time"].size))
        for name in ("time", "force", "ground_acceleration")
    )
    linear, n = Linear(column), column.n
    start = 1e-4 * rng.normal(size=4 * n) * np.repeat([1, 1 / column.height] * 2, n)
    start[2 * n :] *= rbsdem.modes(column).omega[0]
    loads = {"time": time, "force": force, "ground_acceleration": ground}
    loads["initial"] = as_initial(start[: 2 * n], start[2 * n :], n)
    method = chosen["method"]
    if method == "rk45":
        exact = linear.solve(time, np.column_stack([force, ground]), start)
        found = move(column, loads, method=method, tolerance=1e-9)
        assert linear.distance(found, exact) <= 1e-5
        return
    parts = round(time[1] / chosen["dt"])
    found = move(column, loads, **chosen)
    carried = linear.k * start[: 2 * n] + linear.damping @ start[2 * n :]
    at_base = np.array([found.base_shear[0], found.base_moment[0]])
    assert np.abs(at_base - carried[[0, n]]).max() <= 1e-9 * np.abs(carried).max(), "at the base"
    at = np.arange(parts * (time.size - 1) + 1) / parts
    fine = np.column_stack([np.interp(at, np.arange(time.size), x) for x in (force, ground)])
    rows = linear.steps(method, fine, chosen["dt"], chosen.get("rho_infinity", 1.0), start)[::parts]
    apart = linear.distance(found, rows)
    assert apart <= 1e-5, f"{method}: by {apart:.1e}"


@relation(100, judged=0.4)
def test_springs_of_a_motion_are_on_their_rules(rng: Rng) -> None:
    """The deformations of every step fed to the springs alone give the forces of the steps."""
    column, loading, chosen = motion_case(rng)
    run = move(column, loading, every=1, **chosen)
    if run.summary["cut_steps"] or run.summary["status"] == "failed":
        raise Discard
    for name, way, force in (
        ("shear", run.slip, run.shear),
        ("flexure", run.rotation, run.moment),
        ("axial_spring", run.opening, run.axial_force),
    ):
        for i, spring in enumerate(column.joints(name)):
            if not isinstance(spring, Layered):  # these know their axial load
                apart = np.abs(spring.response(way[:, i]) - force[:, i]).max()
                size = np.abs(force[:, i]).max()
                assert apart <= 1e-9 * size, f"{name} {i}, {spring.rule}: by {apart / size:.1e}"


@relation(60, judged=0.4)
def test_mirror_in_time(rng: Rng) -> None:
    """Left and right are names: round-off."""
    column, loading, chosen = motion_case(rng)
    if chosen["method"] == "rk4" and two_sided(column):
        # Such a spring begins on the line of one side: a step more or less ends at zero.
        raise Discard
    other = turns(column)
    back = {n: -v if n in ("ground_acceleration", "force") else v for n, v in loading.items()}
    same_but_round_off(
        lambda: move(column, loading, **chosen),
        lambda: turned_back(move(other, back, **chosen)),
        lambda: move(column, changed(loading), **chosen),
        round_off(chosen),
    )


@relation(60, judged=0.4)
def test_powers_of_two_in_time(rng: Rng) -> None:
    """Units are names, and with small rotations an amplitude is one: round-off."""
    column, loading, chosen = motion_case(rng)
    scale = units(rng, column, loading)
    settings = chosen | ({"dt": chosen["dt"] * scale[2]} if "dt" in chosen else {})
    same_but_round_off(
        lambda: move(column, loading, **chosen),
        lambda: unscaled(
            move(scaled(column, *scale), in_units(loading, *scale), **settings), *scale
        ),
        lambda: move(column, changed(loading), **chosen),
        round_off(chosen),
    )


@relation(60, judged=0.4)
def test_cut_and_restart_in_time(rng: Rng) -> None:
    """A motion that goes on in the state of another one is one motion: bits."""
    column, loading, chosen = motion_case(rng)
    whole = move(column, loading, every=1, **chosen)
    cut = int(rng.integers(1, loading["time"].size - 1))
    first = move(column, {n: v[: cut + 1] for n, v in loading.items()}, every=1, **chosen)
    if first.state is None or first.summary["status"] != "completed":
        raise Discard
    rest = move(column, {n: v[cut:] for n, v in loading.items()}, initial=first, every=1, **chosen)
    for name in EVERY:
        a, b = value(rest, name), value(whole, name)
        if a is not None:
            at = b[first.time.size - 1 :]
            assert np.array_equal(a, at), difference(name, a, at)
    for name, values in rest.energy.items():
        at = whole.energy[name][first.time.size - 1 :]
        assert np.array_equal(values, at), difference(name, values, at)
    if whole.state is not None:
        assert np.array_equal(rest.state, whole.state)


@relation(60, judged=0.4)
def test_few_rows_in_time(rng: Rng) -> None:
    """Which rows are kept is of no weight: bits, and the same figures."""
    column, loading, chosen = motion_case(rng)
    every = int(rng.choice([2, 3, 1000]))
    drift = {"collapse_drift": between(rng, 0.005, 0.1)} if rng.random() < 0.3 else {}
    more = {"motion": bool(rng.random() < 0.5)}
    whole = move(column, loading, every=1, **chosen, **drift, **more)
    if whole.summary["status"] == "failed":
        raise Discard
    few_rows(whole, move(column, loading, every=every, **chosen, **drift, **more), every)


@relation(60, judged=0.4)
def test_the_peaks_are_those_of_all_steps(rng: Rng) -> None:
    """No row goes beyond a figure of the summary; with all rows and fixed steps one reaches it."""
    column, loading, chosen = motion_case(rng)
    run = move(column, loading, every=1, **chosen)
    if run.summary["status"] == "failed":
        raise Discard
    reached = chosen["method"] != "rk45" and chosen.get("events") != "located"
    for name, rows in (("displacement", run.displacement), ("base_shear", run.base_shear)):
        peak, most = abs(run.summary[f"peak_{name}"]), np.abs(rows).max()
        assert most <= peak, f"{name}: {most} in the rows, {peak}"
        assert peak == most or not reached, f"{name}: {most} in the rows, {peak}"


@relation(60, judged=0.4)
def test_zero_loads_change_nothing(rng: Rng) -> None:
    """A load that is zero is none: round-off, as the steps add it."""
    column, loading, chosen = motion_case(rng)
    names = {"ground_acceleration", "force"}
    if axial_matters(column):
        names |= {"vertical_acceleration"}
    zeros = {name: np.zeros(loading["time"].size) for name in names - set(loading)}
    if not zeros:
        raise Discard
    same_but_round_off(
        lambda: move(column, loading, **chosen),
        lambda: move(column, loading | zeros, **chosen),
        lambda: move(column, changed(loading), **chosen),
        round_off(chosen),
    )


@relation(60, judged=0.3)
def test_a_constant_axial_history_in_time(rng: Rng) -> None:
    """A load is stated as a number or as a history: round-off."""
    column, loading, chosen = motion_case(rng)
    if not axial_matters(column) or not may_vary(column, chosen):
        raise Discard
    loading.pop("axial_load", None)
    history = loading | {"axial_load": np.full(loading["time"].size, column.axial_load)}
    one, other = move(column, loading, **chosen), move(column, history, **chosen)
    same_but_round_off(
        lambda: one,
        lambda: other,
        lambda: move(column, changed(loading), **chosen),
        round_off(chosen),
    )
    if one.summary["status"] == other.summary["status"] == "completed":
        size = max(np.abs(values).max() for values in one.energy.values())
        for name, values in one.energy.items():
            apart = np.abs(values - other.energy[name]).max()
            assert apart <= 1e-6 * size, f"{name}: by {apart} J of {size}"


@relation(40, judged=0.3)
def test_springs_stated_each_in_time(rng: Rng) -> None:
    """A spring that several joints have is theirs one by one: bits."""
    column, loading, chosen = motion_case(rng)
    same_bits(move(column, loading, **chosen), move(each_stated(column), loading, **chosen))


@relation(60, judged=0.3)
def test_points_on_the_way_of_a_motion(rng: Rng) -> None:
    """A motion is a line, not its points: round-off."""
    column, loading, chosen = motion_case(rng)
    if chosen["method"] == "rk45" or chosen["dt"] == loading["time"][1]:
        raise Discard
    half = np.arange(2 * loading["time"].size - 1) / 2
    fine = {name: np.interp(half, half[::2], values) for name, values in loading.items()}

    def coarse() -> rbsdem.Result:
        run = move(column, fine, **chosen)
        # The last row is that of the end, wherever it is.
        rows = sorted({*range(0, run.time.size, 2), run.time.size - 1})
        return with_channels(run, {name: getattr(run, name)[rows] for name in SIZED})

    same_but_round_off(
        lambda: move(column, loading, **chosen),
        coarse,
        lambda: move(column, changed(loading), **chosen),
    )


@relation(40, judged=0.2)
def test_huge_axial_springs_in_time(rng: Rng) -> None:
    """Joints that hardly open are joints that do not: to the share of the stiffnesses."""
    rules_of_joints = [name for name in rules("flexure") if name != "layered"]
    kinematics = str(rng.choice(["small", "pdelta"]))
    column, loading, chosen = motion_case(
        rng, kinematics=kinematics, axial_spring=None, axial_height=None, flexure=rules_of_joints,
        damping=None,
    )  # fmt: skip
    if chosen["method"] not in rbsdem.run.solver.IMPLICIT:
        raise Discard
    loading.pop("vertical_acceleration", None)
    loading.pop("axial_load", None)
    other = with_huge_axial_springs(column, 1e6 * stiffest(column))
    same_but_round_off(
        lambda: move(column, loading, **chosen),
        lambda: move(other, loading, **chosen),
        lambda: move(column, changed(loading), **chosen),
        1e-5,
    )


@relation(12, judged=0.2)
def test_methods_have_one_answer(rng: Rng) -> None:
    """All methods tend to the answer of fine steps that are cut at every event.

    Those that are of order four through events are there, the others are near or come nearer with
    a quarter of the step. A motion that a change of its loading by 1e-8 alters a thousand times as
    much tells nothing.
    """
    located = {"method": "rk4", "events": "located"}
    column, loading, _ = motion_case(rng, settings=located | {"dt": 1.0})
    interval = loading["time"][1]
    stable = rbsdem.modes(column).stable_step
    step = interval * 2.0 ** min(0, np.floor(np.log2(0.1 * stable / interval)))
    if 4 * loading["time"][-1] > MOST_STEPS * step:
        raise Discard
    fine, coarse = {"dt": step / 4}, {"dt": step}
    one = move(column, loading, **located, **fine)
    largest = np.abs(one.displacement).max()

    def error(other: rbsdem.Result) -> float:
        if other.displacement.size != one.displacement.size:
            return np.inf
        return float(np.abs(other.displacement - one.displacement).max() / largest)

    sensitive = error(move(column, changed(loading, 1e-8), **located, **fine)) > 1e-5
    if one.summary["status"] != "completed" or sensitive:
        raise Discard
    name = str(rng.choice(["rk4", "rk45", *rbsdem.run.solver.IMPLICIT]))
    if name == "rk45":
        assert error(move(column, loading, method=name, tolerance=1e-10)) <= 1e-5
        return
    apart = error(move(column, loading, method=name, **fine))
    before = error(move(column, loading, method=name, **coarse))
    assert apart <= 2e-3 or apart < 0.4 * before, f"{name}: {before:.1e}, then {apart:.1e}"
