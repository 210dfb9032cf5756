# The names of the package, each with its home: `__init__.py` reads them here.
from rbsdem import codes as codes
from rbsdem import curves as curves
from rbsdem import errors as errors
from rbsdem import fragility as fragility
from rbsdem import frames as frames
from rbsdem import motions as motions
from rbsdem import peer as peer
from rbsdem import plot as plot
from rbsdem import section as section
from rbsdem import springs as springs
from rbsdem.calibration.fit import calibrate as calibrate
from rbsdem.curves.scores import compare as compare
from rbsdem.errors import InputError as InputError
from rbsdem.errors import SolveError as SolveError
from rbsdem.many.ensemble import ensemble as ensemble
from rbsdem.many.ida import ida as ida
from rbsdem.measured.tests import read_test as read_test
from rbsdem.methods.study import compare_methods as compare_methods
from rbsdem.methods.verification import verify as verify
from rbsdem.model.column import Column as Column
from rbsdem.model.column import Damping as Damping
from rbsdem.model.column import Footing as Footing
from rbsdem.model.frame import FrameMember as FrameMember
from rbsdem.model.materials import Bars as Bars
from rbsdem.model.materials import Concrete as Concrete
from rbsdem.model.materials import Layout as Layout
from rbsdem.model.materials import Spiral as Spiral
from rbsdem.model.materials import Steel as Steel
from rbsdem.model.materials import Ties as Ties
from rbsdem.model.shape import CircularSection as CircularSection
from rbsdem.model.shape import RectangularSection as RectangularSection
from rbsdem.motions.motion import GroundMotion as GroundMotion
from rbsdem.run.analysis import matrices as matrices
from rbsdem.run.analysis import modes as modes
from rbsdem.run.case import read_case as read_case
from rbsdem.run.case import read_result as read_result
from rbsdem.run.protocol import protocol as protocol
from rbsdem.run.result import Result as Result
from rbsdem.run.result import cyclic as cyclic
from rbsdem.run.result import pushover as pushover
from rbsdem.run.result import time_history as time_history
from rbsdem.run.solver import Solver as Solver
from rbsdem.section.building import Frame as Frame
from rbsdem.web.report import report as report

__version__: str
__all__: list[str]
