"""Ground motions: records read, measured, scaled and joined, and synthetic ones."""

from rbsdem.motions.motion import STANDARD_GRAVITY, GroundMotion, Spectrum
from rbsdem.motions.read import read_motion, read_motions
from rbsdem.motions.shaping import corrected, resampled, sequence, synthetic

__all__ = [
    "STANDARD_GRAVITY",
    "GroundMotion",
    "Spectrum",
    "corrected",
    "read_motion",
    "read_motions",
    "resampled",
    "sequence",
    "synthetic",
]
