"""Limit states along a response: where it cracks, yields, spalls, loses its strength."""

from rbsdem.limit_states import figure as figure
from rbsdem.limit_states import find as find
from rbsdem.limit_states import state_figure as state_figure
from rbsdem.limit_states import table as table
from rbsdem.limit_states.hinge import Hinge
from rbsdem.limit_states.record import LimitState, LimitStates

__all__ = ["Hinge", "LimitState", "LimitStates"]
