"""The store of predictions: what was predicted is kept, and need not be done again."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import pickle
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem._package import code_digest
from rbsdem.batch.store import JSON_LINES, Store, digest
from rbsdem.curves.scores import compare
from rbsdem.errors import RbsdemError
from rbsdem.measured.predictions import Prediction
from rbsdem.measured.specimens import Specimen
from rbsdem.section.spread import Interval, Spread

_TEXTS = ("status", "error", "note")
_TIMES = ("seconds_model", "seconds_analysis")
_CURVES = ("displacement", "force", "median", "lower", "upper")
_INTERVALS = ("peak_force", "energy", "drift_at_loss")
_SHARES = ("near_shear", "distance")


class PredictionStore:
    """A folder with a line for each predicted test.

    A line is found again by a digest of the test, its history, the model with its version, the
    options, and the code of the installed package: after a change of any of these the test is
    predicted anew.

    Parameters
    ----------
    folder : path
        It is made if it is not there.
    tests : sequence of Specimen
        The tests of the batch.
    model : str
        Name of the model with the version of its parameters.
    options : mapping
        What else the model was given.

    Raises
    ------
    InputError
        If the folder holds other files, or is none.
    """

    def __init__(
        self, folder: Path, tests: Sequence[Specimen], model: str, options: Mapping[str, Any]
    ) -> None:
        self._tests = tests
        self._model = model
        given = hashlib.sha256(code_digest() + model.encode() + pickle.dumps(dict(options), 5))
        self._keys = [_key(specimen, given.digest()) for specimen in tests]
        self._store = Store(folder, JSON_LINES, {"digests": {"contents": "predictions"}})
        self.write_if_due = self._store.write_if_due

    def open(self) -> AbstractContextManager[None]:
        """Keep other processes from the folder while the block lasts."""
        return self._store.open()

    def read(self) -> dict[int, Prediction]:
        """Return the predictions that are in the store, by the number of the test."""
        known = {line["key"]: line for lines in self._store.read() for line in lines}
        rows = {}
        for number, key in enumerate(self._keys):
            row = self._row(self._tests[number], known[key]) if key in known else None
            if row is not None:
                rows[number] = row
        return rows

    def forget(self) -> None:
        """Remove the predictions of this batch; a folder without others goes too."""
        own = set(self._keys)
        self._store.remove(lambda line: line["key"] in own)

    def add(self, number: int, row: Prediction) -> None:
        """Take the prediction of a test; it is written a few seconds later."""
        line: dict[str, Any] = {"name": row.specimen.name, "key": self._keys[number]}
        line |= {name: getattr(row, name) for name in (*_TEXTS, *_TIMES)}
        line["nrmse"] = row.nrmse
        if row.comparison is not None:
            line["model_force"] = _packed(row.comparison.model_force)
        line["remarks"] = list(row.remarks)
        line["limit_states"] = row.limit_states
        if row.band is not None:
            line["band"] = _band_line(row.band)
        self._store.add(line)

    def _row(self, specimen: Specimen, line: dict[str, Any]) -> Prediction | None:
        """Return the prediction of a line; None if there is something wrong with the line."""
        try:
            comparison = None
            if "model_force" in line:
                test = specimen.test()
                comparison = compare((test.displacement, _unpacked(line["model_force"])), test)
            band = _band_of(line["band"]) if "band" in line else None
            remarks = tuple(str(text) for text in line["remarks"])
            values: dict[str, Any] = {name: str(line[name]) for name in _TEXTS}
            values |= {name: float(line[name]) for name in _TIMES}
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
            **values,
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
    values: dict[str, Any] = {name: _unpacked(line[name]) for name in _CURVES}
    values |= {name: Interval(*map(float, line[name])) for name in _INTERVALS}
    values |= {name: float(line[name]) for name in _SHARES}
    samples = np.empty((0, values["force"].size))
    return Spread(**values, samples=samples, remarks=tuple(map(str, line["remarks"])))


def _key(specimen: Specimen, given: bytes) -> str:
    """Return the digest of a test, its history and what it is predicted with."""
    values = dataclasses.asdict(dataclasses.replace(specimen, folder=None))
    text = repr(values).encode("utf-8", "backslashreplace")
    path = specimen.path
    return digest(given, text, b"" if path is None else path.read_bytes())
