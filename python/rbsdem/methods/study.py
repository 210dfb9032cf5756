"""A study of methods: reference, parts of the model and choice of one case, within a budget.

The reference is two independent methods, refined until they agree; a part of the model matters if
the answer changes where it is switched on or off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._progress import progress_bar
from rbsdem._types import ArrayLike, DataFrame
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.methods.ladder import (
    LEVELS,
    VERTICAL,
    Budget,
    MethodRun,
    MethodRuns,
    Setting,
    StudyCase,
    checked_methods,
    ladders,
    own_setting,
    probe,
    study_case,
    too_expensive,
)
from rbsdem.model.column import SPRING_GROUPS, Column, Damping, bodies, notes_off
from rbsdem.model.springs import Spring
from rbsdem.motions.motion import GroundMotion, acting
from rbsdem.run.accuracy import Answer, Errors, errors_of
from rbsdem.run.solver import IMPLICIT, Solver
from rbsdem.section.frame import Frame, Structure

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
    pair = sorted(
        (candidate for candidate in candidates if candidate.run is not None),
        key=lambda candidate: candidate.moved,
    )[:2]
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
        # At least 4000 steps in all.
        parts = max(math.ceil(look.interval / (look.duration / 4000)), 1)
        methods = ("generalised_alpha", "newmark")
        first += [Setting(method, level, dt=look.interval / parts) for method in methods]
    return [_Ladder(setting, trials) for setting in first]


def _bring_together(pair: list[_Ladder], budget: Budget, share: float, wanted: float) -> None:
    """Refine both methods in turn until they agree or make no progress."""
    first, second = pair
    apart = second.apart(first.run)
    idle = 0
    while digits(apart) < wanted and idle < 4:
        # The one that its last refinement moved more; of equals the cheaper one.
        ready = [ladder for ladder in pair if ladder.cost() < budget.left(share)]
        if not ready:
            return
        max(ready, key=lambda ladder: (ladder.moved, -ladder.cost())).refine()
        now = second.apart(first.run)
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
    # True if both are explicit, False if both are implicit.
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
    numbers = response, moment, energy, peak, wanted, first.seconds, "; ".join(parts)
    return Reference(str(first.setting), str(second.setting), *numbers, kind, first.answer)


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
    """Return the path driven by the response; None if that cannot be driven.

    Its response is that of `answer`, off by what the driven quantity lost on its way back.
    """
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

#: Columns of the table of effects whose names are not those of the attributes of `Effect`.
_OF_EFFECTS = {
    "moment": "peak_base_moment", "history": "response_rms", "time_ratio": "wall_time_ratio",
}  # fmt: skip

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
        Relative change of the peak response, of the peak base moment (of a frame base shear) and of
        the energy that springs and damping have taken by the end (relative to its largest value).
    residual : float
        Change of the response at the end over the peak response.
    history : float
        Root mean square change of the response over its peak.
    time_ratio : float
        Wall time over that of the model as given.
    matters : bool or None
        Whether peak, moment, energy or residual changes by more than the tolerance; None if the
        comparison could not be made.
    status, reason : str
        As for a setting.
    """

    part: str
    peak: float = math.nan
    residual: float = math.nan
    moment: float = math.nan
    energy: float = math.nan
    history: float = math.nan
    time_ratio: float = math.nan
    matters: bool | None = None
    status: str = "completed"
    reason: str = ""

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
        frame = data_frame(
            [asdict(effect) for effect in self.effects], [f.name for f in fields(Effect)]
        )
        told = frame["matters"].map({True: "yes", False: "no", None: ""})
        return frame.assign(matters=told).rename(columns=_OF_EFFECTS)


#: A model with one part changed: its name, how to make it, a load that is left out.
Variant: TypeAlias = tuple[str, Callable[[], Structure], str]


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
    return replace(column, **parts)


def variants(case: StudyCase, column: Structure, axial: Spring | None) -> Iterator[Variant]:
    """Yield the models to compare with; each has one part changed.

    `axial` is the spring of joints that open, tried where those of the column do not.
    """
    moving = not case.static
    if isinstance(column, Frame):
        yield from _variants_of_frame(column, moving=moving)
    if not isinstance(column, Column):
        return
    switches: list[tuple[object, str, dict[str, Any]]] = [
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
            yield f"kinematics {level}", partial(replace, column, kinematics=level), ""
    for there, name, changes in switches:
        if there:
            yield name, partial(replace, column, **changes), ""
    for name in VERTICAL:
        if name in case.loads:
            yield f"no {name}", lambda: column, name
    if moving:
        few = [LITTLE_INERTIA * value for value in bodies(column)[2]]
        name = f"rotary inertia x {LITTLE_INERTIA:g}"
        yield name, partial(replace, column, rotary_inertia=few, depth=0.0, top_inertia=0.0), ""
        if isinstance(column.damping, Damping) and column.damping.stiffness:
            tangent = not column.damping.tangent
            other = replace(column.damping, tangent=tangent)
            name = f"damping of {'tangent' if tangent else 'initial'} stiffness"
            yield name, partial(replace, column, damping=other), ""
    if column.top == "free" and column.footing is None:
        yield f"{2 * column.n} bodies", lambda: split_bodies(column), ""


def _variants_of_frame(frame: Frame, *, moving: bool) -> Iterator[Variant]:
    """Yield the changes that every frame can take; sections and joints are the user's to draw."""
    other = "pdelta" if frame.kinematics == "small" else "small"
    parts: list[tuple[object, str, dict[str, Any]]] = [
        (True, f"kinematics {other}", {"kinematics": other}),
        (frame.panel, "nodes without panels", {"panel": None}),
        (frame.losses, "no loss of members", {"losses": None}),
        (moving and frame.damping, "no damping", {"damping": None}),
    ]
    for there, name, changes in parts:
        if there:
            yield name, partial(replace, frame, **changes), ""


def find_physics(
    trials: MethodRuns, reference: Reference | None, tolerance: float | None, axial: Spring | None
) -> Physics | str:
    """Return the effect of each part of the model, or the reason why it is not known."""
    several = list(variants(trials.case, trials.case.column, axial))
    if not several:
        return ""
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
        trials.told(f"physics: {variant[0]}")
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
    name, make, without = variant
    try:
        with notes_off():
            column = make()
    except InputError as error:
        return Effect(name, status="refused", reason=str(error))
    case, left = trials.case, trials.budget.left()
    loads = {load: values for load, values in case.loads.items() if load != without}
    other = replace(case, loads=loads)
    setting = replace(base.setting, kinematics=column.kinematics)
    cost = base.seconds * (TWICE_THE_BODIES if column.n > case.column.n else 1)
    if cost > left:
        return Effect(name, status="skipped", reason=too_expensive(cost, left))
    run = other.run(setting, REPEATS, column, base.seconds)
    for _ in range(6):
        if run.status != "refused" or setting.method != "rk4" or setting.dt is None:
            break
        # The step is beyond the stability limit of this model.
        setting = replace(setting, dt=setting.dt / 2)
        run = other.run(setting, REPEATS, column, base.seconds)
    if not run.solution:
        return Effect(name, status=run.status, reason=run.reason)
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
    # A model that ends at another time has another answer.
    ends = new.response.size == old.response.size
    return replace(effect, matters=bool(effect.largest > tolerance or not ends))


# ---- the study ----------------------------------------------------------------------------------

#: Shares of the budget at which the settings, and then the reference, have to be done.
SETTINGS_SHARE, REFERENCE_SHARE = 0.4, 0.75


@dataclass(frozen=True)
class Choice:
    """The cheapest setting for a tolerance.

    Attributes
    ----------
    tolerance : float
        The error allowed.
    row : MethodRun or None
        The cheapest setting within it, all finer ones of its family within it too; None if there
        is no such setting.
    finer : MethodRun or None
        The next finer setting of its family.
    move : Errors or None
        The difference of the answers of the two.
    """

    tolerance: float
    row: MethodRun | None
    finer: MethodRun | None = None
    move: Errors | None = None

    def __str__(self) -> str:
        wanted = f"tolerance {self.tolerance:g}"
        if self.row is None:
            return f"{wanted}: no setting meets it"
        text = (
            f"{wanted}: {self.row.setting} costs {seconds_text(self.row.seconds)} and errs by "
            f"{self.row.error:.1e}"
        )
        if self.finer is None or self.move is None:
            return f"{text}; no finer one was run"
        return (
            f"{text}; the next finer one ({self.finer.setting.value}, "
            f"{seconds_text(self.finer.seconds)}) moves the answer by {self.move.largest:.1e}"
        )


def seconds_text(seconds: float) -> str:
    """Return a time with its unit, two digits."""
    if not math.isfinite(seconds):
        return "-"
    scales = ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
    scale, unit = next((pair for pair in scales if seconds >= pair[0]), scales[-1])
    value = seconds / scale
    return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"


def make_rows(runs: Sequence[MethodRun], reference: Reference | None) -> tuple[MethodRun, ...]:
    """Return the runs with their errors, the move to the next finer run, and the Pareto front."""
    rows = []
    for run in runs:
        changes: dict[str, float] = {}
        if run.solution:
            finer = _finer(runs, run)
            if finer is not None:
                changes["move"] = errors_of(run.answer, finer.answer).largest
            if reference is not None:
                errors = errors_of(run.answer, reference.answer)
                # A run that ends at another time has another answer.
                apart = abs(run.answer.response.size - reference.answer.response.size)
                changes |= asdict(errors) | {"error": math.inf if apart > 1 else errors.largest}
        rows.append(replace(run, **changes))  # type: ignore[arg-type]
    if reference is None:
        return tuple(rows)
    best = math.inf
    front = set()
    measured = [row for row in rows if math.isfinite(row.error)]
    for row in sorted(measured, key=lambda row: (row.seconds, row.error)):
        # Errors below the agreement of the reference cannot be told apart.
        error = max(row.error, reference.resolution)
        if error < best:
            best = error
            front.add(row.setting)
    return tuple(replace(row, pareto=row.setting in front) for row in rows)


def _finer(runs: Sequence[MethodRun], run: MethodRun) -> MethodRun | None:
    """Return the next finer run of a family that has an answer."""
    for other in runs[runs.index(run) + 1 :]:
        if other.setting.family != run.setting.family:
            return None
        if other.solution:
            return other
    return None


def cheapest(rows: Sequence[MethodRun], tolerance: float) -> MethodRun | None:
    """Return the cheapest row within a tolerance whose finer rows are within it too, or None."""
    able = []
    for place, row in enumerate(rows):
        finer = [r for r in rows[place + 1 :] if r.setting.family == row.setting.family]
        if row.error <= tolerance and not any(r.error > tolerance for r in finer):
            able.append(row)
    return min(able, key=lambda row: row.seconds, default=None)


def choose(rows: Sequence[MethodRun], tolerance: float) -> Choice:
    """Return the cheapest row within a tolerance, and the change by the next finer one."""
    row = cheapest(rows, tolerance)
    finer = _finer(rows, row) if row else None
    if finer is None or row is None:
        return Choice(tolerance, row)
    return Choice(tolerance, row, finer, errors_of(row.answer, finer.answer))


_OF_SETTING = ("method", "events", "kinematics", "dt", "tolerance", "parts")
_OF_RUN = ("seconds", "repeats", "response_rms", "response_max", "moment", "energy", "peak")
_OF_ROW = (*_OF_RUN, "error", "move", "pareto", "status", "reason")
_TITLES = {
    "dt": "dt_s",
    "seconds": "wall_time_s",
    "moment": "base_moment_rms",
    "move": "move_to_finer",
}


@dataclass(frozen=True, repr=False)
class MethodStudy(Tabular):
    """Wall time against accuracy in one case.

    Attributes
    ----------
    rows : tuple of MethodRun
        All settings, families together, coarse ones first.
    reference : Reference or None
        The solution that errors are measured against; None if there is none, as `warnings` says.
    choice : Choice or None
        The cheapest setting that meets the user's tolerance, if one was given.
    physics : Physics or None
        The change of the answer by each part of the model.
    response : str
        Kind of response: "displacement" or "force".
    seconds, budget : float
        Wall time used and wall time allowed [s].
    warnings : tuple of str
        What the table does not show.
    """

    rows: tuple[MethodRun, ...]
    reference: Reference | None
    choice: Choice | None
    physics: Physics | None
    response: str
    seconds: float
    budget: float
    warnings: tuple[str, ...] = ()

    def cheapest(self, tolerance: float) -> MethodRun | None:
        """Return the cheapest setting whose error is within a tolerance, or None.

        All finer settings of its family must be within it too, so that a setting which is accurate
        by chance is not taken.
        """
        return cheapest(self.rows, tolerance)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with a row for each setting: its cost, its errors, the front."""
        rows = [
            {name: getattr(row.setting, name) for name in _OF_SETTING}
            | {name: getattr(row, name) for name in _OF_ROW}
            for row in self.rows
        ]
        frame = data_frame(rows).fillna({"events": ""}).astype({"parts": "Int64", "pareto": int})
        return frame.rename(columns=_TITLES)


def compare_methods(
    column: Structure,
    time: ArrayLike | GroundMotion | None = None,
    *,
    force: ArrayLike | None = None,
    ground_acceleration: ArrayLike | GroundMotion | None = None,
    displacement: ArrayLike | None = None,
    vertical_acceleration: ArrayLike | GroundMotion | None = None,
    axial_load: ArrayLike | None = None,
    initial: Mapping[str, ArrayLike] | None = None,
    methods: Sequence[str] | None = None,
    setting: Solver | None = None,
    tolerance: float | None = None,
    budget: float = 60.0,
    digits: float = 8.0,
    axial_spring: Spring | None = None,
    collapse_drift: float | None = None,
    repeats: int = 3,
    progress: bool = False,
) -> MethodStudy:
    """Measure what accuracy costs in a case, and which physics it needs.

    The case is run over methods, steps or tolerances, ways of locating events and the levels of
    kinematics up to that of the column. Each answer is compared with a reference on which two
    methods agree. Then single parts of the model are switched off, or on. All runs are made in this
    process, one after the other.

    Parameters
    ----------
    column : Column or Frame
        The structure. Its kinematics are those of the reference. Of a frame no parts of the model
        are switched.
    time : array_like of shape (m,), or GroundMotion, optional
        Times of the loading [s], or the motion of the ground. Without times and without a
        `GroundMotion` the path is static.
    force : array_like, shape (m,), optional
        Lateral force at the top [N]; without time it drives the static path.
    ground_acceleration, vertical_acceleration : array_like or GroundMotion, optional
        Accelerations of the ground [m/s2], shape (m,).
    axial_load : array_like, shape (m,), optional
        Axial load, in addition to that of the column [N].
    initial : mapping, optional
        Slips, rotations and their velocities at the start, as for `rbsdem.time_history`.
    displacement : array_like, shape (m,), optional
        Displacement of the top that drives a static path [m]; the response is then the force.
    methods : sequence of str, optional
        The methods in time to try; by default all of them.
    setting : Solver, optional
        A further setting to measure: method, dt, tolerance, events, rho_infinity.
    tolerance : float, optional
        Relative error allowed. The cheapest setting within it is named, and a part of the model
        matters if it changes the answer by more.
    budget : float, optional
        Wall time [s]. A run that would not fit is left out, and the table says so; a run that has
        begun is finished.
    digits : float, optional
        Digits to which the two methods of the reference should agree.
    axial_spring : Spring, optional
        Axial spring of the joints. If the joints of the column do not open, it shows whether
        their opening matters.
    collapse_drift : float, optional
        As for `rbsdem.time_history`.
    repeats : int, optional
        Runs of each setting; the median of their wall times counts. Very short runs are repeated
        more often, long ones less.
    progress : bool, optional
        Show on stderr what is being done and how much of the budget is used.

    Returns
    -------
    MethodStudy
        Tables, figure and choice.

    Raises
    ------
    InputError
        For bad input, also where no setting can solve the case.
    SolveError
        If every setting fails.
    """
    _check(tolerance, budget, digits, repeats)
    tried = checked_methods(methods)
    if axial_spring is not None and not isinstance(axial_spring, Spring):
        raise InputError(f"compare_methods: axial_spring = {axial_spring!r} must be a spring")
    loads = {
        "displacement": displacement,
        "force": force,
        "ground_acceleration": ground_acceleration,
        "vertical_acceleration": vertical_acceleration,
        "axial_load": axial_load,
    }
    time, arrays = acting(time, loads, "compare_methods")
    case = study_case(column, time, arrays, initial, collapse_drift)
    clock = Budget(float(budget))
    wanted = _arguments.boolean(progress, "compare_methods: progress")
    # Drawn between runs only, so that no thread disturbs what is timed.
    with progress_bar(wanted, round(clock.seconds), "s", between=True) as show:

        def told(text: str) -> None:
            show(int(clock.used()), text)

        told("first look")
        trials = MethodRuns(case, probe(case), clock, told)
        families = ladders(case, trials.look, tried)
        if setting is not None and not case.static:
            families.insert(0, [own_setting(column, setting)])
        trials.climb(families, SETTINGS_SHARE, repeats)
        _need_one(trials.runs)
        reference = find_reference(trials, REFERENCE_SHARE, digits)
        known = reference if isinstance(reference, Reference) else None
        physics = find_physics(trials, known, tolerance, axial_spring)
    warnings = [f"reference: {reference}"] if known is None else []
    if isinstance(physics, str) and physics:
        warnings.append(f"physics: {physics}")
    rows = make_rows(trials.runs, known)
    choice = None if tolerance is None else choose(rows, tolerance)
    effects = physics if isinstance(physics, Physics) else None
    warnings += _warnings(case, rows, known)
    spent = clock.used(), budget
    return MethodStudy(rows, known, choice, effects, case.response_name, *spent, tuple(warnings))


def _check(tolerance: float | None, budget: float, digits: float, repeats: int) -> None:
    """Refuse numbers outside of their ranges."""
    who = "compare_methods: "
    if tolerance is not None:
        _arguments.number(tolerance, f"{who}tolerance", above=0, below=1)
    _arguments.number(budget, f"{who}budget", above=0, unit="s")
    _arguments.number(digits, f"{who}digits", above=0, most=15)
    _arguments.integer(repeats, f"{who}repeats", least=1)


def _need_one(runs: Sequence[MethodRun]) -> None:
    """Raise the error of the last run if no setting has an answer."""
    if any(run.solution for run in runs):
        return
    for status, error in (("failed", SolveError), ("refused", InputError)):
        for run in reversed(runs):
            if run.status == status:
                raise error(
                    f"compare_methods: no setting solves the case; {run.setting}: {run.reason}"
                )
    raise InputError(f"compare_methods: the budget is too small for any setting; {runs[0].reason}")


def _warnings(case: StudyCase, rows: Sequence[MethodRun], reference: Reference | None) -> list[str]:
    """Return warnings that the table does not show."""
    warnings = []
    third = None
    if reference is not None and reference.explicit is not None:
        # The most accurate implicit setting if the reference is explicit, and vice versa.
        known = [row for row in rows if row.setting.method != "auto" and math.isfinite(row.error)]
        kind = reference.explicit
        others = [row for row in known if (row.setting.method in IMPLICIT) == kind]
        third = min(others, key=lambda row: row.error, default=None)
    if third is not None:
        warnings.append(
            f"a method of another kind, {third.setting}, comes to within {third.error:.1e} of the "
            "reference"
        )
    if any(row.status == "skipped" for row in rows):
        warnings.append("some settings did not fit into the budget; a larger one tries them")
    if case.static and case.column.kinematics != "finite":
        warnings.append("the static path is exact; errors come from the points that are left out")
    return warnings
