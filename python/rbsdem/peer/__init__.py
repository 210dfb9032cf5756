"""Measured histories of column tests: the PEER Structural Performance Database.

The histories belong to the database and are no part of rbsdem; a user gets them there
(https://nisee.berkeley.edu/spd/) and names the folder. Of the paper's four columns the reversal
points come with rbsdem.
"""

from rbsdem.peer import band_views as band_views
from rbsdem.peer import contact_sheet as contact_sheet
from rbsdem.peer import gallery as gallery
from rbsdem.peer import tables as tables
from rbsdem.peer.bands import band
from rbsdem.peer.batch import predict, predict_one
from rbsdem.peer.columns import column
from rbsdem.peer.doubts import Checked, Doubt, check
from rbsdem.peer.drawing import Drawing, DrawnBar, draw
from rbsdem.peer.file import PeerTest, read_peer
from rbsdem.peer.indicators import Indicators, indicators
from rbsdem.peer.laboratory import read_test
from rbsdem.peer.measured import PDELTA_CODES, MeasuredTest, net_force
from rbsdem.peer.nearest import Neighbour, nearest, properties
from rbsdem.peer.prediction import Prediction
from rbsdem.peer.predictions import Group, Predictions, Quartiles
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
    "PDELTA_CODES",
    "Checked",
    "Doubt",
    "Drawing",
    "DrawnBar",
    "Group",
    "Indicators",
    "MeasuredTest",
    "Neighbour",
    "Observed",
    "PeerTest",
    "Prediction",
    "Predictions",
    "Quartiles",
    "Reversals",
    "Specimen",
    "Specimens",
    "band",
    "check",
    "column",
    "draw",
    "find_history",
    "indicators",
    "measured_loops",
    "nearest",
    "net_force",
    "predict",
    "predict_one",
    "properties",
    "read_peer",
    "read_specimens",
    "read_test",
    "shipped_reversals",
]
