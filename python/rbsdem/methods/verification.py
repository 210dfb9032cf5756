"""Problems whose answers textbooks, standards and other programs print, and those of rbsdem.

An oscillator of mass m, stiffness k and damping c is a column of one body whose flexural spring is
1e9 times as stiff as k h^2: the body does not rotate, and what is left of the rotation changes
displacements by less than 1e-8 of themselves. Inches and kips are converted exactly (25.4 mm; the
pound-force is 0.45359237 kg times 9.80665 m/s2).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, ArrayLike, DataFrame
from rbsdem.errors import InputError, SolveError
from rbsdem.model.column import Column, Damping, notes_off
from rbsdem.model.frame import FrameMember, FrameNode, Member
from rbsdem.model.materials import Concrete, Steel, Ties
from rbsdem.model.shape import RectangularSection
from rbsdem.model.springs import Bilinear, Compression, Elastic, Layered, Spring
from rbsdem.run.analysis import modes
from rbsdem.run.response import cyclic, pushover, time_history
from rbsdem.section.frame import Frame
from rbsdem.section.plan import Building
from rbsdem.section.strength import axial_failure_drift, interaction

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
    """Return the displacement of the top of `seven_storeys` under 72.5 kip [in]."""
    push = pushover(seven_storeys(), force=72.5 * KIP, points=1)
    return [push.displacement[-1] / INCH]


def as_building() -> Array:
    """Return the periods of `seven_storeys` as a building of one line, masses on its floors."""
    frame = seven_storeys()
    bare = replace(frame, nodes=[node for node in frame.nodes if not node.mass], members=())
    return modes(Building([(bare, 0.0, 0.0)], floor_mass=0.49 * MASS, pattern="nodes"), 7).period


def peterson(turned: float = 0.0) -> Building:
    """Return the eccentric building of two storeys, turned in plan by some degrees [ft, kip]."""
    column, beam = FrameMember(3.5e5, 4.0, 1.25), FrameMember(5e5, 1.0, 2.61)
    along_x, along_y = (Frame([13.0] * 2, [bay] * 2, column, beam) for bay in (35.0, 25.0))
    frames = [(along_x, turned, -y, 0.0) for y in (0.0, 25.0, 50.0)]
    frames += [(along_y, turned + 90.0, x, 0.0) for x in (0.0, 35.0, 70.0)]
    c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    centre = 38.0 * c - 27.0 * s, 38.0 * s + 27.0 * c
    return Building(frames, centres=centre, floor_mass=6.21118, inertia=0.0, direction=turned)


def eccentric_building(turned: float = 0.0) -> list[float]:
    """Return the periods of `peterson`, and its roof under a flat 0.4 g, summed by squares [ft]."""
    found = modes(peterson(turned), 4)
    c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    along = c * found.floor_x + s * found.floor_y
    roof = 0.4 * 32.2 / found.omega**2 * 6.21118 * along.sum(axis=0) * along[1]
    return [*found.period, float(np.hypot.reduce(roof))]


def sprung_storey(spring: Spring, mass: float = 0.0, load: float = 0.0) -> Frame:
    """Return a storey of 3 m on a post between pins, held by a spring from the ground."""
    post = FrameMember(3e10, 1.0, 1.0, ends="pinned")
    nodes = [
        FrameNode("foot", 0.0, 0.0, support="fixed", floor=0),
        FrameNode("anchor", -4.0, 3.0, support="fixed"),
        FrameNode("top", 0.0, 3.0, floor=1, mass=mass, load_y=-load),
    ]
    strut = FrameMember.strut(spring)
    members = [Member("post", "foot", "top", post), Member("spring", "anchor", "top", strut)]
    return Frame(nodes=nodes, members=members)


def eccentric_storey() -> Building:
    """Return a storey of four springs that yield, those along x of unlike stiffness."""

    def yielding(k: float, force: float) -> Frame:
        return sprung_storey(Bilinear(k, force / k, 1e-9 * k))

    frames = [(yielding(60e6, 600e3), 0.0, 5.0), (yielding(30e6, 300e3), 0.0, -5.0)]
    return Building([*frames, *((yielding(40e6, 500e3), 90.0, x) for x in (-8.0, 8.0))])


def yields_in_plan() -> list[float]:
    """Return the load at first yield [N], and U [mm] and Theta where both frames yield."""
    building = eccentric_storey()
    first = cyclic(building, displacement=[0.011], corners=True).force[1]
    last = cyclic(building, force=[900e3 * (1.0 - 1e-12)])
    return [first, 1e3 * last.displacement[-1], abs(last.floor_rotation[-1, 0])]


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

    With `tip`, a force across [N], it is a cantilever of one member whose top the spring `guide`
    may hold against rotation; the moment is that of its foot, the displacement that of its top.
    With `across`, a load per length [N/m], it has pins at both ends and is two members; the numbers
    are those of its middle.
    """
    pins = "across" in more
    parts, at = 1 + pins, 1
    ends = {0: "pinned" if pins else "fixed", parts: "roller" if pins else "free"}
    members = [
        Member(f"M-{i}", f"{i}", f"{i + 1}", kind, load=more.get("across", 0.0))
        for i in range(parts)
    ]

    def under(load: float) -> tuple[float, float]:
        """Return moment [N m] and displacement across [m] under one axial load [N]."""
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
    answers = strut(kind, 28 * FOOT, KIP * np.array(loads.split(), float), **more)
    return np.asarray(answers / np.repeat([KIP * INCH, INCH], answers.size // 2))


def beam_column(shares: ArrayLike, halves: int) -> tuple[str, Callable[[], Array]]:
    """Return moments and displacements of a column under shares of Euler's load.

    First by the closed form as a text, then as a function that solves for them. The column is a
    cantilever, or, with two `halves`, has a top that is guided.

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
        answers = strut(kind, length * INCH, loads, guide, tip=across * KIP)
        return np.asarray(answers / np.repeat([KIP * INCH, INCH], u.size))

    return " ".join(f"{value:.4g}" for value in (*moments, *sways)), solve


def swaying_portals() -> list[float]:
    """Return the critical loads of the columns over E I/h^2, on pins and on fixed feet.

    The beam has their length and inertia. The loads are those that a refusal tells.
    """
    kind, loads = FrameMember(30e9, 1e3, 2e-3), []
    for base, load in (("pinned", 3.0), ("fixed", 10.0)):
        nodes = [FrameNode(f"N-{i}-1", load_y=-load * 30e9 * 2e-3 / 9.0) for i in (1, 2)]
        try:
            Frame.grid([3.0], [3.0], columns=kind, beams=kind, nodes=nodes, base=base,
                       kinematics="pdelta")  # fmt: skip
        except SolveError as error:
            said = re.search(r"under it: ([.e\d-]+) of it", str(error))
            loads.append(load * float(said[1]) if said else 0.0)
    return loads


def slender() -> Array:
    """Return moment [N m] and displacement [m] of a cantilever of 10 m, 100 mm square, 30 GPa."""
    kind = FrameMember(30e9, 0.1**2, 0.1**4 / 12)
    return strut(kind, 10.0, [4e3], tip=45.0)


def plastic_sway() -> list[float]:
    """Return the sway load of a portal whose beam is stronger, over M_p/h."""
    column = FrameMember(30e9, 1e3, 2e-3, yield_moment=2e5)
    portal = Frame.grid([3.0], [6.0], columns=column, beams=FrameMember(30e9, 1e3, 2e-3))
    return [pushover(portal, drift=0.1).base_shear.max() * 3.0 / 2e5]


def coupled_walls() -> list[float]:
    """Return the limit load of two walls of 2 m, four storeys, whose beams yield [N]."""
    foot = FrameMember(30e9, 0.5, 0.15, yield_moment=1.2e6)
    beam = FrameMember(30e9, 0.12, 9e-4, yield_moment=0.15e6, rigid_end=(1.0, 1.0))
    nodes = [FrameNode(f"N-1-{i}", push_x=0.1 * i) for i in range(1, 5)]
    columns = {(0, 0): FrameMember(30e9, 0.5, 0.15), (0, 1): foot}
    grid = Frame.grid([3.0] * 4, [3.5], columns=columns, beams=beam, nodes=nodes, pattern="nodes")
    return [pushover(grid, drift=0.02).base_shear.max()]


def coupled_continuum() -> list[float]:
    """Return the displacement of the top of two elastic walls of 20 storeys [mm]."""
    walls = {(i, 0): FrameMember(36e9, 0.3 * b, 0.3 * b**3 / 12) for i, b in ((1, 5.0), (2, 7.0))}
    beam = FrameMember(36e9, 0.3 * 0.4, 0.3 * 0.4**3 / 12, rigid_end=(2.5, 3.5))
    nodes = [FrameNode(f"N-1-{i}", push_x=(1.0 if i < 20 else 0.5) / 19.5) for i in range(1, 21)]
    grid = Frame.grid([2.8] * 20, [8.0], columns=walls, beams=beam, nodes=nodes, pattern="nodes")
    return [1e3 * pushover(grid, force=16.5e3 * 2.8 * 19.5, points=1).displacement[-1]]


def _rocking_foot() -> Layered:
    """Return a joint of 1.2192 m that opens."""
    length, layers = 1.2192, 200
    places = length * ((np.arange(layers) + 0.5) / layers - 0.5)
    return Layered([(float(y), Compression(1e12)) for y in places])


def rocking_wall() -> list[float]:
    """Return the force of a wall without bars that rocks on 200 layers at 2 % drift [kN]."""
    wall = Column(3.66, 1.0, axial_load=378e3, shear=Elastic(1e15), flexure=_rocking_foot())
    return [1e-3 * pushover(wall, drift=0.02).force.max()]


def rocking_line() -> list[float]:
    """Return the force of `rocking_wall` in a frame of three storeys, with P-Delta, at 2 % [kN]."""
    above = FrameMember(1e13, 1.0, 1.0)
    top = FrameNode("N-1-3", load_y=-378e3, push_x=1.0)
    lowest = FrameMember(1e13, 1.0, 1.0, flexure={0.0: _rocking_foot()})
    frame = Frame.grid(
        [1.22] * 3, columns={(1, 0): above, (1, 1): lowest}, nodes=[top], pattern="nodes",
        kinematics="pdelta",
    )  # fmt: skip
    return [1e-3 * pushover(frame, drift=0.02).base_shear[-1]]


def tied_parts() -> list[float]:
    """Return the limit load of two portals and a wall behind each other, tied at their floor [N].

    Portals of 3 m with moments of 0.2 and 0.3 MN m in their columns, the wall with 1.2 MN m.
    """
    stiff = FrameMember(30e9, 1e3, 2e-3)
    first, second = (FrameMember(30e9, 1e3, 2e-3, yield_moment=m) for m in (2e5, 3e5))
    wall = FrameMember(30e9, 1e3, 0.15, flexure={0.0: Bilinear(k=1e9, d_y=1.2e-3, k_post=0.0)})
    floor: Any = {"y": 3.0, "moves_with": "N-1-1"}
    nodes = [
        FrameNode("N-1-1", push_x=1.0),
        *(FrameNode(f"P-{i}-0", x=20.0 + 6.0 * i, y=0.0, support="fixed") for i in (0, 1, 2)),
        FrameNode("P-0-1", x=20.0, **floor),
        FrameNode("P-1-1", x=26.0, y=3.0),
        FrameNode("P-2-1", x=32.0, **floor),
    ]
    members = [
        Member("C-a", "P-0-0", "P-0-1", second),
        Member("C-b", "P-1-0", "P-1-1", second),
        Member("B-a", "P-0-1", "P-1-1", stiff),
        Member("W", "P-2-0", "P-2-1", wall),
    ]
    frame = Frame.grid([3.0], [6.0], columns=first, beams=stiff, nodes=nodes, members=members,
                       pattern="nodes")  # fmt: skip
    return [pushover(frame, drift=0.1).base_shear.max()]


def leaning() -> list[float]:
    """Return the displacement of a column that holds another, on pins, under 2 MN [m]."""
    nodes = [
        FrameNode("L-0", x=5.0, y=0.0, support="pinned"),
        FrameNode("L-1", x=5.0, y=3.0, moves_with="N-1-1", load_y=-2e6),
    ]
    column = FrameMember(30e9, 1e3, 2e-3)
    strut = Member("L", "L-0", "L-1", FrameMember(30e9, 1e3, 2e-3, ends="pinned"))
    frame = Frame.grid([3.0], columns=column, nodes=nodes, members=[strut], kinematics="pdelta")
    return [cyclic(frame, force=[1e5]).displacement[-1]]


def wall_and_frame() -> tuple[str, Callable[[], list[float]]]:
    """Return the displacement of the top of a wall and a frame of 20 storeys, in both ways [mm].

    A wall of 0.3 x 6 m; two columns 0.4 m square between beams that do not bend; 20 kN/m.
    """
    number, height, modulus, load = 20, 3.0, 30e9, 20e3
    inertia, of_column = 0.3 * 6.0**3 / 12, 0.4**4 / 12
    whole = number * height
    shear = 12 * modulus * 2 * of_column / height**2
    k = whole * math.sqrt(shear / (modulus * inertia))
    share = (k * math.sinh(k) + 1) / math.cosh(k) * (math.cosh(k) - 1) - k * math.sinh(k)
    top = load * whole**4 / (modulus * inertia) / k**4 * (share + 0.5 * k**2)

    def solve() -> list[float]:
        levels = range(1, number + 1)
        nodes = [
            FrameNode(f"N-1-{i}", push_x=(0.5 if i == number else 1.0) / (number - 0.5))
            for i in levels
        ]
        nodes.append(FrameNode("W-0", x=20.0, y=0.0, support="fixed"))
        nodes += [FrameNode(f"W-{i}", x=20.0, y=i * height, moves_with=f"N-1-{i}") for i in levels]
        kind = FrameMember(modulus, 1e3, inertia)
        frame = Frame.grid(
            [height] * number, [6.0], columns=FrameMember(modulus, 1e3, of_column),
            beams=FrameMember(modulus, 1e3, 1e3 * of_column), nodes=nodes, pattern="nodes",
            members=[Member(f"W-{i}", f"W-{i - 1}", f"W-{i}", kind) for i in levels],
        )  # fmt: skip
        force = load * height * (number - 0.5)
        return [1e3 * pushover(frame, force=force, points=1).displacement[-1]]

    return f"{1e3 * top:.2f}", solve


def lost_column() -> list[float]:
    """Return the pushdown load of three floors without their middle column, over M_p/L."""
    frame = Frame.grid(
        [3.0] * 3, [6.0] * 2, columns=FrameMember(30e9, 10.0, 0.1), pattern="nodes", control="y",
        beams=FrameMember(30e9, 0.15, 2e-3, yield_moment=2e5), control_node="N-2-1",
        nodes=[FrameNode("N-2-1", push_y=-1.0)],
    )  # fmt: skip
    return [cyclic(frame.without("C-2-1"), displacement=[-0.5]).force[-1] * 6.0 / 2e5]


RIGID = 1e9


@dataclass(frozen=True)
class Problem:
    """A problem whose answer is printed elsewhere.

    Attributes
    ----------
    name : str
        Short name, by which it is asked for.
    source : str
        Where the numbers are printed.
    what : str
        The quantity, and its unit.
    printed : str
        The numbers as they are printed, with blanks between them.
    solve : callable
        Returns the same numbers of the program.
    remark : str
        Why numbers may lie beyond the digits that are printed; "" where none does.
    within : float
        Largest difference then, over the printed number.
    """

    name: str
    source: str
    what: str
    printed: str
    solve: Callable[[], ArrayLike]
    remark: str = ""
    within: float = 0.0


# ---- oscillators --------------------------------------------------------------------------------


def oscillator(
    mass: float, stiffness: float, damping: float = 0.0, spring: Spring | None = None
) -> Column:
    """Return one degree of freedom, of units of kips, inches and seconds."""
    k = stiffness * KIP / INCH
    return Column(
        1.0,
        mass * MASS,
        spring or Elastic(k),
        Elastic(RIGID * k),
        damping=Damping(mass=damping / mass),
    )


#: Mass, stiffness and damping (5 %) of Chopra's examples of chapter 5.
PULSE = 0.2533, 10.0, 0.1592


def pulse(step: float, end: float = 1.0, spring: Spring | None = None, **options: Any) -> Array:
    """Return displacements at every 0.1 s under 10 sin(pi t/0.6) kip up to 0.6 s [in]."""
    time = np.linspace(0.0, end, round(end / step) + 1)
    force = np.where(time < 0.6 - 1e-9, 10 * np.sin(np.pi * time / 0.6), 0.0)
    run = time_history(oscillator(*PULSE, spring), time, force=KIP * force, **options)
    at = np.searchsorted(run.time, 0.1 * np.arange(1, round(end / 0.1) + 1) - 1e-9)
    return np.asarray(run.displacement[at] / INCH)


def yielding_pulse() -> Array:
    """Return the displacements of `pulse` with a spring that yields at 7.5 kip [in]."""
    spring = Bilinear(k=PULSE[1] * KIP / INCH, d_y=0.75 * INCH, k_post=0.0)
    return pulse(0.1, 0.9, spring, method="newmark", dt=0.1)


def released(column: Column, start: float, period: float, cycles: int) -> Array:
    """Return displacements at whole cycles after a release from rest at `start` [in]."""
    time = np.linspace(0.0, cycles * period, cycles * 1000 + 1)
    run = time_history(
        column,
        time,
        method="newmark",
        dt=period / 1000,
        force=np.zeros_like(time),
        initial={"slip": [start * INCH]},
    )
    return np.asarray(run.displacement[::1000] / INCH)


def water_tank() -> list[float]:
    """Return period [s], the pull's displacement, and amplitudes after 4 and 13 cycles [in]."""
    column = oscillator(20.03 / 386, 8.2, 0.0360)
    peaks = released(column, 2.0, 0.5, 13)
    pull = cyclic(column, force=[16.4 * KIP]).displacement[0] / INCH
    return [1 / modes(column).frequency[0], pull, peaks[4], peaks[13]]


def jacked_building() -> list[float]:
    """Return period [s], and amplitudes after one and six cycles [in]."""
    column = oscillator(1920 / 386, 100.0, 1.584)
    peaks = released(column, 0.20, 1.40, 6)
    return [1 / modes(column).frequency[0], peaks[1], peaks[6]]


def rectangular_pulse() -> list[float]:
    """Return the peak over the static displacement, and the peak [in]."""
    column = oscillator(3.73 * (0.5 / (2 * np.pi)) ** 2, 3.73)
    time = np.linspace(0.0, 1.0, 10001)
    force = KIP * np.select([time < 0.2 - 1e-9, time < 0.2 + 1e-9], [4.0, 2.0], 0.0)
    run = time_history(column, time, force=force, method="newmark", dt=1e-4)
    peak = float(np.abs(run.displacement).max()) / INCH
    return [peak / (4 / 3.73), peak]


def two_degrees(**options: Any) -> Array:
    """Return the first of Bathe's two degrees of freedom at steps of 0.28.

    M = diag(2, 1), K = [6 -2; -2 4], a force of 10 on the second from rest. Seen from that force,
    the system is given by its eigenvalues 2 and 5 and by its static and initial flexibility. One
    body that slips and rotates has four values to choose, so it can have the same four; the
    trapezoidal rule does not mind which coordinates it is applied to. The force is 0.01, so that
    rotations are small, and the displacements are 1000 times those here.
    """
    from scipy.optimize import brentq  # noqa: PLC0415

    def body(inertia: float) -> tuple[float, float, float]:
        """Return mass, stiffness in shear and in bending of the body with a rotary inertia J."""
        # A unit force at the top accelerates it by 1 (1/m + 1/(4 J)), moves it by 0.3 in the end
        # (1/k_V + 1/k_M), and the sum of the eigenvalues is 7 (k_V + k_M/J).
        mass = 4 * inertia / (4 * inertia - 1)
        both = 12 * inertia**2 / (4 * inertia - 1)
        flexure = (both - 7) / (1 - 1 / inertia)
        return mass, 7 - flexure / inertia, flexure

    inertia = brentq(lambda j: np.prod(body(j)[1:]) - 10 * body(j)[0] * j, 4.0, 6.0, xtol=1e-14)
    mass, shear, flexure = body(inertia)
    column = Column(1.0, mass, Elastic(shear), Elastic(flexure), rotary_inertia=[inertia])
    time = 0.28 * np.arange(13)
    run = time_history(column, time, force=np.full(13, 0.01), **options)
    return np.asarray(1000 * run.displacement[np.isin(run.time, time)][1:])


# ---- columns ------------------------------------------------------------------------------------


def cantilever(n: int, **options: Any) -> Column:
    """Return a chain of EI = m = L = 1 that only bends; the joint at the foot is half a body."""
    return Column(1.0, 1.0, Elastic(1e9 * n), [Elastic(2.0 * n)] + [Elastic(n)] * (n - 1), n=n,
                  **options)  # fmt: skip


def limit(of: Callable[[int], Any], n: int) -> Array:
    """Return the limit of chains of n and 2 n bodies, whose errors have order 2."""
    return np.asarray((4 * np.asarray(of(2 * n)) - np.asarray(of(n))) / 3)


def pipe_column() -> list[float]:
    """Return stiffness [kip/in], frequency [rad/s] and period [s] of a pipe with a weight."""
    stiffness, length, n = 29e3 * KIP * 7.23 * INCH**2, 144 * INCH, 60
    k = stiffness * n / length
    flexure = [Elastic(2 * k)] + [Elastic(k)] * (n - 1)
    column = Column(length, 1e-3, Elastic(1e9 * k), flexure, n=n, top_mass=5.20 / 386 * MASS,
                    gravity=0.0)  # fmt: skip
    shapes = modes(column)
    pushed = cyclic(column, displacement=[INCH]).force[0] / KIP
    return [pushed, shapes.omega[0], 1 / shapes.frequency[0]]


def euler_load() -> list[float]:
    """Return the critical load that the refusal of a load beyond it tells, over EI/L^2."""
    try:
        modes(cantilever(100, axial_load=3.0, kinematics="pdelta"))
    except InputError as error:
        said = re.search(r"critical load of ([-+.e\d]+) N", str(error))
        return [float(said[1])] if said else []
    return []


def buckled(load: float, way: float) -> list[float]:
    """Return height, way across and rotation [degrees] of the end of a buckled cantilever.

    The chain is driven across to where it needs no force: the printed load has four digits, which
    at 20 degrees are 2 % of the distance from the critical one.
    """
    from scipy.optimize import brentq  # noqa: PLC0415

    column = cantilever(80, axial_load=load * np.pi**2 / 4, kinematics="finite")

    def push(across: float) -> Any:
        return cyclic(column, displacement=np.linspace(0.0, across, 30)[1:])

    ends = 0.9 * way, min(1.1 * way, 0.95)
    end = push(brentq(lambda across: push(across).force[-1], *ends, xtol=1e-9))
    return [end.top[-1, 1], end.top[-1, 0], float(np.degrees(np.sum(end.rotation[-1])))]


def bent(n: int, force: float) -> list[float]:
    """Return way across, way down and rotation of the end of a cantilever under a force across."""
    column = cantilever(n, kinematics="finite")
    run = cyclic(column, force=np.linspace(0, force, 11)[1:])
    return [run.top[-1, 0], 1 - run.top[-1, 1], float(np.sum(run.rotation[-1]))]


# ---- sections -----------------------------------------------------------------------------------


def _at(diagram: Any, values: Array, wanted: list[float], units: tuple[float, float]) -> Array:
    """Return axial load and moment between points of a diagram, at each of some other values."""
    order = np.argsort(values)
    pairs = zip((diagram.axial_load, diagram.moment), units, strict=True)
    values_at = [np.interp(wanted, values[order], axis[order]) / unit for axis, unit in pairs]
    return np.ravel(np.column_stack(values_at))


def eight_bars() -> Array:
    """Return axial load [kN] and moment [kN m] at depths of the neutral axis of 500 mm and less."""
    steel, bar = Steel(460e6, 575e6, es=200e9), np.pi / 4 * 0.025**2
    bars = [(0.1875, 3 * bar, steel), (0.0, 2 * bar, steel), (-0.1875, 3 * bar, steel)]
    section = RectangularSection(
        0.5, 0.5, Concrete(35e6), bars=bars, bar_diameter=0.025, cover=0.04,
        ties=Ties(0.01, 0.1, steel, legs=3),
    )  # fmt: skip
    diagram = interaction(section, "aci318")
    axes = [0.5, 0.4375, 0.247642, 0.164062, 0.158133]
    return _at(diagram, diagram.neutral_axis, axes, (1e3, 1e3))


def spcolumn() -> list[float]:
    """Return axial load [kip] and moment [kip ft] at strains of the far bars of 0, yield, 0.005.

    Then the moment without axial load, and the largest and least axial load.
    """
    psi, units = KSI / 1000, (KIP, KIP * FOOT)
    steel = Steel(60e3 * psi, es=29e6 * psi)
    bars = [(side * 5.5 * INCH, 4.0 * INCH**2, steel) for side in (1, -1)]
    side = 16 * INCH
    section = RectangularSection(
        side, side, Concrete(5e3 * psi), bars=bars, bar_diameter=1.128 * INCH
    )
    diagram = interaction(section, "aci318", points=200)
    numbers = _at(diagram, diagram.tension_strain, [0.0, 60 / 29000, 0.005], units)
    ends = diagram.axial_load[[-1, 0]] / KIP
    return [*numbers, diagram.moment_at(0.0) / units[1], *ends]


def shed() -> list[float]:
    """Return the drift at axial failure of 300 x 500 mm, two ties of 10 mm at 100 mm, 375 kN."""
    bars = [(0.2, 1e-3, Steel(400e6)), (-0.2, 1e-3, Steel(400e6))]
    section = RectangularSection(
        0.3, 0.5, Concrete(25e6), bars=bars, bar_diameter=0.02, cover=0.03,
        ties=Ties(0.01, 0.1, Steel(300e6), legs=2),
    )  # fmt: skip
    return [axial_failure_drift(section, 375e3)]


def elwood() -> str:
    """Return the drift by the formula, with a core of 430 mm and ties of 2 x 78.54 mm2."""
    tangent = np.tan(np.radians(65.0))
    ties = 2 * np.pi / 4 * 0.01**2 * 300e6 * 0.43 / 0.1
    return f"{0.04 * (1 + tangent**2) / (tangent + 375e3 / (ties * tangent)):.6f}"


# ---- the table ----------------------------------------------------------------------------------

CHOPRA = "Chopra, Dynamics of Structures"
TIMOSHENKO = "Timoshenko and Gere, Theory of Elastic Stability"
HALF_SINE = "displacement every 0.1 s [in]"
EXACT = "0.0328 0.2332 0.6487 1.1605 1.5241 1.4814 0.9245 0.0593 -0.7751 -1.2718"
STEPS = "0.0437 0.2326 0.6121 1.0825 1.4309 1.4231 0.9622 0.1908 -0.6044 -1.1442"
YIELDS = "0.0437 0.2326 0.6121 1.1143 1.6214 1.9891 2.0951 1.9240 1.5602"
TRAPEZOIDS = "0.364 1.35 2.68 4.00 4.95 5.34 5.13 4.48 3.64 2.90 2.44 2.31"
SUPERPOSED = "0.382 1.41 2.78 4.09 5.00 5.29 4.986 4.277 3.457 2.806 2.484 2.489"
ENGESSER = "with shear by the slope of the axis; the source does not tell its own"
ROUNDED = "the book goes on with rounded numbers"

PROBLEMS: list[Problem] = [
    Problem("Half-cycle sine pulse", f"{CHOPRA}, tables E5.2 to E5.4", f"exact {HALF_SINE}", EXACT,
            partial(pulse, 1e-3, method="rk45", tolerance=1e-9)),
    Problem("Half-cycle sine pulse, Newmark", f"{CHOPRA}, example 5.3", HALF_SINE, STEPS,
            partial(pulse, 0.1, method="newmark", dt=0.1)),
    Problem("Half-cycle sine pulse, yielding", f"{CHOPRA}, examples 5.5 and 5.6", HALF_SINE, YIELDS,
            yielding_pulse),
    Problem("Elevated water tank", f"{CHOPRA}, chapter 2",
            "period [s], pull, after 4 and 13 cycles [in]", "0.50 2.0 1.0 0.2", water_tank),
    Problem("Rectangular pulse", f"{CHOPRA}, example 4.1", "R_d, peak [in]", "1.902 2.04",
            rectangular_pulse),
    Problem("Pipe column", f"{CHOPRA}, example 6.2", "k [kip/in], omega [rad/s], T [s]",
            "0.211 3.958 1.59", pipe_column, ROUNDED, 1.5e-3),
    Problem("Jacked building", "Clough and Penzien, Dynamics of Structures, example E2-1",
            "period [s], after 1 and 6 cycles [in]", "1.40 0.16 0.0524", jacked_building, ROUNDED,
            6e-3),
    Problem("Two degrees, trapezoidal rule", "Bathe, Finite Element Procedures, chapter 9",
            "displacement at 12 steps", TRAPEZOIDS,
            partial(two_degrees, method="newmark", dt=0.28)),
    Problem("Two degrees, exact", "Bathe, Finite Element Procedures, chapter 9",
            "displacement at 12 steps", SUPERPOSED,
            partial(two_degrees, method="rk45", tolerance=1e-9)),
    Problem("Uniform cantilever", f"{CHOPRA}, distributed mass", "omega over sqrt(EI/(m L^4))",
            "3.516 22.03 61.70",
            partial(limit, lambda n: modes(cantilever(n)).omega[:3], 50)),
    Problem("Euler's column", f"{TIMOSHENKO}, chapter 2", "critical load over EI/L^2", "2.467",
            euler_load),
    *(
        Problem(f"Elastica, {turn} degrees", f"{TIMOSHENKO}, table of the elastica",
                "height, way across over L, rotation", f"{height} {way} {turn}",
                partial(buckled, load, float(way)), "the load is printed with four digits", 2e-2)
        for turn, load, height, way in (
            ("20", 1.015, "0.970", "0.220"), ("40", 1.063, "0.881", "0.422"),
            ("60", 1.152, "0.741", "0.593"), ("80", 1.293, "0.560", "0.719"),
            ("100", 1.518, "0.349", "0.792"),
        )
    ),
    *(
        Problem(f"Cantilever bent by F = {force} EI/L^2",
                "Mattiasson, Int. J. Numer. Methods Eng. 17 (1981)",
                "way across and down over L, rotation", printed,
                partial(limit, partial(bent, force=float(force)), 40),
                "chains of 40 and 80 bodies extrapolated", 1e-4)
        for force, printed in (
            ("1", "0.30172 0.05643 0.46135"), ("2", "0.49346 0.16064 0.78175"),
            ("10", "0.81061 0.55500 1.43029"),
        )
    ),
    Problem("Two storeys with flexible beams", f"{CHOPRA}, example 10.5",
            "omega over sqrt(EI/(m h^3))", "2.198 5.850", flexible_beams),
    Problem("Seven storeys, periods", "SAP2000 verification manual, example 1-022",
            "periods [s]", "1.2732 0.4313 0.2420 0.1602 0.1190 0.0951 0.0795",
            lambda: modes(seven_storeys(), 7).period),
    Problem("Seven storeys, lateral loads", "SAP2000 verification manual, example 1-022",
            "displacement of the top [in]", "1.45076", pushed_seven_storeys),
    Problem("Building of one line, seven storeys", "SAP2000 verification manual, example 1-022",
            "periods [s]", "1.2732 0.4313 0.2420 0.1602 0.1190 0.0951 0.0795", as_building),
    *(
        Problem(f"Eccentric building{how}", "Peterson; SAP2000 verification manual, example 1-024",
                "four periods [s], roof [ft]", "0.2271 0.2156 0.0733 0.0720 0.0201",
                partial(eccentric_building, angle))
        for how, angle in (("", 0.0), (", turned by 30 degrees", 30.0))
    ),
    Problem("Eccentric storey that yields", "closed form, two equations of equilibrium",
            "load [N], U [mm], Theta", "789162.56 11.46484 2.9297e-4", yields_in_plan),
    Problem("Nine storeys, ten bays", "Bathe and Wilson; SAP2000 verification manual, 1-021",
            "eigenvalues [1/s2]", "0.589541 5.52695 16.5878", nine_storeys),
    *(
        Problem(f"AISC benchmark case {case}{', with shear' if shear else ''}",
                f"AISC 360-16, figure C-C2.{case + 1}", "moments [kip in], displacements [in]",
                printed, partial(aisc, loads, shear=shear, **more),
                ENGESSER if shear else "", 2e-3 if shear else 0.0)
        for case, shear, loads, more, printed in (
            (1, False, "0 150 300 450", {"across": 0.2 * KIP / FOOT},
             "235 269 313 375 0.197 0.224 0.261 0.311"),
            (1, True, "0 150 300 450", {"across": 0.2 * KIP / FOOT},
             "235 270 316 380 0.202 0.230 0.269 0.322"),
            (2, False, "0 100 150 200", {"tip": KIP}, "336 469 598 848 0.901 1.33 1.75 2.56"),
            (2, True, "0 100 150 200", {"tip": KIP}, "336 470 601 856 0.907 1.34 1.77 2.60"),
        )
    ),
    *(
        Problem(name, "AISC Design Guide 25, closed form",
                "moments [kip in], sways [in] at 1/4, 1/2 and 0.67 of Euler's load",
                *beam_column((0.25, 0.5, 0.67), halves))
        for name, halves in (("Beam-column", 1), ("Beam-column, guided top", 2))
    ),
    Problem("Portals that sway", "phi tan phi = 6 on pins, phi = -6 tan phi on fixed feet",
            "P h^2/E I of each column, phi^2", "1.8213 7.3792", swaying_portals),
    Problem("Slender cantilever", "CSI, test problem 109, closed form",
            "moment [N m], displacement [m]", "1126.5 0.169134", slender),
    Problem("Sway mechanism of a portal", "limit analysis, 4 M_p/h", "load over M_p/h",
            "4.00000000", plastic_sway),
    Problem("Coupled walls, plastic", "limit analysis, (2 M_w + 8 M_b l/b)/(share x height)",
            "load [N]", "577777.78", coupled_walls),
    Problem("Coupled walls, elastic", "Stafford Smith and Coull 1991, continuous medium",
            "top [mm]", "14.01", coupled_continuum, "the floors are discrete", 5e-3),
    Problem("Wall that rocks", "closed form, N (l_w/2 - l_w/400)/H", "force [kN]", "62.644",
            rocking_wall),
    Problem("Wall that rocks, P-Delta in a frame", "closed form, less N x drift", "force [kN]",
            "55.084", rocking_line),
    Problem("Portals and a wall, tied", "limit analysis, 4 M_1/h + 4 M_2/h + M_w/h", "load [N]",
            "1066666.67", tied_parts),
    Problem("Column that leans on another", "F/(3 E I/h^3 - P/h)", "displacement [m]", "0.0166667",
            leaning),
    Problem("Wall and frame, elastic", "Heidebrecht and Stafford Smith 1973, continuous medium",
            "top [mm]", *wall_and_frame(), "the floors are discrete", 5e-3),
    Problem("Loss of a column, three floors", "limit analysis, 3 x 4 M_p/L", "load over M_p/L",
            "12.0000000", lost_column),
    Problem("Square section, eight bars", "program concreteproperties 0.7.0, ACI 318",
            "N [kN], M [kN m] at five neutral axes",
            "6959.36 395.59 6063.09 509.27 2880.68 687.48 1469.55 581.32 1352.70 570.41",
            eight_bars, "the neutral axes are printed to a micrometre", 1e-5),
    Problem("Column of 16 x 16 in", "published example of spColumn, ACI 318",
            "N [kip], M [kip ft] at three strains; M at N = 0; ends of N",
            "957 261 417 386 195 320 238 1534 -480", spcolumn,
            "beta_1 falls from 4 ksi in the inch-pound edition, from 28 MPa in the metric", 5e-3),
    Problem("Axial load after shear failure", "Elwood and Moehle 2005, formula", "drift", elwood(),
            shed),
]  # fmt: skip


@dataclass(frozen=True)
class PrintedValue:
    """A printed number beside that of the program.

    Attributes
    ----------
    problem : Problem
        What it belongs to.
    printed : str
        As it is printed.
    value : float
        Of the program.
    """

    problem: Problem
    printed: str
    value: float

    @property
    def units(self) -> float:
        """Difference in units of the last printed digit."""
        digits, _, exponent = self.printed.lower().partition("e")
        last = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
        return (self.value - float(self.printed)) / last

    @property
    def difference(self) -> float:
        """Difference over the printed number, or as it is where that is zero."""
        printed = float(self.printed)
        return (self.value - printed) / (abs(printed) or 1.0)

    @property
    def inside(self) -> bool:
        """Whether they differ by less than a unit of the last digit: a printed one may be cut."""
        return abs(self.units) <= 1.0

    @property
    def holds(self) -> bool:
        """Whether it is inside the printed digits, or as close as its remark says."""
        return self.inside or abs(self.difference) <= self.problem.within


@dataclass(frozen=True, repr=False)
class Verification(Tabular):
    """Printed numbers of problems of others beside those of the program.

    Attributes
    ----------
    comparisons : tuple of rbsdem.methods.verification.PrintedValue
        In the order of the problems.
    """

    comparisons: tuple[PrintedValue, ...]

    @property
    def holds(self) -> bool:
        """Whether every number is inside the printed digits, or explained by a remark."""
        return all(comparison.holds for comparison in self.comparisons)

    def worst(self) -> Verification:
        """Return the number of each problem that differs most, in units of its last digit."""
        worst: dict[Problem, PrintedValue] = {}
        for each in self.comparisons:
            worst[each.problem] = max(
                worst.get(each.problem, each), each, key=lambda c: abs(c.units)
            )
        return Verification(tuple(worst.values()))

    def to_pandas(self) -> DataFrame:
        """Return a row for each number: problem, source, quantity, both numbers, verdict."""
        return data_frame(
            {
                "problem": [each.problem.name for each in self.comparisons],
                "source": [each.problem.source for each in self.comparisons],
                "what": [each.problem.what for each in self.comparisons],
                "printed": [each.printed for each in self.comparisons],
                "rbsdem": [_shown(each) for each in self.comparisons],
                "difference": [f"{100 * each.difference:+.2g} %" for each in self.comparisons],
                "verdict": [_verdict(each) for each in self.comparisons],
            }
        )

    def __repr__(self) -> str:
        numbers = len(self.comparisons)
        inside = sum(each.inside for each in self.comparisons)
        failed = numbers - sum(each.holds for each in self.comparisons)
        return (
            f"Verification({len({each.problem for each in self.comparisons})} problems, "
            f"{numbers} numbers: {inside} inside the printed digits, "
            f"{numbers - inside - failed} explained, {failed} wrong)"
        )


def _shown(comparison: PrintedValue) -> str:
    """Return the number with one digit more than is printed."""
    digits = comparison.printed.lower().partition("e")[0].lstrip("-").replace(".", "").lstrip("0")
    return f"{comparison.value:#.{max(len(digits), 1) + 1}g}".rstrip(".")


def _verdict(comparison: PrintedValue) -> str:
    """Return "printed digits", the remark that explains a difference, or "wrong"."""
    if comparison.inside:
        return "printed digits"
    return comparison.problem.remark if comparison.holds else "wrong"


def verify(problems: Sequence[str] | None = None) -> Verification:
    """Solve problems of textbooks, standards and other programs, and compare with what they print.

    Parameters
    ----------
    problems : sequence of str, optional
        Names of problems, or their beginnings; all without them.

    Returns
    -------
    Verification
        A row for each printed number.

    Raises
    ------
    InputError
        If no problem has such a name.
    """
    wanted = PROBLEMS
    if problems is not None:
        begins = _arguments.several(problems, "verify: problems", "names")
        wanted = [each for each in PROBLEMS if each.name.lower().startswith(_lower(begins))]
        for name in _lower(begins):
            if not any(problem.name.lower().startswith(name) for problem in wanted):
                names = ", ".join(dict.fromkeys(problem.name for problem in PROBLEMS))
                raise InputError(f"verify: there is no problem {name!r}; there are {names}")
    comparisons: list[PrintedValue] = []
    for problem in wanted:
        printed = problem.printed.split()
        with notes_off():
            values = np.ravel(problem.solve()).astype(float).tolist()
        if len(values) != len(printed) or not all(map(math.isfinite, values)):
            raise AssertionError(f"{problem.name}: {values} for {problem.printed}")
        comparisons += [PrintedValue(problem, *pair) for pair in zip(printed, values, strict=True)]
    return Verification(tuple(comparisons))


def _lower(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(str(name).lower() for name in names)
