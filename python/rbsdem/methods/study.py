"""A study of methods: settings, reference and physics of one case, within a budget."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._progress import progress_bar
from rbsdem._types import ArrayLike, DataFrame
from rbsdem.errors import InputError, SolveError
from rbsdem.methods.ladder import (
    Budget,
    MethodRun,
    MethodRuns,
    StudyCase,
    checked_methods,
    ladders,
    own_setting,
    probe,
    study_case,
)
from rbsdem.methods.physics import Physics, Reference, find_physics, find_reference
from rbsdem.model.springs import Spring
from rbsdem.motions.motion import GroundMotion, acting
from rbsdem.run.accuracy import Errors, errors_of
from rbsdem.run.solver import IMPLICIT, Solver
from rbsdem.section.frame import Structure

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
    """Return the table, with errors and front."""
    rows = []
    for run in runs:
        found: dict[str, float] = {}
        if run.solution:
            finer = _finer(runs, run)
            if finer is not None:
                found["move"] = errors_of(run.answer, finer.answer).largest
            if reference is not None:
                errors = errors_of(run.answer, reference.answer)
                # A run that ends at another time has another answer.
                apart = abs(run.answer.response.size - reference.answer.response.size)
                found |= asdict(errors) | {"error": math.inf if apart > 1 else errors.largest}
        rows.append(replace(run, **found))  # type: ignore[arg-type]
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
_TITLES = {"dt": "dt_s", "seconds": "wall_time_s", "moment": "base_moment_rms"}
_TITLES["move"] = "move_to_finer"


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
    found = physics if isinstance(physics, Physics) else None
    warnings += _warnings(case, rows, known)
    spent = clock.used(), budget
    return MethodStudy(rows, known, choice, found, case.response_name, *spent, tuple(warnings))


def _check(tolerance: float | None, budget: float, digits: float, repeats: int) -> None:
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
