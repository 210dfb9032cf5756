"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

from rbsdem import compare, peer, plot
from rbsdem._core import version as _version
from rbsdem.analysis import Modes, cyclic, mass_matrix, modes, time_history
from rbsdem.case import Case, read_case
from rbsdem.column import Column
from rbsdem.damping import Damping
from rbsdem.errors import AccuracyWarning, InputError, RbsdemError, SolveError
from rbsdem.paper import paper_columns, paper_sections
from rbsdem.peer_file import PeerTest, read_peer
from rbsdem.protocol import protocol
from rbsdem.results import Result
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda
from rbsdem.trade import Trade, trade

__version__ = _version()

__all__ = [
    "AccuracyWarning",
    "Bilinear",
    "Case",
    "Column",
    "Compression",
    "Damping",
    "Elastic",
    "InputError",
    "Modes",
    "PeerTest",
    "RbsdemError",
    "Result",
    "SolveError",
    "Takeda",
    "Trade",
    "compare",
    "cyclic",
    "mass_matrix",
    "modes",
    "paper_columns",
    "paper_sections",
    "peer",
    "plot",
    "protocol",
    "read_case",
    "read_peer",
    "time_history",
    "trade",
]
