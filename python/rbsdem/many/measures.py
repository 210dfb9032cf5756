"""The measures of a run, its fates, and limit states as a measure and a threshold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, TypeAlias

from rbsdem import _arguments, _core
from rbsdem.checks.criteria import WATCHED
from rbsdem.errors import InputError
from rbsdem.results.result import Result

#: A measure of the user: a function of the `Result` of a run.
Measure: TypeAlias = Callable[[Result], float]

#: The fates of a run, in the order of their numbers in the Fortran part; "" is a run that was not
#: started because the ensemble was broken off.
STATUSES: tuple[str, ...] = ("", "completed", "collapsed", "axial_failure", "failed")

#: What each measure is; "drift" is a displacement of the top over the height.
MEASURES = {
    "peak_drift": "largest drift in size",
    "residual_drift": "drift at the end of the record, in size",
    "peak_displacement": "largest displacement of the top, with its sign [m]",
    "residual_displacement": "displacement of the top at the end [m]",
    "peak_base_shear": "largest shear force at the base, with its sign [N]",
    "peak_rotation": "largest absolute rotation of a body, in size [rad]",
    "input_energy": "work of the ground motion [J]",
    "spring_energy": "energy of the springs at the end, stored and dissipated [J]",
    "damping_energy": "energy of the damping [J]",
    "energy_residual": "largest error of the energy balance [J]",
    "relative_energy_residual": "the same over the largest energy",
    "first_yield": "time at which a bar or a flexural spring first yields [s]; NaN: none does",
    "end_time": "time at which the run ended [s]",
    "time_step": "step [s]",
    "steps": "number of steps",
    "events": "how often a spring left its line",
    "cut_steps": "steps cut at an event, for accuracy, or because they did not converge",
    "lost_joint": "number of the joint that lost its axial load, as in a `Result`; NaN: none did",
}

#: Limit states that are measures too if they are asked for: the time at which each is first reached
#: [s], NaN if it is not; see `rbsdem.Result.limit_states`.
LIMIT_STATES = {name: what for name, what in WATCHED.items() if name != "first_yield"}

#: Measures that are whole numbers.
COUNTS = ("steps", "events", "cut_steps")


@cache
def core_measures() -> tuple[str, ...]:
    """Return the names of the measures that the Fortran part returns, in its order."""
    return _core.measures()


def limit_states_among(names: Sequence[str]) -> tuple[str, ...]:
    """Return the limit states among names, but the first yield, which is kept anyway."""
    return tuple(name for name in LIMIT_STATES if name in names)


def measures_in_a_list(measures: Any) -> list[Any]:
    """Return measures, of which one may stand alone, as a list."""
    if isinstance(measures, str) or callable(measures):
        return [measures]
    return _arguments.several(measures, "measures", "names and functions")


def checked_measures(
    measures: Sequence[str | Measure] | None,
) -> tuple[tuple[str, ...], dict[str, Measure]]:
    """Return the names of the measures that are kept, and the functions by their names.

    Raises
    ------
    InputError
        For a name that is not known, and for functions without a name of their own.
    """
    if measures is None:
        return tuple(MEASURES), {}
    measures = measures_in_a_list(measures)
    names: list[str] = []
    functions: dict[str, Measure] = {}
    for measure in measures:
        name: Any = measure if isinstance(measure, str) else getattr(measure, "__name__", None)
        if isinstance(measure, str):
            if measure not in MEASURES and measure not in LIMIT_STATES:
                raise InputError(
                    f"measures: {measure!r} is not known; it is one of {', '.join(MEASURES)}, a "
                    f"limit state ({', '.join(LIMIT_STATES)}), or a function of a Result"
                )
            names.append(name)
        elif callable(measure) and isinstance(name, str) and name.isidentifier():
            if name in functions or name in MEASURES or name in LIMIT_STATES:
                raise InputError(f"measures: two are called {name!r}; give one another name")
            functions[name] = measure
        else:
            raise InputError(
                f"measures: {_arguments.shown(measure)} is neither the name of a measure nor a "
                "function with a name of its own"
            )
    return tuple(dict.fromkeys(names)), functions


#: Measures that are 0 or 1, and the threshold that tells the two apart.
_SWITCHES = dict.fromkeys(("collapse", *WATCHED), 1.0)


def is_switch(edp: str) -> bool:
    """Return whether a measure says only whether something has happened, not how far it went."""
    return edp in _SWITCHES


def limit_states(edp: str, threshold: Any) -> dict[str, tuple[str, float]]:
    """Return measure and threshold of each limit state.

    Parameters
    ----------
    edp : str
        The measure.
    threshold : float, mapping or None
        One value, or values by the name of the limit state, each a number for this measure or a
        pair of a measure and a number. None for "collapse" and the limit states of
        `rbsdem.Result.limit_states`.
    """
    if isinstance(threshold, Mapping):
        if not threshold:
            raise InputError("threshold is empty; give at least one limit state")
        found = {}
        for name, value in threshold.items():
            pair = value if isinstance(value, tuple) and len(value) == 2 else (edp, value)
            found[str(name)] = _one(str(pair[0]), pair[1])
        return found
    one = _one(edp, threshold)
    return {edp if threshold is None else f"{edp} {one[1]:g}": one}


def _one(edp: str, threshold: Any) -> tuple[str, float]:
    if edp in _SWITCHES:
        if threshold is not None:
            raise InputError(f"threshold: {edp} has none; leave it out")
        return edp, _SWITCHES[edp]
    if threshold is None:
        raise InputError(f"threshold is missing; give the value of {edp} that is the limit state")
    value = _arguments.number(threshold, f"threshold of {edp}")
    if not value > 0:
        raise InputError(f"threshold of {edp} = {value:g} must be above 0")
    return edp, value
