"""Regressions on tests: Elwood and Eberhard, Haselton, Berry and Eberhard, Goodnight."""

from __future__ import annotations

import math

from rbsdem.checks.code_drawing import Quantities

__all__ = [
    "Haselton",
    "berry_buckling_drift",
    "berry_buckling_rotation",
    "berry_spalling_drift",
    "elwood_eberhard_stiffness",
    "goodnight_buckling_drift",
    "goodnight_buckling_strain",
]


def elwood_eberhard_stiffness(q: Quantities) -> float:
    """Return E I_eff/(E I_g) of Elwood, Eberhard 2009, eq 18; 329 columns, 25 % scatter.

    (0.45 + 2.5 nu)/(1 + 110 (d_b/h)(h/a)), from 0.2 to 1.
    """
    ratio = (0.45 + 2.5 * q.axial_load_ratio) / (1.0 + 110.0 * q.bar / q.span)
    return min(max(ratio, 0.2), 1.0)


class Haselton:
    """Haselton and others 2008, 2016: backbone of a hinge; 255 rectangular columns.

    Parameters
    ----------
    q : Quantities
        The column.
    slip : bool, optional
        Whether bars can slip out of the base.
    """

    def __init__(self, q: Quantities, slip: bool = True) -> None:
        self._q = q
        self._slip = 1.0 if slip else 0.0
        self._nu = q.axial_load_ratio
        self._ties = 0.02 + 40.0 * q.tie_ratio

    @property
    def capping_rotation(self) -> float:
        """Plastic rotation up to the cap, theta_cap,pl (2016, eq 5) [rad].

        Unlike bars in compression and in tension count with the factor of 2008,
        (max(0.01, rho' f_y/f'c)/max(0.01, rho f_y/f'c))^0.225.
        """
        q = self._q
        concrete = q.width * q.d * q.fc
        pressed, pulled = (
            max(0.01, force / concrete)
            for force in (q.compression * q.fy_compression, q.tension * q.fy)
        )
        slender = q.spacing / q.bar * math.sqrt(q.fy / 100.0) if q.tie_area > 0 else 20.0
        return (
            0.12
            * (1.0 + 0.55 * self._slip)
            * 0.16**self._nu
            * self._ties**0.43
            * 0.54 ** (0.01 * q.fc)
            * 0.66 ** (0.1 * slender)
            * 2.27 ** (10.0 * q.steel_ratio)
            * (pressed / pulled) ** 0.225
        )

    @property
    def post_capping_rotation(self) -> float:
        """Rotation from the cap to no strength, theta_pc (2016, eq 8), at most 0.1 [rad]."""
        return min(0.76 * 0.031**self._nu * self._ties**1.02, 0.10)

    @property
    def hardening(self) -> float:
        """Moment at the cap over that at yield, M_c/M_y (2008, eq 3.17)."""
        return 1.25 * 0.89**self._nu * 0.91 ** (0.01 * self._q.fc)

    @property
    def yield_stiffness(self) -> float:
        """E I_y/(E I_g), secant to yield (2016), from 0.2 to 0.6."""
        return self._stiffness(0.30, 0.72, 0.2, 0.6)

    @property
    def initial_stiffness(self) -> float:
        """E I_stf,40/(E I_g), secant to 40 % of yield (2016), from 0.35 to 0.8."""
        return self._stiffness(0.77, 0.43, 0.35, 0.8)

    def _stiffness(self, factor: float, power: float, least: float, most: float) -> float:
        pressed = max(0.1 + self._nu, 0.0) ** 0.80
        return min(max(factor * pressed * self._q.slenderness**power, least), most)


def berry_buckling_rotation(q: Quantities) -> float:
    """Return the plastic rotation at bar buckling of Berry, Eberhard 2005 [rad].

    C_0 (1 + C_1 rho_eff)/(1 + C_2 nu) (1 + C_3 L/D + C_4 d_b f_y/D).
    """
    c = (0.006, 7.190, 3.129, 0.651, 0.227) if q.round else (0.019, 1.650, 1.797, 0.012, 0.072)
    effective = q.hoop_ratio * q.fyt / q.fc
    slender = 1.0 + c[3] * q.slenderness + c[4] * q.bar * q.fy / q.depth
    return c[0] * (1.0 + c[1] * effective) / (1.0 + c[2] * q.axial_load_ratio) * slender


def berry_spalling_drift(q: Quantities) -> float:
    """Return the drift at spalling of Berry, Eberhard 2003: 1.6 % (1 - nu)(1 + L/(10 D))."""
    return 0.016 * (1.0 - q.axial_load_ratio) * (1.0 + 0.1 * q.slenderness)


def berry_buckling_drift(q: Quantities) -> float:
    """Return the drift at bar buckling of Berry, Eberhard 2003.

    3.25 % (1 + k_e rho_eff d_b/D)(1 - nu)(1 + L/(10 D)), k_e = 40, 150 for a spiral, 0 for hoops
    further apart than six diameters of a bar.
    """
    effect = 0.0
    if q.spacing <= 6.0 * q.bar:
        effect = (150.0 if q.round else 40.0) * q.hoop_ratio * q.fyt / q.fc * q.bar / q.depth
    return 0.0325 * (1.0 + effect) * (1.0 - q.axial_load_ratio) * (1.0 + 0.1 * q.slenderness)


def goodnight_buckling_strain(q: Quantities) -> float:
    """Return the tensile strain before bar buckling of Goodnight, Kowalsky, Nau; bridge columns.

    0.03 + 700 rho_s f_yh/E_s - 0.1 nu.
    """
    return 0.03 + 700.0 * q.hoop_ratio * q.fyt / q.es - 0.1 * q.axial_load_ratio


def goodnight_buckling_drift(q: Quantities) -> float:
    """Return the drift before bar buckling of Goodnight, Kowalsky, Nau; circular bridge columns.

    In per cent 0.9 - 3.13 nu + 142000 rho_s f_yh/E_s + 0.45 L/D.
    """
    percent = 0.9 - 3.13 * q.axial_load_ratio + 142000.0 * q.hoop_ratio * q.fyt / q.es
    return 0.01 * (percent + 0.45 * q.slenderness)
