"""The tests of a folder that are most like a drawn column, with their loops and errors."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rbsdem.errors import InputError, RbsdemError
from rbsdem.measured.nearest import nearest
from rbsdem.measured.pictures import picture
from rbsdem.measured.predict import predict_one
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.specimen import Specimen
from rbsdem.measured.specimens import read_specimens
from rbsdem.web.gallery import card

__all__ = ["Near", "specimen_of"]


class Near:
    """The tests of a folder; those that are shown are predicted, and kept.

    Parameters
    ----------
    folder : path
        With the table and the histories, as of `rbsdem peer`.
    number : int, optional
        How many tests an answer has.

    Raises
    ------
    InputError
        If the folder has no table, or no history.
    """

    def __init__(self, folder: Path, number: int = 4) -> None:
        self._tests = read_specimens(folder).with_history()
        if not self._tests:
            raise InputError(f"{folder} has no history of any test of its table")
        self._number = number
        self._found: dict[str, Prediction] = {}

    def of(
        self, state: Mapping[str, Any], pause: Callable[[], None] = lambda: None
    ) -> dict[str, Any]:
        """Return the nearest tests of each column; `pause` is called between predictions."""
        columns: list[dict[str, Any]] = []
        for given in state["columns"]:
            specimen = None if "case" in given else specimen_of(given)
            if specimen is None:
                columns.append({"none": "the folder has no tests of such columns"})
                continue
            try:
                near = nearest(specimen, self._tests, self._number)
            except (RbsdemError, ValueError) as error:
                columns.append({"none": str(error)})
                continue
            rows = []
            for one in near:
                pause()
                row = self._predicted(one.specimen)
                drawn = None if row.comparison is None else picture(row.comparison)
                rows.append(card(row, drawn) | {"distance": round(one.distance, 3)})
            columns.append({"tests": rows})
        return {"columns": columns, "tests": len(self._tests)}

    def _predicted(self, test: Specimen) -> Prediction:
        if test.name not in self._found:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self._found[test.name] = predict_one(test)
        return self._found[test.name]


def specimen_of(given: Mapping[str, Any]) -> Specimen | None:
    """Return a drawn column as a specimen to compare; None for shapes that were not tested."""
    try:
        section, bars, ties, frame = (given[name] for name in ("section", "bars", "ties", "column"))
        half = 0.5 if frame.get("ends") == "double" else 1.0
        common = {
            "name": "drawn",
            "length": half * frame["height"],
            "concrete_strength": given["concrete"]["fc"],
            "axial_load": frame["axial_load"],
            "longitudinal_number": bars["number"],
            "corner_diameter": bars["diameter"],
            "corner_yield_stress": bars["fy"],
            "transverse_diameter": ties["diameter"],
            "transverse_spacing": ties["spacing"],
            "transverse_yield_stress": ties["fy"],
        }
        if section["shape"] == "circle":
            return Specimen(
                section="circular",
                width=section["diameter"],
                depth=section["diameter"],
                cover=section["cover"] + 0.5 * ties["diameter"],
                **common,
            )
        if section["shape"] != "rectangle":
            return None
        face = bars.get("face") or bars["number"] // 4 + 1
        return Specimen(
            section="rectangular",
            width=section["width"],
            depth=section["depth"],
            cover=section["cover"],
            intermediate_diameter=bars["diameter"],
            intermediate_perpendicular=face - 2,
            intermediate_parallel=(bars["number"] - 2 * face) // 2,
            shear_legs=float(ties.get("legs") or 2.0),
            **common,
        )
    except (KeyError, TypeError, ValueError):
        return None
