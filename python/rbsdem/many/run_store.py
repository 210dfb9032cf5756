"""The store of an ensemble: a table with a row for each run, known by what the run follows from.

So a second start computes what is missing, and so does one with more columns, motions or scales.
"""

from __future__ import annotations

import inspect
import json
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbsdem import _core
from rbsdem._package import code_digest, extra
from rbsdem.batch.store import PARQUET, Store, digest
from rbsdem.errors import InputError
from rbsdem.many.inputs import STATUSES, Measure
from rbsdem.many.plan import Outcome, Plan, watched


class RunStore:
    """A folder for the runs of ensembles with the same settings and measures.

    Parameters
    ----------
    folder : path
        It is made if it is not there.
    plan : Plan
        The runs.
    names : tuple of lists
        Names of the columns and of the motions.
    part : tuple of two int
        Which part of how many this process does.
    seeds : mapping
        What the inputs were drawn from, for the manifest.

    Raises
    ------
    InputError
        If the folder holds an ensemble of other settings or measures, that of another version, or
        other files, or a function among the measures has no source.
    """

    def __init__(
        self,
        folder: Path,
        plan: Plan,
        names: tuple[list[str | int], list[str | int]],
        part: tuple[int, int],
        seeds: Any = None,
    ) -> None:
        extra("pyarrow.parquet")
        self._plan = plan
        self._names = names
        self._columns = [_column_key(plan, i) for i in range(len(plan.columns))]
        self._motions = [
            digest(motion.time.tobytes(), motion.acceleration.tobytes()) for motion in plan.motions
        ]
        growing = ("columns", "motions")
        self._store = Store(folder, PARQUET, self._manifest(seeds), growing, part)
        self.write_if_due = self._store.write_if_due

    def _manifest(self, seeds: Any) -> dict[str, Any]:
        plan = self._plan
        columns, motions = self._names
        return {
            "version": _core.version(),
            "code": code_digest().hex(),
            "digests": {
                "settings": digest(json.dumps(plan.settings, sort_keys=True).encode()),
                "measures": digest(
                    *(state.encode() for state in plan.states),
                    *(f"{name}\0{_source(f)}".encode() for name, f in plan.functions.items()),
                ),
            },
            "settings": plan.settings,
            "measures": list(plan.functions),
            "seeds": seeds,
            "columns": {
                key: {"name": str(name), "case": column.to_namelist(), "at_rest": not before.size}
                for key, name, column, before in zip(
                    self._columns, columns, plan.columns, plan.initial, strict=True
                )
            },
            "motions": dict(zip(self._motions, map(str, motions), strict=True)),
        }

    def open(self) -> AbstractContextManager[None]:
        """Keep other processes from the same part while the block lasts."""
        return self._store.open()

    def read(self, into: Outcome) -> int:
        """Put the runs that the store has into the outcome; return their number."""
        tables = self._store.read()
        if not tables:
            return 0
        import pyarrow as pa  # noqa: PLC0415

        table = pa.concat_tables(tables).unify_dictionaries()
        keys = (table[name].to_pylist() for name in ("column_key", "motion_key", "scale"))
        row_of = {key: row for row, key in enumerate(zip(*keys, strict=True))}
        plan = self._plan
        rows = np.array(
            [
                row_of.get((self._columns[i], self._motions[j], scale), -1)
                for i, j, scale in zip(plan.column, plan.motion, plan.scale.tolist(), strict=True)
            ]
        )
        runs = np.flatnonzero(rows >= 0)
        table = table.take(rows[runs])
        codes = [STATUSES.index(word) for word in table["status"].to_pylist()]
        known = Outcome(
            np.array(codes, dtype=np.int8),
            np.array([table[name].to_numpy() for name in plan.names]),
            {name: table[name].to_numpy() for name in plan.functions},
            {run: text for run, text in enumerate(table["error"].to_pylist()) if text},
        )
        into.put(runs, known)
        return runs.size

    def add(self, runs: NDArray[np.int_], result: Outcome) -> None:
        """Take the runs that are done of a task; they are written a few seconds later."""
        done = np.flatnonzero(result.fates)
        if not done.size:
            return
        import pyarrow as pa  # noqa: PLC0415

        runs, plan = runs[done], self._plan
        columns, motions = (list(map(str, names)) for names in self._names)
        coded = pa.DictionaryArray.from_arrays
        errors = np.full(result.fates.size, "", dtype=object)
        errors[list(result.errors)] = list(result.errors.values())
        measures = dict(zip(plan.names, result.values, strict=True)) | result.extra
        data: dict[str, Any] = {
            "column": coded(plan.column[runs], columns),
            "motion": coded(plan.motion[runs], motions),
            "scale": pa.array(plan.scale[runs]),
            "status": coded(result.fates[done], list(STATUSES)),
            **{name: pa.array(values[done]) for name, values in measures.items()},
            "error": pa.array(errors[done]),
            "column_key": coded(plan.column[runs], self._columns),
            "motion_key": coded(plan.motion[runs], self._motions),
        }
        self._store.add(pa.table(data), done.size)


def _column_key(plan: Plan, i: int) -> str:
    """Return the digest of a column and of the state that its runs begin in."""
    column = plan.columns[i]
    statement = column._statement
    # Limit states follow from the drawing, which the statement does not have.
    watches = watched(column, plan.states).tobytes()
    text = f"{statement.text}\0{statement.numbers!r}".encode()
    return digest(text, watches, plan.initial[i].tobytes())


def _source(function: Measure) -> str:
    """Return the source of a measure, by which it is known again."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        raise InputError(
            f"measures: the function {function.__name__} has no source, so a store cannot know "
            "whether it has changed; write it into a file, or give no store"
        ) from None
