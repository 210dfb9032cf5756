"""The result of an analysis: its rows, what they reach and mean, how they are kept."""

from __future__ import annotations

import contextlib
import functools
import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Concatenate, ParamSpec, Protocol, cast, overload

import numpy as np

from rbsdem import _arguments
from rbsdem.checks.criteria import all_thresholds
from rbsdem.checks.limit_states import Hinge, LimitStates
from rbsdem.checks.limit_states import hinge as hinge_of
from rbsdem.checks.limit_states import limit_states as find_limit_states
from rbsdem.errors import InputError, SolveError
from rbsdem.model.column import Column
from rbsdem.model.frame import Frame, Structure
from rbsdem.model.frame_result import FrameResult
from rbsdem.model.response import Response
from rbsdem.run import analysis
from rbsdem.run.accuracy import Errors, refined_error
from rbsdem.run.solver import METHODS

P = ParamSpec("P")

#: Most steps times bodies of a run that is short enough to be done once more.
_SHORT = 50_000


@dataclass(frozen=True)
class ErrorEstimate:
    """What is known of the error of one result.

    Attributes
    ----------
    method : str
        The method that was used.
    measured : float
        The largest of `Result.refined_error`, where that run is short; NaN where it is not, and for
        a static path.
    usual, largest : float
        Error of the method at its own step or tolerance, relative to the peaks: median and largest
        of the responses of ``studies/error_classes.py``, which say little of another one. 0 for a
        static path, which is exact but for round-off.
    responses : int
        How many responses those were.
    own_setting : bool
        Whether the result has this step or tolerance; else a setting of the user.
    energy : float
        What is missing in the energy balance of this result, over its largest energy. It is no
        measure of the response, which may err by much more.
    """

    method: str
    measured: float
    usual: float
    largest: float
    responses: int
    own_setting: bool
    energy: float

    def __str__(self) -> str:
        if not self.usual > 0:
            return f"{self.method}: exact but for round-off"
        at = "" if self.own_setting else " at its own setting, which this is not"
        tried = (
            f"{self.usual:g} in the median of {self.responses} other responses, "
            f"{self.largest:g} at most{at}"
        )
        if math.isnan(self.measured):
            return f"{self.method}: errors over the peaks: {tried}; refined_error() measures it"
        return (
            f"{self.method}: error about {self.measured:.1g} of the peaks, by a finer run ({tried})"
        )


@dataclass(frozen=True, repr=False, eq=False)
class Result(Response):
    """What `cyclic` and `time_history` return: a response with what it reaches and means."""

    def limit_states(self) -> LimitStates:
        """Return the limit states that the response reaches, with row, drift and source.

        A layered hinge that knows its drawing: cracking, first yield, nominal moment, yield of the
        hoops, spalling, the tensile strain before bars buckle, fracture of hoops and bars, by the
        strains of its layers (in time the analysis needs ``openings=True``); other layered joints:
        where a layer yields in tension. Other springs: their `Spring.landmarks`, cracking, yield
        and cap.
        All: the same of shear springs, loss of 20 % of the strength, collapse, loss of the axial
        load. Nothing of the response is changed.

        Raises
        ------
        InputError
            If the openings of a layered hinge were not kept in time.
        """
        return find_limit_states(self)

    def hinge(self, joint: int = 1, *, length: float | None = None) -> Hinge:
        """Return rotation, plastic rotation and curvature of a hinge.

        Parameters
        ----------
        joint : int, optional
            The joint, from 1 at the ground to n.
        length : float, optional
            Length of the hinge for its curvature [m]. Known of the hinge of a column that was made
            from its drawing by the layered model.

        Raises
        ------
        InputError
            If there is no such joint, or the openings of a layered hinge were not kept in time.
        """
        return hinge_of(self, joint, length)

    @property
    def error_estimate(self) -> ErrorEstimate:
        """What is known of the error: measured where that takes about 0.1 s, else by its method."""
        about = self.summary
        method = METHODS[about["method"]]
        short = self.dynamic and about["steps"] * self.column.n <= _SHORT
        measured = math.nan
        if short and about["status"] == "completed":
            with contextlib.suppress(SolveError):
                measured = self.refined_error().largest
        usual = method.usual_error, method.largest_error, method.responses
        own = not {"dt", "tolerance", "rho_infinity"} & set(self.call)
        energy = about["relative_energy_residual"]
        return ErrorEstimate(method.name, measured, *usual, own, energy)

    def refined_error(self) -> Errors:
        """Solve once more by the next finer setting and return the distance to it.

        That is half the step, or a hundredth of the tolerance, or half of the increments of a
        static path, by the same method. Where the error falls with the setting, as it does unless
        the response is chaotic, it is about as large as this distance. With a tolerance that cannot
        be made much sharper it is the distance to one a hundred times as large, which is more than
        the error. Nothing is below the last digits of the numbers, 2.2e-16 times the root of the
        number of rows.

        Returns
        -------
        rbsdem.run.accuracy.Errors
            Relative differences of the response (rms and largest), of the base moment, the energy
            and the peak; `largest` is the largest of them.

        Raises
        ------
        SolveError
            If the finer setting does not solve the case.
        """
        return refined_error(self)


Result.__doc__ = Response.__doc__


def result_of(response: Any) -> Any:
    """Return a response as the object that users get; that of a frame is one already."""
    if not isinstance(response, Response):
        return response
    return Result(**{field: getattr(response, field) for field in response.__dataclass_fields__})


class Analysis(Protocol[P]):
    """An analysis: what it returns depends on the structure."""

    @overload
    def __call__(self, column: Column, *arguments: P.args, **options: P.kwargs) -> Result: ...
    @overload
    def __call__(self, column: Frame, *arguments: P.args, **options: P.kwargs) -> FrameResult: ...
    @overload
    def __call__(
        self, column: Structure, *arguments: P.args, **options: P.kwargs
    ) -> Result | FrameResult: ...


#: An analysis that returns plain responses.
Plain = Callable[Concatenate[Structure, P], Response | FrameResult]


def _public(run: Plain[P], documented: Callable[..., Any]) -> Analysis[P]:
    """Return an analysis with a `Result` in place of the plain response."""

    @functools.wraps(documented)
    def analyse(column: Structure, *arguments: P.args, **options: P.kwargs) -> Any:
        try:
            return result_of(run(column, *arguments, **options))
        except SolveError as error:
            error.result = result_of(error.result)
            raise

    signature = inspect.signature(run).replace(return_annotation="Result | FrameResult")
    analyse.__signature__ = signature  # type: ignore[attr-defined]
    return cast("Analysis[P]", analyse)


def _watched(run: Callable[Concatenate[analysis.Watch, Structure, P], Any]) -> Plain[P]:
    """Return the analysis in time that watches the limit states of its column."""
    return functools.partial(run, all_thresholds)


def pushover(
    structure: Structure,
    *,
    drift: float | None = None,
    displacement: float | None = None,
    force: float | None = None,
    pattern: str | None = None,
    points: int = 100,
    initial: Any = None,
) -> Any:
    """Push a frame or a column to one side, from event to event.

    Parameters
    ----------
    structure : Frame or Column
        The structure; a frame stands under its dead load already.
    drift, displacement, force : float, optional
        How far: displacement of the top over the height, displacement [m], or lateral force [N];
        exactly one of them. Under a force a path ends where the structure can carry no more.
    pattern : str, optional
        Shares of the lateral load of a frame in place of its own, see `Frame`.
    points : int, optional
        Rows at equal steps; there is one at each event in addition.
    initial : FrameResult, Result or path, optional
        What the path begins in.

    Returns
    -------
    FrameResult or Result
        With a row for each point and each event; `events` are the limit states in their order. A
        path that ends before is a result too: its `summary` has "ended" as status, and why as
        reason. `cyclic`, whose path is prescribed, raises `SolveError` there.
    """
    given = {"drift": drift, "displacement": displacement, "force": force}
    said = [name for name, value in given.items() if value is not None]
    if len(said) != 1:
        raise InputError("pushover: give exactly one of drift, displacement and force")
    if pattern is not None:
        if not isinstance(structure, Frame):
            raise InputError("pushover: pattern is for frames; a column is pushed at its top")
        structure = replace(structure, pattern=pattern)  # type: ignore[arg-type]
    far = _arguments.number(given[said[0]], f"pushover: {said[0]}")
    if not math.isfinite(far) or far == 0:
        raise InputError(f"pushover: {said[0]} = {far:g} must be a finite number that is not 0")
    if said[0] == "drift":
        far *= structure.height
    points = _arguments.integer(points, "pushover: points")
    if points < 1:
        raise InputError(f"pushover: points = {points} must be 1 or more")
    name = "force" if said[0] == "force" else "displacement"
    way: dict[str, Any] = {name: far * np.arange(1, points + 1) / points}
    try:
        return cyclic(structure, **way, initial=initial, corners=True)
    except SolveError as error:
        if error.result is None or len(error.result.displacement) == 0:
            raise
        error.result.summary.update(status="ended", reason=str(error))
        return error.result


cyclic = _public(analysis.cyclic, analysis.cyclic)
time_history = _public(_watched(analysis.time_history), analysis.time_history)
