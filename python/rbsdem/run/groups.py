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
#: Keys of the location of a spring.
_NO_KEYS = ("rule", "joint", "kind", "node", "panel", "position", "id")
#: Classes of the groups that refer to steels.
_PARTS: dict[str, type] = {
    "layout": Layout, "inner_layout": Layout, "ties": Ties, "spiral": Spiral, "lap": Lap
}  # fmt: skip


def layered_column(drawing: LayeredModel, given: Mapping[str, Any]) -> Column:
    """Return the column of a case that has its drawing.

    Parameters
    ----------
    drawing : LayeredModel
        The drawing.
    given : mapping
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
    made = LayeredColumn(**given, drawing=drawing)
    if made.drawing != drawing:
        warn(
            f"the springs of the case were drawn for axial_load = {drawing.axial_load:g} N, and "
            f"its column has {made.axial_load:g} N; it is solved with its own springs, and "
            "nothing is known of bars and concrete. To draw it again, make the column of its "
            "section",
        )
        return Column(**given)
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
    changes = {one["name"]: one["value"] for one in groups.get("parameter", [])}
    made = _parameters(drawing.pop("version"), changes)
    return LayeredModel(section=section_of(groups), parameters=made, **drawing)


def drawn_column(groups: Groups, given: Mapping[str, Any]) -> Column:
    """Return the column of a case that has its section, and no springs but those of a footing.

    It has second-order effects, as `rbsdem.section.column` makes it.

    Parameters
    ----------
    groups : mapping
        The groups of the case.
    given : mapping
        The arguments of `rbsdem.Column` that the case gives.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    for name in ("lengths", "model"):
        if name in given:
            raise InputError(f"column: {name} is of columns with springs; remove it, or give them")
    about = _one(groups, "drawing")
    about.pop("name", None)
    changes = {one["name"]: one["value"] for one in groups.get("parameter", [])}
    about["model_parameters"] = _parameters(about.pop("version"), changes)
    rest = {name: value for name, value in given.items() if value is not None}
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
    for one in groups.get("steel", []):
        values = _core.typed("steel", one)
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
    for given in groups.get("row", []):
        values = _core.typed("row", given)
        face = values.pop("face", None)
        if "steel" in values:
            values["steel"] = steels[values["steel"]]
        else:
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
        given = _core.typed("boundary", group)
        side, hoops = given.get("side", "both"), None
        if "hoop_diameter" in given:
            legs = {name: given[name] for name in ("legs_along", "legs_across") if name in given}
            hoops = Hoops(
                given["hoop_diameter"], given["hoop_spacing"], steels[given["steel"]], **legs
            )
        sign = -1.0 if side == "start" else 1.0
        own: Any = [
            (round(half - sign * y, 9), a, steels[int(i)]) for y, a, i in rows if sign * y > 0.0
        ]
        laid = [one for one in groups.get("row", []) if one.get("face") == side]
        if laid and own:
            raise InputError("row: there are bars too; give one of them")
        own = own or [
            Bars(
                **_core.typed("row", {k: v for k, v in one.items() if k != "face"})
                | {"steel": steels[one["steel"]] if "steel" in one else next(iter(steels.values()))}
            )
            for one in laid
        ]
        thick = {name: given.get(name) for name in ("thickness", "bar_diameter")}
        ends[side] = Boundary(given["length"], own, hoops, **thick)
    meshes: dict[str, Curtain | None] = dict.fromkeys(("vertical", "horizontal"))
    for group in groups.get("curtain", []):
        given = _core.typed("curtain", group)
        direction = given.pop("direction", "vertical")
        meshes[direction] = Curtain(**given | {"steel": steels[given["steel"]]})
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


def _spring(given: Mapping[str, Any], layers: Sequence[tuple[float, Spring]] = ()) -> Spring:
    """Return the spring that a group states."""
    values = {name: value for name, value in given.items() if name not in _NO_KEYS}
    return SPRINGS[given["rule"]](**({"layers": layers} if layers else values))


def _layer_springs(groups: Groups) -> dict[int, Spring]:
    """Return the springs of layers by their numbers."""
    return {int(one["id"]): _spring(one) for one in groups.get("layer_spring", [])}


def _layers(given: Mapping[str, Any], springs: Mapping[int, Spring]) -> list[tuple[float, Spring]]:
    """Return the layers that a group states."""
    numbers = (int(number) for number in _core.several(given["spring"]))
    return list(zip(_core.several(given["y"]), (springs[i] for i in numbers), strict=True))


def springs_of_joints(groups: Groups, last: int) -> dict[str, Any]:
    """Return the springs of a column, one for all joints or one for each from 1 to the last.

    Those of joint 0, beneath a footing, have its number in their names.
    """
    springs = _layer_springs(groups)
    layers = {_joints(given): _layers(given, springs) for given in groups.get("layers", [])}
    found: dict[str, Any] = {}
    for name in SPRING_GROUPS:
        places: dict[int | None, Spring] = {}
        for given in groups.get(name, []):
            joints = _joints(given)
            spring = _spring(given, layers[joints] if given["rule"] == "layered" else ())
            places |= dict.fromkeys(joints or (None,), spring)
        if 0 in places:
            found[f"{name}_0"] = places.pop(0)
        if None in places:
            found[name] = places[None]
        elif places:
            found[name] = [places[joint] for joint in range(1, last + 1)]
    return found


def _joints(given: dict[str, Any]) -> tuple[int, ...]:
    """Return the joints that a group names; an empty tuple means all joints."""
    return tuple(int(joint) for joint in _core.several(given.get("joint", [])))


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
    damping = groups.get("damping")
    panels = [own for own in groups.get("flexure", []) if "panel" in own]
    drawn = {name: frame.pop(name) for name in _DRAWN if name in frame}
    made = frame | {
        "nodes": _nodes(groups, bays + 1),
        "members": [_member(given, kinds[given["kind"]]) for given in groups.get("member", [])],
        "damping": Damping(**_core.typed("damping", damping[-1])) if damping else None,
        "panel": next((_spring(own) for own in panels if own["panel"] == "all"), None),
        "losses": {own["member"]: own.get("time", 0.0) for own in groups.get("loss", [])} or None,
    }
    columns: Any = _cells("column_of", "line", bays + 1, groups, kinds) or None
    beams = _cells("beam_of", "bay", bays, groups, kinds) or None
    infills = {given["name"]: _infill(given) for given in groups.get("infill", [])}
    infilled = _cells("infill_of", "bay", bays, groups, infills)
    dead, live, mass = (_by_floor(name, storeys, groups) for name in _OF_FLOORS)
    weights = {
        place: given["load"]
        for given in groups.get("node_load", [])
        for place in places_of(_pair(given, "line", "floor"), "node_load", bays + 1)
    }
    cells = [*(columns or {}).values(), *(beams or {}).values()]
    if not (any(map(is_drawn, cells)) or drawn or weights or infilled or any(live)):
        return Frame(columns=columns, beams=beams, floor_mass=mass, beam_load=dead, **made)
    if "panel_hoops" in drawn:
        hoops = kinds.get(drawn["panel_hoops"])
        drawn["panel_hoops"] = getattr(hoops, "ties", drawn["panel_hoops"])
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
    infills = {given["name"]: _infill(given) for given in groups.get("infill", [])}
    frame = _core.typed("frame", groups["frame"][-1])
    for name in ("storeys", "bays_y"):
        if name not in frame:
            raise InputError(f"frame: {name} is missing beside bays_x; give it")
    made = _cells_in_plan(groups, kinds, infills)
    storeys = len(frame["storeys"])
    for key, name in (
        ("floor_load", "floor_load"), ("live_load", "live_floor_load"), ("edge_load", "edge_load")
    ):  # fmt: skip
        made[key] = _by_floor(name, storeys, groups)
    masses = _by_floor("mass", storeys, groups)
    made["floor_mass"] = masses if any(masses) else None
    made["eccentricity"] = [frame.pop(f"eccentricity_{along}", 0.0) for along in "xy"]
    if "panel_hoops" in frame:
        hoops = kinds.get(frame["panel_hoops"])
        frame["panel_hoops"] = getattr(hoops, "ties", frame["panel_hoops"])
    if damping := groups.get("damping"):
        made["damping"] = Damping(**_core.typed("damping", damping[-1]))
    return Building.grid(**made, **frame)


def _cells_in_plan(
    groups: Groups, kinds: Mapping[str, Any], infills: Mapping[str, Any]
) -> dict[str, Any]:
    """Return columns, beams, infills and walls of a grid in plan, by the names of arguments."""
    made: dict[str, Any] = {"columns": {}, "walls": {}}
    made |= {f"{name}_{along}": {} for name in ("beams", "infills") for along in "xy"}
    for group, name in (("column_of", "columns"), ("beam_of", "beams"), ("infill_of", "infills")):
        known = infills if name == "infills" else kinds
        for given in groups.get(group, []):
            words = {given["kind"], given.get("kind_to", "none")} - {"none"}
            if unknown := sorted(words - known.keys()):
                raise InputError(f"{group}: kind = {unknown[0]!r} is not known; give its group")
            if planar := sorted({"line", "lines", "bays"} & given.keys()):
                raise InputError(
                    f"{group}: {planar[0]} is of a planar frame; a grid in plan has line_x and "
                    "line_y, or along, bay and of_line"
                )
            cell, along, k = _cell(given, known), given.get("along"), int(given.get("storey", 0))
            pair = ("line_x", "line_y") if name == "columns" else ("bay", "of_line")
            i, j = (int(given.get(key, 0)) for key in pair)
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
    damping = groups.get("damping")
    losses = {own["member"]: own.get("time", 0.0) for own in groups.get("loss", [])}
    nodes = {given["name"]: given for given in groups.get("node", [])}
    in_plane = {name: given["plane"] for name, given in nodes.items()}
    of_building = ("plane", "rises_with")
    plain = [{k: v for k, v in one.items() if k not in of_building} for one in nodes.values()]
    leaders: dict[tuple[str, int], str] = {}
    own: dict[str, list[FrameNode]] = {}
    for node in _nodes({**groups, "node": plain}, 0):
        plane = in_plane[node.name]
        name = node.name.removeprefix(f"{plane}:")
        # Alone, too, its floors are rigid.
        first = leaders.setdefault((plane, node.floor or 0), name)
        tied = first if node.floor and first != name else ""
        own.setdefault(plane, []).append(replace(node, name=name, moves_with=tied))
    members: dict[str, list[Member]] = {}
    for given in groups.get("member", []):
        plane = in_plane[given["from"]]
        cut = {key: given[key].removeprefix(f"{plane}:") for key in ("name", "from", "to")}
        members.setdefault(plane, []).append(_member(given | cut, kinds[given["kind"]]))
    planes = [_core.typed("plane", given) for given in groups["plane"]]
    count = max(node.floor or 0 for one in own.values() for node in one)
    floors: list[dict[str, float]] = [{} for _ in range(count)]
    for given in groups.get("floor", []):
        for i, floor in enumerate(floors):
            if given.get("floor", 0) in (0, i + 1):
                floor.update(given)
    values = {
        name: [floor.get(name, 0.0) for floor in floors]
        for name in ("mass", "inertia", "centre_x", "centre_y")
    }
    frames = []
    with notes_off():
        for plane in planes:
            start = f"{plane['name']}:"
            lost = {k.removeprefix(start): v for k, v in losses.items() if k.startswith(start)}
            made = FrameInPlan(
                nodes=own[plane["name"]], members=members[plane["name"]], losses=lost or None
            )
            more = (plane["along"],) if "along" in plane else ()
            frames.append((made, plane.get("angle", 0.0), plane.get("arm", 0.0), *more))
    building = Building(
        frames,
        names=[plane["name"] for plane in planes],
        centres=np.column_stack((values["centre_x"], values["centre_y"])),
        floor_mass=values["mass"],
        inertia=values["inertia"],
        damping=Damping(**_core.typed("damping", damping[-1])) if damping else None,
        **frame,
    )
    rises = {name: given.get("rises_with", "") for name, given in nodes.items()}
    axial = {own["name"]: own.get("axial_of", "") for own in groups.get("member", [])}
    for key, given, found in (
        ("rises_with", rises, building.rises), ("axial_of", axial, building.axial_of)
    ):  # fmt: skip
        for name, other in given.items():
            if other != found.get(name, ""):
                raise InputError(
                    f"{key} of {name!r} is {other!r}, and by the places of the planes it is "
                    f"{found.get(name, '')!r}; correct arm and along of each &plane"
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
        # Of several drawings that which is meant
        raise error.of(f"drawing {about['name']!r}") from None


def _infill(given: dict[str, Any]) -> Infill:
    values = _core.typed("infill", given)
    opening = values.pop("opening_length", 0.0), values.pop("opening_height", 0.0)
    return Infill(**values, opening=opening if any(opening) else None)


def _member(given: Mapping[str, Any], kind: FrameMember) -> Member:
    rigid_end = given.get("rigid_from", 0.0), given.get("rigid_to", 0.0)
    return Member(
        given["name"], given["from"], given["to"], kind, rigid_end, given.get("load", 0.0)
    )


def _kinds(groups: Groups, drawings: Sequence[Groups]) -> dict[str, Any]:
    """Return kinds of members, and sections of drawings, by their names."""
    kinds: dict[str, Any] = {own["drawing"][0]["name"]: _drawn_section(own) for own in drawings}
    for given in groups.get("member_kind", []):
        kinds[given["name"]] = _kind(given, groups, kinds)
    return kinds


def _kind(given: dict[str, Any], groups: Groups, sections: Mapping[str, Section]) -> FrameMember:
    """Return a kind of members with its springs, and the sections that they were made of."""
    found: dict[str, Any] = {}
    for group, usual in (("flexure", [0.0, 1.0]), ("shear", [0.5])):
        for spring in groups.get(group, []):
            if spring.get("kind") == given["name"]:
                places = _core.several(spring.get("position", usual))
                made = _layered(spring, groups) if spring["rule"] == "layered" else _spring(spring)
                found.setdefault(group, {}).update(dict.fromkeys(places, made))
    for spring in groups.get("axial_spring", []):
        if spring.get("kind") == given["name"]:
            found["axial_spring"] = _spring(spring)
    # A rigid kind has none of them.
    own: dict[str, Any] = dict.fromkeys(("modulus", "area", "inertia"), 1.0)
    own |= _core.typed("member_kind", given) | found
    keys = ("section", "section_to", "core_layers", "concrete_length", "bar_length")
    first, last, core, *lengths = (own.pop(key, None) for key in keys)
    if first is not None:
        own["sections"] = sections[first], sections[last or first]
    if "shear_spans" in own:
        spans = own["shear_spans"]
        own["shear_spans"] = tuple(spans[:2]), tuple(spans[2:])
    if lengths != [None, None]:
        foot = found.get("flexure", {}).get(0.0)
        layers = len(foot.layers) if isinstance(foot, Layered) else 0
        numbers = {"core": core or 0, "cover": 0, "bar": len(own["sections"][0].bars)}
        numbers["cover"] = layers - sum(numbers.values())
        if None in lengths or numbers["cover"] < 0:
            raise InputError(
                f"member_kind {given['name']!r}: concrete_length, bar_length and core_layers are "
                "of a joint of layers at its start, with the bars of its section; give both "
                "lengths and that joint, or none of them"
            )
        parts: Any = [part for part, number in numbers.items() for _ in range(number)]
        own["gauge"] = Gauge(tuple(parts), tuple(lengths[part == "bar"] for part in parts))
    return FrameMember(**own)


def _layered(given: dict[str, Any], groups: Groups) -> Layered:
    """Return a joint of layers, whose kind and places are those of its spring."""

    def where(group: dict[str, Any]) -> tuple[Any, ...]:
        return group.get("kind"), *_core.several(group.get("position", []))

    layers = next(one for one in groups["layers"] if where(one) == where(given))
    return Layered(_layers(layers, _layer_springs(groups)))


def _pair(given: Mapping[str, Any], line: str, storey: str) -> tuple[Any, int]:
    """Return the place that a group of a grid names, as `Frame.grid` takes it."""
    word = given.get(f"{line}s", "all")
    return int(given.get(line, 0)) if word == "all" else word, int(given.get(storey, 0))


def _cells(
    group: str, key: str, lines: int, groups: Groups, kinds: Mapping[str, Any]
) -> dict[tuple[int, int], Any]:
    """Return kinds, or sections of drawings, by their places."""
    found: dict[tuple[int, int], Any] = {}
    for given in groups.get(group, []):
        cell = _cell(given, kinds)
        for place in places_of(_pair(given, key, "storey"), group, lines):
            # The last that fits counts.
            found.pop(place, None)
            found[place] = cell
    return found


def _cell(given: Mapping[str, Any], kinds: Mapping[str, Any]) -> Any:
    """Return what stands in a place: a kind, the sections of drawings, an infill, or None."""
    cell = None if given["kind"] == "none" else kinds[given["kind"]]
    if isinstance(cell, Section):
        other = given.get("kind_to")
        return cell if other is None else (cell, kinds[other])
    if isinstance(cell, FrameMember):
        rigid_end = given.get("rigid_end", 0.0)
        if "rigid_from" in given or "rigid_to" in given:
            rigid_end = given.get("rigid_from", rigid_end), given.get("rigid_to", rigid_end)
        return with_rigid_end(cell, rigid_end)
    return cell


def _by_floor(name: str, storeys: int, groups: Groups) -> list[Any]:
    values: list[Any] = [0.0] * storeys
    for given in groups.get("floor", []):
        if not 0 <= (floor := int(given.get("floor", 0))) <= storeys:
            raise InputError(
                f"floor: floor = {floor}, but there are {storeys}; correct it, or give 0 for all"
            )
        for i in range(storeys):
            if floor in (0, i + 1):
                several = tuple(_core.several(given.get(name, 0.0)))
                values[i] = several if len(several) > 1 else several[0]
    return values[:1] if len(set(values)) == 1 else values


def _nodes(groups: Groups, lines: int) -> list[FrameNode]:
    """Return the nodes with the springs that hold them to the ground."""
    nodes = {own["name"]: _core.typed("node", own) for own in groups.get("node", [])}
    for group in SPRING_GROUPS:
        for spring in groups.get(group, []):
            name = spring.get("node", "")
            base = [f"N-{line}-0" for line in range(1, lines + 1)]
            for one in base if name == "base" else [name] if name else []:
                nodes.setdefault(one, {"name": one})[group] = _spring(spring)
    for spring in groups.get("flexure", []):
        name = spring.get("panel", "all")
        if name != "all":
            nodes.setdefault(name, {"name": name})["panel"] = _spring(spring)
    return [FrameNode(**node) for node in nodes.values()]
