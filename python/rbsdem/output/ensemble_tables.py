"""Runs at known intensities as DataFrame, csv and Parquet."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from rbsdem._files import whole_file, write_csv
from rbsdem._optional import need_pandas, need_pyarrow
from rbsdem._views import view_of
from rbsdem.many.runs import Runs

if TYPE_CHECKING:
    import pandas as pd


@view_of(Runs, "table")
def make_table(runs: Runs) -> pd.DataFrame:
    """Return a DataFrame with a row for each run."""
    pandas = need_pandas()
    found: pd.DataFrame = pandas.DataFrame(
        {
            "column": np.array(list(runs.columns), dtype=object)[runs.column],
            "motion": np.array(list(runs.motions), dtype=object)[runs.motion],
            "intensity": runs.intensity,
            "scale": runs.scale,
            "status": runs.status,
            **runs.measures,
        }
    )
    return found


@view_of(Runs, "to_csv")
def write_runs(runs: Runs, path: str | os.PathLike[str]) -> None:
    """Write a row for each run."""
    columns, motions = list(runs.columns), list(runs.motions)
    head = ("column", "motion", "intensity_m/s2", "scale", "status", *runs.measures)
    rows = [
        (
            str(columns[runs.column[i]]),
            motions[runs.motion[i]],
            float(runs.intensity[i]),
            float(runs.scale[i]),
            str(runs.status[i]),
            *(float(values[i]) for values in runs.measures.values()),
        )
        for i in range(len(runs))
    ]
    write_csv(path, [head, *rows])


@view_of(Runs, "to_parquet")
def write_parquet(runs: Runs, path: str | os.PathLike[str]) -> None:
    """Write a row for each run as Parquet."""
    need_pyarrow()
    table = make_table(runs)
    table["column"] = table["column"].astype(str)
    with whole_file(path) as file:
        table.to_parquet(file, index=False)
