"""What a case asks beside its analysis: target displacement, records beside it, acceptance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from rbsdem._arguments import collected, raise_faults
from rbsdem._files import text_table
from rbsdem.checks.acceptance import LEVELS, Assessment, assess, limits_given
from rbsdem.checks.target import Target, target
from rbsdem.errors import InputError
from rbsdem.many.check_target import TargetCheck, check_target
from rbsdem.motions.design import DesignSpectrum
from rbsdem.motions.read import read_motion, read_motions
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.case import Case
from rbsdem.run.frame_result import FrameResult
from rbsdem.run.response import pushover
from rbsdem.run.solver import PathMethod
from rbsdem.section.frame import Frame

#: Keys of a spectrum, by its code.
_SPECTRA: dict[str, tuple[str, ...]] = {
    "en_1998": ("ag", "soil", "kind", "damping"),
    "asce_41": ("s_xs", "s_x1", "long_period", "damping"),
}
_NEEDED = {"en_1998": ("ag",), "asce_41": ("s_xs", "s_x1")}


@dataclass(frozen=True, eq=False)
class Judgement:
    """A case with what it asks for.

    Attributes
    ----------
    result : FrameResult or BuildingResult
        The push-over to the largest displacement of the loading, or the response in time.
    target : Target or None
        Its target displacement, if the case has a `&target`.
    check : TargetCheck or None
        The error of that under the records of the case.
    assessments : list of Assessment
        One for each `&assess`.
    levels : list of str
        The level that each of them is judged at.
    """

    result: FrameResult | BuildingResult
    target: Target | None
    check: TargetCheck | None
    assessments: list[Assessment]
    levels: list[str]

    def __str__(self) -> str:
        """Return what was found, a line each."""
        lines = [] if self.target is None else [str(self.target)]
        lines += [] if self.check is None else [str(self.check)]
        for assessment, level in zip(self.assessments, self.levels, strict=True):
            word = "accepted" if assessment.accepted(level) else "not accepted"
            lines += [str(assessment), f"{word} at {level}; the largest ratios:"]
            lines.append(text_table(assessment.worst(5, level)))
        return "\n".join(lines)


def asked(case: Case) -> bool:
    """Return whether a case asks for more than its rows."""
    return bool(case.target or case.assess)


def checked(case: Case) -> tuple[DesignSpectrum | None, list[str]]:
    """Return the spectrum of a case and the level of each assessment.

    Raises
    ------
    InputError
        If what it asks for cannot be done: a line for each fault.
    """
    faults: list[str] = []
    if asked(case) and not isinstance(case.column, Frame):
        faults.append("target, assess: they are for frames; remove them from the case of a column")
    if case.target and (case.dynamic or case.displacement is None):
        faults.append(
            "target: it is that of a push-over; give drive = 'displacement' without times"
        )
    if case.records and not Path(case.records["path"]).exists():
        faults.append(f"records: path = {case.records['path']} is not there; correct it")
    spectrum = None
    with collected(faults):
        spectrum = _spectrum(case.target) if case.target else None
    levels = []
    for group in case.assess:
        known = LEVELS[group["code"]]
        levels.append(group.get("level", known[-1]))
        if levels[-1] not in known:
            faults.append(
                f"assess: level = {levels[-1]!r} is none of {group['code']}; it is one of "
                f"{', '.join(known)}"
            )
        if isinstance(case.column, Frame):
            with collected(faults):
                limits_given(case.column, group["code"], _limits_of(case, group["code"]))
    raise_faults(faults)
    return spectrum, levels


def _limits_of(case: Case, code: str) -> dict[str, Any]:
    """Return the limits that a case gives for a code, by names of members and nodes."""
    given = (limit for limit in case.limit if limit.get("code", code) == code)
    return {limit["member"]: limit["rotations"] for limit in given}


def _spectrum(group: Mapping[str, Any]) -> DesignSpectrum:
    """Return the spectrum that the group &target states."""
    code = group["spectrum"]
    for name in _NEEDED[code]:
        if name not in group:
            raise InputError(f"target: {name} is missing; spectrum = {code!r} needs it")
    others = {name for names in _SPECTRA.values() for name in names} - {*_SPECTRA[code]}
    for name in others & group.keys():
        raise InputError(f"target: {name} is not of spectrum = {code!r}; remove it")
    values = {name: group[name] for name in _SPECTRA[code] if name in group}
    return (DesignSpectrum.en_1998 if code == "en_1998" else DesignSpectrum.asce_41)(**values)


def response(case: Case, **settings: Any) -> FrameResult | BuildingResult:
    """Return the push-over to the largest displacement of a static case, or its response in time.

    Parameters
    ----------
    case : Case
        A case of a frame.
    **settings
        Settings of the response in time beside those of the case.
    """
    path = case.displacement
    result: Any
    if not case.dynamic and path is not None:
        far = float(path[np.abs(path).argmax()])
        # Where the file names no method, that of a push-over is its structure's.
        method = cast(PathMethod, case.method) if case.names_method else None
        result = pushover(case.column, displacement=far, method=method)
    else:
        result = case.run(**settings)
    return cast(FrameResult | BuildingResult, result)


def judge(
    case: Case,
    *,
    result: FrameResult | BuildingResult | None = None,
    jobs: int | None = None,
    progress: bool = False,
) -> Judgement:
    """Run a case and do what its groups `&target`, `&records` and `&assess` ask for.

    A static case is a push-over to the largest displacement of its loading. Members are assessed
    at the target displacement if the push-over reaches it, else by their envelopes.

    Parameters
    ----------
    case : Case
        As of `rbsdem.read_case`.
    result : FrameResult or BuildingResult, optional
        Its response, if it is known.
    jobs, progress
        As for `rbsdem.ensemble`, for the records.

    Raises
    ------
    InputError
        If the case asks for what cannot be done.
    """
    spectrum, levels = checked(case)
    if not isinstance(case.column, Frame):
        raise InputError("judge: the case has no frame; give one")
    result = result or response(case)
    point = check = None
    if spectrum is not None:
        method = case.target["method"]
        settings = {n: case.target[n] for n in ("site_class",) if n in case.target}
        point = target(result, spectrum, method, **settings)
        if case.records:
            place, units = case.records["path"], case.records.get("units")
            folder = Path(place).is_dir()
            records = read_motions(place, units) if folder else [read_motion(place, units)]
            check = check_target(point, records, jobs=jobs, progress=progress)
    at = point if point is not None and point.reached else None
    assessments = []
    for group in case.assess:
        names = ("knowledge", "primary", "detailing")
        options = {name: group[name] for name in names if name in group}
        options["limits"] = _limits_of(case, group["code"])
        assessments.append(assess(result, group["code"], at=at, **options))
    return Judgement(result, point, check, assessments, levels)
