"""ASCE 41-17, chapter 10 (ACI 369.1-17): stiffness, shear strength, plastic rotations."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rbsdem.checks.code_drawing import Quantities

__all__ = ["Rotations", "rotations", "shear_strength", "stiffness_ratio"]


@dataclass(frozen=True)
class Rotations:
    """Plastic rotations of the backbone and acceptance criteria [rad].

    Attributes
    ----------
    a, b : float
        Up to the loss of lateral strength, and of the axial load.
    c : float
        Residual strength over strength.
    """

    a: float
    b: float
    c: float

    @property
    def io(self) -> float:
        """Immediate occupancy."""
        return min(0.15 * self.a, 0.005)

    @property
    def ls(self) -> float:
        """Life safety."""
        return 0.5 * self.b

    @property
    def cp(self) -> float:
        """Collapse prevention."""
        return 0.7 * self.b


def stiffness_ratio(axial_load_ratio: float) -> float:
    """Return E I_eff/(E_c I_g): 0.3 up to 0.1 f'c A_g, 0.7 from 0.5 on (table 10-5)."""
    return min(max(0.3 + (axial_load_ratio - 0.1), 0.3), 0.7)


def shear_strength(q: Quantities, ductility: float = 1.0) -> float:
    """Return V_Col [N] (10.4.2.3.1, normal-weight concrete).

    k (alpha A_v f_yt d/s + 0.5 sqrt(f'c)/(M/(V d)) sqrt(1 + N/(0.5 sqrt(f'c) A_g)) 0.8 A_g), with
    M/(V d) from 2 to 4; k = 1 up to a displacement ductility of 2, 0.7 from 6 on; alpha = 1 up to
    s/d = 0.75, 0 from 1 on.

    Parameters
    ----------
    q : Quantities
        The column.
    ductility : float, optional
        Displacement over that at yield.
    """
    tensile = 0.5 * math.sqrt(q.fc)
    slender = min(max(q.span / q.d, 2.0), 4.0)
    pressed = math.sqrt(max(1.0 + q.load / (tensile * q.gross_area), 0.0))
    concrete = tensile / slender * pressed * 0.8 * q.gross_area
    share = min(max((1.0 - q.spacing / q.d) / 0.25, 0.0), 1.0)
    ties = share * q.tie_area * q.fyt * q.d / q.spacing
    return min(max(1.15 - 0.075 * ductility, 0.7), 1.0) * (ties + concrete)


def rotations(
    axial_load_ratio: float,
    tie_ratio: float,
    shear_ratio: float,
    fc: float,
    fyt: float,
    *,
    circle: bool = False,
) -> Rotations:
    """Return plastic rotations of columns not controlled by splices (tables 10-8, 10-9).

    Parameters
    ----------
    axial_load_ratio : float
        N/(A_g f'c).
    tie_ratio : float
        A_v/(b s); taken as 0.0175 at most. Below 0.0005 the relations do not apply.
    shear_ratio : float
        Shear at flexural yield over `shear_strength` at low ductility; 0.2 at least.
    fc, fyt : float
        Strengths of concrete and ties [MPa].
    circle : bool, optional
        Table 10-9, for circles.
    """
    nu, rho, r = axial_load_ratio, min(tie_ratio, 0.0175), max(shear_ratio, 0.2)
    if circle:
        a = max(0.06 - 0.06 * nu + 1.3 * rho - 0.037 * r, 0.0)
    else:
        a = max(0.042 - 0.043 * nu + 0.63 * rho - 0.023 * r, 0.0)
    top = 0.65 if circle else 0.5

    def loss(pressed: float) -> float:
        return top / (5.0 + max(pressed, 0.1) / 0.8 / rho * fc / fyt) - 0.01

    b = loss(nu) if nu <= 0.5 else loss(0.5) * max(0.7 - nu, 0.0) / 0.2
    return Rotations(a, max(a, b), max(0.24 - 0.4 * nu, 0.0))
