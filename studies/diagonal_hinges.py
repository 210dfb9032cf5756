"""What two planar hinges of a column carry on a diagonal, over what its section does.

python studies/diagonal_hinges.py

A section of fibres is bent about one axis, and about its diagonal, under constant axial load:
concrete in compression by a parabola up to 0.002 and a plateau up to 0.0035, bars elastic and
plastic. Two hinges that do not know of each other carry the moment of one axis in each plane at
once, sqrt(2) times it on the diagonal.
"""

import numpy as np

from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties

STRIPS = 60
CURVATURES = np.linspace(0.004, 0.08, 60)


def strength(section: RectangularSection, share: float, degrees: float) -> float:
    """Return the largest moment along a direction under a share of f'c A_g [N m]."""
    y, x = (
        size * ((np.arange(STRIPS) + 0.5) / STRIPS - 0.5) for size in (section.depth, section.width)
    )
    yc, xc = (grid.ravel() for grid in np.meshgrid(y, x))
    area = section.gross_area / yc.size
    bars = section.place_bars(section.single_bars)
    xb, yb = np.array([bar[0] for bar in bars]), np.array([bar[1] for bar in bars])
    ab, steel = np.array([0.25 * np.pi * bar[2] ** 2 for bar in bars]), section.bars[0][2]
    fc, load = section.concrete.fc, share * section.concrete.fc * section.gross_area
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    concrete, rods = yc * way[0] + xc * way[1], yb * way[0] + xb * way[1]

    def forces(strain: float, curvature: float) -> tuple[float, float, float]:
        short = np.clip(strain + curvature * concrete, 0.0, None)
        stress = fc * np.where(short < 0.002, 1.0 - (1.0 - short / 0.002) ** 2, 1.0)
        pull = np.clip(steel.es * (strain + curvature * rods), -steel.fy, steel.fy)
        total = area * stress.sum() + ab @ pull
        moment = area * stress @ concrete + (ab * pull) @ rods
        return float(total), float(moment), float(short.max())

    found = []
    for curvature in CURVATURES:
        low, high = -0.05, 0.05
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if forces(middle, curvature)[0] < load else (low, middle)
        _, moment, short = forces(high, curvature)
        if short > 0.0035:
            break
        found.append(moment)
    return max(found)


def main() -> None:
    """Print the table."""
    steel = Steel(fy=420e6)
    print(
        "bars    N/(f'c A_g)   M of an axis, of the diagonal (kN m)   two hinges over the section"
    )
    for number in (4, 8, 12):
        section = RectangularSection(
            0.4, 0.4, Concrete(25e6), layout=Layout(number, 0.02, steel), cover=0.03,
            ties=Ties(0.008, 0.1, steel),
        )  # fmt: skip
        for share in (0.05, 0.2, 0.4):
            axis, diagonal = (strength(section, share, degrees) for degrees in (0.0, 45.0))
            over = np.sqrt(2.0) * axis / diagonal
            print(f"{number:3d}{share:13.2f}{axis / 1e3:17.0f}{diagonal / 1e3:9.0f}{over:29.2f}")


if __name__ == "__main__":
    main()
