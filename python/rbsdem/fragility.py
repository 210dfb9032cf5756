"""Incremental dynamic analysis, stripes, fragility, hazard."""

from rbsdem.many.ensemble import Ensemble as Ensemble
from rbsdem.many.fragility import Capacities as Capacities
from rbsdem.many.fragility import Counts as Counts
from rbsdem.many.fragility import Fragility as Fragility
from rbsdem.many.fragility import Hazard as Hazard
from rbsdem.many.fragility import fit_fragility as fit_fragility
from rbsdem.many.ida import IDA as IDA
from rbsdem.many.ida import CollapseSearch as CollapseSearch
from rbsdem.many.ida import Stripes as Stripes
from rbsdem.many.ida import stripes as stripes
from rbsdem.many.inputs import MEASURES as MEASURES
from rbsdem.many.inputs import STOREY_MEASURES as STOREY_MEASURES
