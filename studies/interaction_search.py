"""Search for paths under a varying axial load whose answer depends on increments, or lose energy.

    python studies/interaction_search.py [--cases N] [--seed S]

Random columns of one to three bodies with layered joints (bars, concrete, contacts, bilinear ones),
some with axial springs too, follow random displacements under random axial loads, on the static
path with small rotations, with P-Delta and with exact rotations, N given or in proportion to the
force. Every path is followed once more with every
way cut into seven parts. Printed are the cases whose forces differ, whose balance of energy is
open, or of which only one ends; and the counts.
"""

from __future__ import annotations

import argparse
import warnings
from collections import Counter

import numpy as np

import rbsdem

PARTS = 7


def layered_joint(rng: np.random.Generator) -> rbsdem.Layered:
    """Return a joint 0.4 m deep with bars, and strips of one kind."""
    strips = int(rng.integers(2, 13))
    places = 0.4 * ((np.arange(strips) + 0.5) / strips - 0.5)
    share = 1 / strips
    kind = rng.choice(["concrete", "contact", "bilinear"])
    if kind == "concrete":
        strip: rbsdem.Spring = rbsdem.ConcreteSpring(
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
        strip = rbsdem.Compression(1.6e10 * share)
    else:
        strip = rbsdem.Bilinear(k=1.6e10 * share, d_y=rng.uniform(1e-4, 6e-4), k_post=1e8 * share)
    if rng.random() < 0.5:
        bar: rbsdem.Spring = rbsdem.SteelSpring(8e8, 7.2e5, rng.choice([0.0, 8e6]), r0=8)
    else:
        bar = rbsdem.Bilinear(k=8e8, d_y=9e-4, k_post=rng.choice([0.0, 8e6]))
    return rbsdem.Layered([*((y, strip) for y in places), (-0.16, bar), (0.16, bar)])


def axial_spring(rng: np.random.Generator) -> rbsdem.Spring | None:
    """Return an axial spring, mostly none."""
    if rng.random() < 0.7:
        return None
    if rng.random() < 0.5:
        return rbsdem.Elastic(3e9)
    return rbsdem.Bilinear(k=3e9, d_y=1e-4, k_post=rng.choice([1e7, 1e9]))


def case(rng: np.random.Generator) -> tuple[rbsdem.Column, np.ndarray, np.ndarray]:
    """Return a column, displacements and axial loads."""
    n = int(rng.integers(1, 4))
    joints: list[rbsdem.Spring] = [layered_joint(rng)]
    joints += [
        layered_joint(rng) if rng.random() < 0.5 else rbsdem.Elastic(1e8) for _ in range(n - 1)
    ]
    column = rbsdem.Column(
        1.6,
        600.0,
        rbsdem.Elastic(7e8),
        joints,
        n=n,
        kinematics=str(rng.choice(["small", "pdelta", "finite"])),
        axial_force_ratio=float(rng.choice([0.0, 1.0, -2.0])),
        axial_spring=axial_spring(rng),
    )
    points = int(rng.integers(4, 12))
    if rng.random() < 0.2:
        return column, 0.5 * rng.uniform(-1, 1, points), rng.uniform(-1e5, 5e5, points)
    return column, 0.03 * rng.uniform(-1, 1, points), rng.uniform(-1e5, 1.2e6, points)


def follow(
    column: rbsdem.Column, path: np.ndarray, load: np.ndarray
) -> tuple[str, np.ndarray, float, str]:
    """Return status, forces, open energy over the largest, and the message of a failure."""
    try:
        result = rbsdem.cyclic(column, displacement=path, axial_load=load)
    except rbsdem.SolveError as stop:
        forces = stop.result.force if stop.result is not None else np.empty(0)
        return "failed", forces, 0.0, str(stop)
    about = result.summary
    return about["status"], result.force, about["relative_energy_residual"], ""


def judge(seed: tuple[int, int]) -> tuple[str, str]:
    """Return what one case came to, and what is wrong with it ("" if nothing is).

    The first is a status, "refused", "other end", "open energy" or "other forces".
    """
    column, path, load = case(np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rbsdem.AccuracyWarning)
        try:
            status, forces, energy, message = follow(column, path, load)
        except rbsdem.InputError as refusal:
            return "refused", str(refusal)
        at = np.arange(path.size)
        fine = np.linspace(0, path.size - 1, (path.size - 1) * PARTS + 1)
        cut, parts, _, _ = follow(column, np.interp(fine, at, path), np.interp(fine, at, load))
    if cut != status:
        return "other end", f"{status}, cut into parts {cut}"
    if energy > 1e-9:
        return "open energy", f"{energy:.1e} of the largest"
    if status == "completed":
        wrong = np.abs(parts[::PARTS] - forces).max() / np.abs(forces).max()
        if wrong > 1e-7:
            return "other forces", f"by {wrong:.1e} of the largest"
    return status, message


def main() -> None:
    """Search and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    for number in range(given.cases):
        kind, wrong = judge((given.seed, number))
        counts[kind] += 1
        if wrong:
            print(f"case {number}: {kind}, {wrong}")
    print(dict(counts))


if __name__ == "__main__":
    main()
