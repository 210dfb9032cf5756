"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

from rbsdem import codes, comparison, motions, peer, plot
from rbsdem._core import version as _version
from rbsdem.accuracy import Trade, trade
from rbsdem.analysis import Matrices, Modes, cyclic, matrices, modes, time_history
from rbsdem.calibration import Calibration, Parameter, calibrate
from rbsdem.case import Case, read_case
from rbsdem.column import Column
from rbsdem.comparison import Comparison, compare
from rbsdem.corners import path_of as path_of
from rbsdem.damping import Damping
from rbsdem.ends import double_curvature
from rbsdem.ensembles import Ensemble, cloud, ensemble, ida, stripes
from rbsdem.envelopes import Envelope, Idealisation, envelope
from rbsdem.errors import (
    AccuracyWarning,
    InputError,
    Interrupted,
    LongRunWarning,
    RbsdemError,
    RepairWarning,
    SolveError,
)
from rbsdem.export import load
from rbsdem.footing import Footing
from rbsdem.limit_states import LimitState, LimitStates
from rbsdem.motions import GroundMotion
from rbsdem.paper import paper_columns, paper_sections
from rbsdem.peer import PeerTest, read_peer, read_test
from rbsdem.protocol import protocol
from rbsdem.result import Result
from rbsdem.section import (
    CircularSection,
    Concrete,
    HollowCircularSection,
    HollowRectangularSection,
    Layout,
    RectangularSection,
    Spiral,
    Steel,
    Ties,
)
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    PeakOriented,
    Pinching,
    SteelSpring,
    Takeda,
)
from rbsdem.strains import Gauge, Strains

__version__ = _version()

__all__ = [
    "AccuracyWarning",
    "Bilinear",
    "Calibration",
    "Case",
    "CircularSection",
    "Column",
    "Comparison",
    "Compression",
    "Concrete",
    "ConcreteSpring",
    "Damping",
    "Elastic",
    "Ensemble",
    "Envelope",
    "Footing",
    "Gauge",
    "GroundMotion",
    "HollowCircularSection",
    "HollowRectangularSection",
    "Idealisation",
    "InputError",
    "Interrupted",
    "Layered",
    "Layout",
    "LimitState",
    "LimitStates",
    "LongRunWarning",
    "Matrices",
    "Modes",
    "Parameter",
    "PeakOriented",
    "PeerTest",
    "Pinching",
    "RbsdemError",
    "RectangularSection",
    "RepairWarning",
    "Result",
    "SolveError",
    "Spiral",
    "Steel",
    "SteelSpring",
    "Strains",
    "Takeda",
    "Ties",
    "Trade",
    "calibrate",
    "cloud",
    "codes",
    "compare",
    "comparison",
    "cyclic",
    "double_curvature",
    "ensemble",
    "envelope",
    "ida",
    "load",
    "matrices",
    "modes",
    "motions",
    "paper_columns",
    "paper_sections",
    "peer",
    "plot",
    "protocol",
    "read_case",
    "read_peer",
    "read_test",
    "stripes",
    "time_history",
    "trade",
]
