"""A report: the page with its results inside, one file that asks nothing of a network."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rbsdem import _core
from rbsdem._files import atomic_write
from rbsdem.errors import InputError
from rbsdem.web.answers import Answers, NearestTests
from rbsdem.web.pages import one_file

#: Letters of a text that a report takes with it.
_MOST_TEXT = 400_000


def report_data(
    state: Mapping[str, Any], title: str, near: NearestTests | None = None
) -> dict[str, Any]:
    """Return the answers to a state as a report holds them.

    Parameters
    ----------
    state : mapping
        Columns and loading.
    title : str
        Title of the report.
    near : NearestTests, optional
        Tests to compare with.

    Raises
    ------
    InputError
        With a line for everything that is wrong with a column or the loading.
    """
    answers, asked = Answers(near), {"state": state}

    def ask(answer: Callable[..., dict[str, Any]], **more: Any) -> Any:
        return answer(asked | more, lambda: None)["columns"]

    loops = ask(answers.loops)
    faults = [fault["text"] for loop in loops for fault in loop["faults"]]
    if faults:
        raise InputError("\n".join(dict.fromkeys(faults)))
    data: dict[str, Any] = {
        "title": title,
        "version": _core.version(),
        "state": {"columns": state["columns"], "loading": state["loading"]},
        "loops": [{**loop, "seconds": 0} for loop in loops],
        "sections": {code: ask(answers.sections, code=code) for code in ("aci318", "ec2")},
        "bands": ask(answers.bands),
        "scales": ask(answers.scales) if any(loop.get("dynamic") for loop in loops) else None,
        "own": ask(answers.own),
        "near": None if near is None else near.of(state),
        "exports": {},
    }
    for form in ("namelist", "python"):
        text = answers.export(asked | {"form": form}, lambda: None)["text"]
        # A long history would be most of the report; the case that it is made from has it.
        if len(text) < _MOST_TEXT:
            data["exports"][form] = {"text": text, "name": "column"}
    return data


def write_report(
    path: str | os.PathLike[str],
    state: Mapping[str, Any],
    title: str,
    near: NearestTests | None = None,
) -> Path:
    """Write a report of a state of the page, whole or not at all.

    Parameters
    ----------
    path : path
        File to write.
    state, title, near
        As for `report_data`.
    """
    target = Path(path)
    page = one_file(title, report_data(state, title, near))
    with atomic_write(target) as file:
        file.write(page.encode("utf-8"))
    return target
