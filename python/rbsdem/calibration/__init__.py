"""Fit parameters of a column to a measured loop, and report how well the test determines them.

The parameters are paths into the column, such as ``flexure.k_y``, or those that a column made from
a drawing offers.
"""

from rbsdem.calibration.fit import Calibration as Calibration
from rbsdem.calibration.fit import calibrate as calibrate
from rbsdem.calibration.fit import free_names as free_names
