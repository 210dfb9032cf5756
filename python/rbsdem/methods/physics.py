"""The reference of a study of methods, and the parts of the model that matter.

The reference is two independent methods, refined until they agree; a part matters if the answer
changes where it is switched on or off.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from rbsdem._files import Tabular, data_frame
from rbsdem._types import DataFrame
from rbsdem.errors import InputError, RbsdemError
from rbsdem.methods.ladder import (
    LEVELS,
    VERTICAL,
    Budget,
    MethodRun,
    MethodRuns,
    Setting,
    StudyCase,
    too_expensive,
)
from rbsdem.model.column import SPRING_GROUPS, Column, Damping, bodies, notes_off
from rbsdem.model.springs import Spring
from rbsdem.run.accuracy import Answer, errors_of
from rbsdem.run.solver import IMPLICIT

#: First refinement of a method that was not run before: tolerance of rk45, and the part of the
#: stable step of rk4. Then the tolerance is divided by 100, down to the least, or the step by 2.
FIRST_TOLERANCE, LEAST_TOLERANCE, FIRST_SHARE = 1e-8, 1e-13, 16

#: A refinement has made progress if it reduces the difference of the two by this factor.
PROGRESS = 0.7


@dataclass(frozen=True)
class Reference:
    """The solution that errors are measured against.

    Attributes
    ----------
    first, second : str
        The two settings that were compared; the first one is the reference.
    digits : float
        Digits to which their responses agree: -log10 of the largest difference at any time of the
        loading over the peak.
    moment_digits, energy_digits, peak_digits : float
        The same for base moment (rms), energy at the end and peak.
    wanted : float
        Digits asked for.
    seconds : float
        Wall time of the reference [s].
    warning : str
        Remarks on it.
    explicit : bool or None
        Whether both methods are explicit; None if the path is static or the kinds differ.
    answer : Answer
        The solution.
    """

    first: str
    second: str
    digits: float
    moment_digits: float
    energy_digits: float
    peak_digits: float
    wanted: float
    seconds: float
    warning: str
    explicit: bool | None
    answer: Answer = field(repr=False, compare=False)

    @property
    def reached(self) -> bool:
        """Whether the two agree to the digits asked for."""
        return self.digits >= self.wanted

    @property
    def resolution(self) -> float:
        """Difference of the two methods: smaller errors cannot be measured."""
        worst = min(self.digits, self.moment_digits, self.energy_digits, self.peak_digits)
        return math.pow(10.0, -worst)


class _Ladder:
    """One method of the reference, refined step by step from the runs so far."""

    def __init__(self, first: Setting, trials: MethodRuns) -> None:
        self._trials = trials
        done = [run for run in trials.solved if run.setting.family == first.family]
        #: The finest run so far, and how far the answer moved with the last refinement.
        self.run = done[-1] if done else None
        self.moved = math.inf
        if len(done) > 1:
            self.moved = errors_of(done[-1].answer, done[-2].answer).response_max
        self.next = finer(done[-1].setting) if done else first
        self.trouble = ""

    def cost(self) -> float:
        """Return the estimated wall time of the next refinement [s]; infinite if there is none."""
        if self.next is None or self.trouble:
            return math.inf
        return self._trials.predicted(self.run, self.next)

    def refine(self) -> None:
        """Run the next finer setting."""
        if self.next is None:
            return
        self._trials.told(f"reference: {self.next}")
        run = self._trials.case.run(self.next)
        if not run.solution:
            self.trouble = run.reason
            return
        self.moved = self.apart(run)
        self.run, self.next = run, finer(self.next)

    def apart(self, other: MethodRun | None) -> float:
        """Return how far the answer of another run is from the finest one; infinite without it."""
        if self.run is None or other is None:
            return math.inf
        return errors_of(other.answer, self.run.answer).response_max


def finer(setting: Setting) -> Setting | None:
    """Return the next finer setting; None beyond the precision of the arithmetic."""
    if setting.dt is not None:
        return replace(setting, dt=setting.dt / 2)
    if setting.tolerance is None or setting.tolerance <= LEAST_TOLERANCE:
        return None
    return replace(setting, tolerance=max(setting.tolerance / 100, LEAST_TOLERANCE))


def digits(difference: float) -> float:
    """Return the digits of agreement of a relative difference, 16 at most."""
    return -math.log10(max(difference, 1e-16)) if math.isfinite(difference) else 0.0


def find_reference(trials: MethodRuns, share: float, wanted: float) -> Reference | str:
    """Return the reference, or why there is none."""
    if trials.case.static:
        return _static_reference(trials, wanted)
    candidates = _candidates(trials)
    refined = 0
    for ladder in candidates:
        # Finer than all settings; a method that was not run before needs two runs.
        for _ in range(1 if math.isfinite(ladder.moved) else 2):
            if refined < 2 and ladder.cost() < 0.25 * trials.budget.left(share):
                ladder.refine()
        refined += math.isfinite(ladder.moved) and not ladder.trouble
    # The two that their last refinement moved least.
    pair = sorted((one for one in candidates if one.run is not None), key=lambda one: one.moved)[:2]
    if len(pair) < 2:
        reasons = [ladder.trouble for ladder in candidates if ladder.trouble]
        return reasons[0] if reasons else "the budget does not allow two methods; give more of it"
    _bring_together(pair, trials.budget, share, wanted)
    # The reference is the one that its last refinement moved less.
    pair.sort(key=lambda ladder: ladder.moved)
    first, second = (ladder.run for ladder in pair if ladder.run is not None)
    return compare(first, second, wanted, "")


def _candidates(trials: MethodRuns) -> list[_Ladder]:
    """Return the methods that may make a reference, the most accurate first."""
    level, look = trials.case.column.kinematics, trials.look
    parts = max(math.ceil(look.interval / look.limit), 1) * FIRST_SHARE
    first = [
        Setting("rk45", level, tolerance=FIRST_TOLERANCE),
        Setting("rk4", level, dt=look.interval / parts, events="located"),
    ]
    if math.isfinite(look.implicit):
        parts = max(math.ceil(look.interval / (look.duration / 4000)), 1)
        methods = ("generalised_alpha", "newmark")
        first += [Setting(method, level, dt=look.interval / parts) for method in methods]
    return [_Ladder(setting, trials) for setting in first]


def _bring_together(pair: list[_Ladder], budget: Budget, share: float, wanted: float) -> None:
    """Refine both methods in turn until they agree or make no progress."""
    one, other = pair
    apart = other.apart(one.run)
    idle = 0
    while digits(apart) < wanted and idle < 4:
        # The one that its last refinement moved more; of equals the cheaper one.
        ready = [ladder for ladder in pair if ladder.cost() < budget.left(share)]
        if not ready:
            return
        max(ready, key=lambda ladder: (ladder.moved, -ladder.cost())).refine()
        now = other.apart(one.run)
        idle = idle + 1 if now > PROGRESS * apart else 0
        apart = min(apart, now)


def compare(first: MethodRun, second: MethodRun, wanted: float, warning: str) -> Reference:
    """Return the reference that two runs make."""
    apart = errors_of(second.answer, first.answer)
    parts = [warning] if warning else []
    if digits(apart.response_max) < wanted:
        parts.append(
            f"the two agree to {digits(apart.response_max):.1f} digits only, "
            f"{wanted:g} were wanted: errors below {apart.largest:.0e} cannot be measured"
        )
    kind = None
    implicit = [run.setting.method in IMPLICIT for run in (first, second)]
    if first.setting.method != "static" and any(implicit) == all(implicit):
        kind = not implicit[0]
    if all(implicit):
        parts.append("both methods are implicit and share the solver of the equations")
    if first.answer.response.size != second.answer.response.size:
        parts.append("the two do not end at the same time; the rows of both are compared")
    agreed = map(digits, (apart.response_max, apart.moment, apart.energy, apart.peak))
    response, moment, energy, peak = agreed
    found = response, moment, energy, peak, wanted, first.seconds, "; ".join(parts)
    return Reference(str(first.setting), str(second.setting), *found, kind, first.answer)


def _static_reference(trials: MethodRuns, wanted: float) -> Reference | str:
    """Return the path by small increments, checked by driving it the other way round.

    The response is driven in turn: forces that driven displacements give are driven as forces, or
    the reverse. This solves the same equations in another way and must give back what was driven
    first. A force that falls cannot be driven; the path is then compared with longer increments.
    """
    case = trials.case
    level = case.column.kinematics
    trials.told("reference: static")
    runs: list[MethodRun] = []
    trouble = ""
    for parts in (16, 4, 1) if level == "finite" else (1, 4):
        run = case.run(Setting("static", level, parts=parts))
        if not run.solution:
            trouble = run.reason
            continue
        back = _inverse(case, run.answer, parts)
        if back is not None:
            return compare(run, back, wanted, "the second drives the response of the first")
        runs.append(run)
    if len(runs) < 2:
        return trouble
    warning = "the response cannot be driven back; increments are compared"
    return compare(runs[0], runs[1], wanted, warning)


def _inverse(case: StudyCase, answer: Answer, parts: int) -> MethodRun | None:
    """Return the path driven by the response, its answer in what was driven first."""
    name, path = next(iter(case.loads.items()))
    other = "force" if name == "displacement" else "displacement"
    rows = answer.response.size
    if np.any(np.diff(answer.response) * np.diff(path[:rows]) < 0):
        # The force falls, or the displacement goes back: driven, it would lead elsewhere.
        return None
    inverse = replace(case, time=case.time[:rows], loads={other: answer.response})
    try:
        back = inverse.run(Setting("static", case.column.kinematics, parts=parts))
    except RbsdemError:
        return None
    if not back.solution or back.answer.response.size != rows:
        return None
    # The difference from what was driven, on the scale of the response.
    lost = (back.answer.response - path[:rows]) / max(np.abs(path).max(), 1e-300)
    setting = replace(back.setting, method=f"static driven by {other}")
    answer = replace(back.answer, response=answer.response + lost * answer.peak)
    return replace(back, setting=setting, repeats=1, reason="", solution=answer)


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
    for name in SPRING_GROUPS:
        springs = [spring.split(2) for spring in column.joints(name) for _ in range(2)]
        parts[name] = springs or None
    return dataclasses.replace(column, **parts)


def _little_inertia(column: Column) -> Column:
    few = [LITTLE_INERTIA * value for value in bodies(column)[2]]
    return dataclasses.replace(column, rotary_inertia=few, depth=0.0, top_inertia=0.0)


def variants(case: StudyCase, column: Column, axial: Spring | None) -> Iterator[Variant]:
    """Yield the models to compare with; each has one part changed."""
    moving = not case.static
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
    column = trials.case.column
    if not isinstance(column, Column):
        return ""
    several = list(variants(trials.case, column, axial))
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


def _base(trials: MethodRuns, reference: Reference | None, seconds: float) -> MethodRun | str:
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
        if run.solution:
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


def _effect(trials: MethodRuns, variant: Variant, base: MethodRun, tolerance: float) -> Effect:
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
    if not run.solution:
        return Effect(variant.name, status=run.status, reason=run.reason)
    return _compare(variant.name, run, base, tolerance)


def _compare(name: str, run: MethodRun, base: MethodRun, tolerance: float) -> Effect:
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
