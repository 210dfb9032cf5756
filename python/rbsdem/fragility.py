"""Incremental dynamic analysis, stripes, clouds, fragility, hazard, uncertain columns."""

from rbsdem.many.cloud import Cloud, CloudFragility, cloud
from rbsdem.many.ensemble import Ensemble
from rbsdem.many.fragility import Capacities, Counts, Fragility, Hazard, fit_fragility
from rbsdem.many.ida import IDA, Hunt
from rbsdem.many.measures import LIMIT_STATES, MEASURES, STATUSES
from rbsdem.many.stripes import Stripes, stripes
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
    "Ensemble",
    "Fragility",
    "Hazard",
    "Hunt",
    "Sample",
    "Stripes",
    "Uncertain",
    "VarianceSplit",
    "cloud",
    "fit_fragility",
    "lognormal",
    "stripes",
    "variance_split",
]
