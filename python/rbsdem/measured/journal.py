"""The journal of a batch: what was predicted is written as it comes, and need not be done again."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import os
import pickle
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem._code import code_digest
from rbsdem._files import whole_file
from rbsdem.curves.scores import compare
from rbsdem.errors import InputError, RbsdemError
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.specimen import Specimen
from rbsdem.section.spread import Interval, Spread

__all__ = ["Journal"]

_TEXTS = ("status", "error", "note")
_TIMES = ("seconds_model", "seconds_analysis")
_CURVES = ("displacement", "force", "median", "lower", "upper")
_INTERVALS = ("peak_force", "energy", "drift_at_loss")
_SHARES = ("near_shear", "distance")


class Journal:
    """A file with a line for each predicted test.

    A line is found again by a digest of the test, its history, the model with its version, the
    options, and the code of the installed package: after a change of any of these the test is
    predicted anew. A line that was not written to its end is passed over.

    Parameters
    ----------
    path : path
        The file; it is made with the first line.
    tests : sequence of Specimen
        The tests of the batch.
    model : str
        Name of the model with the version of its parameters.
    options : mapping
        What else the model was given.

    Raises
    ------
    InputError
        If the path is not that of an ordinary file.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        tests: Sequence[Specimen],
        model: str,
        options: Mapping[str, Any],
    ) -> None:
        self.path = Path(path)
        self._tests = tests
        self._model = model
        given = hashlib.sha256(
            code_digest() + model.encode() + pickle.dumps(dict(options), 5)
        ).digest()
        self._keys = [_key(specimen, given) for specimen in tests]
        if self.path.is_symlink() or (self.path.exists() and not self.path.is_file()):
            raise InputError(f"journal: {self.path} is no ordinary file; give another path")

    def finished(self) -> dict[int, Prediction]:
        """Return the predictions that are in the journal, by the number of the test."""
        known = {line["key"]: line for line in self._lines()}
        rows = {}
        for number, key in enumerate(self._keys):
            row = self._row(self._tests[number], known[key]) if key in known else None
            if row is not None:
                rows[number] = row
        return rows

    def add(self, number: int, row: Prediction) -> None:
        """Write a prediction.

        Parameters
        ----------
        number : int
            Number of its test.
        row : Prediction
            The prediction.
        """
        line: dict[str, Any] = {"name": row.specimen.name, "key": self._keys[number]}
        line |= {name: getattr(row, name) for name in (*_TEXTS, *_TIMES)}
        line["nrmse"] = row.nrmse
        if row.comparison is not None:
            line["model_force"] = _packed(row.comparison.model_force)
        line["remarks"] = list(row.remarks)
        line["limit_states"] = row.limit_states
        if row.band is not None:
            line["band"] = _band_line(row.band)
        text = json.dumps(line) + "\n"
        flags = os.O_RDWR | os.O_APPEND | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
        with os.fdopen(os.open(self.path, flags, 0o666), "r+b") as file:
            # Behind a line that was broken off.
            size = file.seek(0, os.SEEK_END)
            if size:
                file.seek(size - 1)
                text = text if file.read(1) == b"\n" else f"\n{text}"
            file.write(text.encode())

    def forget(self) -> None:
        """Take the tests of this batch out; a journal without lines is removed."""
        if not self.path.is_file():
            return
        own = set(self._keys)
        rest = [json.dumps(line) + "\n" for line in self._lines() if line["key"] not in own]
        if not rest:
            self.path.unlink()
            return
        with whole_file(self.path) as file:
            file.write("".join(rest).encode())

    def _lines(self) -> list[dict[str, Any]]:
        try:
            text = self.path.read_bytes()
        except FileNotFoundError:
            return []
        found = []
        for line in text.splitlines():
            try:
                entry = json.loads(line)
                if isinstance(entry, dict) and isinstance(entry["key"], str):
                    found.append(entry)
            except (ValueError, KeyError):
                continue
        return found

    def _row(self, specimen: Specimen, line: dict[str, Any]) -> Prediction | None:
        """Return the prediction of a line; None if there is something wrong with the line."""
        try:
            comparison = None
            if "model_force" in line:
                test = specimen.test()
                comparison = compare((test.displacement, _unpacked(line["model_force"])), test)
            band = _band_of(line["band"]) if "band" in line else None
            remarks = tuple(str(text) for text in line["remarks"])
            texts = {name: str(line[name]) for name in _TEXTS}
            times = {name: float(line[name]) for name in _TIMES}
            states = line["limit_states"]
            if states is not None:
                states = {str(name): float(drift) for name, drift in states.items()}
        except (ValueError, TypeError, KeyError, AttributeError, RbsdemError):
            return None
        return Prediction(
            specimen,
            self._model,
            comparison=comparison,
            band=band,
            remarks=remarks,
            limit_states=states,
            **texts,
            **times,
        )


def _packed(values: Array) -> str:
    return base64.b64encode(values.astype("<f8").tobytes()).decode("ascii")


def _unpacked(text: str) -> Array:
    return np.frombuffer(base64.b64decode(text), "<f8").astype(np.float64)


def _band_line(band: Spread) -> dict[str, Any]:
    """Return a band as values of json; its samples are left out."""
    line: dict[str, Any] = {name: _packed(getattr(band, name)) for name in _CURVES}
    line |= {name: dataclasses.astuple(getattr(band, name)) for name in _INTERVALS}
    line |= {name: getattr(band, name) for name in _SHARES}
    return line | {"remarks": list(band.remarks)}


def _band_of(line: dict[str, Any]) -> Spread:
    curves = {name: _unpacked(line[name]) for name in _CURVES}
    intervals = {name: Interval(*(float(value) for value in line[name])) for name in _INTERVALS}
    return Spread(
        **curves,
        **intervals,
        samples=np.empty((0, curves["force"].size)),
        **{name: float(line[name]) for name in _SHARES},
        remarks=tuple(str(text) for text in line["remarks"]),
    )


def _key(specimen: Specimen, given: bytes) -> str:
    """Return the digest of a test, its history and what it is predicted with."""
    values = dataclasses.asdict(dataclasses.replace(specimen, folder=None))
    digest = hashlib.sha256(given + repr(values).encode("utf-8", "backslashreplace"))
    path = specimen.path
    if path is not None:
        digest.update(path.read_bytes())
    return digest.hexdigest()
