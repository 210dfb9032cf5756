"""Measured histories of column tests: the PEER Structural Performance Database.

The histories belong to the database and are no part of rbsdem; a user gets them there
(https://nisee.berkeley.edu/spd/) and names the folder. Of the paper's four columns the reversal
points come with rbsdem.
"""

from rbsdem.peer.batch import predict, predict_one
from rbsdem.peer.blind import MODELS, LayeredColumn, column
from rbsdem.peer.drawing import Drawing, DrawnBar, draw
from rbsdem.peer.file import PeerTest, read_peer
from rbsdem.peer.layers import Hinge
from rbsdem.peer.measured import PDELTA_CODES, MeasuredTest, net_force
from rbsdem.peer.predictions import Group, Prediction, Predictions, Quartiles
from rbsdem.peer.shear import ShearNumbers
from rbsdem.peer.shipped import (
    FOLDER_VARIABLE,
    HISTORY_FILES,
    Reversals,
    find_history,
    measured_loops,
    shipped_reversals,
)
from rbsdem.peer.specimen import Observed, Specimen
from rbsdem.peer.specimens import Specimens, read_specimens

__all__ = [
    "FOLDER_VARIABLE",
    "HISTORY_FILES",
    "MODELS",
    "PDELTA_CODES",
    "Drawing",
    "DrawnBar",
    "Group",
    "Hinge",
    "LayeredColumn",
    "MeasuredTest",
    "Observed",
    "PeerTest",
    "Prediction",
    "Predictions",
    "Quartiles",
    "Reversals",
    "ShearNumbers",
    "Specimen",
    "Specimens",
    "column",
    "draw",
    "find_history",
    "measured_loops",
    "net_force",
    "predict",
    "predict_one",
    "read_peer",
    "read_specimens",
    "shipped_reversals",
]
