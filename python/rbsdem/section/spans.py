"""The shear spans M/V for which the shear springs of the members of a frame are made.

Where the members of a frame yield, their ends have their plastic moments; with the dead load these
give the shear force there, and M/V. Each end has two: towards the side on which its y > 0 is in
tension, and towards the other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

#: Least M/V over the clear length, of ends of columns that have little moment.
_LEAST = 0.25

Pair = tuple[float, float]


def beam_spans(start: Pair, end: Pair, length: float, load: float = 0.0) -> tuple[Pair, Pair]:
    """Return M/V of both ends of a member whose ends yield, with y > 0 in tension and below [m].

    The frame sways to either side: one end hogs with M-, the other sags with M+, and the shear at
    the one that hogs is (M- + M+)/L + w L/2. Under a large load the hinge that sags is in the span.
    Where the load takes nearly all of the shear of the end that sags, M/V of this end is limited to
    half of the length, or to M/V without the load if that is more.

    Parameters
    ----------
    start, end : tuple of float
        Plastic moments of an end with y > 0 in tension, and in compression [N m].
    length : float
        Clear length L [m].
    load : float, optional
        Load w across it, toward y < 0 [N/m].
    """
    spans = []
    for (hogs, sags), (other_hogs, other_sags) in ((start, end), (end, start)):
        falls = length
        if load > 0.0:
            falls = min(length, math.sqrt(2.0 * (hogs + other_sags) / load))
        down = (hogs + other_sags) / falls + 0.5 * load * falls
        up = (sags + other_hogs) / length - 0.5 * load * length
        without = sags / (sags + other_hogs) * length
        against = min(sags / up if up > 0.0 else math.inf, max(without, 0.5 * length))
        spans.append((hogs / down, against))
    return spans[0], spans[1]


def line_spans(
    base: float,
    plastic: Sequence[tuple[float, float]],
    nodes: Sequence[float],
    heights: Sequence[float],
    clear: Sequence[float],
    pattern: Sequence[float],
) -> list[Pair]:
    """Return M/V at the foot and at the head of each storey of a line of columns [m].

    The beams yield into every node, and the column at its foot. Where no other section of it then
    reaches its plastic moment, as in a wall, its moments are those of statics under a lateral load
    of the pattern. Else each node shares the moment of its beams among the columns below and above,
    up to what these carry.

    Parameters
    ----------
    base : float
        Moment of the foot of the lowest storey [N m], zero on a hinge.
    plastic : sequence of (float, float)
        Plastic moments of foot and head of each storey [N m].
    nodes : sequence of float
        Moments that the yielding beams have on the node above each storey [N m].
    heights, clear : sequence of float
        Storey heights and clear lengths of the columns [m].
    pattern : sequence of float
        Lateral load of each floor, in any scale.
    """
    levels = [sum(heights[: i + 1]) for i in range(len(heights))]
    lever = sum(p * z for p, z in zip(pattern, levels, strict=True))
    total = (base + sum(nodes)) / lever
    foot, moments = base, []
    for i, height in enumerate(heights):
        shear = total * sum(pattern[i:])
        # The rigid ends have part of the storey; at the base they are none.
        below = 0.5 * (height - clear[i]) if i else 0.0
        head = foot - shear * height
        moments.append((foot - shear * below, head + shear * (height - clear[i] - below), shear))
        foot = head + nodes[i]
    if all(
        abs(high) <= top and (not i or abs(low) <= bottom)
        for i, ((low, high, _), (bottom, top)) in enumerate(zip(moments, plastic, strict=True))
    ):
        return [
            (max(abs(low / shear), _LEAST * each), max(abs(high / shear), _LEAST * each))
            for (low, high, shear), each in zip(moments, clear, strict=True)
        ]
    spans = []
    for i, (bottom, top) in enumerate(plastic):
        last = i + 1 == len(plastic)
        above = 0.0 if last else plastic[i + 1][0]
        low = min(base if not i else nodes[i - 1] * bottom / (bottom + plastic[i - 1][1]), bottom)
        high = min(nodes[i] * top / (top + above), top)
        whole = max(low + high, 1e-9 * (bottom + top))
        shares = (max(each / whole, _LEAST) for each in (low, high))
        first, second = (clear[i] * share for share in shares)
        spans.append((first, second))
    return spans
