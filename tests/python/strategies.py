"""Random columns and their loading: the one generator of the tests.

Everything is drawn from a `numpy.random.Generator`, so that a case is two numbers: those of its
seed. Of a rule only what it must have is written here; what it may have, with its bounds, comes
from the list of keys, and is kept where the rule accepts it beside the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import rbsdem
from rbsdem import _core
from rbsdem.model.springs import SPRINGS
from rbsdem.springs import Layered, Spring

Rng = np.random.Generator

#: What a bare number may come to where its key has no bound above, and where it is that of a paper.
_REACH = {"b0": 1.0, "b1": 1.5, "r0": 30.0, "cr2": 1.0, "hardening_reach": 20.0, "plastic": 1.5}
_REACH |= {"isotropic_hardening": 0.05, "plateau": 10.0, "endurance": 2000.0, "buckling": 3.0}
_REACH |= {f"lambda_{kind}": 200.0 for kind in "sckah"}


def between(rng: Rng, low: float, high: float) -> float:
    """Return a number, each size as likely as another; one in four is round, so that ends meet."""
    value = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return float(f"{value:.1g}") if rng.random() < 0.25 else value


def _flat(rng: Rng, k: float) -> float:
    """Return a slope after yield, 0 one time in six."""
    return 0.0 if rng.random() < 1 / 6 else k * between(rng, 1e-4, 0.8)


def _bilinear(rng: Rng, force: float, way: float) -> dict[str, Any]:
    return {"k": force / way, "d_y": way, "k_post": _flat(rng, force / way)}


def _takeda(rng: Rng, force: float, way: float) -> dict[str, Any]:
    k_c, d_c = force / way * between(rng, 1.05, 5), way * between(rng, 0.02, 0.7)
    k_y = k_c * between(rng, 0.1, 0.9)
    return {"k_c": k_c, "d_c": d_c, "k_y": k_y, "d_y": way, "k_u": _flat(rng, k_y)}


def _capped(rng: Rng, force: float, way: float) -> dict[str, Any]:
    cap = way * between(rng, 1, 10)
    given = {"d_y": way, "f_y": force, "d_cap": cap, "f_cap": force * between(rng, 1, 1.3)}
    return given | {"d_pc": cap * between(rng, 1, 20)}


def _pinching(rng: Rng, force: float, way: float) -> dict[str, Any]:
    shares = {name: between(rng, 0.05, 1) for name in ("kappa_f", "kappa_d")}
    return _capped(rng, force, way) | shares


def _concrete(rng: Rng, force: float, way: float) -> dict[str, Any]:
    k = force / way
    peak = way * max(1 + 1e-15, between(rng, 1, 3))
    return {"k": k, "f_peak": force, "d_peak": peak, "k_soft": k * between(rng, 1e-3, 0.5)}


def _steel(rng: Rng, force: float, way: float) -> dict[str, Any]:
    return {"k": force / way, "f_y": force, "k_post": _flat(rng, force / way)}


#: What a spring of each rule must have, that it yields near a force and a deformation.
RECIPES: dict[str, Callable[[Rng, float, float], dict[str, Any]]] = {
    "elastic": lambda _, force, way: {"k": force / way},
    "bilinear": _bilinear,
    "takeda": _takeda,
    "compression": lambda _, force, way: {"k": force / way},
    "peak_oriented": _capped,
    "pinching": _pinching,
    "concrete": _concrete,
    "steel": _steel,
}

#: Values that each rule takes.
GOOD = {rule: made(np.random.default_rng(1), 1e5, 1e-3) for rule, made in RECIPES.items()}


def rules(place: str) -> list[str]:
    """Return the rules that may stand in a place."""
    return [name for name, rule in _core.keys()["rules"].items() if place in rule["places"].split()]


#: Rules that harden all the way, if nothing else is asked of them.
_HARDENING = {"elastic": {}, "bilinear": {"k_post": 0.01}, "takeda": {"k_u": 0.01}}
_HARDENING |= {"steel": {"k_post": 0.01}}


def hardening(rng: Rng, rule: str, force: float, way: float) -> Spring:
    """Return a spring that hardens: a column of such springs has one answer to every load."""
    given = RECIPES[rule](rng, force, way)
    least = {name: share * force / way for name, share in _HARDENING[rule].items()}
    return SPRINGS[rule](**{n: max(value, least.get(n, 0.0)) for n, value in given.items()})


def _option(rng: Rng, key: dict[str, Any], force: float, way: float) -> Any:
    if "choices" in key:
        return str(rng.choice(key["choices"]))
    sizes = {"force": force, "deformation": way, "stiffness": force / way}
    if "unit" in key:
        return sizes[key["unit"]] * between(rng, 0.03, 3 if key["unit"] == "force" else 30)
    low, high = key["least"], key.get("most", _REACH.get(key["name"]))
    if rng.random() < 0.2:
        return float(low if rng.random() < 0.5 else high)
    return float(low + (high - low) * rng.random() ** 2)


def spring(rng: Rng, rule: str, force: float, way: float, *, options: float = 0.25) -> Spring:
    """Return a spring of a rule that yields near a force and a deformation."""
    if rule == "layered":
        return layered(rng, force, way)
    while True:
        given = RECIPES[rule](rng, force, way)
        try:
            made = SPRINGS[rule](**given)
        except rbsdem.InputError:
            continue
        break
    if rng.random() < 0.4:
        return made
    for key in _core.keys()["rules"][rule]["keys"]:
        if key["name"] in given or rng.random() > options:
            continue
        more = given | {key["name"]: _option(rng, key, force, way)}
        try:
            made = SPRINGS[rule](**more)
        except rbsdem.InputError:
            continue
        given = more
    return made


def scaled_spring(spring: Spring, force: float, way: float) -> Spring:
    """Return the spring in other units, by the dimensions that its keys have."""
    sizes = {"force": force, "deformation": way, "stiffness": force / way}
    changes = {}
    for key in _core.keys()["rules"][spring.rule]["keys"]:
        value = getattr(spring, key["name"])
        if value is not None and "unit" in key:
            changes[key["name"]] = value * sizes[key["unit"]]
    return replace(spring, **changes)


def layered(
    rng: Rng, moment: float, turn: float, depth: float = 0.4, *, rocks: float = 0.2
) -> Layered:
    """Return a joint of layers with bars at its faces, or now and then of contacts that rocks."""
    arm = 0.4 * depth
    force, way = moment / (2 * arm), turn * arm
    if rng.random() < rocks:
        contact = SPRINGS["compression"](force / way)
        return Layered([(-arm, contact), (arm, contact)])
    bar = spring(rng, str(rng.choice(["steel", "bilinear", "elastic"])), force, way)
    count = int(rng.integers(1, 9))
    places = depth * ((np.arange(count) + 0.5) / count - 0.5)
    rule = str(rng.choice(rules("layer")))
    strip = spring(rng, rule, 4 * force / count, way * between(rng, 0.3, 3))
    return Layered([(-arm, bar), *((float(y), strip) for y in places), (arm, bar)])


def joints(
    rng: Rng, names: list[str] | None, n: int, force: float, low: float, high: float
) -> Spring | list[Spring]:
    """Return a spring for all joints, or a few that come again here and there; None: hardening."""
    several = []
    for _ in range(int(rng.integers(1, 4))):
        rule = str(rng.choice(names or list(_HARDENING)))
        size = force * between(rng, 0.7, 2), between(rng, low, high)
        several.append(spring(rng, rule, *size) if names else hardening(rng, rule, *size))
    if rng.random() < 0.3:
        return several[0]
    return [several[rng.integers(len(several))] for _ in range(n)]


def column(rng: Rng, *, in_time: bool = False, **fixed: Any) -> rbsdem.Column:
    """Return a column; fields that are given stand, `shear`, `flexure` and `axial_spring` as rules.

    With None for the rules of `shear` and `flexure` their springs harden all the way.

    Raises
    ------
    rbsdem.InputError
        If it is too weak for its load, or has what does not go together.
    """
    chosen = {name: fixed.pop(name) for name in ("shear", "flexure") if name in fixed}

    def one(name: str, share: float, make: Callable[[], Any], otherwise: Any = None) -> Any:
        drawn = rng.random() < share
        return fixed.pop(name) if name in fixed else make() if drawn else otherwise

    n = one("n", 0.6, lambda: int(rng.integers(2, 8)), 1)
    kinematics = one("kinematics", 1, lambda: str(rng.choice(["small", "pdelta", "finite"])))
    lengths = rng.uniform(0.4, 1.2, n) if rng.random() < 0.5 else np.full(n, between(rng, 0.3, 2))
    height = float(lengths.sum())
    moment = between(rng, 3e4, 1e6)
    lateral = moment / height
    opens = one("axial_spring", 0.15, lambda: rules("axial"))
    top = one("top", 0.12, lambda: "fixed", "free")
    count = n + (top == "fixed")
    given: dict[str, Any] = {"n": n, "kinematics": kinematics, "top": top, "lengths": lengths}
    given["shear"] = joints(
        rng, chosen.get("shear", rules("shear")), count, 2 * lateral, 1e-4, 1e-2
    )
    flexure = chosen.get("flexure", rules("flexure"))
    given["flexure"] = joints(rng, flexure, count, moment, 1e-3, 1e-2)
    if opens:
        given["axial_spring"] = joints(rng, opens, count, 30 * lateral, 1e-4, 1e-3)
    given["axial_load"] = one("axial_load", 0.6, lambda: lateral * between(rng, 0.1, 10), 0.0)
    mass = between(rng, 1e2, 1e4)
    masses = {"masses": mass * rng.uniform(0.1, 1, n)} if rng.random() < 0.3 else {"mass": mass}
    if one("self_weight", 0.25, lambda: True):
        given |= {"self_weight": True, "gravity": between(rng, 1, 20)}
    if one("top_mass", 0.9 if top == "fixed" else 0.5, lambda: True):
        given |= {"top_mass": between(rng, 1e2, 1e5)}
        given |= {"top_inertia": between(rng, 1, 1e4)} if rng.random() < 0.5 else {}
    if rng.random() < 0.4:
        given |= {"depth": between(rng, 0.1, 1)}
    elif rng.random() < 0.5:
        each = n if rng.random() < 0.5 else 1
        given |= {"rotary_inertia": mass / n * height**2 * rng.uniform(0.02, 0.3, each)}
    given["damping"] = one("damping", 0.6, lambda: damping(rng))
    if one("footing", 0.15, lambda: True):
        given["footing"] = footing(rng, bool(opens), moment, lateral)
    if kinematics == "pdelta":
        given["axial_height"] = one("axial_height", 0.1, lambda: height * between(rng, 0.5, 2))
    return rbsdem.Column(**({"height": height, "mass": None} | masses | given | fixed))


def two_sided(made: rbsdem.Column) -> bool:
    """Return whether a spring has a backbone of its own for the negative side."""
    springs = [*made.joints("shear"), *made.joints("flexure")]
    return any(
        getattr(spring, name) is not None
        for spring in springs
        for name in vars(spring)
        if name.endswith("_neg")
    )


def damping(rng: Rng) -> float | rbsdem.Damping:
    """Return damping of one of its kinds."""
    size = {"mass": between(rng, 0.01, 3), "stiffness": between(rng, 1e-6, 1e-3)}
    kinds = [between(rng, 0.01, 0.2), rbsdem.Damping(**size), rbsdem.Damping(**size, tangent=True)]
    kinds += [rbsdem.Damping(mass=size["mass"], modal=rng.uniform(0.01, 0.1, 2))]
    return kinds[rng.integers(len(kinds))]


def footing(rng: Rng, opens: bool, moment: float, lateral: float) -> rbsdem.Footing:
    """Return a footing, some of which rock."""
    return rbsdem.Footing(
        spring(rng, str(rng.choice(rules("shear"))), 2 * lateral, between(rng, 1e-4, 1e-2)),
        spring(rng, str(rng.choice(rules("flexure"))), moment, between(rng, 1e-3, 1e-2)),
        spring(rng, str(rng.choice(rules("axial"))), 30 * lateral, between(rng, 1e-4, 1e-3))
        if opens
        else None,
        mass=between(rng, 1e2, 1e4),
        inertia=between(rng, 10, 1e4),
        height=0.0 if rng.random() < 0.5 else between(rng, 0.1, 1),
    )


def accepted(make: Callable[[], rbsdem.Column]) -> rbsdem.Column:
    """Return the first of some columns that is accepted: a few are too weak for their load."""
    for _ in range(100):
        try:
            with rbsdem.model.column.notes_off():
                return make()
        except rbsdem.InputError:
            continue
    raise AssertionError("no column of 100 was accepted")


def any_column(rng: Rng, **fixed: Any) -> rbsdem.Column:
    """Return a column that is accepted; `fixed` is what `column` takes."""
    return accepted(lambda: column(rng, **fixed))


def walk(rng: Rng, largest: float, points: int) -> np.ndarray:
    """Return a path that often comes back to where it was, stays, or goes on by next to nothing."""
    found = [largest * rng.uniform(0.1, 1)]
    for _ in range(points - 1):
        old, last = found[rng.integers(len(found))], found[-1]
        nearly = last * (1 + 10.0 ** rng.uniform(-12, -1))
        kinds = [rng.uniform(-1, 1) * largest, old, -old, 0.0, old * rng.uniform(0.2, 1.2), nearly]
        found.append(float(kinds[rng.integers(len(kinds))]))
    return np.array(found)


def strength(made: rbsdem.Column) -> float:
    """Return the force at a drift where most columns have yielded [N]; 0 if there is none."""
    try:
        return float(abs(rbsdem.cyclic(made, displacement=[0.005 * made.height]).force[-1]))
    except rbsdem.SolveError:
        return 0.0


def static_path(rng: Rng, made: rbsdem.Column) -> dict[str, np.ndarray]:
    """Return displacements of the top [m], or now and then forces [N], below and beyond yield."""
    points = int(rng.integers(4, 16))
    if rng.random() < 0.2 and (force := strength(made)):
        return {"force": walk(rng, force * between(rng, 0.1, 2), points)}
    return {"displacement": walk(rng, made.height * between(rng, 2e-3, 0.1), points)}


def methods(rng: Rng, made: rbsdem.Column, stable: float, interval: float) -> dict[str, Any]:
    """Return a method in time and its settings, of steps that are a binary fraction."""
    kinds = [name for name in rbsdem.run.solver.IN_TIME if name != "auto"] + ["located"]
    name = str(rng.choice(kinds))
    settings: dict[str, Any] = {"method": "rk4" if name == "located" else name}
    if name in ("rk4", "located"):
        settings["dt"] = interval * 2.0 ** min(0, np.floor(np.log2(0.4 * stable / interval)))
        settings["events"] = "located" if name == "located" else "step"
    elif name != "rk45":
        settings["dt"] = interval / float(rng.choice([1, 2, 8]))
    if "rho_infinity" in rbsdem.run.solver.METHODS[settings["method"]].settings:
        settings["rho_infinity"] = float(rng.uniform(0.5 if name == "hht" else 0.0, 1))
    return settings


#: Steps of a motion at the most: a stiff column with exact rotations takes many.
MOST_STEPS = 4000


def may_vary(made: rbsdem.Column, settings: dict[str, Any]) -> bool:
    """Whether the axial load may vary: layers are no events of steps that stop at events."""
    stops = settings["method"] == "rk45" or settings.get("events") == "located"
    return not (stops and any(isinstance(spring, Layered) for spring in made.joints("flexure")))


def motion(
    rng: Rng, made: rbsdem.Column, *, settings: dict[str, Any] | None = None
) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Return loading in time and settings that bring a column beyond yield; None if it takes long.

    The clock is of binary fractions, which have no round-off.
    """
    found = rbsdem.modes(made)
    interval = 2.0 ** np.round(np.log2(2 * np.pi / found.omega[0] / between(rng, 8, 40)))
    points = int(rng.integers(20, 60))
    chosen = methods(rng, made, found.stable_step, interval) if settings is None else settings
    step = chosen.get("dt", found.stable_step)
    if points * interval > MOST_STEPS * step:
        return None
    mass = made.top_mass + (made.mass or sum(made.masses or ()))
    size = strength(made) * between(rng, 0.1, 3)
    if not size:
        return None
    loads: dict[str, Any] = {"time": interval * np.arange(points)}
    drives = rng.random()
    if drives < 0.8:
        loads["ground_acceleration"] = size / mass * waves(rng, points)
    if drives > 0.6:
        loads["force"] = size * waves(rng, points)
    return loads, chosen


def waves(rng: Rng, points: int) -> np.ndarray:
    """Return a signal of a few sines between -1 and 1 that begins with nothing."""
    at = np.arange(points) / points
    parts = [
        rng.normal() * np.sin(2 * np.pi * rng.uniform(0.5, 8) * at + rng.uniform(0, 6))
        for _ in range(4)
    ]
    values = np.sum(parts, axis=0) * np.minimum(1, 5 * at)
    return values / np.abs(values).max()


def section(rng: Rng, shape: str | None = None) -> rbsdem.model.shape.Section:
    """Return a solid or hollow section, whose faces need not be alike, of 2 to 4 % of bars."""
    depth = between(rng, 0.3, 1.5)
    fy = rng.uniform(300e6, 600e6)
    steel = rbsdem.Steel(fy, rng.uniform(1.1, 1.6) * fy)
    hoops = rbsdem.Steel(rng.uniform(250e6, 600e6))
    given: dict[str, Any] = {"concrete": rbsdem.Concrete(rng.uniform(15e6, 90e6)), "cover": 0.03}
    wall = {"wall": depth * rng.uniform(0.2, 0.4)} if rng.random() < 0.3 else {}
    if (shape or str(rng.choice(["rectangle", "circle"]))) == "circle":
        spiral = rbsdem.Spiral(0.01, rng.uniform(0.05, 0.12), hoops)
        layout = rbsdem.Layout(int(rng.integers(6, 25)), 0.035 * depth, steel)
        return rbsdem.CircularSection(depth, layout=layout, spiral=spiral, **given, **wall)
    width = depth * rng.uniform(0.5, 2)
    share = rng.dirichlet([2, 1, 2]) * width * depth * rng.uniform(0.01, 0.03)
    edge = 0.5 * depth - 0.06
    places = (edge, edge * rng.uniform(-0.6, 0.6), -edge)
    return rbsdem.RectangularSection(
        width,
        depth,
        bars=[(y, float(area), steel) for y, area in zip(places, share, strict=True)],
        bar_diameter=0.02,
        ties=rbsdem.Ties(0.01, rng.uniform(0.05, 0.2), hoops, legs=rng.uniform(2, 5)),
        **given,
        **wall,
    )
