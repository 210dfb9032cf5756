"""Time against accuracy: which method, step or tolerance a case needs, and which physics.

`trade` measures it; `Trade` holds what was found.
"""

from rbsdem.accuracy import figure as figure
from rbsdem.accuracy import files as files
from rbsdem.accuracy import refine as refine
from rbsdem.accuracy import table as table
from rbsdem.accuracy.answer import Setting
from rbsdem.accuracy.measure import trade
from rbsdem.accuracy.outcome import Trade
from rbsdem.accuracy.physics import Effect, Physics
from rbsdem.accuracy.reference import Reference
from rbsdem.accuracy.rows import Choice, Row

__all__ = ["Choice", "Effect", "Physics", "Reference", "Row", "Setting", "Trade", "trade"]
