"""Measured histories of column tests: the PEER Structural Performance Database.

The histories belong to the database and are no part of rbsdem; a user gets them there
(https://nisee.berkeley.edu/spd/) and names the folder. Of the paper's four columns the reversal
points come with rbsdem.
"""

from rbsdem.measured.doubts import Checked, Doubt, Indicators, check, indicators
from rbsdem.measured.drawing import DrawnSpecimen, column, draw
from rbsdem.measured.laboratory import read_test
from rbsdem.measured.measured import PDELTA_CODES, MeasuredTest, PeerTest, net_force, read_peer
from rbsdem.measured.nearest import nearest
from rbsdem.measured.predict import predict, predict_one
from rbsdem.measured.predictions import Neighbour, Prediction, Predictions
from rbsdem.measured.shipped import (
    FOLDER_VARIABLE,
    HISTORY_FILES,
    Reversals,
    find_history,
    measured_loops,
    shipped_reversals,
)
from rbsdem.measured.specimens import Observed, Specimen, Specimens, read_specimens
from rbsdem.section.paper import paper_columns, paper_sections
from rbsdem.section.spread import likeness
from rbsdem.web.gallery import gallery

__all__ = [
    "FOLDER_VARIABLE",
    "HISTORY_FILES",
    "PDELTA_CODES",
    "Checked",
    "Doubt",
    "DrawnSpecimen",
    "Indicators",
    "MeasuredTest",
    "Neighbour",
    "Observed",
    "PeerTest",
    "Prediction",
    "Predictions",
    "Reversals",
    "Specimen",
    "Specimens",
    "check",
    "column",
    "draw",
    "find_history",
    "gallery",
    "indicators",
    "likeness",
    "measured_loops",
    "nearest",
    "net_force",
    "paper_columns",
    "paper_sections",
    "predict",
    "predict_one",
    "read_peer",
    "read_specimens",
    "read_test",
    "shipped_reversals",
]
