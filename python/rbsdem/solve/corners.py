"""The lines of a static path: a row at every corner, from the same analysis once more."""

from __future__ import annotations

from rbsdem import _core
from rbsdem._views import view_of
from rbsdem.result import Result, result_from_arrays
from rbsdem.solve.analysis import settings_of
from rbsdem.solve.state_file import state_of


@view_of(Result, "path")
def path_of(result: Result) -> Result:
    """Return the result with a row at every corner; see `Result.path`."""
    column, call = result.column, result.call
    by_force = result.summary["driven"] == "force"
    values = call["force" if by_force else "displacement"]
    run = _core.cyclic(
        column._statement + settings_of(None, True, collapse_drift=call.get("collapse_drift")),
        by_force,
        values,
        call.get("axial_load"),
        state_of(call["initial"], "cyclic") if "initial" in call else None,
        corners=True,
    )
    # Where the path broke off, the result has been told of it.
    path = result_from_arrays(run[0], column, result.summary, call, result.state)
    vars(path)["_is_path"] = True
    return path
