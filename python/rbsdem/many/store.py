"""A folder that keeps what was computed, in files (shards) that are whole or not there.

A row is known by the digest of all that it follows from, which its owner makes. So a second start
computes what is missing, after whatever end of the first.
"""

from __future__ import annotations

import errno
import hashlib
import inspect
import io
import json
import os
import re
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._files import atomic_write
from rbsdem._package import code_digest, extra
from rbsdem._types import NDArray
from rbsdem.errors import InputError
from rbsdem.many import inputs
from rbsdem.many.plan import Outcome, Plan, watched

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


_MANIFEST = "manifest.json"
_LOCK = "manifest.lock"
_SHARDS = "*.parquet"
_PART = "part-{}-of-{}.lock"
#: Names that a store without its manifest may hold.
_OWN = re.compile(r"shards|manifest\.lock|part-\d+-of-\d+\.lock")
#: How often what was computed is written [s].
_BEAT = 3.0
#: Rows of a shard at the most.
_MOST_ROWS = 65536
#: Letters of a digest.
_LETTERS = 32


def digest(*parts: bytes) -> str:
    """Return the digest of some parts, each for itself."""
    whole = hashlib.sha256()
    for part in parts:
        whole.update(hashlib.sha256(part).digest())
    return whole.hexdigest()[:_LETTERS]


def _table_of(data: bytes) -> Any:
    return extra("pyarrow.parquet").read_table(io.BytesIO(data))


class Store:
    """A folder for the runs of ensembles with the same settings and measures.

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
    seeds : mapping
        Seeds that the inputs were drawn with, for the manifest.

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
        self.folder, self._shards, self._part = folder, folder / "shards", part
        self._plan, self._names = plan, names
        self._columns = [_column_key(plan, i) for i in range(len(plan.columns))]
        self._motions = [
            digest(motion.time.tobytes(), motion.acceleration.tobytes()) for motion in plan.motions
        ]
        self._waiting: list[Any] = []
        self._written = time.monotonic()
        self._check_folder()
        wanted = self._manifest(seeds)
        _manifest_text(wanted)
        with self._alone():
            if self._shards.exists() and not self._shards.is_dir():
                raise InputError(f"store: {self._shards} is no folder; give another store")
            self._shards.mkdir(exist_ok=True)
            known = self._known()
            if known is not None:
                _compare(folder, known, wanted)
                for name in ("columns", "motions"):
                    wanted[name] = known.get(name, {}) | wanted[name]
                wanted |= {name: known.get(name) for name in wanted if wanted[name] is None}
            if wanted != known:
                for path in folder.glob(f"{_MANIFEST}.*.partial"):
                    path.unlink()
                with atomic_write(folder / _MANIFEST) as file:
                    file.write(_manifest_text(wanted))

    def _check_folder(self) -> None:
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"store: {self.folder} is no folder; give another path")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            names = [path.name for path in self.folder.iterdir() if path.suffix != ".partial"]
        except OSError as error:
            raise InputError(f"store: {self.folder}: {error.strerror}") from None
        others = [name for name in names if not _OWN.fullmatch(name)]
        if others and _MANIFEST not in others:
            raise InputError(
                f"store: {self.folder} holds other files ({others[0]}) and no {_MANIFEST}; give an "
                "empty folder"
            )

    def _known(self) -> dict[str, Any] | None:
        path = self.folder / _MANIFEST
        try:
            known = json.loads(path.read_text(encoding="utf-8"))
            if isinstance(known, dict) and isinstance(known.get("digests"), dict):
                return known
        except FileNotFoundError:
            return None
        except (OSError, ValueError):
            pass
        raise InputError(
            f"store: {path} is no manifest of a store, or is damaged; give another folder, or "
            "remove this file: the rows in the shards beside it are known by what they follow from"
        )

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Let processes begin one after the other: what one of them finds or writes stays so."""
        with _clear(self.folder), (self.folder / _LOCK).open("ab") as file:
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX)
            yield

    @contextmanager
    def open(self) -> Iterator[None]:
        """Keep other processes from the same part while the block lasts; write the rest after it.

        The lock ends with the process, however that ends.

        Raises
        ------
        InputError
            If another process has the lock, or is at work on parts of another size.
        """
        with ExitStack() as stack:
            with self._alone():
                self._lock(self._part, stack)
                for path in self.folder.glob(_PART.format("*", "*")):
                    number, parts = map(int, re.findall(r"\d+", path.name))
                    if parts != self._part[1]:
                        with ExitStack() as moment:
                            self._lock((number, parts), moment)
                # Files that an earlier process of this part has begun and not finished.
                for path in self._shards.glob(f"{self._prefix}*.partial"):
                    with suppress(OSError):
                        path.unlink()
            self._written = time.monotonic()
            try:
                yield
            finally:
                self._write()

    def _lock(self, part: tuple[int, int], stack: ExitStack) -> None:
        """Lock a part until the stack is left; raise `InputError` if another process has it."""
        file = stack.enter_context((self.folder / _PART.format(*part)).open("ab"))
        if fcntl is None:
            return
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in (errno.EAGAIN, errno.EACCES):
                raise
            raise InputError(
                f"store: another process is at work on part {part[0]} of {part[1]} of "
                f"{self.folder}; wait for it, or give another folder"
            ) from None

    @property
    def _prefix(self) -> str:
        return "{}-of-{}-".format(*self._part)

    def _manifest(self, seeds: Any) -> dict[str, Any]:
        plan = self._plan
        columns, motions = self._names
        return {
            "version": _core.version(),
            "code": code_digest().hex(),
            "digests": {
                "settings": digest(json.dumps(plan.settings, sort_keys=True).encode()),
                "measures": digest(
                    *(name.encode() for name in plan.names[len(inputs.core_measures()) :]),
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

    def read(self, into: Outcome) -> int:
        """Put the runs that the store has into the outcome; return their number."""
        tables = list(self._tables())
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
        codes = [inputs.STATUSES.index(word) for word in table["status"].to_pylist()]
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
            "status": coded(result.fates[done], list(inputs.STATUSES)),
            **{name: pa.array(values[done]) for name, values in measures.items()},
            "error": pa.array(errors[done]),
            "column_key": coded(plan.column[runs], self._columns),
            "motion_key": coded(plan.motion[runs], self._motions),
        }
        self._waiting.append(pa.table(data))
        self.write_if_due()

    def _tables(self) -> Iterator[Any]:
        """Yield the rows of each whole shard; its name has the digest of its bytes."""
        for path in sorted(self._shards.glob(_SHARDS)):
            with suppress(OSError, KeyError, ValueError, TypeError):  # Those of pyarrow among them.
                data = path.read_bytes()
                if path.stem.endswith(digest(data)):
                    yield _table_of(data)

    def write_if_due(self) -> None:
        """Write a shard of what waits if the last one is some seconds old."""
        due = time.monotonic() - self._written > _BEAT
        if self._waiting and (due or sum(len(rows) for rows in self._waiting) >= _MOST_ROWS):
            self._write()

    def _write(self) -> None:
        """Write a shard of all that waits."""
        waiting, self._waiting = self._waiting, []
        self._written = time.monotonic()
        if not waiting:
            return
        parquet = extra("pyarrow.parquet")
        import pyarrow as pa  # noqa: PLC0415

        file = io.BytesIO()
        parquet.write_table(pa.concat_tables(waiting), file)
        data = file.getvalue()
        path = self._shards / f"{self._prefix}{digest(data)}.parquet"
        with _clear(self.folder), atomic_write(path) as shard:
            shard.write(data)


def _column_key(plan: Plan, i: int) -> str:
    """Return the digest of a column and of the state that its runs begin in."""
    column = plan.columns[i]
    statement = column._statement
    # Limit states follow from the drawing, which the statement does not have.
    thresholds = watched(column, plan.states).tobytes()
    text = f"{statement.text}\0{statement.numbers!r}".encode()
    return digest(text, thresholds, plan.initial[i].tobytes())


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
    if not (folder / _MANIFEST).is_file():
        raise InputError(f"{folder} is no store of runs: it has no {_MANIFEST}")
    counts: Counter[str] = Counter()
    parts: dict[str, tuple[int, float]] = {}
    failures: list[str] = []
    for path in sorted((folder / "shards").glob(_SHARDS)):
        with suppress(OSError, ValueError):
            table = _table_of(path.read_bytes()).select(["status", "error", "column", "motion"])
            rows = table.to_pylist()
            counts.update(row["status"] for row in rows)
            failures += [f"{row['column']}, {row['motion']}: {row['error']}"
                         for row in rows if row["error"]]  # fmt: skip
            part = " of ".join(path.name.split("-")[:3:2])
            number, last = parts.get(part, (0, 0.0))
            parts[part] = number + len(rows), max(last, path.stat().st_mtime)
    now = time.time()
    told = ", ".join(f"{number} {status}" for status, number in counts.most_common())
    return [
        f"{counts.total()} runs{told and ': '}{told}",
        *(
            f"part {part}: {number} runs, the last written {now - last:.0f} s ago"
            for part, (number, last) in sorted(parts.items())
        ),
        *failures[:_MOST_FAILURES],
        *([f"and {more} more"] if (more := len(failures) - _MOST_FAILURES) > 0 else []),
    ]


#: Failures that are told one by one.
_MOST_FAILURES = 10


@contextmanager
def _clear(folder: Path) -> Iterator[None]:
    """Explain an error of the disk."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(
            error.errno,
            f"store: {folder}: {os.strerror(error.errno)}; the shards that were written are kept, "
            "and a new start computes the rest",
        ) from error


def _manifest_text(manifest: dict[str, Any]) -> bytes:
    try:
        return json.dumps(manifest, indent=1).encode()
    except (TypeError, ValueError) as error:
        raise InputError(
            f"seeds: the manifest of a store takes what JSON takes ({error}); give numbers, texts, "
            "lists and dicts of Python"
        ) from None


def _compare(folder: Path, known: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Raise `InputError` if a store holds rows of another kind."""
    if any(known.get(name, wanted[name]) != wanted[name] for name in ("version", "code")):
        raise InputError(
            f"store: {folder} was written by rbsdem {known.get('version')}, or by other code of "
            f"it, and this is {wanted.get('version')}; give another folder, or remove this one"
        )
    other = [
        name for name, value in wanted["digests"].items() if known["digests"].get(name) != value
    ]
    if other:
        raise InputError(
            f"store: {folder} holds runs of another kind: their {', '.join(other)} differ; give "
            "another folder, or remove this one"
        )
