"""Fit parameters of a column to a measured loop, and report how well the test determines them.

The parameters are paths into the column, such as ``flexure.k_y``, or those that a column made from
a recipe offers.
"""

from rbsdem.calibration.fit import calibrate, free_names, undetermined
from rbsdem.calibration.outcome import Calibration, Fitted
from rbsdem.model.parameter import Parameter, Recipe

__all__ = [
    "Calibration",
    "Fitted",
    "Parameter",
    "Recipe",
    "calibrate",
    "free_names",
    "undetermined",
]
