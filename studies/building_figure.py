"""The figure of the README: a drawn building with its hinges, its push-over, and a tested frame.

    python studies/building_figure.py [FOLDER] [--out docs/building.png]

The building is `rbsdem.examples.house()`. The band of its target displacement is that of twenty
records scaled to the spectrum, from the 16th to the 84th percentile. The tested frame is the
cruciform of Park and Dai Ruitong 1988 of `frames_measured.py`, for which FOLDER, by default that of
the environment variable RBSDEM_FRAMES_DIR, has the measured reversals.
"""

from __future__ import annotations

import argparse
import os
import warnings
from pathlib import Path

import numpy as np
from frames_measured import cruciform, draw_loops, followed, reversals, ways
from matplotlib.axes import Axes

import rbsdem
from rbsdem import plot
from rbsdem.codes import DesignSpectrum, target
from rbsdem.output import style

#: Percentiles of the band.
BAND = (16, 84)


def building(hinges: Axes, curve: Axes) -> None:
    """Draw the house with its hinges, and its push-over with the target displacement."""
    house = rbsdem.examples.house()
    push = rbsdem.pushover(house, drift=0.025)
    demand = target(push, DesignSpectrum.en_1998(0.25, "C"), "en_1998")
    plot.frame(push, ax=hinges)
    plot.pushover(push, ax=curve)
    records = rbsdem.motions.synthetic(20)
    reached = rbsdem.codes.check_target(demand, records).roof_drift * house.height
    low, middle, high = (1e3 * np.percentile(reached, q) for q in (BAND[0], 50, BAND[1]))
    curve.axvspan(low, high, color="0.9", zorder=0, label="20 records, 16 to 84 %")
    look = {"color": "black", "linewidth": 0.7, "linestyle": ":", "label": "target, EN 1998-1"}
    curve.axvline(1e3 * demand.displacement, **look)
    curve.legend(loc="lower right", handletextpad=0.2)
    text = f"target of EN 1998-1: {1e3 * demand.displacement:.0f} mm"
    print(f"{text}; records {low:.0f}, {middle:.0f}, {high:.0f} mm")


def tested(ax: Axes, folder: Path) -> None:
    """Draw the loops of the tested cruciform beside its reversals."""
    loops = followed(cruciform("asce"), ways(folder), False)
    draw_loops(ax, loops, "rbsdem", reversals(folder), folder)
    ax.set_ylabel("Force (kN)")


def main() -> None:
    """Draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    default = os.environ.get("RBSDEM_FRAMES_DIR", ".")
    parser.add_argument("folder", nargs="?", default=default, type=Path)
    parser.add_argument("--out", type=Path, default=Path("docs/building.png"))
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    axes = style.new_axes(1, 3, (10.2, 3.3))
    for ax in axes:
        with style.style_of(ax):
            if ax is axes[0]:
                building(axes[0], axes[1])
            elif ax is axes[2]:
                tested(ax, asked.folder)
    with style.style():
        axes[0].figure.savefig(asked.out, dpi=130)
    print(f"wrote {asked.out}")


if __name__ == "__main__":
    main()
