"""Random search for static paths whose rows are not equilibrium, or lose energy.

    python studies/balance_search.py [paths] [seed]

Columns of one to seven bodies with springs of every rule, plateaus, contacts, cracked and rocking
layered joints, small rotations, P-Delta and exact ones, under a constant axial load or one that
varies, are driven by displacements or forces. Every row must be a state of the column: the
displacement of the top is that of its joints, each joint is in equilibrium, and the work of the
loads is that of the springs. A path that cannot be followed ends with an error. Prints the paths of
which a row is not, then one line of counts.
"""

from __future__ import annotations

import itertools
import multiprocessing
import sys
import warnings
from functools import partial

import numpy as np
from static_search import targets

import rbsdem
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    PeakOriented,
    Pinching,
    SteelSpring,
    Takeda,
)

Generator = np.random.Generator

#: What a row may miss: of the displacement, as a share of the largest deformations; of equilibrium,
#: as a share of the largest forces; of energy, as a share of the largest work.
GEOMETRY, EQUILIBRIUM, ENERGY = 1e-12, 1e-9, 1e-9
#: The same where the path is a curve, which Newton's method follows, and the work an integral.
CURVED = 1e-10, 1e-9, 1e-5

HEIGHT = 1.6

#: Forces [N] and works [J] below this are none, round-off of columns that carry 1e4 N or more.
NO_FORCE, NO_WORK = 1e2, 10.0
#: Beyond this, where a force may drive a column whose springs have next to nothing left, the forces
#: of stiff springs are round-off [m].
FAR = 10 * HEIGHT


def spring(rng: Generator, force: float, yielding: float) -> rbsdem.Spring:
    """Return a spring of some rule that yields near a force and a deformation."""
    k = force / yielding
    post = k * float(rng.choice([0.0, 0.0, 1e-15, 10 ** rng.uniform(-9, -0.5)]))
    crack = yielding * rng.uniform(0.05, 0.5)
    cap = yielding * rng.uniform(2, 10)
    top = force * float(rng.choice([1.0, rng.uniform(1.01, 1.3)]))
    falls = [yielding, force, cap, top, cap * 10 ** rng.uniform(0, 8)]
    loss = {"f_res": top * float(rng.choice([0.0, 0.3])), "lambda_s": float(rng.choice([0, 100]))}
    match rng.integers(7):
        case 0:
            return Elastic(k)
        case 1:
            return Bilinear(k, yielding, post)
        case 2:
            k_y = k * rng.uniform(0.3, 1.0)
            return Takeda(
                k_c=k * rng.uniform(1.05, 3.0),
                d_c=crack,
                k_y=k_y,
                d_y=yielding,
                k_u=min(post, 0.9 * k_y),
                b0=rng.choice([0.0, 0.4]),
                b1=rng.uniform(0.5, 1.0),
                inner=str(rng.choice(["kc", "kr", "one"])),
            )
        case 3:
            return PeakOriented(*falls, **loss)
        case 4:
            return Pinching(*falls, **loss, kappa_f=0.3, kappa_d=0.5)
        case _:
            more = {}
            if rng.random() < 0.6:
                more = {"f_u": force * rng.uniform(1.05, 1.5), "plateau": rng.uniform(0.5, 10)}
                post = max(post, 1e-3 * k)
            hardening = float(rng.choice([0.0, 0.1]))
            endurance = float(rng.choice([0.0, 1e3]))
            return SteelSpring(
                k, force, post, isotropic_hardening=hardening, endurance=endurance, **more
            )


def rocking(rng: Generator, load: float) -> Layered:
    """Return a joint of contacts alone, or of contacts and bars."""
    k = 10 ** rng.uniform(7.5, 9.5)
    half = rng.uniform(0.1, 0.3)
    count = int(rng.integers(2, 8))
    layers = [(y, Compression(k)) for y in np.linspace(-half, half, count)]
    if rng.random() < 0.4:
        bar = spring(rng, max(load, 1e5) * rng.uniform(0.1, 1), 10 ** rng.uniform(-4, -2.5))
        if bar.rule in ("elastic", "bilinear", "steel"):
            layers += [(y, bar) for y in (-0.7 * half, 0.7 * half)[: rng.integers(1, 3)]]
    return Layered(layers)


def layered_joint(rng: np.random.Generator) -> Layered:
    """Return a joint 0.4 m deep with bars, and strips of one kind."""
    strips = int(rng.integers(2, 13))
    places = 0.4 * ((np.arange(strips) + 0.5) / strips - 0.5)
    share = 1 / strips
    kind = rng.choice(["concrete", "contact", "bilinear"])
    if kind == "concrete":
        strip: rbsdem.Spring = ConcreteSpring(
            k=1.6e10 * share,
            f_peak=4.8e6 * share,
            d_peak=6e-4,
            k_soft=rng.uniform(5e7, 5e8) * share,
            f_res=rng.uniform(0.1, 0.6) * 4.8e6 * share,
            contact=rng.uniform(0, 0.5),
            misfit=rng.uniform(0, 0.5),
            wear=rng.uniform(0, 0.05),
        )
    elif kind == "contact":
        strip = Compression(1.6e10 * share)
    else:
        strip = Bilinear(k=1.6e10 * share, d_y=rng.uniform(1e-4, 6e-4), k_post=1e8 * share)
    if rng.random() < 0.5:
        bar: rbsdem.Spring = SteelSpring(8e8, 7.2e5, rng.choice([0.0, 8e6]), r0=8)
    else:
        bar = Bilinear(k=8e8, d_y=9e-4, k_post=rng.choice([0.0, 8e6]))
    return Layered([*((y, strip) for y in places), (-0.16, bar), (0.16, bar)])


def problem(rng: Generator) -> tuple[rbsdem.Column, dict[str, list[float]]]:
    """Return a column and what drives it."""
    n = int(rng.choice([1, 1, 2, 2, 3, 5, 7]))
    top = str(rng.choice(["free", "free", "free", "fixed"]))
    joints = n + (top == "fixed")
    moment = 10 ** rng.uniform(4.5, 6)
    load = float(rng.choice([0.0, rng.uniform(0, 0.6), rng.uniform(0, 3)])) * moment / HEIGHT * 3
    shear, flexure = [], []
    layered = rng.random() < 0.4
    for i in range(joints):
        force = moment / HEIGHT * float(rng.choice([1.0, rng.uniform(0.7, 3)]))
        shear.append(spring(rng, force, 10 ** rng.uniform(-4, -2)))
        if layered and rng.random() < 0.7:
            joint = rocking(rng, load) if rng.random() < 0.6 else layered_joint(rng)
            flexure.append(joint)
        else:
            share = rng.uniform(0.7, 2.0) * (1 - 0.8 * i / joints)
            flexure.append(spring(rng, moment * share, 10 ** rng.uniform(-3.5, -2)))
    if rng.random() < 0.4:
        shear, flexure = [shear[0]] * joints, [flexure[0]] * joints
    kinematics = str(rng.choice(["small", "small", "pdelta", "pdelta", "finite"]))
    varies = rng.random() < 0.25
    column = rbsdem.Column(
        HEIGHT, 600.0, shear, flexure, n=n, kinematics=kinematics, axial_load=load,
        top=top,
        axial_force_ratio=float(rng.choice([0.5, 1.5])) if varies and rng.random() < 0.7 else 0.0,
    )  # fmt: skip
    by_force = rng.random() < 0.15
    if by_force:
        largest = moment / HEIGHT * 10 ** rng.uniform(-1, 0.3)
    else:
        largest = HEIGHT * 10 ** rng.uniform(-3, -1.2)
    drive = {"force" if by_force else "displacement": targets(rng, largest)}
    if varies and (kinematics != "small" or layered):
        points = len(next(iter(drive.values())))
        drive["axial_load"] = [load * float(rng.uniform(0.5, 1.5)) for _ in range(points)]
    return column, drive


def shortening(q: np.ndarray, lengths: np.ndarray, fixed: bool) -> float:
    """Return by how much the top comes down with small rotations, to second order."""
    m = len(lengths)
    turned = np.cumsum(q[m:])
    before = turned - q[m:]
    if fixed:
        before[-1] = 0.0
    return float(q[:m] @ before + 0.5 * lengths @ turned**2)


def defects(result: rbsdem.Result, load: float | list[float]) -> tuple[float, float, float]:
    """Return the largest defects of geometry, equilibrium and energy, each as a share."""
    column = result.column
    if np.abs(result.displacement).max() > FAR:
        return 0.0, 0.0, 0.0
    slip, turn = result.slip, result.rotation
    m = slip.shape[1]
    fixed = column.top == "fixed"
    below = HEIGHT / column.n * np.arange(m)
    lengths = np.where(below < 0.999 * HEIGHT, HEIGHT / column.n, 0.0)
    works = [np.abs(result.energy[name]).max() for name in ("input", "spring", "axial")]
    energy = np.abs(result.energy["residual"]).max() / max(*works, NO_WORK)
    if column.kinematics == "finite":
        angle = np.cumsum(turn, axis=1)
        before = angle - turn
        if fixed:
            before[:, -1] = 0.0
        parts = np.column_stack([slip * np.cos(before), lengths * np.sin(angle)])
    else:
        parts = np.column_stack([slip, turn * (HEIGHT - below)])
    size = max(np.abs(parts).max(), 1e-300)
    geometry = np.abs(parts.sum(axis=1) - result.displacement).max() / size
    if column.kinematics == "finite":
        return geometry, 0.0, energy
    arm = np.concatenate([np.ones(m), HEIGHT - below])
    loads = np.outer(result.force, arm)
    if column.kinematics == "pdelta":
        given = np.broadcast_to(load, len(turn) if np.ndim(load) == 0 else np.shape(load))
        press = given[: len(turn)] + column.axial_force_ratio * result.force
        # The shortening is quadratic: its gradient by central differences is exact.
        steps = np.eye(2 * m)
        lowers = partial(shortening, lengths=lengths, fixed=fixed)
        slopes = [
            [0.5 * (lowers(q + e) - lowers(q - e)) for e in steps]
            for q in np.column_stack([slip, turn])
        ]
        loads += press[:, None] * np.array(slopes)
    off = loads - np.column_stack([result.shear, result.moment])
    if fixed:
        # The rotations add up to zero: the moment that holds the top acts on every joint.
        off = np.column_stack([off[:, :m], off[:, m:-1] - off[:, -1:]])
    off[:, m:] /= HEIGHT
    size = max(np.abs(result.shear).max(), np.abs(result.moment).max() / HEIGHT, NO_FORCE)
    return geometry, np.abs(off).max() / size, energy


def judge(seed: tuple[int, int]) -> tuple[str, str]:
    """Follow one path; return its class and what is to be said of it."""
    rng = np.random.default_rng(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            column, drive = problem(rng)
            result = rbsdem.cyclic(column, **drive)
            kind, message = result.summary["status"], ""
        except rbsdem.InputError as error:
            return "no column", str(error)
        except rbsdem.SolveError as error:
            result, kind, message = error.result, "error", str(error)
        if result is None or not len(result.displacement):
            return kind, message
        off = defects(result, drive.get("axial_load", column.axial_load))
    if kind in ("error", "axial_failure") and "axial_load" in drive:
        # It ended between two rows, under an axial load that only the solver knows.
        off = off[0], 0.0, off[2]
    limits = CURVED if column.kinematics == "finite" else (GEOMETRY, EQUILIBRIUM, ENERGY)
    if any(a > b for a, b in zip(off, limits, strict=True)):
        about = f"n={column.n} {column.kinematics} {column.top} {'+'.join(drive)}"
        rules = {s.rule for s in [*column.joints("shear"), *column.joints("flexure")]}
        shares = " ".join(f"{share:.1e}" for share in off)
        return "WRONG", f"{about} {' '.join(sorted(rules))}: {shares} {kind} {message}"
    return kind, message


def main(count: int = 100_000, first: int = 1) -> None:
    """Follow the paths and print what was found."""
    seeds = list(zip(itertools.repeat(first), range(count), strict=False))
    classes: dict[str, int] = {}
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for seed, (kind, text) in zip(seeds, pool.imap(judge, seeds, chunksize=50), strict=True):
            classes[kind] = classes.get(kind, 0) + 1
            if kind == "WRONG":
                print(seed, text, flush=True)
    print(", ".join(f"{kind} {number}" for kind, number in sorted(classes.items())))


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
