"""The function `compare_methods`: settings, reference and physics of one case, within a budget."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext

from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem.errors import InputError, SolveError
from rbsdem.methods.answer import Run
from rbsdem.methods.ladder import Budget, checked_methods, climb, ladders, own_setting, probe
from rbsdem.methods.physics import Physics, find_physics
from rbsdem.methods.reference import Reference, find_reference
from rbsdem.methods.rows import MethodStudy, Row, choose, make_rows, third_method
from rbsdem.methods.scene import Scene, make_scene
from rbsdem.model.column import Column
from rbsdem.model.springs import Spring
from rbsdem.motions.acting import acting
from rbsdem.motions.motion import GroundMotion
from rbsdem.solve.solver import Solver

#: Shares of the budget at which the settings, and then the reference, have to be done.
SETTINGS_SHARE, REFERENCE_SHARE = 0.4, 0.75


def compare_methods(
    column: Column,
    time: ArrayLike | None = None,
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
    column : Column
        The column. Its kinematics are those of the reference.
    time : array_like, shape (m,), optional
        Times of the loading [s]. Without it and without a `GroundMotion` the path is static.
    force : array_like, shape (m,), optional
        Lateral force at the top [N]; without time it drives the static path.
    ground_acceleration, vertical_acceleration : array_like or GroundMotion, optional
        Accelerations of the ground [m/s2], shape (m,).
    axial_load : array_like, shape (m,), optional
        Axial load, in addition to that of the column [N].
    initial : mapping, optional
        State at the start, as for `rbsdem.time_history`.
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
        Show the progress on stderr; needs rich.

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
    wanted = checked_methods(methods)
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
    scene = make_scene(column, time, arrays, initial, collapse_drift)
    clock = Budget(budget)
    with _telling(progress, clock) as told:
        told("first look")
        look = None if scene.static else probe(scene)
        families = ladders(scene, look, wanted)
        if setting is not None and not scene.static:
            families.insert(0, [own_setting(column, setting)])
        runs = climb(scene, families, look, clock, SETTINGS_SHARE, repeats, told)
        _need_one(runs)
        reference = find_reference(scene, look, runs, clock, REFERENCE_SHARE, digits, told)
        known = reference if isinstance(reference, Reference) else None
        physics = find_physics(scene, look, known, runs, clock, tolerance, axial_spring, told)
    notes = [f"reference: {reference}"] if known is None else []
    if isinstance(physics, str):
        notes.append(f"physics: {physics}")
    rows = make_rows(runs, known)
    return MethodStudy(
        rows,
        known,
        None if tolerance is None else choose(rows, runs, tolerance),
        physics if isinstance(physics, Physics) else None,
        scene.response_name,
        clock.used(),
        budget,
        tuple(notes + _notes(scene, rows, known)),
    )


def _check(tolerance: float | None, budget: float, digits: float, repeats: int) -> None:
    who = "compare_methods: "
    if tolerance is not None and not 0 < _arguments.number(tolerance, f"{who}tolerance") < 1:
        raise InputError(f"{who}tolerance = {tolerance!r} must be above 0 and below 1")
    if not 0 < _arguments.number(budget, f"{who}budget") < math.inf:
        raise InputError(f"{who}budget = {budget!r} must be a positive number of seconds")
    if not 0 < _arguments.number(digits, f"{who}digits") <= 15:
        raise InputError(f"{who}digits = {digits!r} must be above 0 and at most 15")
    if _arguments.whole(repeats, f"{who}repeats") < 1:
        raise InputError(f"{who}repeats = {repeats!r} must be a whole number, 1 or more")


def _telling(progress: bool, clock: Budget) -> AbstractContextManager[Callable[[str], None]]:
    wanted = _arguments.switch(progress, "compare_methods: progress")
    return _shown(clock) if wanted else nullcontext(lambda text: None)


def _need_one(runs: Sequence[Run]) -> None:
    """Raise the error of the last run if no setting has an answer."""
    if any(run.answer is not None for run in runs):
        return
    for status, error in (("failed", SolveError), ("refused", InputError)):
        for run in reversed(runs):
            if run.status == status:
                raise error(
                    f"compare_methods: no setting solves the case; {run.setting}: {run.reason}"
                )
    raise InputError(f"compare_methods: the budget is too small for any setting; {runs[0].reason}")


def _notes(scene: Scene, rows: Sequence[Row], reference: Reference | None) -> list[str]:
    """Return remarks that the table does not show."""
    notes = []
    third = third_method(rows, reference)
    if third is not None:
        notes.append(
            f"a method of another kind, {third.setting}, comes to within {third.error:.1e} of the "
            "reference"
        )
    if any(row.status == "skipped" for row in rows):
        notes.append("some settings did not fit into the budget; a larger one tries them")
    if scene.static and scene.column.kinematics != "finite":
        notes.append("the static path is exact; errors come from the points that are left out")
    return notes


@contextmanager
def _shown(clock: Budget) -> Iterator[Callable[[str], None]]:
    """Show on stderr what is being done and how much of the budget is used.

    Drawn between runs only, so that no thread disturbs what is timed.
    """
    import rich.progress  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=20),
        rich.progress.TextColumn("{task.completed:.0f} of {task.total:.0f} s  {task.description}"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=clock.seconds)

        def told(text: str) -> None:
            bar.update(task, completed=clock.used(), description=text, refresh=True)

        yield told
