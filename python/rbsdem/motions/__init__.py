"""Ground motions: records read, measured, scaled and joined, and synthetic ones."""

from rbsdem._tables import STANDARD_GRAVITY as STANDARD_GRAVITY
from rbsdem.motions.motion import GroundMotion as GroundMotion
from rbsdem.motions.motion import Spectrum as Spectrum
from rbsdem.motions.read import read_motion as read_motion
from rbsdem.motions.read import read_motions as read_motions
from rbsdem.motions.shaping import corrected as corrected
from rbsdem.motions.shaping import resampled as resampled
from rbsdem.motions.shaping import sequence as sequence
from rbsdem.motions.shaping import synthetic as synthetic
