"""Times of a building of drawn members: 4 storeys, 3 bays, some 1 800 layers. Nothing is asserted.

    python tests/benchmarks/drawn_building.py [repeats]

It prints the least processor time of a push-over to 1.5 % with a row at every corner, and of a
synthetic record of 33 s in steps of 0.01 s with all rows, by the default method and by Newmark's.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import rbsdem
from rbsdem.frames import FrameNode
from rbsdem.springs import Bilinear, Layered


def section(depth: float) -> rbsdem.RectangularSection:
    """Return a section with bars in all faces."""
    bars = rbsdem.Layout(8, 0.018, rbsdem.Steel(446e6, 702e6))
    ties = rbsdem.Ties(0.008, 0.1, rbsdem.Steel(364e6, 521e6))
    return rbsdem.RectangularSection(
        0.4, depth, rbsdem.Concrete(30e6), layout=bars, ties=ties, cover=0.03
    )


def building() -> rbsdem.Frame:
    """Return the frame, under its dead load."""
    upper, lowest = (
        rbsdem.section.member(section(0.4), length, axial_load=400e3, rigid_end=0.25)
        for length in (2.70, 2.95)
    )
    return rbsdem.Frame.grid(
        [3.2] * 4, [6.0] * 3, columns={(0, 0): upper, (0, 1): lowest},
        beams=rbsdem.section.member(section(0.5), 5.6, rigid_end=0.2),
        beam_load=20e3, floor_mass=60e3, kinematics="pdelta",
    )  # fmt: skip


def fibres() -> list[tuple[float, float]]:
    """Return places and areas of twelve fibres of a square section of 0.4 m."""
    return [(0.4 * ((i + 0.5) / 12 - 0.5), 0.16 / 12) for i in range(12)]


def fibre_frame(storeys: int, bays: int, load: float) -> rbsdem.Frame:
    """Return a frame whose members have three sections of twelve fibres each.

    Its sections, loads and damping are those of `studies/frames_opensees.py`.
    """

    def kind(length: float) -> rbsdem.FrameMember:
        def joint(share: float) -> Layered:
            layers = []
            for y, area in fibres():
                k = 30e9 * area / (share * length)
                layers.append((y, Bilinear(k, 0.0012 * share * length, 0.01 * k)))
            return Layered(layers)

        sections = {0.0: joint(1 / 6), 0.5: joint(2 / 3), 1.0: joint(1 / 6)}
        return rbsdem.FrameMember(30e9, 1e12, 1.0, flexure=sections, interior="rigid")

    nodes = [
        FrameNode(f"N-{line + 1}-{floor + 1}", load_y=-load)
        for line in range(bays + 1)
        for floor in range(storeys)
    ]
    return rbsdem.Frame.grid(
        [3.2] * storeys, [6.0] * bays, columns=kind(3.2), beams=kind(6.0), nodes=nodes,
        floor_mass=20e3 * bays, damping=rbsdem.Damping(mass=0.3),
    )  # fmt: skip


def least(run: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least processor time of a run [s], and its result."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        result = run()
        times.append(time.process_time() - begin)
    return min(times), result


def main() -> None:
    """Print the table."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    frame = building()
    record = rbsdem.motions.synthetic(1)[0]
    runs: dict[str, Callable[[], Any]] = {
        "push-over": lambda: rbsdem.pushover(frame, drift=0.015),
        "record, default": lambda: rbsdem.time_history(frame, record, dt=0.01),
        "record, Newmark": lambda: rbsdem.time_history(frame, record, dt=0.01, method="newmark"),
    }
    print(f"{'':16} {'[s]':>6} {'rows':>6} {'changes of line':>16}")
    for name, run in runs.items():
        seconds, result = least(run, repeats)
        print(f"{name:16} {seconds:6.3f} {len(result.base_shear):6} {result.summary['events']:16,}")


if __name__ == "__main__":
    main()
