"""Frames and struts whose answers are printed, for `rbsdem.methods.problems`."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from rbsdem._types import Array, ArrayLike
from rbsdem.errors import SolveError
from rbsdem.model.frame import FrameMember, FrameNode, Member
from rbsdem.model.springs import Elastic, Spring
from rbsdem.run.analysis import modes
from rbsdem.run.result import cyclic, pushover
from rbsdem.section.building import Frame

INCH, FOOT = 0.0254, 0.3048
KIP = 1000 * 0.45359237 * 9.80665
MASS = KIP / INCH  # kip s2/in
KSI = KIP / INCH**2


def seven_storeys() -> Frame:
    """Return the frame of example 1-022: two bays, masses on the left line, rigid floors."""
    shapes = {
        "W14X176": (51.7, 2150), "W14X211": (62.1, 2670), "W14X246": (72.3, 3230),
        "W14X287": (84.4, 3910), "W24X110": (32.5, 3330), "W24X130": (38.3, 4020),
        "W24X160": (47.1, 5120),
    }  # fmt: skip
    modulus = 29500 * KSI
    kinds = {
        name: FrameMember(modulus, area * INCH**2, inertia * INCH**4)
        for name, (area, inertia) in shapes.items()
    }
    outer = ["W14X246"] * 3 + ["W14X211"] * 2 + ["W14X176"] * 2
    inner = ["W14X287"] * 3 + ["W14X246"] * 2 + ["W14X211"] * 2
    beams = ["W24X160"] * 2 + ["W24X130"] * 2 + ["W24X110"] * 3
    storeys = np.array([162] * 2 + [156] * 5) * INCH
    pushes = np.array([2.5, 5, 7.5, 10, 12.5, 15, 20])
    nodes = [FrameNode(f"N-1-{i + 1}", push_x=push / pushes.sum()) for i, push in enumerate(pushes)]
    # The masses have no weight upward: they stand on rollers, held by members without stiffness.
    nodes += [
        FrameNode(f"M-{i + 1}", x=-1, y=y, support="roller", mass=0.49 * MASS,
                  moves_with=f"N-1-{i + 1}")
        for i, y in enumerate(np.cumsum(storeys))
    ]  # fmt: skip
    weak = FrameMember(modulus, 1e-9, 1e-14)
    return Frame.grid(
        storeys,
        [360 * INCH] * 2,
        columns={(i, s + 1): kinds[(outer, inner)[i == 2][s]] for i in (1, 2, 3) for s in range(7)},
        beams={(b, s + 1): kinds[beams[s]] for b in (1, 2) for s in range(7)},
        nodes=nodes,
        members=[Member(f"M-{i}", f"N-1-{i}", f"M-{i}", kind=weak) for i in range(1, 8)],
        diaphragm=True,
        pattern="nodes",
    )


def pushed_seven_storeys() -> list[float]:
    """Return the displacement of its top under 72.5 kip [in]."""
    push = pushover(seven_storeys(), force=72.5 * KIP, points=1)
    return [push.displacement[-1] / INCH]


def nine_storeys() -> Array:
    """Return eigenvalues of the frame of Bathe and Wilson: 10 bays, all members alike."""
    kind = FrameMember(432000 * KIP / FOOT**2, 3 * FOOT**2, FOOT**4)
    half = 3 * KIP / FOOT**2 / 2  # mass of half a length of a member
    nodes = [
        FrameNode(
            f"N-{line}-{floor}",
            mass=half
            * FOOT
            * (10 * (1 + (floor < 9)) + 20 * (1 + (1 < line < 11)))  # columns, then beams
        )
        for line in range(1, 12)
        for floor in range(1, 10)
    ]  # fmt: skip
    frame = Frame.grid([10 * FOOT] * 9, [20 * FOOT] * 10, columns=kind, beams=kind, nodes=nodes)
    return np.asarray(modes(frame, 3).omega ** 2)


def flexible_beams() -> Array:
    """Return frequencies of two storeys over sqrt(EI/(m h^3)); 2 m and 2 EI below, bay of 2 h."""
    inertia, height, mass = 1e-4, 3.0, 1e4
    upper, lower = (FrameMember(2e11, 10.0, share * inertia) for share in (1, 2))
    kinds = {(0, 1): lower, (0, 2): upper}
    frame = Frame.grid(
        [height] * 2, [2 * height], columns=kinds, beams=kinds, floor_mass=[2 * mass, mass],
        diaphragm=True,
    )  # fmt: skip
    return np.asarray(modes(frame, 2).omega / np.sqrt(2e11 * inertia / (mass * height**3)))


def strut(
    kind: FrameMember, length: float, loads: ArrayLike, guide: Spring | None = None, **more: float
) -> Array:
    """Return moments [N m], then displacements across [m], of a strut under axial loads [N].

    With `tip`, a force across [N], it is a cantilever, of its foot and top, which a spring may
    guide against rotation; with `across`, a load
    per length [N/m], it has pins at both ends, and the numbers are those of its middle. It
    is one member, or two.
    """
    pins = "across" in more
    parts, at = 1 + pins, 1
    ends = {0: "pinned" if pins else "fixed", parts: "roller" if pins else "free"}
    members = [
        Member(f"M-{i}", f"{i}", f"{i + 1}", kind, load=more.get("across", 0.0))
        for i in range(parts)
    ]

    def under(load: float) -> tuple[float, float]:
        nodes = [
            FrameNode(
                f"{i}", length * i / parts, 0.0, ends.get(i, "free"),
                load_x=-load if i == parts else 0.0, push_y=float(-(i == at)),
                flexure=guide if i == parts else None,
            )
            for i in range(parts + 1)
        ]  # fmt: skip
        frame = Frame(nodes=nodes, members=members, pattern="nodes", control="y",
                      control_node=f"{at}", kinematics="pdelta")  # fmt: skip
        run = cyclic(frame, force=[more.get("tip", 0.0)])
        return abs(run.moment_from[-1, at if pins else 0]), -float(run.displacement[-1])

    return np.ravel([under(float(load)) for load in np.ravel(loads)], "F")


def aisc(loads: str, *, shear: bool, **more: Any) -> Array:
    """Return moments [kip in], then displacements [in], of a W14x48 of 28 ft."""
    rigidity = 11200 * 13.8 * 0.34 * KIP if shear else 0.0
    kind = FrameMember(
        29e3 * KSI, 14.1 * INCH**2, 484 * INCH**4, shear_rigidity=rigidity, name="W14x48"
    )
    found = strut(kind, 28 * FOOT, KIP * np.array(loads.split(), float), **more)
    return np.asarray(found / np.repeat([KIP * INCH, INCH], found.size // 2))


def beam_column(shares: ArrayLike, halves: int) -> tuple[str, Callable[[], Array]]:
    """Return moment and displacement of a column under shares of Euler's load, in both ways.

    It is a cantilever, or two `halves` of that with a top that is guided.

    L = 196 in, E = 29 500 ksi, A = 51.7 in2, I = 2150 in4, 10 kip across.
    """
    length, modulus, inertia, across = 196.0, 29500.0, 2150.0, 10.0
    critical = halves**2 * np.pi**2 * modulus * inertia / (2 * length) ** 2
    u = np.pi / 2 * np.sqrt(np.asarray(shares))
    moments = across * length / halves * np.tan(u) / u
    sways = across * length**3 / (halves**2 * modulus * inertia) * (np.tan(u) - u) / u**3
    kind = FrameMember(modulus * KSI, 51.7 * INCH**2, inertia * INCH**4)

    def solve() -> Array:
        loads = np.asarray(shares) * critical * KIP
        guide = Elastic(1e9 * kind.modulus * kind.inertia) if halves > 1 else None
        found = strut(kind, length * INCH, loads, guide, tip=across * KIP)
        return np.asarray(found / np.repeat([KIP * INCH, INCH], u.size))

    return " ".join(f"{value:.4g}" for value in (*moments, *sways)), solve


def swaying_portals() -> list[float]:
    """Return the critical loads of the columns over E I/h^2, on pins and on fixed feet.

    The beam has their length and inertia. The loads are those that a refusal tells.
    """
    kind, found = FrameMember(30e9, 1e3, 2e-3), []
    for base, load in (("pinned", 3.0), ("fixed", 10.0)):
        nodes = [FrameNode(f"N-{i}-1", load_y=-load * 30e9 * 2e-3 / 9.0) for i in (1, 2)]
        try:
            Frame.grid([3.0], [3.0], columns=kind, beams=kind, nodes=nodes, base=base,
                       kinematics="pdelta")  # fmt: skip
        except SolveError as error:
            said = re.search(r"under it: ([.e\d-]+) of it", str(error))
            found.append(load * float(said[1]) if said else 0.0)
    return found


def slender() -> Array:
    """Return moment [N m] and displacement [m] of a cantilever of 10 m, 100 mm square, 30 GPa."""
    kind = FrameMember(30e9, 0.1**2, 0.1**4 / 12)
    return strut(kind, 10.0, [4e3], tip=45.0)


def plastic_sway() -> list[float]:
    """Return the sway load of a portal whose beam is stronger, over M_p/h."""
    column = FrameMember(30e9, 1e3, 2e-3, yield_moment=2e5)
    portal = Frame.grid([3.0], [6.0], columns=column, beams=FrameMember(30e9, 1e3, 2e-3))
    return [pushover(portal, drift=0.1).base_shear.max() * 3.0 / 2e5]


def lost_column() -> list[float]:
    """Return the pushdown load of three floors without their middle column, over M_p/L."""
    frame = Frame.grid(
        [3.0] * 3, [6.0] * 2, columns=FrameMember(30e9, 10.0, 0.1), pattern="nodes", control="y",
        beams=FrameMember(30e9, 0.15, 2e-3, yield_moment=2e5), control_node="N-2-1",
        nodes=[FrameNode("N-2-1", push_y=-1.0)],
    )  # fmt: skip
    return [cyclic(frame.without("C-2-1"), displacement=[-0.5]).force[-1] * 6.0 / 2e5]
