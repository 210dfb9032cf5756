"""Moment-curvature once more, in plain numpy: another arrangement of the same laws, for the tests.

Fine fibres in place of strips, the strain by scanning and `brentq`, laws written as masks. Strains
and stresses are positive in compression, MPa and mm inside.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

FIBRES = 2000


def concrete(strain, fc, tension):
    """Stress of unconfined concrete [MPa]; `fc` in MPa."""
    strain = np.asarray(strain, dtype=float)
    ec = 3320.0 * np.sqrt(fc) + 6900.0
    n = 0.8 + fc / 17.0
    peak = fc / ec * n / (n - 1.0)
    ft = 0.45 * fc**0.4
    x = np.clip(strain, 0.0, None) / peak
    k = np.where(x > 1.0, max(1.0, 0.67 + fc / 62.0), 1.0)
    stress = fc * n * x / (n - 1.0 + x ** (n * k))
    if tension == "zero":
        return stress
    opening = np.clip(-strain, 0.0, None)
    after = 0.0 if tension == "bare" else ft / (1.0 + np.sqrt(500.0 * opening))
    return np.where(strain < 0.0, -np.where(ec * opening <= ft, ec * opening, after), stress)


def steel(strain, fy, fu, es=200e3, eps_sh=0.007, eps_u=0.1):
    """Stress of steel [MPa]."""
    strain = np.asarray(strain, dtype=float)
    size = np.abs(strain)
    hard = fu - (fu - fy) * ((eps_u - size) / (eps_u - eps_sh)) ** 2
    stress = np.where(size < fy / es, es * size, np.where(size <= eps_sh, fy, hard))
    return np.sign(strain) * np.where(size > eps_u, 0.0, stress)


class Fibres:
    """A section as fibres: `widths` gives the width at ordinates [mm]; bars are (y, A, fy, fu)."""

    def __init__(self, depth, widths, fc, bars, tension="ts"):
        edges = np.linspace(-depth / 2, depth / 2, FIBRES + 1)
        self.y = 0.5 * (edges[1:] + edges[:-1])
        self.area = widths(self.y) * np.diff(edges)
        self.depth, self.fc, self.tension = depth, fc, tension
        self.bar_y, self.bar_area, self.fy, self.fu = np.array(bars, dtype=float).reshape(-1, 4).T

    def sums(self, eps0, phi):
        """Axial force [N] and moment about mid-depth [N mm]."""
        force = concrete(eps0 - phi * self.y, self.fc, self.tension) * self.area
        strain = eps0 - phi * self.bar_y
        stress = steel(strain, self.fy, self.fu) - concrete(strain, self.fc, self.tension)
        bars = self.bar_area * stress
        return force.sum() + bars.sum(), -(force @ self.y) - bars @ self.bar_y

    def moments(self, load, curvature, step=5e-4):
        """Moments at rising curvatures of one sign [1/mm], following one branch from zero."""
        eps0, phi, found = 0.0, 0.0, []
        for target in [0.0, *curvature]:
            parts = max(1, int(np.ceil(abs(target - phi) * self.depth / step)))
            for at in np.linspace(phi, target, parts + 1)[1:]:
                eps0 = self._strain(load, at, eps0)
            phi = target
            found.append(self.sums(eps0, phi)[1])
        return np.array(found[1:])

    def _strain(self, load, phi, start):
        def residual(eps0):
            return self.sums(eps0, phi)[0] - load

        at, value = start, residual(start)
        side = -np.sign(value)
        step = 1e-6
        for _ in range(400):
            ahead = at + side * step
            if residual(ahead) * value <= 0.0:
                return brentq(residual, *sorted((at, ahead)), xtol=1e-14)
            at, step = ahead, min(1e-4, 1.5 * step)
        raise ValueError(f"no equilibrium at {phi}")
