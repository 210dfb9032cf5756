"""What a result tells of its loop, by the definitions that tests are judged by."""

from __future__ import annotations

from typing import Literal

from rbsdem._arguments import Array
from rbsdem._views import view_of
from rbsdem.curves.cycles import HalfCycles, half_cycles
from rbsdem.curves.envelope import Envelope, envelope
from rbsdem.curves.idealise import Idealisation, Method
from rbsdem.curves.strength import strength_loss
from rbsdem.result import Result


@view_of(Result, "envelope")
def envelope_of(result: Result, side: Literal[1, -1]) -> Envelope:
    """Return the envelope of the loop to one side."""
    return envelope(result, side)


@view_of(Result, "idealise")
def idealise(
    result: Result, method: Method, side: Literal[1, -1], end: float | None
) -> Idealisation:
    """Return two straight lines in place of the envelope."""
    return envelope(result, side).idealise(method, end=end)


@view_of(Result, "half_cycles")
def cycles(result: Result) -> HalfCycles:
    """Return the half-cycles of the loop."""
    done = None if result.dynamic else result.path.energy["input"]
    return half_cycles(*_loop(result), done=done)


@view_of(Result, "strength_loss")
def loss(result: Result, share: float) -> float:
    """Return the displacement at which a share of the strength is lost."""
    return strength_loss(*_loop(result), share=share)


def _loop(result: Result) -> tuple[Array, Array]:
    return result.path.displacement, result.path.loop_force
