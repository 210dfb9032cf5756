"""Incremental dynamic analysis, stripes, clouds, fragility, hazard, uncertain columns."""

from rbsdem.many.cloud import Cloud, CloudFragility
from rbsdem.many.fragility import Capacities, Counts, Fragility, fit_fragility
from rbsdem.many.hazard import Hazard
from rbsdem.many.hunt import Hunt
from rbsdem.many.ida import IDA
from rbsdem.many.measures import LIMIT_STATES, MEASURES, STATUSES
from rbsdem.many.stripes import Stripes
from rbsdem.many.uncertain import Sample, Uncertain, VarianceSplit, lognormal, variance_split

__all__ = [
    "IDA",
    "LIMIT_STATES",
    "MEASURES",
    "STATUSES",
    "Capacities",
    "Cloud",
    "CloudFragility",
    "Counts",
    "Fragility",
    "Hazard",
    "Hunt",
    "Sample",
    "Stripes",
    "Uncertain",
    "VarianceSplit",
    "fit_fragility",
    "lognormal",
    "variance_split",
]
