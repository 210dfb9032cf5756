"""One row of the properties of the tests, in SI."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path, PurePath

from rbsdem.errors import InputError
from rbsdem.measured.file import PeerTest, read_peer
from rbsdem.measured.measured import MeasuredTest, net_force, top_displacement
from rbsdem.section.columns import CONCRETE_DENSITY

__all__ = ["Observed", "Specimen"]

# Spellings of one author.
_AUTHORS = {"Petrovsky": "Petrovski"}


@dataclass(frozen=True, slots=True)
class Observed:
    """What was measured, as far as the table reports it; no prediction may use it.

    Attributes
    ----------
    points : int or None
        Rows of the history.
    largest_force, smallest_force : float or None
        Of the force column [N].
    largest_displacement, smallest_displacement : float or None
        Of the history [m].
    reversals, cycles : int or None
        Turning points by 2 % of the largest displacement; half of them.
    stiffness_25, stiffness_50, stiffness_75 : float or None
        Secant stiffness at 25, 50, 75 % of the largest force [N/m].
    published_shear : float or None
        Largest shear as published [N].
    published_moment : float or None
        Largest base moment as published [N m].
    published_yield_displacement : float or None
        Calculated in the publication, not measured [m].
    published_label : str or None
        Name of the test there.
    """

    points: int | None = None
    largest_force: float | None = None
    smallest_force: float | None = None
    largest_displacement: float | None = None
    smallest_displacement: float | None = None
    reversals: int | None = None
    cycles: int | None = None
    stiffness_25: float | None = None
    stiffness_50: float | None = None
    stiffness_75: float | None = None
    published_shear: float | None = None
    published_moment: float | None = None
    published_yield_displacement: float | None = None
    published_label: str | None = None


@dataclass(frozen=True, slots=True)
class Specimen:
    """A tested column: its properties before the test, and where its history is.

    What was not reported is None. Steel, bars and lengths follow the notation of the database.

    Attributes
    ----------
    name : str
        Name of the test.
    section : str
        "rectangular", "circular", "octagonal" or "square(spiral table)" (square, with a spiral).
    length : float
        Of the equivalent cantilever [m].
    width, depth : float
        Of the section, depth in the direction of loading [m]; both the diameter if it is round.
    concrete_strength : float
        Cylinder strength [Pa].
    axial_load : float
        Compression positive, tension negative [N].
    longitudinal_number : int
        Number of longitudinal bars.
    peer_id : int or None
        Number in the database.
    file : str or None
        File of the history; None if the folder has none for this test.
    folder : Path or None
        Folder of the table.
    author, year : str or None
        Of the report; the year is that in the name if there is no other.
    config : str or None
        C cantilever, DC double curvature, DE double ended, CFB flexible base, HH hammer head.
    measured_length : float or None
        Height at which the displacement was measured [m].
    cover : float or None
        Along the direction of loading: clear to the outer edge of the hoops of a rectangular
        section, to the centre of a spiral [m].
    cover_perpendicular : float or None
        The same across the direction of loading [m].
    cover_definition : str or None
        As in the table.
    corner_diameter, intermediate_diameter : float or None
        Of longitudinal bars [m].
    intermediate_perpendicular, intermediate_parallel : int or None
        Bars between the corner bars, per face, of the faces across and along the loading.
    corner_yield_stress, intermediate_yield_stress : float or None
        Of longitudinal bars [Pa].
    longitudinal_ultimate_stress : float or None
        Of longitudinal bars [Pa].
    transverse_yield_stress, transverse_ultimate_stress : float or None
        Of hoops or spiral [Pa].
    transverse_diameter : float or None
        Of a hoop or spiral bar [m].
    transverse_spacing : float or None
        Of hoops, or pitch of the spiral, where they are close [m].
    shear_legs : float or None
        Hoop bars that cross the section in the direction of loading; diagonal ones count in part.
    confinement : str or None
        Type of the hoops, such as "RI: Rectangular and interlocking ties".
    failure_mode : str or None
        "Flexure", "Flexure-Shear" or "Shear".
    pdelta_code : int or None
        1 to 4, what the force column means; None if the report does not give it.
    top_length, bottom_length : float or None
        From the ends of the column to the hinges of the axial ram [m].
    beam_length, splice_length : float or None
        Of the beam of a flexible base, of the lap splice of the bars [m].
    notes : str
        Remarks of the table.
    duplicate_of : int or None
        Number of the test whose history is repeated here, which is an error of the database.
    observed : Observed
        What was measured.
    """

    name: str
    section: str
    length: float
    width: float
    depth: float
    concrete_strength: float
    axial_load: float
    longitudinal_number: int
    peer_id: int | None = None
    file: str | None = None
    folder: Path | None = None
    author: str | None = None
    year: str | None = None
    config: str | None = None
    measured_length: float | None = None
    cover: float | None = None
    cover_perpendicular: float | None = None
    cover_definition: str | None = None
    corner_diameter: float | None = None
    intermediate_diameter: float | None = None
    intermediate_perpendicular: int | None = None
    intermediate_parallel: int | None = None
    corner_yield_stress: float | None = None
    intermediate_yield_stress: float | None = None
    longitudinal_ultimate_stress: float | None = None
    transverse_yield_stress: float | None = None
    transverse_ultimate_stress: float | None = None
    transverse_diameter: float | None = None
    transverse_spacing: float | None = None
    shear_legs: float | None = None
    confinement: str | None = None
    failure_mode: str | None = None
    pdelta_code: int | None = None
    top_length: float | None = None
    bottom_length: float | None = None
    beam_length: float | None = None
    splice_length: float | None = None
    notes: str = ""
    duplicate_of: int | None = None
    observed: Observed = Observed()

    @property
    def gross_area(self) -> float:
        """Area of the concrete section [m2]."""
        if self.section == "circular":
            return math.pi / 4 * self.depth**2
        if self.section == "octagonal":
            return 2 * (math.sqrt(2) - 1) * self.depth**2
        return self.width * self.depth

    @property
    def axial_load_ratio(self) -> float:
        """Axial load over gross area times concrete strength."""
        return self.axial_load / (self.gross_area * self.concrete_strength)

    @property
    def axial_height(self) -> float:
        """Height at which the axial load acts [m].

        The length and `top_length`; the length alone with P-Delta code 4, whose net force has the
        horizontal part of the load in it (Berry, Parrish and Eberhard 2004, 3.3).
        """
        return self.length + (0.0 if self.pdelta_code == 4 else self.top_length or 0.0)

    @property
    def second_order_load(self) -> float:
        """Load at the top that has the second-order moment of the axial load at its height [N].

        P (L + L_top)/L. The sections carry P.
        """
        return self.axial_load * (self.axial_height / self.length)

    @property
    def span_depth_ratio(self) -> float:
        """Length over depth."""
        return self.length / self.depth

    @property
    def mass(self) -> float:
        """Mass from the gross volume and `rbsdem.section.columns.CONCRETE_DENSITY` [kg]."""
        return self.gross_area * self.length * CONCRETE_DENSITY

    @property
    def series(self) -> str:
        """First author and year: tests that one laboratory made together.

        Split tests by this key when a relation is fitted to some and tried on others.
        """
        author = self.author or self.name
        first = re.split(r"\s+et\s+al\b|\s+and\s+|,|&", author.strip())[0].strip()
        first = _AUTHORS.get(first, first)
        # A name in place of the author has the year in it.
        return f"{first} {self.year}" if self.year and self.year not in first else first

    @property
    def kind(self) -> str:
        """Form of the section and failure mode, such as "rectangular, Flexure".

        Octagons and spirals in a square count as round.
        """
        form = "rectangular" if self.section == "rectangular" else "round"
        return f"{form}, {self.failure_mode or 'not known'}"

    def is_called(self, key: str) -> bool:
        """Whether a text is its file (with or without ending), name or number in the database.

        Parameters
        ----------
        key : str
            The text.
        """
        files = (self.file, Path(self.file).stem) if self.file else ()
        return key.strip() in {self.name, str(self.peer_id), *files} - {""}

    @property
    def path(self) -> Path | None:
        """File of the history, a csv or the database's own text; None if it is not there.

        It lies in the folder of the table or below.
        """
        if self.file is None or self.folder is None or not _stays_below(self.file):
            return None
        name = self.folder / self.file
        raw = self.folder / "raw" / name.name
        for path in (name, name.with_suffix(".txt"), raw, raw.with_suffix(".txt")):
            try:
                if path.is_file():
                    return path
            except OSError:  # such as a name that is too long
                continue
        return None

    def history(self) -> PeerTest:
        """Read the history as it is in its file.

        Returns
        -------
        PeerTest
            Displacement [m] and force column [N].

        Raises
        ------
        InputError
            If there is no file, or if it cannot be read.
        """
        path = self.path
        if path is None:
            where = self.folder or "a folder"
            named = f"{self.file} is not in {where}" if self.file else "the table names no file"
            if self.file and not _stays_below(self.file):
                named = f"file = {self.file!r} is no file below the folder of the table"
            raise InputError(f"{self.name}: no history, {named}; put its csv or txt there")
        return read_peer(path)

    def test(self) -> MeasuredTest:
        """Read the history and find the net horizontal force.

        Returns
        -------
        MeasuredTest
            Displacement of the top [m], net horizontal force [N], and the columns of the file.

        Raises
        ------
        InputError
            If there is no file, if it cannot be read, or if a length that its P-Delta code needs is
            not known.
        """
        history = self.history()
        try:
            force = net_force(
                history.displacement,
                history.force,
                code=self.pdelta_code,
                axial_load=self.axial_load,
                length=self.length,
                measured_length=self.measured_length,
                top_length=self.top_length,
                bottom_length=self.bottom_length,
            )
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from error
        return MeasuredTest(
            name=self.name,
            displacement=top_displacement(
                history.displacement, length=self.length, measured_length=self.measured_length
            ),
            force=force,
            measured_displacement=history.displacement,
            measured_force=history.force,
            length=self.length,
            axial_load=self.axial_load,
            pdelta_code=self.pdelta_code,
            axial_height=self.axial_height,
        )


def _stays_below(file: str) -> bool:
    """Whether the path of a table leads to a file in its folder or below."""
    path = PurePath(file)
    return bool(path.name) and not path.anchor and ".." not in path.parts and "\0" not in file
