"""Finding limit states in the rows of a result. They read its state and change nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rbsdem._core import Array
from rbsdem._views import view_of
from rbsdem.codes.drawing import quantities
from rbsdem.codes.regressions import goodnight_buckling_strain
from rbsdem.column import Column
from rbsdem.comparison.cycles import strength_loss_point
from rbsdem.limit_states.record import LimitState, LimitStates
from rbsdem.result import Result
from rbsdem.section.model import LayeredColumn
from rbsdem.section.section import Section
from rbsdem.springs import Layered
from rbsdem.strains import Strains

#: Name, values in each row, threshold, and its source.
Criterion = tuple[str, Array, float, str]

_LOSS = 0.2


@view_of(Result, "limit_states")
def limit_states(result: Result) -> LimitStates:
    """Return the limit states that a result reaches; see `Result.limit_states`."""
    first: dict[str, LimitState] = {}
    for name, values, threshold, source in _criteria(result):
        found = _reached(result, name, values, threshold, source)
        if found is not None and (name not in first or found.time < first[name].time):
            first[name] = found
    states = [*first.values(), *_losses(result)]
    ends = {
        "axial_failure": ("axial_failure", "the layers lose the axial load"),
        "collapsed": ("collapse", "collapse_drift"),
    }
    if result.summary["status"] in ends:
        name, source = ends[result.summary["status"]]
        states.append(_state(result, name, result.time.size - 1, 1.0, math.nan, source))
    return LimitStates(result, states)


def _criteria(result: Result) -> Iterator[Criterion]:
    """Yield what is watched: strains of a hinge that knows its drawing, lines of springs."""
    column = result.column
    if isinstance(column, LayeredColumn) and column.recipe is not None:
        yield from _of_strains(column.recipe.section, result)
    for joint, spring in enumerate(column.joints("flexure")):
        if isinstance(spring, Layered):
            continue
        turned = result.rotation[:, joint]
        kind = type(spring).__name__
        for name, key in (("cracking", "d_c"), ("first_yield", "d_y"), ("cap", "d_cap")):
            at = getattr(spring, key, None)
            if at is not None and math.isfinite(at):
                source = f"{key} of the {kind} spring of joint {joint + 1}"
                yield from ((name, side * turned, at, source) for side in (1, -1))
    for joint, spring in enumerate(column.joints("shear")):
        slipped = result.slip[:, joint]
        kind = type(spring).__name__
        for name, key in (("shear_yield", "d_y"), ("shear_failure", "d_cap")):
            at = getattr(spring, key, None)
            if at is not None and math.isfinite(at):
                source = f"{key} of the {kind} shear spring of joint {joint + 1}"
                yield from ((name, side * slipped, at, source) for side in (1, -1))


def _of_strains(section: Section, result: Result) -> Iterator[Criterion]:
    strains = result.strains(1)
    law, depth = section.concrete_law, section.depth
    for side in (-1, 1):
        fibre = _fibre(strains, side * 0.5 * depth)
        source = "f_t/E_c at the extreme fibre, over the length of the hinge"
        yield "cracking", fibre, law["ft"] / law["ec"], source
        source = "0.003 at the extreme fibre (ACI 318-19, 22.2.2.1)"
        yield "nominal_moment", -fibre, 0.003, source
        yield "spalling", -fibre, section.concrete.eps_spall, "eps_spall of the concrete"
    bars = strains.of("bar")
    places = strains.position[strains.part == "bar"]
    steels = [min(section.bars, key=lambda bar, y=y: abs(bar[0] - y))[2] for y in places]
    yields = np.array([steel.fy / steel.es for steel in steels])
    breaks = np.array([steel.eps_u for steel in steels])
    yield (
        "first_yield",
        (bars / yields).max(axis=1) * yields[0],
        float(yields[0]),
        "f_y/E_s of a bar in tension",
    )
    yield (
        "bar_fracture",
        (bars / breaks).max(axis=1) * breaks[0],
        float(breaks[0]),
        "eps_u of a bar in tension",
    )
    core = section.confinement
    if core is None:
        return
    source = "eps_cu at the edge of the core (Priestley, Seible, Calvi 1996, eq 5.14)"
    for side in (-1, 1):
        edge = _fibre(strains, side * 0.5 * core.depth)
        yield "hoop_fracture", -edge, core.eps_cu, source
    source = "tensile strain before bars buckle on reversal (Goodnight, Kowalsky, Nau 2016)"
    yield "bar_buckling", bars.max(axis=1), buckling_strain(section, result.column), source


def buckling_strain(section: Section, column: Column) -> float:
    """Return the tensile strain beyond which bars buckle on reversal; infinite if not known.

    It is known of solid sections with hoops.
    """
    if section.hollow or section.ties is None:
        return math.inf
    given = quantities(section, column.height, column.axial_load)
    return max(goodnight_buckling_strain(given), 0.01)


def _fibre(strains: Strains, y: float) -> Array:
    """Return the strain of the concrete at a place in each row, elongation positive."""
    concrete = np.flatnonzero(strains.part != "bar")
    first = concrete[np.argmin(strains.position[concrete])]
    last = concrete[np.argmax(strains.position[concrete])]
    low, high = strains.position[first], strains.position[last]
    opened = strains.value[:, [first, last]] * strains.length[[first, last]]
    share = (y - low) / (high - low)
    plane = (1.0 - share) * opened[:, 0] + share * opened[:, 1]
    return np.asarray(plane / strains.length[first])


def _reached(
    result: Result, name: str, values: Array, threshold: float, source: str
) -> LimitState | None:
    rows = np.flatnonzero(values >= threshold)
    if rows.size == 0:
        return None
    row = int(rows[0])
    share = 1.0
    if row > 0 and values[row] > values[row - 1]:
        share = float((threshold - values[row - 1]) / (values[row] - values[row - 1]))
    return _state(result, name, row, share, threshold, source)


def _losses(result: Result) -> list[LimitState]:
    """Return where a fifth of the strength of a side is lost first, as the comparison has it."""
    force = result.base_shear if result.dynamic else result.force
    row, loss = strength_loss_point(result.displacement, force, share=_LOSS)
    if row is None:
        return []
    source = "20 % of the largest force of a side, on its envelope"
    state = _state(result, "strength_loss", row, 1.0, _LOSS, source)
    # Interpolated on the envelope.
    at = math.copysign(loss, state.displacement)
    return [replace(state, displacement=at, drift=at / result.column.height)]


def _state(
    result: Result, name: str, row: int, share: float, threshold: float, source: str
) -> LimitState:
    before = max(row - 1, 0)

    def at(values: Array) -> float:
        return float((1.0 - share) * values[before] + share * values[row])

    displacement = at(result.displacement)
    return LimitState(
        name,
        row,
        at(result.time),
        displacement,
        displacement / result.column.height,
        threshold,
        source,
    )
