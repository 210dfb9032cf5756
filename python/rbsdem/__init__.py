"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

from rbsdem import _registered as _registered
from rbsdem import codes, curves, fragility, motions, peer, plot, springs
from rbsdem._core import version as _version
from rbsdem.calibration.fit import calibrate
from rbsdem.calibration.outcome import Calibration
from rbsdem.checks.limit_states import LimitState, LimitStates
from rbsdem.curves.envelope import Envelope, envelope
from rbsdem.curves.idealise import Idealisation
from rbsdem.curves.scores import Comparison, compare
from rbsdem.errors import (
    AccuracyWarning,
    InputError,
    Interrupted,
    LongRunWarning,
    RbsdemError,
    RepairWarning,
    SolveError,
)
from rbsdem.many.cloud import cloud
from rbsdem.many.ensemble import Ensemble, ensemble
from rbsdem.many.ida import ida
from rbsdem.many.stripes import stripes
from rbsdem.measured.file import PeerTest, read_peer
from rbsdem.measured.laboratory import read_test
from rbsdem.methods.measure import trade
from rbsdem.methods.outcome import Trade
from rbsdem.model.circular import CircularSection
from rbsdem.model.column import Column
from rbsdem.model.damping import Damping
from rbsdem.model.ends import double_curvature
from rbsdem.model.footing import Footing
from rbsdem.model.hollow import HollowCircularSection, HollowRectangularSection
from rbsdem.model.materials import Concrete, Steel
from rbsdem.model.parameter import Parameter
from rbsdem.model.rectangular import RectangularSection
from rbsdem.model.reinforcement import Layout, Spiral, Ties
from rbsdem.model.springs import (
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
from rbsdem.model.strains import Gauge, Strains
from rbsdem.motions.motion import GroundMotion
from rbsdem.results.case import Case, read_case
from rbsdem.results.result import Result, cyclic, time_history
from rbsdem.results.saved import read_result
from rbsdem.section.paper import paper_columns, paper_sections
from rbsdem.solve.analysis import Matrices, Modes, matrices, modes
from rbsdem.solve.protocol import protocol

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
    "curves",
    "cyclic",
    "double_curvature",
    "ensemble",
    "envelope",
    "fragility",
    "ida",
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
    "read_result",
    "read_test",
    "springs",
    "stripes",
    "time_history",
    "trade",
]
