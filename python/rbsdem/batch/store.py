"""The store of an ensemble: a folder that keeps the runs that were computed.

A run is known by the digest of all that it follows from. So a second start computes what is
missing, after whatever end of the first, and so does one with more columns, motions or scales.
"""

from __future__ import annotations

import errno
import hashlib
import inspect
import json
import os
import re
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbsdem import _core
from rbsdem._code import code_digest
from rbsdem._files import whole_file
from rbsdem._optional import need_parquet
from rbsdem.batch.measures import STATUSES, Measure
from rbsdem.batch.tasks import Plan, TaskResult, watched
from rbsdem.errors import InputError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

__all__ = ["Store"]

_MANIFEST = "manifest.json"
_LOCK = "manifest.lock"
_PART = "part-{}-of-{}.lock"
#: What a store without its manifest may hold.
_OWN = re.compile(r"shards|manifest\.lock|part-\d+-of-\d+\.lock")
#: Where a shard has the digest of what it holds.
_SUM = b"rbsdem"
#: How often what was computed is written [s].
_BEAT = 3.0
#: Runs of a shard at the most.
_MOST_RUNS = 65536
#: Letters of a digest.
_LETTERS = 32


class Store:
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
    ImportError
        If pyarrow is not installed.
    """

    def __init__(
        self,
        folder: Path,
        plan: Plan,
        names: tuple[list[str | int], list[str | int]],
        part: tuple[int, int],
        seeds: Any = None,
    ) -> None:
        need_parquet()
        self.folder = folder
        self._plan = plan
        self._names = names
        self._part = part
        self._columns = [_column_key(plan, i) for i in range(len(plan.columns))]
        self._motions = [_motion_key(plan, j) for j in range(len(plan.motions))]
        self._waiting: list[tuple[NDArray[np.int_], TaskResult]] = []
        self._written = time.monotonic()
        self._check_folder()
        manifest = self._manifest(seeds)
        _manifest_text(manifest)
        with self._alone():
            shards = self.folder / "shards"
            if shards.exists() and not shards.is_dir():
                raise InputError(f"store: {shards} is no folder; give another store")
            shards.mkdir(exist_ok=True)
            known = self._known()
            if known is not None:
                _compare(self.folder, known, manifest)
                for kind in ("columns", "motions"):
                    manifest[kind] = known.get(kind, {}) | manifest[kind]
                if seeds is None:
                    manifest["seeds"] = known.get("seeds")
            if manifest != known:
                self._write_manifest(_manifest_text(manifest))

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

    def _manifest(self, seeds: Any) -> dict[str, Any]:
        plan = self._plan
        columns, motions = self._names
        return {
            "version": _core.version(),
            "code": code_digest().hex(),
            "digests": {
                "settings": _digest(json.dumps(plan.settings, sort_keys=True).encode()),
                "measures": _digest(
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
            f"store: {path} is no manifest of an ensemble, or is damaged; give another folder, or "
            "remove this file: the runs in the shards beside it are known by what they follow from"
        )

    def _write_manifest(self, text: bytes) -> None:
        for path in self.folder.glob(f"{_MANIFEST}.*.partial"):
            path.unlink()
        with whole_file(self.folder / _MANIFEST) as file:
            file.write(text)

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
                    place, parts = map(int, re.findall(r"\d+", path.name))
                    if parts != self._part[1]:
                        with ExitStack() as moment:
                            self._lock((place, parts), moment)
                self._sweep()
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

    def _sweep(self) -> None:
        """Remove what an earlier process of this part has begun and not finished."""
        for path in (self.folder / "shards").glob(f"{self._prefix}*.partial"):
            with suppress(OSError):
                path.unlink()

    def read(self) -> tuple[NDArray[np.int_], TaskResult | None]:
        """Return which runs the store has, and their results; None if it has none."""
        parquet = need_parquet()
        import pyarrow as pa  # noqa: PLC0415

        tables = []
        for path in sorted((self.folder / "shards").glob("*.parquet")):
            try:
                table = parquet.read_table(path)
                if (table.schema.metadata or {}).get(_SUM) == _sum(table):
                    tables.append(table.replace_schema_metadata(None))
            except (OSError, KeyError, ValueError, TypeError):  # Those of pyarrow are among them.
                continue
        if not tables:
            return np.empty(0, dtype=int), None
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
        return runs, _result_of(table.take(rows[runs]), plan)

    def add(self, runs: NDArray[np.int_], result: TaskResult) -> None:
        """Take the runs that are done of a task; they are written a few seconds later.

        Raises
        ------
        OSError
            If the disk does not take them; what was there before stays.
        """
        self._waiting.append((runs, result))
        if time.monotonic() - self._written > _BEAT or self._number() >= _MOST_RUNS:
            self._write()

    def _number(self) -> int:
        return sum(runs.size for runs, _ in self._waiting)

    def _write(self) -> None:
        """Write a shard of all that waits."""
        waiting, self._waiting = self._waiting, []
        self._written = time.monotonic()
        tables = [self._table(runs, result) for runs, result in waiting if result.fates.any()]
        if not tables:
            return
        parquet = need_parquet()
        import pyarrow as pa  # noqa: PLC0415

        table = pa.concat_tables(tables)
        known = _sum(table)
        path = self.folder / "shards" / f"{self._prefix}{known[:_LETTERS].decode()}.parquet"
        with _clear(self.folder), whole_file(path) as file:
            parquet.write_table(table.replace_schema_metadata({_SUM: known}), file)

    def _table(self, runs: NDArray[np.int_], result: TaskResult) -> Any:
        """Return a row for each run of a task that is done."""
        import pyarrow as pa  # noqa: PLC0415

        done = np.flatnonzero(result.fates)
        runs = runs[done]
        plan = self._plan
        columns, motions = (list(map(str, names)) for names in self._names)
        coded = pa.DictionaryArray.from_arrays
        errors = np.full(result.fates.size, "", dtype=object)
        errors[list(result.errors)] = list(result.errors.values())
        data: dict[str, Any] = {
            "column": coded(plan.column[runs], columns),
            "motion": coded(plan.motion[runs], motions),
            "scale": pa.array(plan.scale[runs]),
            "status": coded(result.fates[done], list(STATUSES)),
        }
        named = zip(plan.names, result.values, strict=True)
        data |= {name: pa.array(values[done]) for name, values in named}
        data |= {name: pa.array(values[done]) for name, values in result.extra.items()}
        data["error"] = pa.array(errors[done])
        data["column_key"] = coded(plan.column[runs], self._columns)
        data["motion_key"] = coded(plan.motion[runs], self._motions)
        return pa.table(data)


@contextmanager
def _clear(folder: Path) -> Iterator[None]:
    """Say what an error of the disk means."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(
            error.errno,
            f"store: {folder}: {os.strerror(error.errno)}; the shards that were written are kept, "
            "and a new start goes on from there",
        ) from error


def _result_of(table: Any, plan: Plan) -> TaskResult:
    """Return what rows of shards hold."""
    codes = [STATUSES.index(word) for word in table["status"].to_pylist()]
    return TaskResult(
        np.array(codes, dtype=np.int8),
        np.array([table[name].to_numpy() for name in plan.names]),
        {name: table[name].to_numpy() for name in plan.functions},
        {run: text for run, text in enumerate(table["error"].to_pylist()) if text},
    )


def _sum(table: Any) -> bytes:
    """Return the digest of a table, by which a shard knows that it is whole."""
    digest = hashlib.sha256()
    for name in table.column_names:
        column = table[name]
        if str(column.type) == "double":
            digest.update(np.ascontiguousarray(column.to_numpy()).tobytes())
        else:
            digest.update(json.dumps(column.to_pylist()).encode())
    return digest.hexdigest().encode()


def _manifest_text(manifest: dict[str, Any]) -> bytes:
    try:
        return json.dumps(manifest, indent=1).encode()
    except (TypeError, ValueError) as error:
        raise InputError(
            f"seeds: the manifest of a store takes what JSON takes ({error}); give numbers, texts, "
            "lists and dicts of Python"
        ) from None


def _compare(folder: Path, known: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Raise `InputError` if a store is not that of an ensemble."""
    if known.get("version") != wanted["version"] or known.get("code") != wanted["code"]:
        raise InputError(
            f"store: {folder} was written by rbsdem {known.get('version')}, or by other code of "
            f"it, and this is {wanted['version']}; give another folder, or remove this one"
        )
    other = [
        name for name, digest in wanted["digests"].items() if known["digests"].get(name) != digest
    ]
    if other:
        raise InputError(
            f"store: {folder} holds runs of another kind: their {', '.join(other)} differ; give "
            "another folder, or remove this one"
        )


def _digest(*parts: bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:_LETTERS]


def _column_key(plan: Plan, i: int) -> str:
    """Return the digest of a column and of the state that its runs begin in."""
    column = plan.columns[i]
    statement = column._statement
    # Limit states follow from the drawing, which the statement does not have.
    watches = watched(column, plan.states).tobytes()
    text = f"{statement.text}\0{statement.numbers!r}".encode()
    return _digest(text, watches, plan.initial[i].tobytes())


def _motion_key(plan: Plan, j: int) -> str:
    motion = plan.motions[j]
    return _digest(motion.time.tobytes(), motion.acceleration.tobytes())


def _source(function: Measure) -> str:
    """Return the source of a measure, by which it is known again."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        raise InputError(
            f"measures: the function {function.__name__} has no source, so a store cannot know "
            "whether it has changed; write it into a file, or give no store"
        ) from None
