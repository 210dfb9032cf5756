"""Which parts of the model matter: the answer with one part switched on or off."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rbsdem._files import Tabular, data_frame
from rbsdem._types import DataFrame
from rbsdem.errors import InputError
from rbsdem.methods.ladder import LEVELS, MethodRuns, too_expensive
from rbsdem.methods.reference import Reference
from rbsdem.methods.study_case import VERTICAL, Setting, SolvedRun, StudyCase
from rbsdem.model.column import PLACES, Column, Damping, bodies, notes_off
from rbsdem.model.springs import Spring
from rbsdem.run.accuracy import errors_of
from rbsdem.run.solver import IMPLICIT

#: Share of the rotary inertia that stays when it is taken off: a body without any has no equation
#: of motion.
LITTLE_INERTIA = 0.01

#: Changes larger than this matter if the user gives no tolerance.
USUAL_TOLERANCE = 0.01

#: Columns of the table, and the attributes of `Effect` that they hold.
_TITLES = {"moment": "peak_base_moment", "history": "response_rms", "time_ratio": "wall_time_ratio"}
_NAMES = ("part", "peak", "residual", "moment", "energy", "history", "time_ratio")
_COLUMNS = {_TITLES.get(name, name): name for name in (*_NAMES, "matters", "status", "reason")}

#: Cost of twice the bodies: twice the work of a step, and a stable step of less than half.
TWICE_THE_BODIES = 6

#: How often short runs are repeated for their wall times.
REPEATS = 3

#: Tolerance of rk45 for the comparisons.
FINE = 1e-8


@dataclass(frozen=True)
class Effect:
    """The change of the answer by one part of the model.

    Attributes
    ----------
    part : str
        The part that was changed.
    peak, moment, energy : float
        Relative change of the peak response, of the peak base moment and of the energy that springs
        and damping have taken by the end (the last relative to its largest value).
    residual : float
        Change of the response at the end over the peak response.
    history : float
        Root mean square change of the response over its peak.
    time_ratio : float
        Wall time over that of the model as given.
    status, reason : str
        As for a setting.
    matters : bool or None
        Whether peak, moment, energy or residual changes by more than the tolerance; None if the
        comparison could not be made.
    """

    part: str
    peak: float = math.nan
    residual: float = math.nan
    moment: float = math.nan
    energy: float = math.nan
    history: float = math.nan
    time_ratio: float = math.nan
    status: str = "completed"
    reason: str = ""
    matters: bool | None = None

    @property
    def largest(self) -> float:
        """Largest of the absolute changes of peak, residual, moment and energy."""
        return max(abs(self.peak), abs(self.residual), abs(self.moment), abs(self.energy))


@dataclass(frozen=True, repr=False)
class Physics(Tabular):
    """All effects, and the setting they were computed with.

    Second-order effects are those of columns: a joint slips across the body below it, so that its
    shear is the lateral force, V = F. A member of a frame deforms across its chord, where the axial
    force N adds to the shear, V = F + N psi with the rotation psi of the chord.

    Attributes
    ----------
    effects : tuple of Effect
        One for each part of the model.
    setting : str
        The setting of all runs.
    resolution : float
        Error of that setting; smaller changes mean nothing.
    tolerance : float
        Changes larger than this matter.
    """

    effects: tuple[Effect, ...]
    setting: str
    resolution: float
    tolerance: float

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with a row for each part of the model."""
        words = {True: "yes", False: "no", None: ""}
        rows = [
            {title: getattr(effect, name) for title, name in _COLUMNS.items()}
            | {"matters": words[effect.matters]}
            for effect in self.effects
        ]
        return data_frame(rows, list(_COLUMNS))


class Variant(NamedTuple):
    """A model with one part changed: its name, how to make it, a load that is left out."""

    name: str
    make: Callable[[], Column]
    without: str = ""


def split_bodies(column: Column) -> Column:
    """Return the column with every body cut in two and the same flexibility.

    The flexibility of each joint is shared by the joint at the bottom of its body and a new one at
    half of the body's height. Each has springs of twice the stiffness and half the deformations, so
    that both together slip, rotate and open under a given force as the one did. What changes is the
    place along the height where the column rotates.
    """
    lengths, masses, inertias = bodies(column)
    halves: dict[str, list[float]] = {}
    if column.lengths is not None:
        halves["lengths"] = [length / 2 for length in lengths]
    if column.masses is not None:
        halves["masses"] = [mass / 2 for mass in masses]
    if column.rotary_inertia is not None:
        # About their own centroids: two masses m/2, each l/4 from the middle, make the given one;
        # very compact bodies keep the share of a rod.
        halves["rotary_inertia"] = [
            max(0.5 * inertia - mass * length**2 / 32, inertia / 8)
            for length, mass, inertia in zip(lengths, masses, inertias, strict=True)
        ]
    parts: dict[str, Any] = {"n": 2 * column.n}
    parts |= {name: np.repeat(values, 2) for name, values in halves.items()}
    for name in PLACES:
        springs = [spring.split(2) for spring in column.joints(name) for _ in range(2)]
        parts[name] = springs or None
    return dataclasses.replace(column, **parts)


def _little_inertia(column: Column) -> Column:
    few = [LITTLE_INERTIA * value for value in bodies(column)[2]]
    return dataclasses.replace(column, rotary_inertia=few, depth=0.0, top_inertia=0.0)


def variants(case: StudyCase, axial: Spring | None) -> Iterator[Variant]:
    """Yield the models to compare with; each has one part changed."""
    column, moving = case.column, not case.static
    switches: list[tuple[object, str, dict[str, object]]] = [
        (column.axial_load, "no axial load", {"axial_load": 0.0}),
        (column.self_weight, "no self-weight", {"self_weight": False}),
        (column.axial_spring, "joints do not open", {"axial_spring": None}),
        (axial and not column.axial_spring, "joints open", {"axial_spring": axial}),
        (moving and column.top_mass, "no top mass", {"top_mass": 0.0, "top_inertia": 0.0}),
        (moving and column.top_inertia, "no inertia of top", {"top_inertia": 0.0}),
        (moving and column.depth, "bodies without depth", {"depth": 0.0}),
        (moving and column.damping, "no damping", {"damping": None}),
    ]
    for level in LEVELS:
        if level != column.kinematics:
            yield Variant(f"kinematics {level}", _replacing(column, {"kinematics": level}))
    for there, name, fields in switches:
        if there:
            yield Variant(name, _replacing(column, fields))
    for name in VERTICAL:
        if name in case.loads:
            yield Variant(f"no {name}", lambda: column, name)
    if moving:
        yield Variant(f"rotary inertia x {LITTLE_INERTIA:g}", lambda: _little_inertia(column))
        if isinstance(column.damping, Damping) and column.damping.stiffness:
            tangent = not column.damping.tangent
            other = dataclasses.replace(column.damping, tangent=tangent)
            name = f"damping of {'tangent' if tangent else 'initial'} stiffness"
            yield Variant(name, _replacing(column, {"damping": other}))
    if column.top == "free" and column.footing is None:
        yield Variant(f"{2 * column.n} bodies", lambda: split_bodies(column))


def _replacing(column: Column, fields: dict[str, Any]) -> Callable[[], Column]:
    return lambda: dataclasses.replace(column, **fields)


def find_physics(
    trials: MethodRuns, reference: Reference | None, tolerance: float | None, axial: Spring | None
) -> Physics | str:
    """Return the effect of each part of the model, or the reason why it is not known."""
    several = list(variants(trials.case, axial))
    weight = len(several) + TWICE_THE_BODIES + 1
    base = _base(trials, reference, trials.budget.left() / weight)
    if isinstance(base, str):
        return base
    resolution = math.nan
    if reference is not None:
        resolution = max(errors_of(base.answer, reference.answer).largest, reference.resolution)
    limit = USUAL_TOLERANCE if tolerance is None else tolerance
    effects = []
    for variant in several:
        trials.told(f"physics: {variant.name}")
        effects.append(_effect(trials, variant, base, limit))
    return Physics(tuple(effects), str(base.setting), resolution, limit)


def _base(trials: MethodRuns, reference: Reference | None, seconds: float) -> SolvedRun | str:
    """Return the run of the model as given, with which the others are compared.

    A fine run if the budget allows it, else the most accurate one that it allows. A method that
    chooses its step is preferred: a fixed step may be too long for a variant.
    """
    case = trials.case
    level = case.column.kinematics
    if case.static:
        fine = Setting("static", level, parts=4 if level == "finite" else 1)
    else:
        fine = Setting("rk45", level, tolerance=FINE)
    if trials.predicted(None, fine) < seconds:
        run = case.run(fine, REPEATS, seconds=seconds / REPEATS)
        if isinstance(run, SolvedRun):
            return run
    done = [r for r in trials.solved if r.setting.kinematics == level and r.seconds < seconds]
    # An implicit step suits any variant; a fixed explicit step may be beyond the limit.
    for methods in (("rk45",), IMPLICIT, ("rk4", "static", "auto")):
        able = [run for run in done if run.setting.method in methods]
        if able and reference is not None:
            exact = reference.answer
            return min(able, key=lambda run: errors_of(run.answer, exact).largest)
        if able:
            return able[-1]
    return "the budget allows no setting for the comparisons; give more of it"


def _effect(trials: MethodRuns, variant: Variant, base: SolvedRun, tolerance: float) -> Effect:
    """Return the effect of one change of the model."""
    try:
        with notes_off():
            column = variant.make()
    except InputError as error:
        return Effect(variant.name, status="refused", reason=str(error))
    case, left = trials.case, trials.budget.left()
    loads = {load: values for load, values in case.loads.items() if load != variant.without}
    other = dataclasses.replace(case, loads=loads)
    setting = dataclasses.replace(base.setting, kinematics=column.kinematics)
    cost = base.seconds * (TWICE_THE_BODIES if column.n > case.column.n else 1)
    if cost > left:
        return Effect(variant.name, status="skipped", reason=too_expensive(cost, left))
    run = other.run(setting, REPEATS, column, base.seconds)
    for _ in range(6):
        if run.status != "refused" or setting.method != "rk4" or setting.dt is None:
            break
        # The step is beyond the stability limit of this model.
        setting = dataclasses.replace(setting, dt=setting.dt / 2)
        run = other.run(setting, REPEATS, column, base.seconds)
    if not isinstance(run, SolvedRun):
        return Effect(variant.name, status=run.status, reason=run.reason)
    return _compare(variant.name, run, base, tolerance)


def _compare(name: str, run: SolvedRun, base: SolvedRun, tolerance: float) -> Effect:
    old, new = base.answer, run.answer

    def change(quantity: str, scale: float) -> float:
        return (getattr(new, quantity) - getattr(old, quantity)) / scale if scale > 0 else 0.0

    effect = Effect(
        name,
        peak=change("peak", old.peak),
        residual=change("residual", old.peak),
        moment=change("peak_moment", old.peak_moment),
        energy=change("energy", old.largest_energy),
        history=errors_of(new, old).response_rms,
        time_ratio=run.seconds / base.seconds,
        status=run.status,
    )
    ends = new.response.size == old.response.size
    return dataclasses.replace(effect, matters=bool(effect.largest > tolerance or not ends))
