"""The one way in which the package writes files: whole or not at all."""

from __future__ import annotations

import csv
import errno
import io
import math
import os
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import IO, Any, ClassVar

import numpy as np

from rbsdem import _arguments
from rbsdem._types import DataFrame
from rbsdem.errors import InputError

#: Bytes of a name that go into the temporary name, so that this does not become too long.
_LONGEST = 180
#: Names that are tried before the folder is taken to be at fault.
_TRIES = 1000
#: A cell that starts like this is a formula to a spreadsheet.
_FORMULA = ("=", "+", "-", "@", "\t", "\n")
_STANDARD_OUTPUT = ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file for writing that gets its name when the block ends without an error.

    Until then it has a name of its own in the same folder, which is opened exclusively: no file is
    replaced by it and no link is followed. After an error it is removed, and an earlier file with
    the final name stays as it was. Devices and pipes, which nothing can take the place of, are
    written directly.

    Parameters
    ----------
    path : path-like
        Final name.

    Yields
    ------
    file
        Binary, to be written.

    Raises
    ------
    InputError
        If the path is a folder, or a pipe that nobody reads.
    OSError
        If the file cannot be written.
    """
    target = _arguments.path(path)
    try:
        mode = target.stat().st_mode
    except OSError:
        mode = stat.S_IFREG
    if stat.S_ISDIR(mode):
        raise InputError(f"{target} is a folder; give the path of a file")
    if os.fspath(target) in _STANDARD_OUTPUT or not stat.S_ISREG(mode):
        # Seen as a whole by its reader, too, and never half of it after an error.
        with os.fdopen(_direct(target), "wb") as file:
            buffer = io.BytesIO()
            yield buffer
            file.write(buffer.getvalue())
        return
    descriptor, own = _own_file(target)
    try:
        with os.fdopen(descriptor, "wb") as file:
            yield file
        own.replace(target)
    except BaseException as error:
        with suppress(OSError):
            own.unlink()
        if isinstance(error, OSError) and error.errno and error.filename is None:
            raise type(error)(error.errno, error.strerror, os.fspath(target)) from error
        raise


#: The list of the files of a folder, and how it begins.
_LIST, _MARK = "contents.txt", "# Written by rbsdem"
#: What a page or report has near its beginning.
GENERATOR = '<meta name="generator" content="rbsdem">'


def claim_folder(
    path: str | os.PathLike[str], names: Iterable[str], *, anew: bool = False, look: bool = False
) -> list[Path]:
    """Return the paths of files that belong together, in a folder that is made for them.

    The list in the folder, contents.txt, names them. A file that is on no list is not ours and is
    never written over.

    Parameters
    ----------
    path : path-like
        The folder.
    names : iterable of str
        Names of the files.
    anew : bool, optional
        Whether other files of an earlier list are removed.
    look : bool, optional
        Whether the folder is only looked at, before a long run that writes it at its end.

    Raises
    ------
    InputError
        If a file of one of these names is there that is on no list; nothing is changed then.
    """
    folder, wanted = Path(path), list(names)
    contents = folder / _LIST
    earlier: list[str] = []
    if contents.is_file():
        head, *earlier = contents.read_text("utf-8", errors="replace").splitlines() or [""]
        if not head.startswith(_MARK):
            earlier, wanted = [], [_LIST, *wanted]
    strange = [folder / name for name in wanted if name not in earlier and (folder / name).exists()]
    if strange:
        raise InputError(
            f"{strange[0]} is there and is none of the files that rbsdem wrote into this folder; "
            "move it away, or choose another name"
        )
    if look:
        return [folder / name for name in wanted]
    folder.mkdir(parents=True, exist_ok=True)
    others = [name for name in earlier if name not in wanted]
    # An interrupted run leaves only what is on the list.
    _write_list(contents, [*others, *wanted])
    if anew:
        for name in others:
            # A name with a folder in it is none that was written here.
            if Path(name).name == name:
                (folder / name).unlink(missing_ok=True)
        _write_list(contents, wanted)
    return [folder / name for name in wanted]


def _write_list(path: Path, names: Iterable[str]) -> None:
    """Write the list of the files of a folder."""
    with atomic_write(path) as file:
        file.write("\n".join((f"{_MARK}, which replaces:", *names, "")).encode())


def refuse_other_page(path: Path) -> None:
    """Refuse to write a page over a file that is none, as the case itself would be."""
    if path.is_file() and GENERATOR.encode() not in path.read_bytes()[:1000]:
        raise InputError(
            f"{path} is there and is no report of rbsdem; move it away, or choose another name"
        )


def write_csv(path: str | os.PathLike[str], rows: Iterable[Sequence[object]]) -> None:
    """Write rows as csv, whole or not at all.

    Parameters
    ----------
    path : path-like
        File to write.
    rows : iterable of sequences
        Cells: numbers are written with six digits, None and numbers that are not finite as blanks,
        texts as `escape_formula` returns them.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([_cell(value) for value in row] for row in rows)
    with atomic_write(path) as file:
        file.write(text.getvalue().encode())


class Tabular:
    """A record with a table: `to_pandas` makes it, all other forms follow from that one.

    As text it is one line: its numbers, and the range of each array.
    """

    __slots__ = ()

    #: The attributes with their units, as "force N", of a table that is no more than those.
    _columns: ClassVar[tuple[str, ...]] = ()

    def to_pandas(self) -> DataFrame:
        """Return the table as a DataFrame in SI, with units in the names of its columns."""
        return data_frame(
            {name.replace(" ", "_"): getattr(self, name.split()[0]) for name in self._columns}
        )

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the table as csv with six digits, whole or not at all.

        Parameters
        ----------
        path : path-like
            File to write.
        """
        save_frame(self.to_pandas(), path)

    def __repr__(self) -> str:
        names = getattr(self, "__dataclass_fields__", {})
        units = dict(name.partition(" ")[::2] for name in self._columns)
        parts = [_part(name, getattr(self, name), units.get(name, "")) for name in names]
        return f"{type(self).__name__}({', '.join(filter(None, parts))})"


def text_table(frame: DataFrame) -> str:
    """Return a short table for `print`: four digits, and no more than twenty rows."""
    shown: str = frame.head(20).to_string(index=False, float_format="{:.4g}".format)
    return shown + (f"\n... {len(frame) - 20} more" if len(frame) > 20 else "")


def _part(name: str, value: Any, unit: str) -> str:
    """Return a number, a word or the range of an array with its name; "" for what is long."""
    if isinstance(value, np.ndarray) and value.size and value.dtype.kind in "fi":
        return f"{name} {np.nanmin(value):.4g} to {np.nanmax(value):.4g} {unit}".rstrip()
    if isinstance(value, float):
        return f"{name} {value:.4g}"
    return f"{name} {value}" if isinstance(value, (str, int)) else ""


def data_frame(data: Any, columns: Sequence[str] | None = None) -> DataFrame:
    """Return a DataFrame of columns by their names, or of rows."""
    import pandas  # noqa: PLC0415

    return pandas.DataFrame(data, columns=columns)


def save_frame(frame: DataFrame, path: str | os.PathLike[str]) -> None:
    """Write a DataFrame as csv with six digits, whole or not at all.

    Parameters
    ----------
    frame : DataFrame
        The table; its index is left out unless it has a name.
    path : path-like
        File to write, as by `write_csv`.
    """
    if frame.index.name is not None:
        frame = frame.reset_index()
    write_csv(path, [list(frame.columns), *frame.itertuples(index=False, name=None)])


def write_figure(drawn: Any, path: str | os.PathLike[str], **options: Any) -> None:
    """Write a figure of matplotlib, whole or not at all.

    Parameters
    ----------
    drawn : matplotlib Figure or Axes, or array of Axes
        The figure, or axes of it.
    path : path-like
        File to write; its ending says in which format.
    **options
        Of `savefig`.
    """
    ending = Path(path).suffix.lower().lstrip(".")
    with atomic_write(path) as file:
        file.write(figure_bytes(drawn, ending or "png", **options))


def figure_bytes(drawn: Any, ending: str, **options: Any) -> bytes:
    """Return a figure as the bytes of a file.

    Parameters
    ----------
    drawn : matplotlib Figure or Axes, or array of Axes
        The figure, or axes of it.
    ending : str
        Format, as the ending of a file names it.
    **options
        Of `savefig`.

    Returns
    -------
    bytes
        Content of the file.
    """
    content = io.BytesIO()
    np.ravel(drawn)[0].figure.savefig(content, format=ending, **options)
    return content.getvalue()


def escape_formula(text: str) -> str:
    """Return a text that a spreadsheet does not take for a formula.

    Parameters
    ----------
    text : str
        Of a table that may come from anywhere.

    Returns
    -------
    str
        With an apostrophe in front if it begins with = + - @, a tab or the end of a line.
    """
    # A reader of csv would take a bare carriage return for the end of a row.
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return f"'{text}" if text.startswith(_FORMULA) else text


def _cell(value: object) -> str:
    """Return a value as a cell of csv: six digits; nothing for None, NaN and infinity."""
    if isinstance(value, str):
        return escape_formula(value)
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _own_file(target: Path) -> tuple[int, Path]:
    """Open a file that was not there; return its descriptor and its name."""
    if not target.parent.is_dir():
        raise InputError(f"{target}: there is no folder {target.parent}; make it first")
    start = os.fsdecode(os.fsencode(target.name)[:_LONGEST])
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0)
    flags |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    for number in count(1):
        own = target.with_name(f"{start}.{os.getpid()}-{number}.partial")
        try:
            return os.open(own, flags, 0o666), own
        except FileExistsError:
            if number == _TRIES:
                raise
        except OSError as error:
            raise type(error)(error.errno, error.strerror, os.fspath(target)) from None
    raise AssertionError


def _direct(target: Path) -> int:
    """Open a device or a pipe without waiting for a reader; return the descriptor."""
    if os.fspath(target) in _STANDARD_OUTPUT:
        return os.dup(1)
    try:
        descriptor = os.open(target, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise InputError(
                f"{target} is a pipe that nobody reads; start its reader first, or choose another "
                "file"
            ) from None
        raise
    os.set_blocking(descriptor, True)
    return descriptor
