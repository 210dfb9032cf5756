"""Predictions with bands: one call for a test or a folder, the nearest tests, files, commands."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from samples import read_rows, write_history, write_table

import rbsdem
from rbsdem import peer, plot
from rbsdem.cli import main
from rbsdem.errors import AccuracyWarning
from rbsdem.output import measured

DRIFTS = (0.005, 0.015)
PATH = 1.6 * rbsdem.protocol(DRIFTS, cycles=1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four columns of growing axial load, 5 % stronger than the model; two have no history."""
    place = tmp_path_factory.mktemp("tests")
    rows = [
        {"file": f"T{i}.csv", "name": f"T{i}", "axial_kN": f"{400 * i}", "year": f"{1990 + i}"}
        for i in range(1, 7)
    ]
    for specimen in write_table(place, rows)[:4]:
        force = 1.05 * peer.predict(specimen, displacement=PATH).force
        write_history(place / f"T{specimen.peer_id}.csv", PATH, force)
    return place


@pytest.fixture
def table(folder: Path) -> peer.Specimens:
    return peer.read_specimens(folder)


def test_one_test(table: peer.Specimens, folder: Path) -> None:
    """Band, intervals and the tests of the folder of its table; the nearest in axial load first."""
    row = peer.predict(table["T1"], bands=True, samples=8, near=folder)
    path = table["T1"].test().displacement
    band = rbsdem.peer.band(peer.column(table["T1"]), path, samples=8, rig=True)
    for name in ("force", "median", "lower", "upper", "samples"):
        np.testing.assert_array_equal(getattr(row.band, name), getattr(band, name))
    assert [one.specimen.name for one in row.nearest] == ["T2", "T3", "T4"]
    # 400 kN of f'c A = 6400 kN; 0.15 counts as 1.
    assert row.nearest[0].distance == pytest.approx(400 / 6400 / 0.15)
    assert row.nearest[0].prediction.score("peak_ratio") == pytest.approx(1 / 1.05)
    assert row.comparison.peak_ratio == pytest.approx(1 / 1.05)
    # 5 % are within the band of nominally equal specimens.
    assert row.points_within == 1.0
    assert len(plot.prediction(row)) == 2
    assert measured.numbers_table(row).row_count >= 8


def test_a_column_that_nobody_tested(table: peer.Specimens, folder: Path) -> None:
    mine = replace(table["T5"], folder=None, file=None)
    row = peer.predict(mine, displacement=PATH, near=folder, bands=True)
    assert (row.status, row.comparison) == ("completed", None)
    assert math.isnan(row.points_within)
    assert row.nearest[0].specimen.name == "T4"
    assert len(plot.prediction(row)) == 2
    high = replace(mine, concrete_strength=140e6)
    with pytest.warns(AccuracyWarning, match="concrete strength = 140 MPa is outside"):
        assert peer.predict(high, displacement=PATH).warnings
    # Of several it is in the rows, and nothing is warned of.
    (far,) = peer.predict([high], displacement=PATH, bands=True, samples=8)
    assert far.warnings == far.band.warnings


def test_what_cannot_be_read_or_drawn_is_no_neighbour(folder: Path, tmp_path: Path) -> None:
    for path in folder.iterdir():
        (tmp_path / path.name).write_text(path.read_text())
    (tmp_path / "T2.csv").write_text("displacement_mm,force_kN\n1,what\n")
    table = peer.read_specimens(tmp_path)
    row = peer.predict(table["T1"], near=table.with_history())
    assert [one.specimen.name for one in row.nearest] == ["T3", "T4"]
    # Nothing that was not asked for: no band, no other test.
    plain = peer.predict(table["T1"])
    assert (plain.band, plain.nearest) == (None, ())
    found = peer.predict(tmp_path, bands=True, samples=8)
    assert [one.status for one in found] == ["completed", "no history", *2 * ["completed"]]
    assert peer.scores(found)["points_within"].count() == 3
    tests = [replace(table["T2"], longitudinal_number=0), table["T3"], table["T6"]]
    twice = replace(table["T4"], duplicate_of=3)
    first = table["T1"]
    column = peer.draw(first).section, first.length, first.axial_load
    near = peer.nearest(*column, [first, *tests, twice], but=first)
    assert [one.specimen.name for one in near] == ["T3"]
    assert [one.distance for one in peer.nearest(*column, [first])] == [0.0]
    assert peer.nearest(*column, tests, but=replace(first, section="circular")) == ()


def test_commands(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["peer", str(folder), "--only", "T1", "--bands"]) == 0
    assert "Within" in capsys.readouterr().out
    out = tmp_path / "mine"
    drifts = [str(drift) for drift in DRIFTS]
    given = ["--cycles", "1", "--near", str(folder), "--out", str(out)]
    assert main(["predict", str(folder), "T5", *given, "--drifts", *drifts]) == 0
    assert "Nearest tests" in capsys.readouterr().out
    (numbers,) = read_rows(out / "numbers.csv")
    assert float(numbers["peak_force_lower"]) < float(numbers["peak_force_upper"])
    assert len(read_rows(out / "1_T5.csv")) == PATH.size
    assert (out / "1_T5.png").stat().st_size > 1e4
    # Without the friction of the rig the column is weaker.
    given += ["--no-rig", "--drifts", *drifts]
    assert main(["predict", str(folder), "T5", *given]) == 0
    (alone,) = read_rows(out / "numbers.csv")
    assert float(alone["peak_force_upper"]) < float(numbers["peak_force_upper"])
    assert main(["predict", str(folder), "T5"]) == 2
    assert "--drifts" in capsys.readouterr().err
