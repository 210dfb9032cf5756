"""Cyclic loading protocols."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError

_NONE = np.empty(0)


def protocol(
    amplitudes: ArrayLike | str,
    cycles: int | Sequence[int] | None = None,
    repeats: int = 1,
    points: int = 25,
    *,
    negative_amplitudes: ArrayLike | None = None,
    reference: float | None = None,
    largest: float | None = None,
) -> Array:
    """Return full cycles 0, +a, 0, -a, 0 of given amplitudes, or a protocol of the literature.

    Parameters
    ----------
    amplitudes : array_like, shape (k,), or str
        Amplitude of each step of the protocol, in the unit of the driven quantity; or the name of a
        protocol: "sac", "aci_374_1", "aci_374_2" (their amplitudes are drifts, displacement over
        height), "fema_461", "curee", "atc_24" (multiples of `reference`). Their sources, and what
        of them is not confirmed, are in ``docs/input.md``, "Named protocols".
    cycles : int or sequence of k int, optional
        Cycles at each amplitude, by default 1; a named protocol has its own.
    repeats : int, optional
        How often the whole protocol is repeated.
    points : int, optional
        Points on a quarter of a cycle.
    negative_amplitudes : array_like, shape (k,), optional
        Amplitudes to the other side; by default the same. Zero pushes to one side only.
    reference : float, optional
        For a named protocol: the amplitude that it is counted in ("fema_461": of its tenth step;
        "curee": its reference deformation; "atc_24": at yield), or the drift at yield
        ("aci_374_2"). The result has its unit.
    largest : float, optional
        For a named protocol: no amplitude goes beyond; it continues up to there by its own rule.
        "atc_24" needs it.

    Returns
    -------
    ndarray, shape (4 points sum(cycles) repeats + 1,)
        The path, which starts at zero.

    Raises
    ------
    InputError
        If an amplitude is not positive, a count is below 1, or a name is not known.

    Examples
    --------
    >>> protocol([0.01, 0.02], points=1)
    array([ 0.  ,  0.01,  0.  , -0.01,  0.  ,  0.02,  0.  , -0.02,  0.  ])
    >>> float(protocol("fema_461", reference=0.04).max())
    0.04
    """
    one_side = _NONE
    if isinstance(amplitudes, str):
        if cycles is not None or negative_amplitudes is not None:
            raise InputError(
                f"protocol: {amplitudes!r} has its own cycles and amplitudes; leave out cycles and "
                "negative_amplitudes"
            )
        limits = [_positive(reference, "reference"), _positive(largest, "largest")]
        steps, counts = np.split(
            _core.evaluate("named_protocol", amplitudes, reference_and_largest=limits).values, 2
        )
    else:
        if reference is not None or largest is not None:
            raise InputError(
                "protocol: reference and largest belong to a named protocol; leave them out"
            )
        steps = _arguments.finite_vector(amplitudes, "amplitudes", shape="1 or m")
        several = [1] if cycles is None else [cycles] if np.isscalar(cycles) else cycles
        whole = [
            _arguments.integer(count, "cycles") for count in _arguments.several(several, "cycles")
        ]
        counts = np.array(whole, dtype=np.int32)
        if negative_amplitudes is not None:
            one_side = _arguments.finite_vector(
                negative_amplitudes, "negative_amplitudes", shape="1 or m"
            )
            if one_side.size == 0:
                raise InputError("protocol: negative_amplitudes must not be empty")
    if counts.size == 0 or steps.size == 0:
        empty = "amplitudes" if steps.size == 0 else "cycles"
        raise InputError("protocol: amplitudes and cycles must not be empty", f"protocol.{empty}")
    repeats, points = _arguments.integer(repeats, "repeats"), _arguments.integer(points, "points")
    number = int(counts.sum()) if counts.size > 1 else int(counts[0]) * steps.size
    size = 4 * points * number * repeats + 1
    if size > np.iinfo(np.int32).max:
        raise InputError(f"protocol: {size} points are too many; reduce cycles, repeats or points")
    loading: dict[str, Any] = {"drive": "force", "source": "protocol", "amplitudes": steps}
    loading |= {"negative_amplitudes": one_side, "cycles": counts}
    loading |= {"repeats": repeats, "points": points}
    return _core.evaluate("protocol", _core.group("loading", loading)).values


def _positive(value: float | None, name: str) -> float:
    """Return a number above zero, `UNSET` if there is none."""
    return _core.UNSET if value is None else _arguments.number(value, f"protocol: {name}", above=0)
