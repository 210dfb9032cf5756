"""How often a call of the package goes from one of its files to another, and its number of calls.

What an engineer does with a building of four storeys, step by step. A change of file is a call of
a function in another file of the package than that of the call before (`sys.setprofile`); numpy
and the Fortran part do not count. Where the number is large, a reader of the code has a long way.

    python studies/walks.py
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import rbsdem
from rbsdem.codes import DesignSpectrum, assess, target

T = TypeVar("T")
PACKAGE = str(Path(rbsdem.__file__).parent)


def walk(name: str, run: Callable[[], T]) -> T:
    """Run a step, print its changes of file and its calls, and return what it returns."""
    last, changes, calls = "", 0, 0

    def count(frame: Any, event: str, _: Any) -> None:
        nonlocal last, changes, calls
        path = frame.f_code.co_filename
        if event != "call" or not path.startswith(PACKAGE):
            return
        calls, changes, last = calls + 1, changes + (path != last), path

    sys.setprofile(count)
    try:
        found = run()
    finally:
        sys.setprofile(None)
    print(f"| {name} | {changes} | {calls} |")
    return found


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    print("| step | changes of file | calls |\n| --- | ---: | ---: |")
    walk("frame of 4 storeys from its sections", rbsdem.examples.house)
    frame = walk("the same again", rbsdem.examples.house)
    push = walk("push-over", lambda: rbsdem.pushover(frame, drift=0.02))
    walk("its events", lambda: push.events)
    spectrum = DesignSpectrum.en_1998(0.25, "C")
    point = walk("target displacement", lambda: target(push, spectrum, "en_1998"))
    judged = walk("acceptance", lambda: assess(push, "en_1998_3", at=point))
    walk("its line of text", lambda: str(judged))
    with tempfile.TemporaryDirectory() as folder:
        walk("its report", lambda: rbsdem.report(judged, Path(folder) / "report.html"))


if __name__ == "__main__":
    main()
