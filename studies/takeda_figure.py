"""Draw docs/takeda.svg: outer loops, and inner loops with the three readings of B_1.

python studies/takeda_figure.py
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np

import rbsdem

mpl.use("svg")
from matplotlib import pyplot as plt

DOCS = Path(__file__).resolve().parents[1] / "docs"

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "svg.hashsalt": "rbsdem",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.solid_joinstyle": "round",
}
GREY, BLUE, RED, GREEN = "#9aa3af", "#1d6fb8", "#b4471f", "#3b8a4b"

PARTS = 400


def fine(corners: np.ndarray) -> np.ndarray:
    """Return the path with many points from corner to corner."""
    corners = np.concatenate([[0.0], corners])
    return np.concatenate([np.linspace(a, b, PARTS) for a, b in itertools.pairwise(corners)])


def main() -> None:
    """Draw both panels."""
    spring = rbsdem.peer.paper_columns()["soesianawati_1"].flexure
    f_c = spring.k_c * spring.d_c
    f_y = f_c + spring.k_y * (spring.d_y - spring.d_c)

    def loop(ax, mu, first, rule, **style):
        """Draw a path from its corner `first` on."""
        path = fine(np.asarray(mu, dtype=float)) * rule.d_y
        force = rule.response(path)
        begin = first * PARTS
        ax.plot(path[begin:] / rule.d_y, force[begin:] / f_y, **style)

    with plt.rc_context(STYLE):
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
        for ax, reach in ((left, 5.0), (right, 2.6)):
            for side in (1, -1):
                back = np.array([0.0, spring.d_c / spring.d_y, 1.0, reach])
                force = np.array([0.0, f_c, f_y, f_y + (reach - 1) * spring.k_u * spring.d_y])
                ax.plot(side * back, side * force / f_y, color=GREY, lw=1, ls=(0, (5, 3)))
            ax.axhline(0, color=GREY, lw=0.6)
            ax.axvline(0, color=GREY, lw=0.6)
            ax.set(xlabel="$D / D_y$", ylabel="$F / F_y$", xlim=(-reach, reach), ylim=(-1.6, 1.6))

        loop(left, [2, -2, 4, -4, 4], 0, spring, color=BLUE, lw=1.6)
        left.set_title("(a) outer loops", loc="left")
        for text, at, to in (
            ("uncracked, $K_c$", (0.06, 0.19), (-4.6, 0.42)),
            ("cracked backbone, $K_y$", (0.5, 0.55), (-4.6, 0.85)),
            ("yielded backbone, $K_u$", (1.5, 1.045), (-4.6, 1.3)),
            ("outer unloading, $K_r$", (3.05, 0.4), (2.4, -0.3)),
            ("reloading", (1.2, -0.32), (1.6, -0.8)),
        ):
            left.annotate(text, at, to, arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.8})

        loop(right, [2, -2, 1.2], 0, spring, color=GREY, lw=1.2)
        for name, color, width in (("kr", GREEN, 2.6), ("one", RED, 1.6), ("kc", BLUE, 1.6)):
            rule = replace(spring, inner=name)
            label = {"kr": "$B_1 K_r$", "one": "$K_r$", "kc": "$B_1 K_c$"}[name]
            label = f"{name}: {label}" + (", raised to the secant" if name == "kr" else "")
            loop(right, [2, -2, 1.2, -1, 1.2], 3, rule, color=color, lw=width, label=label)
        peak = spring.response(np.array([2, -2, 1.2]) * spring.d_y)[-1] / f_y
        right.plot([1.2], [peak], "o", color="k", ms=4)
        right.annotate(
            "inner peak",
            (1.2, peak),
            (-1.2, 1.2),
            arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.8},
        )
        right.set_title("(b) an inner loop, $B_1 = 0.22$", loc="left")
        right.legend(frameon=False, loc="lower right", title="inner", alignment="left")
        figure.savefig(DOCS / "takeda.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
