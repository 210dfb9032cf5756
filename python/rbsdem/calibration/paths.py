"""Names of the parameters in a column, such as ``flexure.k_y`` or ``flexure[0].d_y``.

In a frame they begin with a kind of members, as ``kind-1.yield_moment``. A name is the path to a
parameter through frozen dataclasses. Only parameters on which a static path depends have one. Where
there are several springs, ``flexure[*].k_y`` is a factor on all of them, and
``flexure.layers[*].f_y`` a factor on all layers of a joint that have an ``f_y``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from itertools import pairwise
from typing import Any

from rbsdem import _arguments, _core
from rbsdem.errors import InputError
from rbsdem.model.column import Column, Parameter
from rbsdem.model.frame import Frame, Structure, checked_structure
from rbsdem.model.springs import Spring

#: Parameters of springs are searched within this factor, unless their rule sets other bounds.
REACH = 5.0

#: Lengths and loads were measured: they are searched within this share.
MEASURED = 0.2

#: Names with a range of their own, within the bounds of their keys. Exponents of unloading
#: stiffness are reported from 0 (none) to 0.5, the ratio B_1 from 0.1 to 1 (paper, table 3; Otani
#: 1981), the exponent of deterioration from 1 to 2 (Ibarra, Medina, Krawinkler 2005).
LIMITS = {"b0": (0.0, 1.0), "c": (1.0, 2.0)}
LIMITS |= dict.fromkeys(("b1", "kappa_f", "kappa_d"), (0.02, 1.0))

#: Stiffnesses after yield, which may be zero.
AFTER_YIELD = ("k_u", "k_post")

_PLAIN = ("height", "axial_load")
#: What a kind of members has that is no parameter of its own.
_OF_LAYOUT = ("rigid_end", "length", "sections", "failure_drift", "failure_load", "shear_drift")
#: Units of the quantities that the keys of springs name.
_NORMAL = {"stiffness": "N/m", "deformation": "m", "force": "N"}
_TURNING = {"stiffness": "N m/rad", "deformation": "rad", "force": "N m"}
_UNITS = {"shear": _NORMAL, "flexure": _TURNING, "axial_spring": _NORMAL}

#: The path to a parameter: names of fields and indices of tuples; ``None`` stands for all indices.
ParameterPath = tuple[str | int | None, ...]


def paths(column: Structure) -> dict[str, ParameterPath]:
    """Return the names of all parameters of a structure that its static path may depend on."""
    if isinstance(column, Frame):
        return {
            f"{name}{rest}": (name, *path)
            for name, kind in column.named_kinds.items()
            for rest, path in _below(kind)
            if path[0] not in _OF_LAYOUT and not (kind.sections and _is_one_layer(path))
        }
    found: dict[str, ParameterPath] = {name: (name,) for name in _PLAIN}
    for kind in _UNITS:
        springs = getattr(column, kind)
        if springs is not None:
            found |= {f"{kind}{name}": (kind, *path) for name, path in _below(springs)}
        joints = column.joint_numbers[-1]
        if isinstance(springs, Spring) and joints > 1:
            # Joints with the same spring may get different ones.
            several = (springs,) * joints
            found |= {f"{kind}{name}": (kind, *path) for name, path in _below(several)}
    return found


def _is_one_layer(path: ParameterPath) -> bool:
    """Return whether a path leads to a single layer: a strip or a bar of a drawn member."""
    return any(step == "layers" and below is not None for step, below in pairwise(path))


def parameter(column: Structure, name: str, path: ParameterPath) -> Parameter | None:
    """Return the parameter at a path with its default bounds; None if they must be given."""
    value = value_at(column, path)
    bounds = default_bounds("" if None in path else str(path[-1]), value, len(path) == 1)
    if bounds is None:
        return None
    least, most = key_bounds(column, path)
    return Parameter(
        value, max(bounds[0], least), min(bounds[1], most), unit_of(column, path), name
    )


def unit_of(column: Structure, path: ParameterPath) -> str:
    """Return the unit of the parameter at a path; empty for a factor."""
    unit = str(_key(column, path).get("unit") or "")
    # Layers of a joint are normal springs.
    group = next((_UNITS[str(step)] for step in path if step in _UNITS), {})
    return (_NORMAL if "layers" in path else group).get(unit, unit)


def key_bounds(column: Structure, path: ParameterPath) -> tuple[float, float]:
    """Return the least and the largest value that the key of a parameter takes."""
    key = _key(column, path)
    least, most = key.get("least"), key.get("most")
    return (-math.inf if least is None else float(least), math.inf if most is None else float(most))


def _key(column: Structure, path: ParameterPath) -> dict[str, Any]:
    """Return the key of the parameter at a path, as `rbsdem keys` has it; empty for a factor."""
    if None in path:
        return {}
    rule = ""
    for place in range(1, len(path)):
        rule = getattr(_get(column, path[:place]), "rule", rule)
    group = "member_kind" if isinstance(column, Frame) else "column"
    return _keys_of(rule, group).get(str(path[-1]), {})


@cache
def _keys_of(rule: str, group: str) -> dict[str, dict[str, Any]]:
    """Return the keys of a rule by name; without a rule those of a group."""
    known = _core.keys()
    keys = known["rules"][rule]["keys"] if rule else known["groups"][group]
    return {key["name"]: key for key in keys}


def default_bounds(name: str, value: float, measured: bool) -> tuple[float, float] | None:
    """Return the range in which a parameter is searched; None if it must be given."""
    if name in LIMITS:
        low, high = LIMITS[name]
        return min(low, value), max(high, value)
    if value == 0:
        return None
    if measured:
        ends = value * (1 - MEASURED), value * (1 + MEASURED)
    else:
        ends = 0.0 if name in AFTER_YIELD else value / REACH, value * REACH
    return min(ends), max(ends)


def value_at(column: Structure, path: ParameterPath) -> float:
    """Return the parameter at a path; 1 for a factor on several."""
    return 1.0 if None in path else _get(column, path)


def with_values(
    column: Structure, paths: Mapping[str, ParameterPath], values: Mapping[str, float]
) -> Structure:
    """Return the structure with other parameters at some paths.

    Raises
    ------
    InputError
        If it refuses them.
    """
    # Springs check their parameters together, so all parameters of one spring change at once.
    changes: dict[str, dict[ParameterPath, float]] = {}
    for name, value in values.items():
        path = paths[name]
        changes.setdefault(str(path[0]), {})[path[1:]] = value
    if isinstance(column, Frame):
        kinds = column.named_kinds
        return column.with_kinds(
            {name: _changed(kinds[name], own) for name, own in changes.items()}
        )
    parts: Any = {
        name: _changed_part(column, getattr(column, name), own) for name, own in changes.items()
    }
    return replace(column, **parts)


def _changed_part(column: Column, part: Any, changes: dict[ParameterPath, float]) -> Any:
    """Change a field of the column; joints get springs of their own where they differ."""
    single = {
        path: value for path, value in changes.items() if path and not isinstance(path[0], str)
    }
    if isinstance(part, Spring) and single:
        common = {path: value for path, value in changes.items() if path not in single}
        spring = _changed(part, common) if common else part
        return _changed((spring,) * column.joint_numbers[-1], single)
    return _changed(part, changes)


def _below(part: Any) -> Iterator[tuple[str, ParameterPath]]:
    """Yield names and paths of all parameters in a spring, or in several.

    They are ``.k_y`` in one spring, ``[0].k_y`` in one of several, and ``[*].k_y`` in all that have
    a k_y.
    """
    if isinstance(part, tuple):
        several = [list(_below(_spring(item))) for item in part]
        for place, parameters in enumerate(several):
            yield from ((f"[{place}]{name}", (place, *path)) for name, path in parameters)
        every = {name: path for parameters in several for name, path in parameters}
        yield from ((f"[*]{name}", (None, *path)) for name, path in every.items())
    elif is_dataclass(part):
        for field in fields(part):
            value = getattr(part, field.name) if field.init else None
            if isinstance(value, float):
                yield f".{field.name}", (field.name,)
            elif is_dataclass(value) or isinstance(value, tuple):
                yield from (
                    (f".{field.name}{name}", (field.name, *path)) for name, path in _below(value)
                )


def _spring(item: Any) -> Any:
    """Return the spring of an item, which for a layer follows its distance."""
    return item[-1] if isinstance(item, tuple) else item


def _get(part: Any, path: ParameterPath) -> Any:
    if isinstance(part, Frame):
        part, path = part.named_kinds[str(path[0])], path[1:]
    for step in path:
        if isinstance(step, int):
            # One spring for all joints is the spring of each of them.
            part = part if isinstance(part, Spring) else _spring(part[step])
        else:
            part = getattr(part, str(step), None)
    return part


def _changed(part: Any, changes: Mapping[ParameterPath, float]) -> Any:
    """Return a copy of a spring, or of several, with the parameters at some paths replaced."""
    if () in changes:
        return changes[()]
    if isinstance(part, tuple):
        return tuple(_changed_item(item, place, changes) for place, item in enumerate(part))
    steps: dict[str, dict[ParameterPath, float]] = {}
    for path, value in changes.items():
        steps.setdefault(str(path[0]), {})[path[1:]] = value
    return replace(
        part, **{step: _changed(getattr(part, step), rest) for step, rest in steps.items()}
    )


def _changed_item(item: Any, place: int, changes: Mapping[ParameterPath, float]) -> Any:
    """Change one of several springs: first its own parameters, then factors on all springs."""
    spring = _spring(item)
    own = {path[1:]: value for path, value in changes.items() if path[0] == place}
    for path, factor in changes.items():
        rest = path[1:]
        if path[0] is None and None in rest:
            own[rest] = own.get(rest, 1.0) * factor
        elif path[0] is None:
            value = own.get(rest, _get(spring, rest))
            if value is not None:
                own[rest] = value * factor
    if not own:
        return item
    changed = _changed(spring, own)
    return (*item[:-1], changed) if isinstance(item, tuple) else changed


#: Largest number of names in a message.
_MANY = 30


class Parameters:
    """The parameters of one column: those that it offers, or otherwise the paths in it."""

    def __init__(self, column: Structure) -> None:
        self.offered = isinstance(getattr(column, "parameters", None), Mapping)
        if not self.offered:
            checked_structure(column, "calibrate: ")
        self.column: Any = column  # with `parameters`, if it offers them
        self.paths = {} if self.offered else paths(column)

    @property
    def names(self) -> list[str]:
        """Names of all parameters."""
        return list(self.column.parameters) if self.offered else list(self.paths)

    def known(self) -> dict[str, Parameter | None]:
        """Return all parameters by name; None for those whose bounds must be given."""
        if self.offered:
            return dict(self.column.parameters)
        return {name: parameter(self.column, name, path) for name, path in self.paths.items()}

    def start(self, name: str) -> float:
        """Return the value of a parameter in the column."""
        if self.offered:
            return float(self.column.parameters[name].value)
        return value_at(self.column, self.paths[name])

    def build(self, values: Mapping[str, float]) -> Structure:
        """Return the structure with other values, or raise `InputError` if it is refused."""
        if self.offered:
            changed: Structure = self.column.with_parameters(**values)
            return changed
        return with_values(self.column, self.paths, values)


def free_parameters(
    parameters: Parameters, free: Sequence[str], bounds: Mapping[str, Sequence[float]] | None
) -> dict[str, Parameter]:
    """Return the parameters to fit, in the order of `free`, with their bounds.

    Raises
    ------
    InputError
        If names are unknown or repeated, or bounds are wrong.
    """
    names = _names(parameters, free)
    given = {name: _pair(name, pair) for name, pair in _mapping(bounds).items()}
    for name in given:
        if name not in names:
            raise InputError(f"calibrate: bounds: {name!r} is not in free ({', '.join(names)})")
    known = parameters.known()
    chosen = {}
    for name in names:
        one = known[name]
        if name in given:
            one = _within(parameters, name, one, given[name])
        if one is None:
            raise InputError(
                f"calibrate: {name} = {parameters.start(name):g} has no default bounds; give "
                f"bounds={{{name!r}: (low, high)}}"
            )
        chosen[name] = one
    return chosen


def _names(parameters: Parameters, free: Any) -> list[str]:
    if isinstance(free, str) or not isinstance(free, Sequence | Mapping | set):
        raise InputError(f"calibrate: free = {free!r} must be a list of names")
    names = list(free)
    if not names:
        raise InputError(f"calibrate: free is empty; it names {_list(parameters.names)}")
    for name in names:
        if name not in parameters.names:
            raise _unknown(name, parameters)
        if names.count(name) > 1:
            raise InputError(f"calibrate: free: {name!r} comes twice")
    return names


def _unknown(name: Any, parameters: Parameters) -> InputError:
    near = get_close_matches(str(name), parameters.names, n=1, cutoff=0.0)
    if not near:
        return InputError(f"calibrate: free: {name!r}: this column has no parameters to fit")
    return InputError(
        f"calibrate: free: {name!r} is not a parameter of this column; did you mean {near[0]!r}? "
        f"It has {_list(parameters.names)}"
    )


def _list(names: Sequence[str]) -> str:
    """Return the names as a text; if there are too many, only the first."""
    if len(names) <= _MANY:
        return ", ".join(names)
    first = ", ".join(names[:_MANY])
    return f"{first} and {len(names) - _MANY} more (rbsdem.calibration.free_names lists them)"


def _mapping(bounds: Any) -> Mapping[str, Sequence[float]]:
    if bounds is None:
        return {}
    if not isinstance(bounds, Mapping):
        raise InputError(f"calibrate: bounds = {bounds!r} must be a mapping of name to (low, high)")
    return bounds


def _pair(name: str, pair: Any) -> tuple[float, float]:
    try:
        low, high = pair
    except (TypeError, ValueError):
        raise InputError(f"calibrate: bounds of {name} = {pair!r} must be (low, high)") from None
    about = f"calibrate: bounds of {name}"
    return _arguments.number(low, about), _arguments.number(high, about)


def _within(
    parameters: Parameters, name: str, one: Parameter | None, pair: tuple[float, float]
) -> Parameter:
    start = parameters.start(name)
    if pair[0] < pair[1] and not pair[0] <= start <= pair[1]:
        raise InputError(
            f"calibrate: bounds of {name}: {pair[0]:g} to {pair[1]:g} leave out the start "
            f"{start:g}; move the bounds, or start from another column"
        )
    if not parameters.offered:
        least, most = key_bounds(parameters.column, parameters.paths[name])
        if pair[0] < least or pair[1] > most:
            side = f"below {least:g}" if pair[0] < least else f"above {most:g}"
            raise InputError(
                f"calibrate: bounds of {name}: {pair[0]:g} to {pair[1]:g} go {side}, which the "
                "column refuses; move the bound"
            )
    try:
        if one is None:
            unit = unit_of(parameters.column, parameters.paths[name])
            return Parameter(start, *pair, unit, name)
        return replace(one, low=pair[0], high=pair[1])
    except InputError as error:
        raise InputError(f"calibrate: bounds of {name}: {error}") from None
