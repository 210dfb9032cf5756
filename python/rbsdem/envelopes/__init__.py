"""Envelopes of cyclic curves and their idealisation by the definitions of codes."""

from rbsdem.envelopes import figure as figure
from rbsdem.envelopes import of_result as of_result
from rbsdem.envelopes.envelope import Envelope, envelope
from rbsdem.envelopes.idealise import IDEALISATIONS, Idealisation

__all__ = ["IDEALISATIONS", "Envelope", "Idealisation", "envelope"]
