"""Names of the parameters in a column, such as ``flexure.k_y`` or ``flexure[0].d_y``.

In a frame they begin with a kind of members, as ``kind-1.yield_moment``. Only parameters on which a
static path depends have a name. Where there are several springs, ``flexure[*].k_y`` is a factor on
all of them, and ``flexure.layers[*].f_y`` a factor on all layers of a joint that have an ``f_y``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from typing import Any

from rbsdem import _arguments, _core
from rbsdem.errors import InputError
from rbsdem.model.column import Column, Parameter
from rbsdem.model.springs import Spring
from rbsdem.section.frame import Frame, Structure, checked_structure

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
#: Largest number of names in a message.
_MANY = 30


@dataclass(frozen=True)
class _Place:
    """A parameter of a structure: its name and value, the key of its rule, and the name of that.

    A factor has no key, and the value 1.
    """

    name: str
    value: float
    key_name: str = ""
    key: Mapping[str, Any] = field(default_factory=dict)

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest value that the key takes."""
        least, most = self.key.get("least"), self.key.get("most")
        return -math.inf if least is None else least, math.inf if most is None else most

    @property
    def unit(self) -> str:
        """Unit of the value; empty for a factor. Layers of a joint are normal springs."""
        unit = str(self.key.get("unit") or "")
        group = next((_UNITS[word] for word in _UNITS if word in self.name), {})
        return (_NORMAL if ".layers[" in self.name else group).get(unit, unit)

    def parameter(self) -> Parameter | None:
        """Return the parameter with its default bounds; None if they must be given."""
        low, high = sorted((self.value / REACH, self.value * REACH))
        if self.key_name in LIMITS:
            low, high = LIMITS[self.key_name]
            low, high = min(low, self.value), max(high, self.value)
        elif self.value == 0:
            return None
        elif self.name in _PLAIN:
            low, high = sorted((self.value * (1 - MEASURED), self.value * (1 + MEASURED)))
        elif self.key_name in AFTER_YIELD:
            low, high = sorted((0.0, self.value * REACH))
        ends = max(low, self.ends[0]), min(high, self.ends[1])
        return Parameter(self.value, *ends, self.unit, self.name)


class Parameters:
    """The parameters of one structure: those that it offers, or otherwise the paths in it."""

    def __init__(self, structure: Structure) -> None:
        self.offered = isinstance(getattr(structure, "parameters", None), Mapping)
        if not self.offered:
            checked_structure(structure, "calibrate: ")
        self.structure: Any = structure  # with `parameters`, if it offers them
        self._places = {} if self.offered else _places(structure)

    def known(self) -> dict[str, Parameter | None]:
        """Return all parameters by name; None for those whose bounds must be given."""
        if self.offered:
            return dict(self.structure.parameters)
        return {name: place.parameter() for name, place in self._places.items()}

    def build(self, values: Mapping[str, float]) -> Structure:
        """Return the structure with other values, or raise `InputError` if it is refused."""
        if self.offered:
            changed: Structure = self.structure.with_parameters(**values)
            return changed
        return with_values(self.structure, values)

    def free(
        self, free: Sequence[str], bounds: Mapping[str, Sequence[float]] | None
    ) -> dict[str, Parameter]:
        """Return the parameters to fit, in the order of `free`, with their bounds.

        Raises
        ------
        InputError
            If names are unknown or repeated, or bounds are wrong.
        """
        known = self.known()
        names = _names(list(known), free)
        if not isinstance(bounds, Mapping | None):
            raise InputError(
                f"calibrate: bounds = {bounds!r} must be a mapping of name to (low, high)"
            )
        for name in bounds or {}:
            if name not in names:
                raise InputError(f"calibrate: bounds: {name!r} is not in free ({', '.join(names)})")
        chosen = {}
        for name in names:
            parameter = known[name]
            if bounds and name in bounds:
                parameter = self._within(name, parameter, bounds[name])
            if parameter is None:
                raise InputError(
                    f"calibrate: {name} = {self._places[name].value:g} has no default bounds; give "
                    f"bounds={{{name!r}: (low, high)}}"
                )
            chosen[name] = parameter
        return chosen

    def _within(self, name: str, parameter: Parameter | None, pair: Any) -> Parameter:
        """Return a parameter with bounds that a user gives."""
        about = f"calibrate: bounds of {name}"
        try:
            low, high = pair
        except (TypeError, ValueError):
            raise InputError(f"{about} = {pair!r} must be (low, high)") from None
        low, high = (_arguments.number(end, about) for end in (low, high))
        start = parameter.value if parameter else self._places[name].value
        if low < high and not low <= start <= high:
            raise InputError(
                f"{about}: {low:g} to {high:g} leave out the start {start:g}; move the bounds, or "
                "start from another column"
            )
        if not self.offered:
            least, most = self._places[name].ends
            if low < least or high > most:
                side = f"below {least:g}" if low < least else f"above {most:g}"
                raise InputError(
                    f"{about}: {low:g} to {high:g} go {side}, which the column refuses; move the "
                    "bound"
                )
        try:
            if parameter is None:
                return Parameter(start, low, high, self._places[name].unit, name)
            return replace(parameter, low=low, high=high)
        except InputError as error:
            raise InputError(f"{about}: {error}") from None


def _names(known: list[str], free: Any) -> list[str]:
    """Return the names of the parameters to fit, if the column has them."""
    if isinstance(free, str) or not isinstance(free, Sequence | Mapping | set):
        raise InputError(f"calibrate: free = {free!r} must be a list of names")
    names, more = list(free), len(known) - _MANY
    told = ", ".join(known[:_MANY])
    if more > 0:
        told += f" and {more} more (rbsdem.calibration.free_names lists them)"
    if not names:
        raise InputError(f"calibrate: free is empty; it names {told}")
    for name in names:
        if name not in known:
            near = get_close_matches(str(name), known, n=1, cutoff=0.0)
            if not near:
                raise InputError(f"calibrate: free: {name!r}: this column has no parameters to fit")
            raise InputError(
                f"calibrate: free: {name!r} is not a parameter of this column; did you mean "
                f"{near[0]!r}? It has {told}"
            )
        if names.count(name) > 1:
            raise InputError(f"calibrate: free: {name!r} comes twice")
    return names


def _places(structure: Structure) -> dict[str, _Place]:
    """Return all parameters that the static path of a structure may depend on, by name."""
    frame = isinstance(structure, Frame)
    leaves = _of_frame(structure) if isinstance(structure, Frame) else _of_column(structure)
    places: dict[str, _Place] = {}
    for names, rule, key_name, value in leaves:
        key = _keys_of(rule, "member_kind" if frame else "column").get(key_name, {})
        for name in names:
            place = _Place(name, 1.0) if "*" in name else _Place(name, value, key_name, key)
            places.setdefault(name, place)
    return places


#: Names of a number: its own, and those of factors on it; its rule; the name of its field; value.
_Leaf = tuple[list[str], str, str, float]


def _of_frame(frame: Frame) -> Iterator[_Leaf]:
    """Yield the numbers of the kinds of members that may be fitted."""
    for kind_name, kind in frame.named_kinds.items():
        for names, rule, key_name, value in _leaves(kind, [kind_name]):
            # The strips and bars of a drawn member change together.
            single = re.compile(r"\.layers\[\d") if kind.sections else None
            known = [name for name in names if not (single and single.search(name))]
            field_of_kind = re.split(r"[.\[]", names[0].removeprefix(f"{kind_name}."))[0]
            if known and field_of_kind not in _OF_LAYOUT:
                yield known, rule, key_name, value


def _of_column(column: Column) -> Iterator[_Leaf]:
    """Yield height, axial load and the numbers of the springs of a column."""
    yield from (([name], "", name, getattr(column, name)) for name in _PLAIN)
    for kind in _UNITS:
        springs, joints = getattr(column, kind), column.joint_numbers[-1]
        yield from _leaves(springs, [kind])
        if isinstance(springs, Spring) and joints > 1:
            # Joints with the same spring may get different ones.
            yield from _leaves((springs,) * joints, [kind])


def _leaves(part: Any, names: list[str], rule: str = "", key_name: str = "") -> Iterator[_Leaf]:
    """Yield the numbers in a spring, in several, or in what has springs."""
    if isinstance(part, tuple):
        for place, item in enumerate(part):
            if is_dataclass(_spring(item)):
                yield from _leaves(_spring(item), _of_item(names, place), rule)
    elif is_dataclass(part):
        rule = getattr(part, "rule", rule)
        for each in fields(part):
            if each.init:
                below = [f"{name}.{each.name}" for name in names]
                yield from _leaves(getattr(part, each.name), below, rule, each.name)
    elif isinstance(part, float):
        yield names, rule, key_name, part


def _spring(item: Any) -> Any:
    """Return the spring of an item, which for a layer follows its distance."""
    return item[-1] if isinstance(item, tuple) else item


def _of_item(names: list[str], place: int) -> list[str]:
    """Return the names of an item of a sequence: by its place, and by * for all of them."""
    return [f"{name}[{index}]" for index in (place, "*") for name in names]


@cache
def _keys_of(rule: str, group: str) -> dict[str, dict[str, Any]]:
    """Return the keys of a rule by name; without a rule those of a group."""
    known = _core.keys()
    keys = known["rules"][rule]["keys"] if rule else known["groups"][group]
    return {key["name"]: key for key in keys}


def with_values(structure: Structure, values: Mapping[str, float]) -> Structure:
    """Return the structure with other parameters, or raise `InputError` if it refuses them.

    Springs check their parameters together, so all parameters of one spring change at once.
    """
    if isinstance(structure, Frame):
        kinds = structure.named_kinds.items()
        changed = {name: _changed(kind, [name], values) for name, kind in kinds}
        return structure.with_kinds({name: changed[name] for name, kind in kinds
                                     if changed[name] is not kind})  # fmt: skip
    parts: dict[str, Any] = {name: values[name] for name in _PLAIN if name in values}
    for kind in _UNITS:
        part = getattr(structure, kind)
        if isinstance(part, Spring) and any(name.startswith(f"{kind}[") for name in values):
            part = (_changed(part, [kind], values),) * structure.joint_numbers[-1]
        if part is not None:
            parts[kind] = _changed(part, [kind], values)
    return replace(structure, **parts)


def _changed(part: Any, names: list[str], values: Mapping[str, float]) -> Any:
    """Return a spring, or several, with other parameters; itself if nothing changes."""
    if isinstance(part, tuple):
        items = [(item, _changed(_spring(item), _of_item(names, place), values))
                 for place, item in enumerate(part)]  # fmt: skip
        if all(spring is _spring(item) for item, spring in items):
            return part
        return tuple(
            (*item[:-1], spring) if isinstance(item, tuple) else spring for item, spring in items
        )
    if is_dataclass(part) and not isinstance(part, type):
        changes = {}
        for each in fields(part):
            old = getattr(part, each.name) if each.init else None
            new = _changed(old, [f"{name}.{each.name}" for name in names], values)
            if new is not old:
                changes[each.name] = new
        return replace(part, **changes) if changes else part
    if not isinstance(part, float) or not any(name in values for name in names):
        return part
    return values.get(names[0], part) * math.prod(values.get(name, 1.0) for name in names[1:])
