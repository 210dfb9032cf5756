"""The frame of a case file, from its groups."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rbsdem import _core
from rbsdem.model.damping import Damping
from rbsdem.model.frame import Frame, FrameMember, FrameNode, Member, with_panel
from rbsdem.model.springs import SPRINGS, Layered, Spring

#: Groups by name, each as often as it was given.
Groups = Mapping[str, list[dict[str, Any]]]

_SPRINGS = ("shear", "flexure", "axial_spring")


def frame_of(groups: Groups) -> Frame:
    """Return the frame of the groups of a case."""
    kinds = {given["name"]: _kind(given, groups) for given in groups.get("member_kind", [])}
    frame = _core.typed("frame", groups["frame"][-1])
    storeys = max(len(frame.get("storeys", ())), 1)
    damping = groups.get("damping")
    panels = [own for own in groups.get("flexure", []) if "panel" in own]
    return Frame(
        **frame,
        columns=_cells("column_of", "line", groups, kinds),
        beams=_cells("beam_of", "bay", groups, kinds),
        floor_mass=_by_floor("mass", storeys, groups),
        beam_load=_by_floor("load", storeys, groups),
        nodes=_nodes(groups, len(frame.get("bays", ())) + 1),
        members=[
            Member(
                given["name"],
                given["from"],
                given["to"],
                kinds[given["kind"]],
                (given.get("panel_from", 0.0), given.get("panel_to", 0.0)),
                given.get("load", 0.0),
            )
            for given in groups.get("member", [])
        ],
        damping=Damping(**_core.typed("damping", damping[-1])) if damping else None,
        panel=next((_spring(own) for own in panels if own["panel"] == "all"), None),
        losses={own["member"]: own.get("time", 0.0) for own in groups.get("loss", [])} or None,
    )


def _kind(given: dict[str, Any], groups: Groups) -> FrameMember:
    """Return a kind of members with its springs."""
    found: dict[str, Any] = {}
    for group, usual in (("flexure", [0.0, 1.0]), ("shear", [0.5])):
        for spring in groups.get(group, []):
            if spring.get("kind") == given["name"]:
                places = _core.several(spring.get("place", usual))
                made = _layered(spring, groups) if spring["rule"] == "layered" else _spring(spring)
                found.setdefault(group, {}).update(dict.fromkeys(places, made))
    for spring in groups.get("axial_spring", []):
        if spring.get("kind") == given["name"]:
            found["axial_spring"] = _spring(spring)
    own: dict[str, Any] = _core.typed("member_kind", given)
    return FrameMember(**own, **found)


def _layered(given: dict[str, Any], groups: Groups) -> Layered:
    """Return a joint of layers, whose kind and places are those of its spring."""
    springs = {int(one["id"]): _spring(one) for one in groups["layer_spring"]}

    def where(group: dict[str, Any]) -> tuple[Any, ...]:
        return group.get("kind"), *_core.several(group.get("place", []))

    layers = next(one for one in groups["layers"] if where(one) == where(given))
    numbers = (int(number) for number in _core.several(layers["spring"]))
    return Layered(
        list(zip(_core.several(layers["y"]), (springs[i] for i in numbers), strict=True))
    )


def _cells(
    group: str, key: str, groups: Groups, kinds: Mapping[str, FrameMember]
) -> dict[tuple[int, int], FrameMember | None] | None:
    found: dict[tuple[int, int], FrameMember | None] = {}
    for given in groups.get(group, []):
        pair = (int(given.get(key, 0)), int(given.get("storey", 0)))
        # The last that fits counts.
        found.pop(pair, None)
        none = given["kind"] == "none"
        found[pair] = None if none else with_panel(kinds[given["kind"]], given.get("panel", 0.0))
    return found or None


def _by_floor(name: str, storeys: int, groups: Groups) -> list[float]:
    values = [0.0] * storeys
    for given in groups.get("floor", []):
        for i in range(storeys):
            if given.get("storey", 0) in (0, i + 1):
                values[i] = given.get(name, 0.0)
    return values[:1] if len(set(values)) == 1 else values


def _nodes(groups: Groups, lines: int) -> list[FrameNode]:
    """Return the nodes with the springs that hold them to the ground."""
    nodes = {given["name"]: dict(given) for given in groups.get("node", [])}
    for group in _SPRINGS:
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


def _spring(given: Mapping[str, Any]) -> Spring:
    places = ("rule", "kind", "node", "panel", "place", "id")
    return SPRINGS[given["rule"]](**{k: v for k, v in given.items() if k not in places})
