"""The function `calibrate`: search, refusals, and what the test determines."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np

from rbsdem import _arguments
from rbsdem._package import unwarned
from rbsdem._progress import progress_bar
from rbsdem._types import Array
from rbsdem.calibration.outcome import (
    AnyStructure,
    Calibration,
    determine,
    refuse,
    warnings_of,
    without_effect,
)
from rbsdem.calibration.paths import Parameters, free_parameters
from rbsdem.calibration.search import LOSSES, Misfit, Search, Target
from rbsdem.curves.scores import Comparison, compare
from rbsdem.errors import warn
from rbsdem.model.column import Parameter
from rbsdem.model.frame import Structure
from rbsdem.run.result import reached_force

#: Number of random points, besides the start, at which the effect of a parameter is tried.
_LOOKS = 3


def free_names(column: Structure) -> dict[str, Parameter | None]:
    """Return the parameters of a column that may be free, with default bounds.

    Parameters
    ----------
    column : Column or Frame
        The column.

    Returns
    -------
    dict of str to Parameter or None
        Parameters by name; None if a calibration needs given bounds, as for a stiffness of 0.
    """
    return Parameters(column).known()


def undetermined(
    column: Structure,
    test: Any,
    free: Sequence[str],
    bounds: Mapping[str, Sequence[float]] | None = None,
) -> list[str]:
    """Return the parameters that a calibration would refuse: they change no force of the test.

    Parameters
    ----------
    column : Column or Frame
        The column.
    test : MeasuredTest, PeerTest, or pair of array_like of shape (m,)
        The measured loop.
    free : sequence of str
        Names of the parameters.
    bounds : mapping of str to (low, high), optional
        As for `calibrate`.

    Returns
    -------
    list of str
        Those that change no force between their bounds, from the start and from random points.

    Raises
    ------
    InputError
        For bad input.
    """
    target, parameters = Target(test), Parameters(column)
    chosen = free_parameters(parameters, free, bounds)
    with (
        unwarned(),
        Misfit(parameters.build, chosen, target, "nrmse", 1, lambda done, best: None) as misfit,
    ):
        return without_effect(misfit, _looks(misfit.start_places(), 0))


def calibrate(
    column: AnyStructure,
    test: Any,
    free: Sequence[str],
    bounds: Mapping[str, Sequence[float]] | None = None,
    loss: str = "nrmse",
    seed: int = 0,
    progress: bool = False,
    jobs: int = 1,
    *,
    evaluations: int = 800,
    seconds: float | None = None,
) -> Calibration[AnyStructure]:
    """Fit parameters of a column to a measured loop.

    The column is driven through the measured displacements. The error of the force is minimised by
    a Latin hypercube over the bounds and least squares from its best points (scipy). The same input
    gives the same fit.

    Parameters
    ----------
    column : Column or Frame
        The structure to start from. A column made from a drawing offers its parameters as
        `parameters` and changes them by `with_parameters`; in any other the names are paths, in a
        frame of its kinds of members (`Frame.named_kinds`).
    test : MeasuredTest, PeerTest, or pair of array_like of shape (m,)
        The measured loop: displacement [m] and net horizontal force [N], as for `rbsdem.compare`.
    free : sequence of str
        Names of the parameters to fit, such as "flexure.k_y", "shear.k", "flexure[0].d_y" (of the
        lowest joint), "flexure[*].k_y" (a factor on all joints); `free_names` lists them.
    bounds : mapping of str to (low, high), optional
        Bounds in place of the default ones, which are a factor of 5 up and down for a spring, as
        far as its rule allows, and 20 % for lengths and loads.
    loss : {"nrmse", "balanced"}, optional
        The error that is minimised: that of the force, alone or together with the errors of peak
        force and energy.
    seed : int, optional
        Seed of the random points.
    progress : bool, optional
        Show on stderr the number of finished analyses and the best error so far.
    jobs : int, optional
        Analyses at a time, in threads. The fit does not depend on it.
    evaluations : int, optional
        Approximate limit for the analyses of the search. A few more show what the test determines.
    seconds : float, optional
        Wall time after which the search ends [s]; the fit then depends on the machine.

    Returns
    -------
    Calibration
        The fitted column, its parameters with standard errors and sensitivities, report and figure.
        A keyboard interrupt ends the search; the best fit so far is returned.

    Raises
    ------
    InputError
        For wrong input (unknown or repeated names, bounds that exclude the start), and for a
        parameter that changes no force of the test anywhere between its bounds.

    Warns
    -----
    AccuracyWarning
        If the test hardly determines a parameter, or does not distinguish two of them.
    """
    started = time.perf_counter()
    loss = _arguments.choice(loss, "calibrate: loss", LOSSES)
    _check(seed, jobs, evaluations, seconds)
    target = Target(test)
    parameters = Parameters(column)
    chosen = free_parameters(parameters, free, bounds)
    wanted = _arguments.boolean(progress, "calibrate: progress")
    showing = progress_bar(wanted, evaluations, "analyses")
    # Warnings about the many columns of the search do not help the user.
    with unwarned(), showing as show:
        with Misfit(parameters.build, chosen, target, loss, jobs, show) as misfit:
            start = misfit.start_places()
            misfit.column(start)
            refuse(misfit, without_effect(misfit, _looks(start, seed)))
            status = Search(misfit, seed, evaluations, seconds).run()
            places = misfit.best_places.copy()
            found, correlation = determine(misfit, places)
        fitted = cast(AnyStructure, misfit.column(places))
        before, after = (_compared(tried, target, column) for tried in (column, fitted))
    lines = tuple(warnings_of(found, correlation))
    for line in lines:
        warn(f"calibrate: {line}")
    return Calibration(
        column=fitted,
        start=column,
        parameters=found,
        before=before,
        after=after,
        correlation=correlation,
        status=status,
        warnings=lines,
        loss=loss,
        seed=seed,
        **{name: getattr(misfit, name) for name in ("evaluations", "failed", "refused")},
        seconds=time.perf_counter() - started,
    )


def _check(seed: int, jobs: int, evaluations: int, seconds: float | None) -> None:
    _arguments.integer(seed, "calibrate: seed", least=0)
    _arguments.integer(jobs, "calibrate: jobs", least=1)
    _arguments.integer(evaluations, "calibrate: evaluations", least=1)
    if seconds is not None:
        _arguments.number(seconds, "calibrate: seconds", above=0)


def _looks(start: Array, seed: int) -> list[Array]:
    """Return the points from which the effect of each parameter is tried."""
    return [start, *np.random.default_rng(seed).random((_LOOKS, start.size))]


def _compared(column: Structure, target: Target, start: Structure) -> Comparison:
    """Return the scores of a column; the force is NaN after the end of a failed analysis."""
    reached, _ = reached_force(column, target.displacement)
    force = np.full(target.force.size, np.nan)
    force[: reached.size] = reached
    loop = target.displacement, force
    return compare(loop, target, height=getattr(start, "height", None))
