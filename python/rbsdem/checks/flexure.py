"""Yield of a rectangular section in closed form, and lengths of plastic hinges."""

from __future__ import annotations

import math

from rbsdem.checks.code_drawing import Quantities

__all__ = ["hinge_length_paulay", "hinge_length_priestley", "yield_point"]


def yield_point(q: Quantities, modulus: float | None = None) -> tuple[float, float, float]:
    """Return curvature [1/mm], moment [N mm] and relative depth of the neutral axis at yield.

    Panagiotakos and Fardis 2001, eqs 1 to 6: yield of the bars in tension, or a strain of
    1.8 f'c/E_c of the concrete, whichever comes first.

    Parameters
    ----------
    q : Quantities
        The column; a rectangle.
    modulus : float, optional
        Of the concrete [MPa]; 4700 sqrt(f'c) by default.
    """
    ec = 4700.0 * math.sqrt(q.fc) if modulus is None else modulus
    area = q.width * q.d
    rho, rho2, web = (each / area for each in (q.tension, q.compression, q.web))
    n, cover = q.es / ec, q.d2 / q.d
    found = []
    for steel in (True, False):
        load = q.load / (area * q.fy) if steel else -q.load / (1.8 * n * area * q.fc)
        a = rho + rho2 + web + load
        b = rho + rho2 * cover + 0.5 * web * (1.0 + cover)
        if steel:
            b += load
        deep = math.sqrt((n * a) ** 2 + 2.0 * n * b) - n * a
        strain = q.fy / (q.es * (1.0 - deep) * q.d) if steel else 1.8 * q.fc / (ec * deep * q.d)
        found.append((strain if strain > 0 else math.inf, deep))
    curvature, deep = min(found)
    concrete = 0.5 * ec * deep**2 * (0.5 * (1.0 + cover) - deep / 3.0)
    bars = (1.0 - deep) * rho + (deep - cover) * rho2 + web * (1.0 - cover) / 6.0
    moment = q.width * q.d**3 * curvature * (concrete + 0.5 * q.es * (1.0 - cover) * bars)
    return curvature, moment, deep


def hinge_length_priestley(q: Quantities) -> float:
    """Return the hinge length of Priestley, Calvi, Kowalsky 2007 [mm].

    k L + L_sp, at least 2 L_sp; k = 0.2 (f_u/f_y - 1) up to 0.08, L_sp = 0.022 f_y d_b. NaN where
    the tensile strength of the bars is not known.
    """
    slip = 0.022 * q.fy * q.bar
    if math.isnan(q.fu):
        return math.nan
    return max(min(0.2 * (q.fu / q.fy - 1.0), 0.08) * q.span + slip, 2.0 * slip)


def hinge_length_paulay(q: Quantities) -> float:
    """Return the hinge length 0.08 L + 0.022 d_b f_y of Paulay, Priestley 1992 [mm]."""
    return 0.08 * q.span + 0.022 * q.bar * q.fy
