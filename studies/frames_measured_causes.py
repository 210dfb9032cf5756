"""What moves the answers to tested frames: one physical change of the model at a time.

    python studies/frames_measured_causes.py [FOLDER] [--ends 0|1|asce]

prints the table of docs/evidence.md: the portals with tie rods, Vecchio and Emara, Park and Dai
Ruitong, each with the members, nodes and loads of `frames_measured.py` but for one change. None of
them is fitted to frames; none of them is taken over here.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from frames_measured import (
    DOUBTFUL,
    OTHER_UNITS,
    PUSH,
    WAY,
    Answers,
    Curve,
    Drawing,
    Part,
    answers,
    cruciform,
    followed,
    kind,
    model,
    options,
    push_path,
    reversals,
    scores,
    two_storeys,
    ways,
    work_of_push,
)

import rbsdem
from rbsdem.frames import FrameMember, FrameNode, JointPanel
from rbsdem.springs import Layered, Pinching, SteelSpring

#: How bars of columns grow stronger with their range of strain, and wear.
OF_COLUMNS = {
    name: getattr(rbsdem.section.parameters(), name) for name in ("isotropic_hardening", "fatigue")
}
#: The share of the yield stress that the layered model adds to the measured one.
ADDED = rbsdem.section.parameters().steel_strength


def on_bars(change: Callable[[SteelSpring, Part], SteelSpring]) -> Callable:
    """Return what makes members whose bars are changed."""

    def spring(part: Part, one: rbsdem.springs.Spring) -> rbsdem.springs.Spring:
        if not isinstance(one, Layered):
            return one
        layers = [(y, change(x, part) if isinstance(x, SteelSpring) else x) for y, x in one.layers]
        return Layered(layers)

    def make(part: Part, length: float) -> FrameMember:
        made = kind(part, length)
        return replace(made, flexure={at: spring(part, one) for at, one in made.flexure})

    return make


def coupon(bar: SteelSpring, part: Part, strength: float = ADDED) -> SteelSpring:
    """Return a bar as in its test in tension: plateau, hardening to its end; without fatigue."""
    steel = part.section.bars[0][2]
    f_y = bar.f_y / ADDED * strength
    slope = (steel.fu - steel.fy) / (steel.eps_u - steel.eps_sh) / steel.es
    return replace(
        bar, f_y=f_y, k_post=slope * bar.k, f_u=f_y * steel.fu / steel.fy, isotropic_hardening=0.0,
        plateau=steel.eps_sh * steel.es / steel.fy - 1.0,
        endurance=0.0, d_buckle=None, buckling=0.0,
    )  # fmt: skip


def cracked_in_shear(part: Part, length: float) -> FrameMember:
    """Return a member that has the shear stiffness of the truss of its ties from the first."""
    made = kind(part, length)

    def spring(one: rbsdem.springs.Spring) -> rbsdem.springs.Spring:
        if not isinstance(one, Pinching):
            return one
        f_c, truss = 0.02 * one.f_y, (one.f_y - one.f_c) / (one.d_y - one.d_c)
        d_c = min(one.d_c * f_c / one.f_c, 0.9 * f_c / truss)
        d_y = d_c + (one.f_y - f_c) / truss
        return replace(one, f_c=f_c, d_c=d_c, d_y=d_y, d_cap=d_y + one.d_cap - one.d_y)

    return replace(made, shear={at: spring(one) for at, one in made.shear})


def panels_of(
    drawing: Drawing, change: Callable[[FrameNode, Pinching | None], Pinching | None]
) -> Drawing:
    """Return a drawing with other springs in its panels."""
    nodes = tuple(replace(node, panel=change(node, node.panel)) for node in drawing.nodes)
    return replace(drawing, nodes=nodes)


def cracked_panels(drawing: Drawing) -> Drawing:
    """Return a drawing whose panels are trusses of their hoops from the first."""

    def change(_: FrameNode, one: Pinching | None) -> Pinching | None:
        if one is None:
            return None
        truss = (one.f_y - one.f_c) / (one.d_y - one.d_c)
        f_c = 0.02 * one.f_y
        d_y = one.f_y / truss
        return replace(
            one, f_c=f_c, d_c=0.9 * f_c / truss, d_y=d_y, d_cap=d_y + one.d_cap - one.d_y
        )

    return panels_of(drawing, change)


def panels_with_ties(drawing: Drawing) -> Drawing:
    """Return a drawing with panels that have the ties of the columns, where it has none."""
    if any(node.panel for node in drawing.nodes):
        return drawing
    column, beam = drawing.parts[0], drawing.parts[-1]
    top = max(node.y or 0.0 for node in drawing.nodes)

    def change(node: FrameNode, _: Pinching | None) -> Pinching | None:
        if not node.y:
            return None
        return JointPanel(
            column.section, beam.section, "knee" if node.y == top else "exterior",
            hoops=column.section.ties, axial_load=column.load,
        ).spring()  # fmt: skip

    return panels_of(drawing, change)


CHANGES: dict[str, tuple[Callable | None, Callable | None]] = {
    "none": (None, None),
    "bars slip twice as far": (partial(kind, slip_length=2 * 0.0158), None),
    "bars do not slip": (partial(kind, slip_length=1e-4), None),
    "bars at 1.00 of the measured yield stress, not 1.05": (
        partial(kind, steel_strength=1.0),
        None,
    ),
    "bars of beams as those of columns": (partial(kind, **OF_COLUMNS), None),
    "bars of columns as those of beams": (
        partial(kind, isotropic_hardening=0.0, fatigue=0.0),
        None,
    ),
    "bars as in their test in tension, 1.05": (on_bars(coupon), None),
    "bars as in their test in tension, 1.00": (on_bars(partial(coupon, strength=1.0)), None),
    "members cracked in shear from the first": (cracked_in_shear, None),
    "no second-order work": (None, lambda drawing: replace(drawing, tied=True)),
    "panels with the ties of the columns": (None, panels_with_ties),
    "panels cracked from the first": (None, cracked_panels),
}


def changed(make: Callable | None, draw: Callable | None) -> Callable:
    """Return a program with a change."""

    def program(drawing: Drawing, path: np.ndarray, unload: bool) -> Curve:
        return followed(draw(drawing) if draw else drawing, path, unload, make or kind)

    return program


def row(name: str, found: Answers, test: np.ndarray) -> str:
    """Return a row of the table."""
    portals = found.portals[True]

    def ratios(what: str, without: set[int]) -> str:
        pairs = (getattr(one, what) for number, one in portals.items() if number not in without)
        return scores([of_test / own for of_test, own in pairs])[1].rsplit(",", 1)[0]

    push, loops = found.vecchio_emara, found.park_ruitong
    moved, force = push.displacement[:PUSH], push.force[:PUSH]
    top = int(force.argmax())
    secant = push.yielded[1] / push.yielded[0] / 1e6
    at = np.arange(WAY - 1, loops.force.size, WAY)
    ratio = test[: at.size, 1] / loops.force[at]
    share = 100 * np.abs(loops.panel[at] * 2.473 / loops.displacement[at])
    cells = (
        name,
        ratios("peak", DOUBTFUL),
        ratios("first", DOUBTFUL | OTHER_UNITS),
        f"{force[top] / 1e3:.0f} at {1e3 * moved[top]:.0f}",
        f"{secant:.1f}; {np.interp(0.05, moved, force) / 0.05e6:.1f}",
        work_of_push(push),
        f"{np.median(ratio):.2f}, {ratio.min():.2f} to {ratio.max():.2f}"
        + ("" if at.size == len(test) else f" ({at.size} reversals)"),
        f"{share.min():.0f} to {share.max():.0f}",
    )
    return "| " + " | ".join(cells) + " |"


def largest_growth(drawing: Drawing, path: np.ndarray) -> tuple[float, float]:
    """Return the largest range of strain of a bar over its yield strain, and its growth there.

    The growth is that of the strength by isotropic hardening (docs/rules.md).
    """
    frame = model(drawing)
    try:
        run = rbsdem.cyclic(frame, displacement=path)
    except rbsdem.SolveError as error:
        run = error.result
    turns = [one for one in frame.parts.springs_of("flexure") if one.group == "flexure"]
    at = {(one.member, one.place): i for i, one in enumerate(turns)}
    found = (0.0, 1.0)
    for i, joint in enumerate(frame.parts.springs_of("axial_spring")):
        opening = run.springs["opening"][:, i]
        rotation = run.springs["rotation"][:, at[joint.member, joint.place]]
        made = frame.kinds[joint.member].at("flexure", joint.place)
        for y, bar in made.layers if isinstance(made, Layered) else ():
            if isinstance(bar, SteelSpring):
                strain = np.append(opening + y * rotation, 0.0) * bar.k / bar.f_y
                reach = max(strain.max(), 1.0) - min(strain.min(), -1.0) - 2.0
                growth = 1.0 + bar.isotropic_hardening * (0.5 * reach) ** 0.8
                found = max(found, (float(reach), float(growth)))
    return found


def main() -> None:
    """Print the table."""
    asked = options()
    warnings.simplefilter("ignore")
    print(
        "| change | portals: peak | first stiffness | V-E: peak, kN at mm | secant at first yield; "
        "at 50 mm, kN/mm | work, kN m | P-R: force | node, % |"
    )
    print("|" + " --- |" * 8)
    for name, change in CHANGES.items():
        found = answers(asked.folder, asked.ends, changed(*change))
        print(row(name, found, reversals(asked.folder)), flush=True)
    for who, drawing, path in (
        ("Vecchio and Emara", two_storeys(asked.ends), push_path()),
        ("Park and Dai Ruitong", cruciform(asked.ends), ways(asked.folder)),
    ):
        reach, growth = largest_growth(drawing, path)
        print(f"{who}: range of strain of a bar {reach:.0f} yield strains, strength {growth:.2f}")


if __name__ == "__main__":
    main()
