"""The store of an ensemble: a folder that keeps what was computed.

Each shard is a Parquet file with a row for each of its runs, named by the digest of all that they
follow from, and written whole or not at all. So a second start computes what is missing, after
whatever end of the first.
"""

from __future__ import annotations

import errno
import hashlib
import inspect
import json
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._code import code_digest
from rbsdem._files import whole_file
from rbsdem._optional import need_parquet
from rbsdem.ensembles.measures import STATUSES, Measure
from rbsdem.ensembles.tasks import Plan, Task, TaskResult, watches
from rbsdem.ensembles.threads import Piece
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

#: Letters of a digest in the name of a shard.
_LETTERS = 32


class Store:
    """A folder for the shards of one ensemble.

    Parameters
    ----------
    folder : path
        It is made if it is not there.
    plan : Plan
        The runs.
    names : tuple of lists
        Names of the columns and of the motions.
    pieces : list of tuple
        The runs of each shard.
    seeds : mapping
        What the inputs were drawn from, for the manifest.

    Raises
    ------
    InputError
        If the folder holds another ensemble, that of another version, or other files, or a function
        among the measures has no source.
    ImportError
        If pyarrow is not installed.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        plan: Plan,
        names: tuple[list[str | int], list[str | int]],
        pieces: list[Piece],
        seeds: Any = None,
    ) -> None:
        need_parquet()
        self.folder = Path(folder).expanduser()
        self._names = names
        self._plan = plan
        given = _given(plan)
        self.shards = {piece: _shard_name(plan.task(*piece), given) for piece in pieces}
        self._check_folder()
        manifest = self._manifest(seeds)
        text = _manifest_text(manifest)
        with self._alone():
            shards = self.folder / "shards"
            if shards.exists() and not shards.is_dir():
                raise InputError(f"store: {shards} is no folder; give another store")
            shards.mkdir(exist_ok=True)
            known = self._known()
            if known is None:
                self._write_manifest(text)
            else:
                _compare(self.folder, known, manifest)

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
        texts = [column.to_namelist() for column in plan.columns]
        return {
            "version": _version(),
            "code": code_digest().hex(),
            "digests": {
                "columns": _digest(texts),
                "motions": _digest(_motion_bytes(plan, j) for j in range(len(plan.motions))),
                "scales": _digest([plan.column, plan.motion, plan.scale]),
                "settings": _digest([json.dumps(plan.settings, sort_keys=True)]),
                "initial": _digest(plan.initial),
                "measures": _digest([*plan.states, *map(_source, plan.functions.values())]),
            },
            "settings": plan.settings,
            "measures": list(plan.functions),
            "initial": [
                str(name) for name, state in zip(columns, plan.initial, strict=True) if state.size
            ],
            "seeds": seeds,
            "runs": int(plan.scale.size),
            "shards": list(self.shards.values()),
            "motions": {str(name): motions.index(name) for name in motions},
            "columns": dict(zip(map(str, columns), texts, strict=True)),
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
            "remove this file: the shards beside it are known by their names"
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
    def locked(self, part: tuple[int, int]) -> Iterator[None]:
        """Keep other processes from the same part while the block lasts.

        The lock ends with the process, however that ends.

        Raises
        ------
        InputError
            If another process has the lock, or is at work on parts of another size.
        """
        with ExitStack() as stack:
            with self._alone():
                self._lock(part, stack)
                for path in self.folder.glob(_PART.format("*", "*")):
                    place, parts = map(int, re.findall(r"\d+", path.name))
                    if parts != part[1]:
                        with ExitStack() as moment:
                            self._lock((place, parts), moment)
                self._sweep(part)
            yield

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

    def part(self, part: tuple[int, int]) -> list[Piece]:
        """Return the pieces of part i of n: every n-th, from the i-th on."""
        return list(self.shards)[part[0] - 1 :: part[1]]

    def _sweep(self, part: tuple[int, int]) -> None:
        """Remove what an earlier process of this part has begun and not finished."""
        own = {self.shards[piece] for piece in self.part(part)}
        for path in (self.folder / "shards").glob("*.partial"):
            if path.name.partition(".")[0] in own:
                with suppress(OSError):
                    path.unlink()

    def read(self, piece: Piece) -> TaskResult | None:
        """Return the result of a shard; None if it is not there, or is damaged."""
        parquet = need_parquet()
        path = self._path(piece)
        if not path.is_file():
            return None
        try:
            table = parquet.read_table(path)
            found = _result_of(table, self._plan)
            whole = (table.schema.metadata or {}).get(_SUM) == _sum(self.shards[piece], found)
        except (OSError, KeyError, ValueError, TypeError):  # Those of pyarrow are among them.
            return None
        return found if whole and found.fates.size == piece[1] - piece[0] else None

    def write(self, piece: Piece, result: TaskResult) -> None:
        """Write a shard, if all of its runs are done.

        Raises
        ------
        OSError
            If the disk does not take it; what was there before stays.
        """
        if not result.fates.all():
            return
        parquet = need_parquet()
        import pyarrow as pa  # noqa: PLC0415

        first, last = piece
        rows = slice(first, last)
        columns, motions = (list(map(str, names)) for names in self._names)
        coded = pa.DictionaryArray.from_arrays
        errors = np.full(last - first, "", dtype=object)
        errors[list(result.errors)] = list(result.errors.values())
        data: dict[str, Any] = {
            "run": pa.array(np.arange(first, last)),
            "column": coded(self._plan.column[rows], columns),
            "motion": coded(self._plan.motion[rows], motions),
            "scale": pa.array(self._plan.scale[rows]),
            "status": coded(result.fates, list(STATUSES)),
        }
        data |= {
            name: pa.array(values)
            for name, values in zip(self._plan.names, result.values, strict=True)
        }
        data |= {name: pa.array(values) for name, values in result.extra.items()}
        data["error"] = pa.array(errors)
        table = pa.table(data).replace_schema_metadata({_SUM: _sum(self.shards[piece], result)})
        with _clear(self.folder), whole_file(self._path(piece)) as file:
            parquet.write_table(table, file)

    def _path(self, piece: Piece) -> Path:
        return self.folder / "shards" / f"{self.shards[piece]}.parquet"


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
    """Return what a shard holds."""
    status = table["status"].combine_chunks()
    codes = np.array([STATUSES.index(word) for word in status.dictionary.to_pylist()], np.int8)
    return TaskResult(
        codes[status.indices.to_numpy()],
        np.array([table[name].to_numpy() for name in plan.names]),
        {name: table[name].to_numpy() for name in plan.functions},
        {run: text for run, text in enumerate(table["error"].to_pylist()) if text},
    )


def _sum(name: str, result: TaskResult) -> bytes:
    """Return the digest of a result, by which a shard knows that it is whole and in its place."""
    digest = hashlib.sha256(name.encode() + result.fates.astype(np.int8).tobytes())
    for values in (*result.values, *result.extra.values()):
        digest.update(np.ascontiguousarray(values, dtype=np.float64).tobytes())
    digest.update(json.dumps(sorted(result.errors.items())).encode())
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
            f"store: {folder} holds another ensemble: its {', '.join(other)} differ; give another "
            "folder, or remove this one"
        )


def _version() -> str:
    return _core.version()


def _digest(parts: Any) -> str:
    digest = hashlib.sha256()
    for part in parts:
        raw = part.encode() if isinstance(part, str) else np.ascontiguousarray(part).tobytes()
        digest.update(hashlib.sha256(raw).digest())
    return digest.hexdigest()


def _motion_bytes(plan: Plan, j: int) -> Any:
    return np.concatenate([plan.motions[j].time, plan.motions[j].acceleration])


def _given(plan: Plan) -> bytes:
    """Return the digest of what all shards follow from."""
    digest = hashlib.sha256(code_digest())
    digest.update(json.dumps(plan.settings, sort_keys=True).encode())
    digest.update("\0".join(plan.states).encode())
    for name, function in plan.functions.items():
        digest.update(f"{name}\0{_source(function)}\0".encode())
    return digest.digest()


def _source(function: Measure) -> str:
    """Return the source of a measure, by which it is known again."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        raise InputError(
            f"measures: the function {function.__name__} has no source, so a store cannot know "
            "whether it has changed; write it into a file, or give no store"
        ) from None


def _shard_name(task: Task, given: bytes) -> str:
    digest = hashlib.sha256(given)
    for column, before in zip(task.columns, task.initial, strict=True):
        statement = column._statement
        digest.update(f"{statement.text}\0{statement.numbers!r}\0".encode())
        # Limit states follow from the drawing, which the statement does not have.
        digest.update(watches(column, task.states).tobytes())
        digest.update(b"initial" + before.tobytes())
    for motion in task.motions:
        digest.update(motion.time.tobytes() + motion.acceleration.tobytes())
    digest.update(task.column.tobytes() + task.motion.tobytes() + task.scale.tobytes())
    return digest.hexdigest()[:_LETTERS]
