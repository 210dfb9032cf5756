"""Objects made of the groups of a case file: sections, models, springs of a column, frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem.errors import InputError, warn
from rbsdem.model.column import SPRING_GROUPS, Column, Damping, notes_off
from rbsdem.model.frame import FrameMember, FrameNode, Member, places_of, with_rigid_end
from rbsdem.model.materials import Bars, Concrete, Lap, Layout, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection, Section, TeeSection
from rbsdem.model.springs import SPRINGS, Gauge, Layered, Spring
from rbsdem.model.wall import Boundary, Curtain, Hoops, WallSection
from rbsdem.section.columns import column
from rbsdem.section.frame import Frame, FrameInPlan
from rbsdem.section.grid import is_drawn
from rbsdem.section.infill import Infill
from rbsdem.section.layered import LayeredColumn, LayeredModel
from rbsdem.section.parameters import VERSION, ModelParameters, parameters
from rbsdem.section.plan import Building

Groups = Mapping[str, list[dict[str, Any]]]
"""The groups of a case file with their values by name; those of one name in their order."""

#: The classes of the shapes.
SHAPES: dict[str, type[Section]] = {
    "rectangle": RectangularSection,
    "circle": CircularSection,
    "hollow_rectangle": RectangularSection,
    "hollow_circle": CircularSection,
    "tee": TeeSection,
    "wall": WallSection,
}

#: Keys of a frame that is drawn, and of its floors.
_DRAWN = ("ends", "panel_hoops", "live_share", "self_weight", "mass", "wall_spans")
_OF_FLOORS = ("dead_load", "live_load", "mass")
#: Keys of a column that is drawn which are arguments of `rbsdem.section.column`.
_OF_DRAWN = ("mass", "n", "axial_height", "top", "footing")
#: Keys of a spring that are no parameters of its rule: the rule itself, and where it stands.
_NO_KEYS = ("rule", "joint", "kind", "node", "panel", "position", "id")
#: Classes of the groups that refer to steels.
_PARTS: dict[str, type] = {
    "layout": Layout, "inner_layout": Layout, "ties": Ties, "spiral": Spiral, "lap": Lap
}  # fmt: skip


def layered_column(drawing: LayeredModel, keywords: Mapping[str, Any]) -> Column:
    """Return the column of a case that has its drawing.

    Parameters
    ----------
    drawing : LayeredModel
        The drawing.
    keywords : mapping
        The arguments of `rbsdem.Column` that the case gives, with its springs.

    Returns
    -------
    Column
        A `LayeredColumn` with the springs of the case; a plain column where these were drawn for
        another axial load than that of the case.

    Warns
    -----
    AccuracyWarning
        Where they are not those that the model draws.
    """
    made = LayeredColumn(**keywords, drawing=drawing)
    if made.drawing != drawing:
        warn(
            f"the springs of the case were drawn for axial_load = {drawing.axial_load:g} N, and "
            f"its column has {made.axial_load:g} N; it is solved with its own springs, and "
            "nothing is known of bars and concrete. To draw it again, make the column of its "
            "section",
        )
        return Column(**keywords)
    other = made.replaced
    if other:
        warn(
            f"the case has {' and '.join(other)} other than layered {drawing.parameters.label} "
            "draws from its section; it is solved with its own springs, and what bars and concrete "
            "undergo is known only for a hinge that is as drawn. To draw the springs anew, make "
            "the column of case.column.drawing.section",
        )
    return made


def drawing_of(groups: Groups) -> LayeredModel:
    """Return the drawing of a case.

    Parameters
    ----------
    groups : mapping
        The groups of the case, which are those of a drawing or others.

    Raises
    ------
    InputError
        If a value is refused, or the program does not know the version.
    """
    drawing = _one(groups, "drawing")
    changes = {parameter["name"]: parameter["value"] for parameter in groups.get("parameter", [])}
    made = _parameters(drawing.pop("version"), changes)
    return LayeredModel(section=section_of(groups), parameters=made, **drawing)


def drawn_column(groups: Groups, keywords: Mapping[str, Any]) -> Column:
    """Return the column of a case that has its section, and no springs but those of a footing.

    It has second-order effects, as `rbsdem.section.column` makes it.

    Parameters
    ----------
    groups : mapping
        The groups of the case.
    keywords : mapping
        The arguments of `rbsdem.Column` that the case gives.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    for name in ("lengths", "model"):
        if name in keywords:
            raise InputError(f"column: {name} is of columns with springs; remove it, or give them")
    about = _one(groups, "drawing")
    about.pop("name", None)
    changes = {parameter["name"]: parameter["value"] for parameter in groups.get("parameter", [])}
    about["model_parameters"] = _parameters(about.pop("version"), changes)
    rest = {name: value for name, value in keywords.items() if value is not None}
    about |= {name: rest.pop(name) for name in _OF_DRAWN if name in rest}
    if "n" in about and about.get("top") == "fixed":
        # Bodies of each half, which share the one in the middle
        about["n"] = (about["n"] + 1) // 2
    if rest.get("kinematics") == "small":
        del rest["kinematics"]
    height, load = rest.pop("height", None), rest.pop("axial_load", 0.0)
    made: Column = column(section_of(groups), height, axial_load=load, **about)
    return replace(made, **rest)


def _parameters(version: str, changes: dict[str, float]) -> ModelParameters:
    """Return the parameters of a version; of another version than this one `changes` has all."""
    made = parameters().with_values(**changes)
    if version != VERSION and set(made.values) - set(changes):
        raise InputError(
            f"drawing: version = {version!r} is not known; this program has {VERSION}, and takes "
            "another one with all of its parameters"
        )
    return replace(made, version=version)


def section_of(groups: Groups) -> Section:
    """Return the section of the groups of one drawing."""
    steels: dict[int | None, Steel] = {}
    for group in groups.get("steel", []):
        values = _core.typed("steel", group)
        number = values.pop("id", None)
        steels.setdefault(number, Steel(**values))
    sizes = _one(groups, "section")
    shape = sizes.pop("shape")
    if shape == "wall":
        return _wall(groups, sizes, steels)
    kind = SHAPES[shape]
    parts: dict[str, Any] = {"concrete": Concrete(**_one(groups, "concrete"))}
    if "bars" in groups:
        bars = _one(groups, "bars")
        rows = zip(bars["y"], bars["area"], bars["steel"], strict=True)
        parts["bars"] = [(y, area, steels[int(number)]) for y, area, number in rows]
    for group in groups.get("row", []):
        values = _core.typed("row", group)
        face = values.pop("face", None)
        if "steel" in values:
            values["steel"] = steels[values["steel"]]
        else:
            # Of the first steel.
            parts["steel"] = next(iter(steels.values()), None)
        row = Bars(**values)
        parts[face] = row if face == "side" else (*parts.get(face, ()), row)
    for name, part in _PARTS.items():
        if name in groups:
            values = _one(groups, name)
            used = {key: steels[values[key]] for key in values if key.endswith("steel")}
            parts[name] = part(**values | used)
    known = {field.name for field in fields(kind)}
    for name in (*sizes, *parts):
        # One class serves solid and hollow shapes; fields of walls are for hollow ones.
        solid = not shape.startswith("hollow")
        if name not in known or (solid and name in ("wall", "side_wall", "inner_layout")):
            raise InputError(f"section: {name} is not for shape = {shape!r}; remove it")
    return kind(**sizes, **parts)


def _wall(groups: Groups, sizes: dict[str, Any], steels: Mapping[int | None, Steel]) -> WallSection:
    """Return a wall; its bars belong to the boundary element that they are nearer to."""
    half = 0.5 * sizes["depth"]
    bars = _one(groups, "bars") if "bars" in groups else {"y": (), "area": (), "steel": ()}
    rows = list(zip(bars["y"], bars["area"], bars["steel"], strict=True))
    ends: dict[str, Boundary] = {}
    for group in groups.get("boundary", []):
        values = _core.typed("boundary", group)
        side, hoops = values.get("side", "both"), None
        if "hoop_diameter" in values:
            legs = {name: values[name] for name in ("legs_along", "legs_across") if name in values}
            hoops = Hoops(
                values["hoop_diameter"], values["hoop_spacing"], steels[values["steel"]], **legs
            )
        sign = -1.0 if side == "start" else 1.0
        # Distances from the outer face of the element; y points to the end of the wall.
        of_end: Any = [
            (round(half - sign * y, 9), a, steels[int(i)]) for y, a, i in rows if sign * y > 0.0
        ]
        laid = [row for row in groups.get("row", []) if row.get("face") == side]
        if laid and of_end:
            raise InputError("row: there are bars too; give one of them")
        of_end = of_end or [
            Bars(
                **_core.typed("row", {k: v for k, v in row.items() if k != "face"})
                | {"steel": steels[row["steel"]] if "steel" in row else next(iter(steels.values()))}
            )
            for row in laid
        ]
        thick = {name: values.get(name) for name in ("thickness", "bar_diameter")}
        ends[side] = Boundary(values["length"], of_end, hoops, **thick)
    meshes: dict[str, Curtain | None] = dict.fromkeys(("vertical", "horizontal"))
    for group in groups.get("curtain", []):
        values = _core.typed("curtain", group)
        direction = values.pop("direction", "vertical")
        meshes[direction] = Curtain(**values | {"steel": steels[values["steel"]]})
    boundary = ends.get("both") or ((ends["start"], ends["end"]) if ends else None)
    cover = {"cover": sizes["cover"]} if "cover" in sizes else {}
    concrete = Concrete(**_one(groups, "concrete"))
    made = {"boundary": boundary, "concrete": concrete, **meshes, **cover}
    return WallSection(sizes["depth"], sizes["width"], **made)


def _one(groups: Groups, name: str) -> dict[str, Any]:
    """Return the values of a group that is there once."""
    if name not in groups:
        raise InputError(f"section: the group &{name} is missing; give it")
    return _core.typed(name, groups[name][0])


def _spring(group: Mapping[str, Any], layers: Sequence[tuple[float, Spring]] = ()) -> Spring:
    """Return the spring that a group states."""
    values = {name: value for name, value in group.items() if name not in _NO_KEYS}
    return SPRINGS[group["rule"]](**({"layers": layers} if layers else values))


def _layer_springs(groups: Groups) -> dict[int, Spring]:
    """Return the springs of layers by their numbers."""
    return {int(group["id"]): _spring(group) for group in groups.get("layer_spring", [])}


def _layers(group: Mapping[str, Any], springs: Mapping[int, Spring]) -> list[tuple[float, Spring]]:
    """Return the layers that a group states."""
    numbers = (int(number) for number in _core.several(group["spring"]))
    return list(zip(_core.several(group["y"]), (springs[i] for i in numbers), strict=True))


def springs_of_joints(groups: Groups, last: int) -> dict[str, Any]:
    """Return the springs of a column, one for all joints or one for each from 1 to the last.

    Springs of joint 0, beneath a footing, have names as "shear_0".
    """
    springs = _layer_springs(groups)
    layers = {_joints(group): _layers(group, springs) for group in groups.get("layers", [])}
    by_name: dict[str, Any] = {}
    for name in SPRING_GROUPS:
        places: dict[int | None, Spring] = {}
        for group in groups.get(name, []):
            joints = _joints(group)
            spring = _spring(group, layers[joints] if group["rule"] == "layered" else ())
            places |= dict.fromkeys(joints or (None,), spring)
        if 0 in places:
            by_name[f"{name}_0"] = places.pop(0)
        if None in places:
            by_name[name] = places[None]
        elif places:
            by_name[name] = [places[joint] for joint in range(1, last + 1)]
    return by_name


def _joints(group: dict[str, Any]) -> tuple[int, ...]:
    """Return the joints that a group names; an empty tuple means all joints."""
    return tuple(int(joint) for joint in _core.several(group.get("joint", [])))


def frame_of(groups: Groups, drawings: Sequence[Groups] = ()) -> Frame:
    """Return the frame of the groups of a case, and of those of each of its drawings.

    Raises
    ------
    InputError
        If the members of a drawn frame cannot be made.
    """
    kinds = _kinds(groups, drawings)
    frame = _core.typed("frame", groups["frame"][-1])
    bays, storeys = len(frame.get("bays", ())), max(len(frame.get("storeys", ())), 1)
    panels = [group for group in groups.get("flexure", []) if "panel" in group]
    drawn = {name: frame.pop(name) for name in _DRAWN if name in frame}
    made = frame | {
        "nodes": _nodes(groups, bays + 1),
        "members": [_member(group, kinds[group["kind"]]) for group in groups.get("member", [])],
        "damping": _damping(groups),
        "panel": next((_spring(group) for group in panels if group["panel"] == "all"), None),
        "losses": _losses(groups) or None,
    }
    columns: Any = _cells("column_of", "line", bays + 1, groups, kinds) or None
    beams = _cells("beam_of", "bay", bays, groups, kinds) or None
    infills = {group["name"]: _infill(group) for group in groups.get("infill", [])}
    infilled = _cells("infill_of", "bay", bays, groups, infills)
    dead, live, mass = (_by_floor(name, storeys, groups) for name in _OF_FLOORS)
    weights = {
        place: group["load"]
        for group in groups.get("node_load", [])
        for place in places_of(_pair(group, "line", "floor"), "node_load", bays + 1)
    }
    cells = [*(columns or {}).values(), *(beams or {}).values()]
    if not (any(map(is_drawn, cells)) or drawn or weights or infilled or any(live)):
        return Frame(columns=columns, beams=beams, floor_mass=mass, beam_load=dead, **made)
    _put_hoops(drawn, kinds)
    if any(mass):
        made["floor_mass"] = mass
    return Frame.grid(
        made.pop("storeys", ()), made.pop("bays", None), columns=columns, beams=beams,
        dead_load=dead, live_load=live, node_load=weights, infills=infilled, **drawn, **made,
    )  # fmt: skip


def building_in_plan(groups: Groups, drawings: Sequence[Groups] = ()) -> Building:
    """Return the building of the groups of a case that has a grid in plan.

    Raises
    ------
    InputError
        If a place or a kind is not of the grid, or the members cannot be made.
    """
    kinds = _kinds(groups, drawings)
    infills = {group["name"]: _infill(group) for group in groups.get("infill", [])}
    frame = _core.typed("frame", groups["frame"][-1])
    for name in ("storeys", "bays_y"):
        if name not in frame:
            raise InputError(f"frame: {name} is missing beside bays_x; give it")
    made = _cells_in_plan(groups, kinds, infills)
    storeys = len(frame["storeys"])
    for key in ("floor_load", "live_load", "edge_load", "floor_mass"):
        name = {"live_load": "live_floor_load", "floor_mass": "mass"}.get(key, key)
        made[key] = _by_floor(name, storeys, groups)
    if not any(made["floor_mass"]):
        made["floor_mass"] = None
    made["eccentricity"] = [frame.pop(f"eccentricity_{along}", 0.0) for along in "xy"]
    _put_hoops(frame, kinds)
    return Building.grid(**made, **frame, damping=_damping(groups))


def _damping(groups: Groups) -> Damping | None:
    """Return the damping of the last group of this name, or None."""
    stated = groups.get("damping")
    return Damping(**_core.typed("damping", stated[-1])) if stated else None


def _put_hoops(frame: dict[str, Any], kinds: Mapping[str, Any]) -> None:
    """Put the hoops of a drawing in place of its name."""
    if name := frame.get("panel_hoops"):
        frame["panel_hoops"] = getattr(kinds.get(name), "ties", name)


def _cells_in_plan(
    groups: Groups, kinds: Mapping[str, Any], infills: Mapping[str, Any]
) -> dict[str, Any]:
    """Return columns, beams, infills and walls of a grid in plan, by the names of arguments."""
    made: dict[str, Any] = {"columns": {}, "walls": {}}
    made |= {f"{name}_{along}": {} for name in ("beams", "infills") for along in "xy"}
    for group, name in (("column_of", "columns"), ("beam_of", "beams"), ("infill_of", "infills")):
        known = infills if name == "infills" else kinds
        for values in groups.get(group, []):
            words = {values["kind"], values.get("kind_to", "none")} - {"none"}
            if unknown := sorted(words - known.keys()):
                raise InputError(f"{group}: kind = {unknown[0]!r} is not known; give its group")
            if planar := sorted({"line", "lines", "bays"} & values.keys()):
                raise InputError(
                    f"{group}: {planar[0]} is of a planar frame; a grid in plan has line_x and "
                    "line_y, or along, bay and of_line"
                )
            cell, along, k = _cell(values, known), values.get("along"), int(values.get("storey", 0))
            pair = ("line_x", "line_y") if name == "columns" else ("bay", "of_line")
            i, j = (int(values.get(key, 0)) for key in pair)
            if name == "columns" and along is None:
                made[name][i, j, k] = cell
            elif name == "columns":
                key = (along, j, i) if along == "x" else (along, i, j)
                made["walls"].setdefault(key, []).append(cell)
            elif along is None:
                raise InputError(f"{group}: along is missing; it is 'x' or 'y' in a grid in plan")
            else:
                made[f"{name}_{along}"][i, j, k] = cell
    return made


def building_of(groups: Groups, drawings: Sequence[Groups] = ()) -> Building:
    """Return the building of the groups of a case, whose frames have the nodes of its planes."""
    kinds = _kinds(groups, drawings)
    frame = _core.typed("frame", groups["frame"][-1])
    losses = _losses(groups)
    nodes = {group["name"]: group for group in groups.get("node", [])}
    in_plane = {name: group["plane"] for name, group in nodes.items()}
    of_building = ("plane", "rises_with")
    plain = [{k: v for k, v in node.items() if k not in of_building} for node in nodes.values()]
    leaders: dict[tuple[str, int], str] = {}
    nodes_of: dict[str, list[FrameNode]] = {}
    for node in _nodes({**groups, "node": plain}, 0):
        plane = in_plane[node.name]
        name = node.name.removeprefix(f"{plane}:")
        # The floors of a frame are rigid also where the frame is solved alone.
        first = leaders.setdefault((plane, node.floor or 0), name)
        tied = first if node.floor and first != name else ""
        nodes_of.setdefault(plane, []).append(replace(node, name=name, moves_with=tied))
    members: dict[str, list[Member]] = {}
    for group in groups.get("member", []):
        plane = in_plane[group["from"]]
        cut = {key: group[key].removeprefix(f"{plane}:") for key in ("name", "from", "to")}
        members.setdefault(plane, []).append(_member(group | cut, kinds[group["kind"]]))
    planes = [_core.typed("plane", group) for group in groups["plane"]]
    count = max(node.floor or 0 for of_plane in nodes_of.values() for node in of_plane)
    masses, inertia, *centres = (
        np.broadcast_to(_by_floor(name, count, groups), count)
        for name in ("mass", "inertia", "centre_x", "centre_y")
    )
    frames = []
    with notes_off():
        for plane in planes:
            start = f"{plane['name']}:"
            lost = {k.removeprefix(start): v for k, v in losses.items() if k.startswith(start)}
            made = FrameInPlan(
                nodes=nodes_of[plane["name"]], members=members[plane["name"]], losses=lost or None
            )
            more = (plane["along"],) if "along" in plane else ()
            frames.append((made, plane.get("angle", 0.0), plane.get("arm", 0.0), *more))
    building = Building(
        frames,
        names=[plane["name"] for plane in planes],
        centres=np.column_stack(centres),
        floor_mass=masses,
        inertia=inertia,
        damping=_damping(groups),
        **frame,
    )
    rises = {name: group.get("rises_with", "") for name, group in nodes.items()}
    axial = {group["name"]: group.get("axial_of", "") for group in groups.get("member", [])}
    for key, stated, by_place in (
        ("rises_with", rises, building.rises), ("axial_of", axial, building.axial_of)
    ):  # fmt: skip
        for name, other in stated.items():
            if other != by_place.get(name, ""):
                raise InputError(
                    f"{key} of {name!r} is {other!r}, and by the places of the planes it is "
                    f"{by_place.get(name, '')!r}; correct arm and along of each &plane"
                )
    return building


def _drawn_section(groups: Groups) -> Section:
    """Return the section of a drawing of members of a frame."""
    about = _one(groups, "drawing")
    if set(about) > {"name", "version"} or "parameter" in groups:
        raise InputError(
            f"drawing {about['name']!r}: of members of a frame it has name and version alone, and "
            "the parameters of the version"
        )
    try:
        _parameters(about["version"], {})
        return section_of(groups)
    except InputError as error:
        # The message names the drawing.
        raise error.of(f"drawing {about['name']!r}") from None


def _losses(groups: Groups) -> dict[str, float]:
    """Return the times at which members are taken away [s], by member."""
    return {group["member"]: group.get("time", 0.0) for group in groups.get("loss", [])}


def _infill(group: dict[str, Any]) -> Infill:
    """Return the infill of a group; an opening is stated by its length and height."""
    values = _core.typed("infill", group)
    opening = values.pop("opening_length", 0.0), values.pop("opening_height", 0.0)
    return Infill(**values, opening=opening if any(opening) else None)


def _member(group: Mapping[str, Any], kind: FrameMember) -> Member:
    """Return the member of a group."""
    rigid_end = group.get("rigid_from", 0.0), group.get("rigid_to", 0.0)
    return Member(
        group["name"], group["from"], group["to"], kind, rigid_end, group.get("load", 0.0)
    )


def _kinds(groups: Groups, drawings: Sequence[Groups]) -> dict[str, Any]:
    """Return kinds of members, and sections of drawings, by their names."""
    kinds: dict[str, Any] = {
        drawing["drawing"][0]["name"]: _drawn_section(drawing) for drawing in drawings
    }
    for group in groups.get("member_kind", []):
        kinds[group["name"]] = _kind(group, groups, kinds)
    return kinds


def _kind(stated: dict[str, Any], groups: Groups, sections: Mapping[str, Section]) -> FrameMember:
    """Return a kind of members with its springs, and the sections that they were made of."""
    springs: dict[str, Any] = {}
    # Springs without a position: flexure at both ends, shear at midspan.
    for group, usual in (("flexure", [0.0, 1.0]), ("shear", [0.5])):
        for spring in groups.get(group, []):
            if spring.get("kind") == stated["name"]:
                places = _core.several(spring.get("position", usual))
                made = _layered(spring, groups) if spring["rule"] == "layered" else _spring(spring)
                springs.setdefault(group, {}).update(dict.fromkeys(places, made))
    for spring in groups.get("axial_spring", []):
        if spring.get("kind") == stated["name"]:
            springs["axial_spring"] = _spring(spring)
    # A rigid kind states none of these three, which have no effect there.
    values: dict[str, Any] = dict.fromkeys(("modulus", "area", "inertia"), 1.0)
    values |= _core.typed("member_kind", stated) | springs
    keys = ("section", "section_to", "core_layers", "concrete_length", "bar_length")
    first, last, core, *lengths = (values.pop(key, None) for key in keys)
    if first is not None:
        values["sections"] = sections[first], sections[last or first]
    if "shear_spans" in values:
        spans = values["shear_spans"]
        values["shear_spans"] = tuple(spans[:2]), tuple(spans[2:])
    if lengths != [None, None]:
        foot = springs.get("flexure", {}).get(0.0)
        layers = len(foot.layers) if isinstance(foot, Layered) else 0
        numbers = {"core": core or 0, "cover": 0, "bar": len(values["sections"][0].bars)}
        numbers["cover"] = layers - sum(numbers.values())
        if None in lengths or numbers["cover"] < 0:
            raise InputError(
                f"member_kind {stated['name']!r}: concrete_length, bar_length and core_layers are "
                "of a joint of layers at its start, with the bars of its section; give both "
                "lengths and that joint, or none of them"
            )
        parts: Any = [part for part, number in numbers.items() for _ in range(number)]
        values["gauge"] = Gauge(tuple(parts), tuple(lengths[part == "bar"] for part in parts))
    return FrameMember(**values)


def _layered(spring: dict[str, Any], groups: Groups) -> Layered:
    """Return a joint of layers, whose kind and places are those of its spring."""

    def where(group: dict[str, Any]) -> tuple[Any, ...]:
        return group.get("kind"), *_core.several(group.get("position", []))

    layers = next(group for group in groups["layers"] if where(group) == where(spring))
    return Layered(_layers(layers, _layer_springs(groups)))


def _pair(group: Mapping[str, Any], line: str, storey: str) -> tuple[Any, int]:
    """Return the place that a group of a grid names, as `Frame.grid` takes it.

    `line` and `storey` are the names of the keys; the plural of `line` has a word for several
    lines, 0 stands for all.
    """
    word = group.get(f"{line}s", "all")
    return int(group.get(line, 0)) if word == "all" else word, int(group.get(storey, 0))


def _cells(
    group: str, key: str, lines: int, groups: Groups, kinds: Mapping[str, Any]
) -> dict[tuple[int, int], Any]:
    """Return kinds, or sections of drawings, by their places."""
    cells: dict[tuple[int, int], Any] = {}
    for values in groups.get(group, []):
        cell = _cell(values, kinds)
        for place in places_of(_pair(values, key, "storey"), group, lines):
            # The last group that names a place counts.
            cells.pop(place, None)
            cells[place] = cell
    return cells


def _cell(group: Mapping[str, Any], kinds: Mapping[str, Any]) -> Any:
    """Return what stands in a place: a kind, the sections of drawings, an infill, or None."""
    cell = None if group["kind"] == "none" else kinds[group["kind"]]
    if isinstance(cell, Section):
        other = group.get("kind_to")
        return cell if other is None else (cell, kinds[other])
    if isinstance(cell, FrameMember):
        rigid_end = group.get("rigid_end", 0.0)
        if "rigid_from" in group or "rigid_to" in group:
            rigid_end = group.get("rigid_from", rigid_end), group.get("rigid_to", rigid_end)
        return with_rigid_end(cell, rigid_end)
    return cell


def _by_floor(name: str, storeys: int, groups: Groups) -> list[Any]:
    """Return a value of the groups &floor for each floor; a list of one if all are the same."""
    values: list[Any] = [0.0] * storeys
    for group in groups.get("floor", []):
        if not 0 <= (floor := int(group.get("floor", 0))) <= storeys:
            raise InputError(
                f"floor: floor = {floor}, but there are {storeys}; correct it, or give 0 for all"
            )
        for i in range(storeys):
            if floor in (0, i + 1):
                several = tuple(_core.several(group.get(name, 0.0)))
                values[i] = several if len(several) > 1 else several[0]
    return values[:1] if len(set(values)) == 1 else values


def _nodes(groups: Groups, lines: int) -> list[FrameNode]:
    """Return the nodes with the springs that hold them to the ground."""
    nodes = {node["name"]: _core.typed("node", node) for node in groups.get("node", [])}
    for group in SPRING_GROUPS:
        for spring in groups.get(group, []):
            name = spring.get("node", "")
            base = [f"N-{line}-0" for line in range(1, lines + 1)]
            for node_name in base if name == "base" else [name] if name else []:
                nodes.setdefault(node_name, {"name": node_name})[group] = _spring(spring)
    for spring in groups.get("flexure", []):
        name = spring.get("panel", "all")
        if name != "all":
            nodes.setdefault(name, {"name": name})["panel"] = _spring(spring)
    return [FrameNode(**node) for node in nodes.values()]
