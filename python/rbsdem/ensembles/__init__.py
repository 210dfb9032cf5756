"""Many runs: columns under ground motions at many scales, with measures of each run.

`rbsdem.ensemble` runs them and returns an `Ensemble`.
"""

from rbsdem.ensembles import table as _table  # registers the view
from rbsdem.ensembles.engine import ensemble
from rbsdem.ensembles.measures import MEASURES, STATUSES
from rbsdem.ensembles.record import Ensemble

__all__ = ["MEASURES", "STATUSES", "Ensemble", "ensemble"]

del _table
