"""Masonry infills of frames: panels that act as two struts, one across each diagonal."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.model.frame import FrameMember, Member
from rbsdem.model.springs import Landmark, PeakOriented

#: Mean shear stress of a panel at its largest force, at f_m = 1 MPa [Pa], and how it grows with
#: f_m: `studies/infills_measured.py` fits the first and chooses the second.
STRESS, EXPONENT = 0.42e6, 0.25
#: Share of the force at which a panel cracks, and its stiffness before over that to the peak.
_CRACKS, _STIFFER = 0.8, 8.0
#: Share of the force that is left, and the drift of the panel from which on it is.
_LEFT, _LEFT_FROM = 0.3, 0.03

#: What is said of frames with infills, with their results.
INFILL_NOTE = (
    "Infills are struts between the nodes: the shear that a panel puts on a column beside it is "
    "not in the model, and 20 of 56 tested frames name it; compare the forces of the struts with "
    "the shear strength of the columns by hand. Peaks of tested frames are 0.97 of the model, "
    "with a standard deviation of ln of 0.30; initial stiffness and drift at the peak are not "
    "predicted (0.7)."
)


@dataclass(frozen=True)
class Infill:
    """A masonry panel between the columns and beams of a bay.

    It becomes two struts between the nodes, each of which carries compression alone, and none of
    the dead load. The horizontal force of a panel grows to V at the drift `peak_drift` of its clear
    height, with a crack at 0.8 V and eight times the stiffness, and falls to 0.3 V at a drift of 3
    %; V = 0.42 MPa (f_m/MPa)^0.25 t l with the clear length l. How well that predicts
    tests is in ``docs/existing.md``.

    Parameters
    ----------
    thickness : float
        Of the masonry, all wythes together [m].
    fm : float, optional
        Compressive strength of the masonry across its bed joints [Pa], as prisms have it; needed
        unless `strength` is given.
    opening : pair of float, optional
        Length and height of a window or a door [m]; of several, the sum of their lengths and their
        mean height. It takes V to the share 0.55 exp(-0.035 A) + 0.44 exp(-0.025 L), A and L its
        shares of area and length of the panel in % (Decanini, Liberatore, Mollaioli 2014).
    strength : float, optional
        V [N], in place of the law and of the effect of the opening.
    peak_drift : float, optional
        Drift of the panel at which it has its largest force.
    name : str, optional
        Name in case files; made up if it is not given.

    Raises
    ------
    InputError
        If an argument is refused.
    """

    thickness: float
    fm: float | None = None
    opening: tuple[float, float] | None = None
    strength: float | None = None
    peak_drift: float = 0.005
    name: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        _arguments.convert(self, "Infill")
        for name in ("thickness", "fm", "strength"):
            value = getattr(self, name)
            if value is not None and not value > 0.0:
                raise InputError(f"Infill: {name} = {value:g} must be above 0")
        if self.fm is None and self.strength is None:
            raise InputError("Infill: fm is not given; give it, or strength")
        if not 0.0 < self.peak_drift < _LEFT_FROM:
            raise InputError(
                f"Infill: peak_drift = {self.peak_drift:g} must be above 0 and below {_LEFT_FROM:g}"
            )
        if self.opening is not None:
            sizes = _arguments.vector(self.opening, "Infill: opening", shape="2")
            if sizes.size != 2 or not (sizes > 0.0).all():
                raise InputError(
                    f"Infill: opening = {_arguments.shown(self.opening)} must be its length and "
                    "its height [m], both above 0"
                )
            _arguments.put(self, opening=tuple(sizes.tolist()))

    def opening_factor(self, length: float, height: float) -> float:
        """Return the share of the force that an opening leaves of a panel with clear sizes [m]."""
        if self.opening is None:
            return 1.0
        for name, size, whole in zip(("long", "high"), self.opening, (length, height), strict=True):
            if size >= whole:
                raise InputError(
                    f"the opening is {size:g} m {name}, and the panel {whole:.4g} m; correct it, "
                    "or leave the infill out"
                )
        wide = 100.0 * float(self.opening[0]) / length
        area = wide * float(self.opening[1]) / height
        return float(0.55 * math.exp(-0.035 * area) + 0.44 * math.exp(-0.025 * wide))

    def force(self, length: float, height: float) -> float:
        """Return the largest horizontal force V of a panel with clear sizes [m] in N."""
        factor = self.opening_factor(length, height)
        if self.strength is not None:
            return self.strength
        assert self.fm is not None
        stress = STRESS * (1e-6 * self.fm) ** EXPONENT
        return float(factor * stress * self.thickness * length)


class InfilledBay(NamedTuple):
    """An infill in its place.

    Attributes
    ----------
    infill : Infill
        The panel.
    bay, storey : int
        Its place in the grid.
    length, height : float
        Clear sizes between columns and beams [m].
    run, rise : float
        Sizes between the axes, which the struts cross [m].
    """

    infill: Infill
    bay: int
    storey: int
    length: float
    height: float
    run: float
    rise: float

    @property
    def struts(self) -> tuple[str, str]:
        """Names of its struts: that which rises to the right, then the other one."""
        return f"I-{self.bay}-{self.storey}-1", f"I-{self.bay}-{self.storey}-2"

    @property
    def force(self) -> float:
        """Largest horizontal force [N]."""
        return self.infill.force(self.length, self.height)

    @property
    def slope(self) -> float:
        """Cosine of the angle of the struts."""
        return self.run / math.hypot(self.run, self.rise)

    def _drifts(self) -> dict[str, float]:
        """Return the displacements of the panel where it cracks, at its peak and behind it [m]."""
        peak = self.infill.peak_drift * self.height
        return {
            "cracking": _CRACKS / _STIFFER * peak, "cap": peak, "residual": _LEFT_FROM * self.height
        }  # fmt: skip

    def landmarks(self) -> list[Landmark]:
        """Return where a strut cracks, has its largest force, and has what is left of it."""
        source = {"cracking": "0.8 V", "cap": "V at peak_drift", "residual": "0.3 V at 3 %"}
        return [
            Landmark(name, -1, at * self.slope, source[name])  # type: ignore[arg-type]
            for name, at in self._drifts().items()
        ]

    def spring(self) -> PeakOriented:
        """Return the spring of a strut: forces and displacements of the panel along it."""
        at = {name: drift * self.slope for name, drift in self._drifts().items()}
        force = self.force / self.slope
        return PeakOriented(
            d_c=at["cracking"], f_c=_CRACKS * force, d_y=at["cap"], f_y=0.0, f_y_neg=force,
            d_cap=at["cap"], f_cap=force, d_pc=(at["residual"] - at["cap"]) / (1.0 - _LEFT),
            f_res=_LEFT * force,
        )  # fmt: skip

    def members(self) -> list[Member]:
        """Return its struts, which are built after the dead load."""
        kind = FrameMember.strut(self.spring(), after_dead_load=True)
        i, k = self.bay, self.storey
        nodes = (f"N-{i}-{k - 1}", f"N-{i + 1}-{k}"), (f"N-{i + 1}-{k - 1}", f"N-{i}-{k}")
        return [Member(name, *ends, kind) for name, ends in zip(self.struts, nodes, strict=True)]
