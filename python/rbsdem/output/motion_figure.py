"""Figures of ground motions and of their spectra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rbsdem._views import view_of
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.spectrum import Spectrum
from rbsdem.output.style import MODEL_LINE, axes_or_new, line_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@view_of(GroundMotion, "plot")
def draw_motion(motion: GroundMotion, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the acceleration over time.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones.
    **line
        Keywords of the line.
    """
    with axes_or_new(ax, (6.0, 2.2)) as drawn:
        default = {**MODEL_LINE, "linewidth": 0.7, "label": motion.name}
        drawn.plot(motion.time, motion.acceleration, **line_of(default, line))
        if ax is None:
            drawn.set(xlabel="Time (s)", ylabel="Acceleration (m/s²)", title=motion.name)
    return drawn


@view_of(Spectrum, "plot")
def draw_spectrum(spectrum: Spectrum, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the pseudo-acceleration over the period.

    Parameters
    ----------
    spectrum : Spectrum
        The spectrum.
    ax : matplotlib Axes, optional
        Axes to draw on; by default new ones with logarithmic scales.
    **line
        Keywords of the line.
    """
    with axes_or_new(ax) as drawn:
        drawn.plot(spectrum.period, spectrum.pseudo_acceleration, **line_of(MODEL_LINE, line))
        if ax is None:
            drawn.set(xlabel="Period (s)", ylabel="Pseudo-acceleration (m/s²)")
            drawn.set(xscale="log", yscale="log", title=f"Damping {100 * spectrum.damping:g} %")
    return drawn
