"""The reference of a study of methods: two independent methods, refined until they agree."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from rbsdem.errors import RbsdemError
from rbsdem.methods.ladder import Budget, MethodRuns
from rbsdem.methods.study_case import Setting, SolvedRun, StudyCase
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
    note : str
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
    note: str
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
        if not isinstance(run, SolvedRun):
            self.trouble = run.reason
            return
        self.moved = self.apart(run)
        self.run, self.next = run, finer(self.next)

    def apart(self, other: SolvedRun | None) -> float:
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


def compare(first: SolvedRun, second: SolvedRun, wanted: float, note: str) -> Reference:
    """Return the reference that two runs make."""
    apart = errors_of(second.answer, first.answer)
    parts = [note] if note else []
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
    runs: list[SolvedRun] = []
    trouble = ""
    for parts in (16, 4, 1) if level == "finite" else (1, 4):
        run = case.run(Setting("static", level, parts=parts))
        if not isinstance(run, SolvedRun):
            trouble = run.reason
            continue
        back = _inverse(case, run.answer, parts)
        if back is not None:
            return compare(run, back, wanted, "the second drives the response of the first")
        runs.append(run)
    if len(runs) < 2:
        return trouble
    note = "the response cannot be driven back; increments are compared"
    return compare(runs[0], runs[1], wanted, note)


def _inverse(case: StudyCase, answer: Answer, parts: int) -> SolvedRun | None:
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
    if not isinstance(back, SolvedRun) or back.answer.response.size != rows:
        return None
    # The difference from what was driven, on the scale of the response.
    lost = (back.answer.response - path[:rows]) / max(np.abs(path).max(), 1e-300)
    setting = replace(back.setting, method=f"static driven by {other}")
    answer = replace(back.answer, response=answer.response + lost * answer.peak)
    return replace(back, setting=setting, repeats=1, reason="", answer=answer)
