"""The table of an ensemble."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rbsdem._optional import need_pandas
from rbsdem._views import view_of
from rbsdem.many.ensemble import Ensemble
from rbsdem.many.measures import COUNTS, STATUSES

if TYPE_CHECKING:
    import pandas as pd


@view_of(Ensemble, "table")
def make_table(found: Ensemble) -> pd.DataFrame:
    """Return a DataFrame with a row for each run."""
    pandas = need_pandas()
    values = {
        "column": pandas.Categorical.from_codes(found.column, list(found.columns)),
        "motion": pandas.Categorical.from_codes(found.motion, list(found.motions)),
        "scale": found.scale,
        "status": pandas.Categorical(found.status, STATUSES),
    }
    for name, numbers in found.measures.items():
        whole = name in COUNTS and not found.errors and (found.status != "").all()
        values[name] = numbers.astype(int) if whole else numbers
    error = pandas.Series("", index=range(len(found)), dtype=object)
    for run, text in found.errors.items():
        error[run] = text
    values["error"] = error
    table: pd.DataFrame = pandas.DataFrame(values)
    return table
