"""What an event of a layered joint costs, relative to one of the Takeda rule. Nothing is asserted.

    python tests/benchmarks/layered.py [--quick]

The same static cycles of one body with either flexural spring; a layered joint has more events,
one for every end of a line of a layer, and each asks all layers. Times are those of the processor
in the fastest of many calls through Python, less what a column with an elastic spring costs.
"""

from __future__ import annotations

import sys
import time

import numpy as np

import rbsdem
from rbsdem.springs import ConcreteSpring, Elastic, Layered, Spring, SteelSpring, Takeda

TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b0=0.4, b1=0.22)
DRIFTS = np.linspace(0.005, 0.03, 20)


def joint(strips: int) -> Layered:
    """Return strips of concrete over 0.4 m between two rows of bars."""
    share = 1 / strips
    strip = ConcreteSpring(
        k=1.6e10 * share,
        f_peak=4.8e6 * share,
        d_peak=6e-4,
        k_soft=3e8 * share,
        f_res=1.5e6 * share,
        contact=0.35,
        misfit=0.4,
        wear=0.03,
    )
    bar = SteelSpring(8e8, 7.2e5, 8e6, r0=8, cr1=0.83, cr2=0.42)
    ys = 0.4 * ((np.arange(strips) + 0.5) / strips - 0.5)
    return Layered((*((y, strip) for y in ys), (-0.16, bar), (0.16, bar)))


def cost(spring: Spring, repeats: int) -> tuple[float, int]:
    """Return the seconds of one run and its events."""
    load = 700e3 if isinstance(spring, Layered) else 0.0
    column = rbsdem.Column(1.6, 614.4, Elastic(1e9), spring, kinematics="pdelta", axial_load=load)
    path = rbsdem.protocol(DRIFTS * 1.6, cycles=2, points=1)
    events = rbsdem.cyclic(column, displacement=path).summary["events"]
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        rbsdem.cyclic(column, displacement=path)
        times.append(time.process_time() - begin)
    return min(times), events


def main() -> None:
    """Print the table."""
    repeats = 20 if "--quick" in sys.argv[1:] else 200
    bare, _ = cost(Elastic(1e8), repeats)
    base, events = cost(TAKEDA, repeats)
    base = (base - bare) / events
    print(f"{'spring':<22}{'events':>8}{'per event':>12}{'over Takeda':>13}")
    print(f"{'Takeda':<22}{events:>8}{base * 1e6:>9.2f} us{1:>13.1f}")
    for strips in (4, 8, 14, 28):
        seconds, events = cost(joint(strips), repeats)
        each = (seconds - bare) / events
        name = f"{strips + 2} layers"
        print(f"{name:<22}{events:>8}{each * 1e6:>9.2f} us{each / base:>13.1f}")


if __name__ == "__main__":
    main()
