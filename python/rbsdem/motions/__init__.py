"""Ground motions: records read, measured, scaled and joined, and synthetic ones."""

from rbsdem._tables import STANDARD_GRAVITY as STANDARD_GRAVITY
from rbsdem.motions.motion import GroundMotion as GroundMotion
from rbsdem.motions.motion import Spectrum as Spectrum
from rbsdem.motions.motion import corrected as corrected
from rbsdem.motions.motion import resampled as resampled
from rbsdem.motions.motion import sequence as sequence
from rbsdem.motions.motion import synthetic as synthetic
from rbsdem.motions.read import read_motion as read_motion
from rbsdem.motions.read import read_motions as read_motions
