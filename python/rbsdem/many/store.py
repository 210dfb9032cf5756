"""A folder that keeps runs: a database of SQLite for each part of the work.

A run is known by the digest of all that it follows from. So a second start computes what is
missing, after whatever end of the first. A file has one writer at a time; its rows are committed
every few seconds through a rollback journal, which also folders on a network allow.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import sqlite3
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._package import code_digest
from rbsdem._types import NDArray
from rbsdem.errors import InputError
from rbsdem.many import inputs
from rbsdem.many.plan import Outcome, Plan, watched

#: How often what was computed is written [s].
_BEAT = 3.0
#: Failures that are told one by one.
_MOST_FAILURES = 10
#: How long a reader waits for a commit [s].
_PATIENCE = 60.0
_FILES = "part-*.sqlite"
_TABLE = (
    "create table if not exists runs (key blob primary key, column_name text, motion text,"
    " scale real, status integer, numbers blob, error text, at real)"
)


class Store:
    """A folder for the runs of ensembles.

    Parameters
    ----------
    folder : path-like
        It is made if it is not there.
    plan : Plan
        The runs.
    names : tuple of lists
        Names of the columns and of the motions.
    part : tuple of two int
        Which part of how many this process does.

    Raises
    ------
    InputError
        If the folder cannot be made, or a function among the measures has no source.
    """

    def __init__(
        self,
        folder: Path,
        plan: Plan,
        names: tuple[list[str | int], list[str | int]],
        part: tuple[int, int],
    ) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"store: {folder}: {error.strerror}; give another path") from None
        self.folder, self._plan, self._names, self._written = folder, plan, names, 0.0
        self._path = folder / "part-{}-of-{}.sqlite".format(*part)
        kind = [code_digest(), json.dumps(plan.settings, sort_keys=True).encode()]
        kind += [name.encode() for name in plan.names]
        kind += [f"{name}\0{_source(f)}".encode() for name, f in plan.functions.items()]
        columns = [_column(plan, i) for i in range(len(plan.columns))]
        motions = [
            [each.tobytes() for each in (motion.time, motion.acceleration, motion.across)]
            for motion in plan.motions
        ]
        self._keys = [
            _digest(*kind, *columns[i], *motions[j], scale.tobytes())
            for i, j, scale in zip(plan.column, plan.motion, plan.scale, strict=True)
        ]

    @contextmanager
    def open(self) -> Iterator[None]:
        """Keep other processes from writing this part while the block lasts; commit after it.

        Raises
        ------
        InputError
            If another process has the part.
        OSError
            If the disk is full, or fails: what was committed is kept.
        """
        with _told(self._path), closing(_connection(self._path, 0.0)) as self._file:
            # Others may read until the moment of a commit, which waits for them.
            self._file.execute("begin immediate")
            self._file.execute(f"pragma busy_timeout = {1000 * _PATIENCE:.0f}")
            self._file.execute(_TABLE)
            self._file.execute("commit")
            self._file.execute("begin immediate")
            self._written = time.monotonic()
            try:
                yield
            finally:
                if self._file.in_transaction:
                    self._file.execute("commit")

    def read(self, into: Outcome) -> int:
        """Put the runs that the store has into the outcome; return their number."""
        known: dict[bytes, Any] = {}
        for path in sorted(self.folder.glob(_FILES)):
            rows = _rows(path, "select key, status, numbers, error from runs")
            known |= {key: row for key, *row in rows}
        runs = np.array([i for i, key in enumerate(self._keys) if key in known], dtype=np.intp)
        if runs.size:
            fates, numbers, errors = zip(*(known[self._keys[i]] for i in runs), strict=True)
            values = np.array([np.frombuffer(row) for row in numbers]).T
            measures, functions = np.split(values, [len(self._plan.names)])
            outcome = Outcome(
                np.array(fates, dtype=np.int8),
                measures,
                dict(zip(self._plan.functions, functions, strict=True)),
                {i: text for i, text in enumerate(errors) if text},
            )
            into.put(runs, outcome)
        return int(runs.size)

    def add(self, runs: NDArray[np.int_], result: Outcome) -> None:
        """Take the runs that are done of a task; they are committed a few seconds later."""
        plan, (columns, motions) = self._plan, self._names
        numbers = np.vstack([result.values, *result.extra.values()]).T
        rows = [
            (
                self._keys[run],
                str(columns[plan.column[run]]),
                str(motions[plan.motion[run]]),
                float(plan.scale[run]),
                int(result.fates[i]),
                numbers[i].tobytes(),
                result.errors.get(i, ""),
                time.time(),
            )
            for i, run in enumerate(runs.tolist())
            if result.fates[i]
        ]
        self._file.executemany("insert or replace into runs values (?, ?, ?, ?, ?, ?, ?, ?)", rows)
        self.write_if_due()

    def write_if_due(self) -> None:
        """Commit what was taken if that was last done some seconds ago."""
        if time.monotonic() - self._written > _BEAT:
            self._file.execute("commit")
            self._file.execute("begin immediate")
            self._written = time.monotonic()


def _connection(path: Path, patience: float = _PATIENCE) -> sqlite3.Connection:
    """Open a database, waiting so many seconds for the lock of another process."""
    # Transactions are begun and ended by name.
    return sqlite3.connect(path, timeout=patience, isolation_level=None)


def _rows(path: Path, query: str) -> list[Any]:
    """Return the answer of a database to a query; nothing while its table is not there."""
    with _told(path), closing(_connection(path)) as file:
        # Another process may have made the file, and not yet its table.
        is_new = file.execute("select count(*) from sqlite_master").fetchone() == (0,)
        return [] if is_new else file.execute(query).fetchall()


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Tell an error of SQLite with its remedy."""
    try:
        yield
    except sqlite3.Error as error:
        if "locked" in str(error):
            raise InputError(
                f"store: another process is at work on {path}; wait for it, or give another folder"
            ) from None
        if not isinstance(error, sqlite3.OperationalError) or "no such table" in str(error):
            raise InputError(
                f"store: {path}: {error}; it is damaged, remove it, and its runs are computed again"
            ) from None
        raise OSError(
            f"store: {path}: {error}; the runs that were written before are kept, and a new start "
            "computes the rest"
        ) from error


def _digest(*parts: bytes) -> bytes:
    """Return the digest of some parts, each for itself."""
    whole = hashlib.sha256()
    for part in parts:
        whole.update(hashlib.sha256(part).digest())
    return whole.digest()[:16]


def _column(plan: Plan, i: int) -> list[bytes]:
    """Return what the runs of a column follow from; limit states follow from its drawing."""
    column = plan.columns[i]
    text = f"{column._statement.text}\0{column._statement.numbers!r}".encode()
    return [text, watched(column, plan.states).tobytes(), plan.before[i].tobytes()]


def _source(function: inputs.Measure) -> str:
    """Return the source of a measure, by which it is known again."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        raise InputError(
            f"measures: the function {function.__name__} has no source, so a store cannot know "
            "whether it has changed; write it into a file, or give no store"
        ) from None


def store_status(folder: Path) -> list[str]:
    """Return the contents of a store in lines: runs by status, parts, and the failures.

    Parameters
    ----------
    folder : path-like
        Of the store.

    Raises
    ------
    InputError
        If it is no store.
    """
    counts: Counter[str] = Counter()
    parts, failures = [], []
    for path in sorted(folder.glob(_FILES)):
        rows = _rows(path, "select status, column_name, motion, error, at from runs")
        counts.update(inputs.STATUSES[row[0]] for row in rows)
        failures += [f"{row[1]}, {row[2]}: {row[3]}" for row in rows if row[3]]
        ago = time.time() - max((row[4] for row in rows), default=path.stat().st_mtime)
        part = path.stem.removeprefix("part-").replace("-", " ")
        parts.append(f"part {part}: {len(rows)} runs, the last written {ago:.0f} s ago")
    if not parts:
        raise InputError(f"{folder} is no store of runs: it has no {_FILES}")
    told = ", ".join(f"{number} {status}" for status, number in counts.most_common())
    more = len(failures) - _MOST_FAILURES
    rest = [f"and {more} more"] if more > 0 else []
    runs = f"{counts.total()} runs{told and ': '}{told}"
    return [runs, *parts, *failures[:_MOST_FAILURES], *rest]
