"""Many runs: columns under ground motions at many scales, with measures of each run.

`rbsdem.ensemble` runs them and returns an `Ensemble`. On it stand incremental dynamic analysis,
stripes and clouds, their fragility curves, and columns of uncertain properties.
"""

from rbsdem.ensembles import figure as figure
from rbsdem.ensembles import table as _table  # registers the view
from rbsdem.ensembles import tables as tables
from rbsdem.ensembles.cloud import Cloud, CloudFragility, cloud
from rbsdem.ensembles.engine import ensemble
from rbsdem.ensembles.figure import draw_fragilities
from rbsdem.ensembles.fragility import Capacities, Counts, Fragility, fit_fragility
from rbsdem.ensembles.hazard import Hazard
from rbsdem.ensembles.hunt import Hunt
from rbsdem.ensembles.ida import IDA, ida
from rbsdem.ensembles.measures import LIMIT_STATES, MEASURES, STATUSES
from rbsdem.ensembles.record import Ensemble
from rbsdem.ensembles.stripes import Stripes, stripes
from rbsdem.ensembles.uncertain import (
    Sample,
    Uncertain,
    VarianceSplit,
    lognormal,
    variance_split,
)

__all__ = [
    "IDA",
    "LIMIT_STATES",
    "MEASURES",
    "STATUSES",
    "Capacities",
    "Cloud",
    "CloudFragility",
    "Counts",
    "Ensemble",
    "Fragility",
    "Hazard",
    "Hunt",
    "Sample",
    "Stripes",
    "Uncertain",
    "VarianceSplit",
    "cloud",
    "draw_fragilities",
    "ensemble",
    "fit_fragility",
    "ida",
    "lognormal",
    "stripes",
    "variance_split",
]

del _table
