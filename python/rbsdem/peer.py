"""Measured histories of column tests: the PEER Structural Performance Database.

The histories belong to the database and are no part of rbsdem; a user gets them there
(https://nisee.berkeley.edu/spd/) and names the folder. Of the paper's four columns the reversal
points come with rbsdem.
"""

from rbsdem.measured.predict import Prediction as Prediction
from rbsdem.measured.predict import nearest as nearest
from rbsdem.measured.predict import predict as predict
from rbsdem.measured.predict import score_summary as score_summary
from rbsdem.measured.predict import scores as scores
from rbsdem.measured.specimens import Specimen as Specimen
from rbsdem.measured.specimens import Specimens as Specimens
from rbsdem.measured.specimens import column as column
from rbsdem.measured.specimens import draw as draw
from rbsdem.measured.specimens import read_specimens as read_specimens
from rbsdem.measured.tests import FOLDER_VARIABLE as FOLDER_VARIABLE
from rbsdem.measured.tests import MeasuredTest as MeasuredTest
from rbsdem.measured.tests import find_history as find_history
from rbsdem.measured.tests import measured_loops as measured_loops
from rbsdem.measured.tests import net_force as net_force
from rbsdem.measured.tests import read_peer as read_peer
from rbsdem.measured.tests import read_test as read_test
from rbsdem.measured.tests import shipped_reversals as shipped_reversals
from rbsdem.run.bands import Band as Band
from rbsdem.run.bands import band as band
from rbsdem.section.paper import paper_columns as paper_columns
from rbsdem.section.paper import paper_sections as paper_sections
