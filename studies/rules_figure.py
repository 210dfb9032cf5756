"""Draw docs/rules.svg: the backbone and its corners, deterioration, and pinched reloading.

python studies/rules_figure.py
"""

from __future__ import annotations

import itertools
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("svg")
from matplotlib import pyplot as plt

from rbsdem.springs import PeakOriented, Pinching

DOCS = Path(__file__).resolve().parents[1] / "docs"

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "svg.hashsalt": "rbsdem",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.solid_joinstyle": "round",
}
GREY, BLUE, RED = "#9aa3af", "#1d6fb8", "#b4471f"
THIN = {"arrowstyle": "-", "color": GREY, "lw": 0.8}

# Over yield deformation and yield force.
CRACKED = {"d_c": 0.15, "f_c": 0.35, "d_y": 1.0, "f_y": 1.0, "d_cap": 4.0, "f_cap": 1.15}
SOFT = {"d_pc": 9.0, "f_res": 0.25}
REACH = 9.5


def fine(corners: list[float], parts: int = 400) -> np.ndarray:
    """Return the path with many points from corner to corner."""
    ways = itertools.pairwise([0.0, *corners])
    return np.concatenate([np.linspace(a, b, parts) for a, b in ways])


def cycles(amplitudes: list[float], times: int) -> list[float]:
    """Return the turning points of cycles."""
    return [s * a for a in amplitudes for _ in range(times) for s in (1, -1)]


def draw_axes(ax: plt.Axes, title: str) -> None:
    """Draw cross, limits and the virgin backbone."""
    back = np.linspace(0, REACH, 500)
    for side in (1, -1):
        force = PeakOriented(**CRACKED, **SOFT).response(side * back)
        ax.plot(side * back, force, color=GREY, lw=1, ls=(0, (5, 3)))
    ax.axhline(0, color=GREY, lw=0.6)
    ax.axvline(0, color=GREY, lw=0.6)
    ax.set(xlabel="$D / D_y$", xlim=(-REACH, REACH), ylim=(-1.35, 1.45))
    ax.set_title(title, loc="left")


def main() -> None:
    """Draw the three panels."""
    lasting = {"lambda_s": 80.0, "lambda_c": 80.0, "lambda_k": 160.0, "lambda_a": 160.0}
    panels = {
        "(a) peak-oriented": (PeakOriented(**CRACKED, **SOFT, b0=0.3), BLUE, 1),
        r"(b) with deterioration, $\lambda$ = 80, 160": (
            PeakOriented(**CRACKED, **SOFT, b0=0.3, **lasting), BLUE, 2,
        ),
        r"(c) pinching, $\kappa_f$ = 0.3, $\kappa_d$ = 0.5": (
            Pinching(**CRACKED, **SOFT, b0=0.3, **lasting, kappa_f=0.3, kappa_d=0.5), RED, 2,
        ),
    }  # fmt: skip
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 3, figsize=(12.6, 4.0), layout="constrained", sharey=True)
        for ax, (title, (spring, color, times)) in zip(axes, panels.items(), strict=True):
            draw_axes(ax, title)
            path = fine(cycles([2, 4, 7], times))
            ax.plot(path, spring.response(path), color=color, lw=1.3)
        axes[0].set_ylabel("$F / F_y$")
        for text, at, to in (
            ("cracking", (0.15, 0.35), (-6.5, 0.55)),
            ("yield", (1.0, 1.0), (-5.0, 1.0)),
            ("cap", (4.0, 1.15), (4.4, 1.32)),
            ("softening", (8.2, 0.613), (6.6, 0.95)),
            ("unloading", (3.4, 0.55), (4.4, 0.2)),
            ("reloading", (0.6, -0.35), (2.0, -0.8)),
        ):
            axes[0].annotate(text, at, to, arrowprops=THIN)
        figure.savefig(DOCS / "rules.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
