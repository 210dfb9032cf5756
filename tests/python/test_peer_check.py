"""Doubtful tests: loops made by hand with known labels, and the shared tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from samples import SPECIMEN, read_rows, write_history

import rbsdem
from rbsdem import peer
from rbsdem.cli import main

LENGTH, LOAD, BOTTOM = 1.6, 1.2e6, 0.3
DRAWN = {
    "longitudinal_number": 12, "cover": 0.03, "corner_diameter": 0.016, "shear_legs": 4.0,
    "intermediate_diameter": 0.016, "intermediate_perpendicular": 2, "intermediate_parallel": 2,
    "bottom_length": BOTTOM, "author": "Maker", "year": "2000", "failure_mode": "Flexure",
}  # fmt: skip


def made(
    folder: Path,
    name: str,
    *,
    force_is: int = 2,
    label: int | None = 2,
    load: float = LOAD,
    strength: float = 1.0,
    weak_side: float = 1.0,
    stiffness: float = 0.4,
    **changes: object,
) -> peer.Specimen:
    """Return a test whose base moment is elastic-plastic, with its force column by a code.

    The moment strength is that of the section times `strength`; on the negative side times
    `weak_side` too. The first stiffness is that of the gross column times `stiffness`.
    """
    specimen = replace(
        SPECIMEN,
        name=name,
        file=f"{name}.csv",
        folder=folder,
        axial_load=load,
        pdelta_code=label,
        **DRAWN | changes,
    )
    section = peer.draw(specimen).section
    peak = rbsdem.section.diagram(section, load, confined=False).events.peak
    assert peak is not None
    gross = 3 * section.concrete_law["ec"] * section.width * section.depth**3 / 12 / LENGTH**3
    turns = LENGTH * np.repeat([0.005, 0.01, 0.02, 0.03, 0.04, 0.06], 2) * np.tile([1, -1], 6)
    d = np.concatenate([np.linspace(a, b, 60) for a, b in zip([0.0, *turns], turns, strict=False)])
    highest = strength * peak.moment
    moment, moments = 0.0, []
    for step in np.diff(d, prepend=0.0):
        # Elastic, on the way of the net force, to the moment of the section.
        moment += (stiffness * gross * LENGTH + load) * step
        moment = min(max(moment, -weak_side * highest), highest)
        moments.append(moment)
    net = (np.array(moments) - load * d) / LENGTH
    if force_is == 1:
        net += load * d / LENGTH
    elif force_is == 3:
        net += load * np.sin(np.arctan(d / (LENGTH + BOTTOM)))
    write_history(folder / f"{name}.csv", d, net)
    return specimen


def doubts(tests: list[peer.Specimen]) -> set[tuple[str, str, bool, int | None]]:
    return {(d.specimen.name, d.about, d.sure, d.code) for d in peer.check(tests).doubts}


@pytest.mark.parametrize("code", [1, 2, 3])
def test_right_labels_are_not_doubted(tmp_path: Path, code: int) -> None:
    assert not doubts([made(tmp_path, "a", force_is=code, label=code)])


@pytest.mark.parametrize(
    ("force_is", "label", "code"), [(2, 1, 2), (1, 2, 1), (2, 3, 2), (1, None, 1)]
)
def test_wrong_labels_are_found_and_mended(
    tmp_path: Path, force_is: int, label: int | None, code: int
) -> None:
    tests = [
        made(tmp_path, name, force_is=force_is, label=label, load=load)
        for name, load in (("a", 2.0e6), ("b", 2.3e6), ("c", 2.6e6))
    ]
    checked = peer.check(tests)
    force = {(d.specimen.name, d.sure, d.code) for d in checked.doubts if d.about == "force"}
    assert force == {(name, True, code) for name in "abc"}
    assert [row.pdelta_code for row in checked.mended()] == 3 * [code]


def test_a_small_axial_load_tells_nothing(tmp_path: Path) -> None:
    assert not doubts([made(tmp_path, "a", force_is=1, label=2, load=0.2e6)])


def test_indicators_of_a_perfectly_plastic_column(tmp_path: Path) -> None:
    # By hand: the net envelope falls by P/L, the effective one not at all; the moment stays.
    found = peer.indicators(made(tmp_path, "a", stiffness=0.5))
    assert found.slope == pytest.approx(-1.0, abs=0.02)
    assert found.growth_net == found.growth_labelled == pytest.approx(0.0, abs=0.01)
    assert found.strength == pytest.approx(1.0, abs=0.001)
    # At half of the net force the column is elastic.
    assert found.stiffness == pytest.approx(0.5, rel=0.01)


def test_twins(tmp_path: Path) -> None:
    three = [made(tmp_path, name, strength=f) for name, f in (("a", 1.0), ("b", 1.02), ("c", 1.3))]
    assert doubts(three) == {("c", "twins", True, None)}
    assert [row.name for row in peer.check(three).mended()] == ["a", "b"]
    # Of two nobody knows which is right.
    assert doubts(three[1:]) == {("b", "twins", False, None), ("c", "twins", False, None)}
    # Other ties, other failure, another laboratory: no twins.
    other = [
        three[0],
        made(tmp_path, "d", strength=1.3, transverse_spacing=0.12),
        made(tmp_path, "e", strength=1.3, author="Other"),
    ]
    assert not doubts(other)


def test_hints(tmp_path: Path) -> None:
    assert doubts([made(tmp_path, "a", strength=1.6)]) == {("a", "strength", False, None)}
    assert doubts([made(tmp_path, "b", stiffness=1.5)]) == {("b", "stiffness", False, None)}
    assert doubts([made(tmp_path, "c", weak_side=0.7, load=0.3e6)]) == {
        ("c", "symmetry", False, None)
    }


def test_a_repeated_history_is_set_aside(tmp_path: Path) -> None:
    tests = [made(tmp_path, "a"), replace(made(tmp_path, "b"), duplicate_of=1)]
    assert doubts(tests) == {("b", "history", True, None)}
    assert [row.name for row in peer.check(tests).mended()] == ["a"]
    checked = peer.check([replace(made(tmp_path, "a"), file=None)])
    assert (checked.indicators, checked.doubts, len(checked.mended())) == ((), (), 0)


def test_the_shared_tests(
    peer_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["peer", str(peer_folder), "--check", "--out", str(tmp_path)]) == 0
    assert "surely doubtful" in capsys.readouterr().out
    rows = read_rows(tmp_path / "check.csv")
    # The force of this series is net, whatever its label: the loop itself says so.
    bayrak = [row for row in rows if row["series"] == "Bayrak 1996"]
    assert [row["code_instead"] for row in bayrak] == 8 * ["2"]
    # The paper's four are not in doubt.
    names = {file.removesuffix(".csv") for files in peer.HISTORY_FILES.values() for file in files}
    paper = [row for row in rows if row["file"].removesuffix(".csv") in names]
    assert [row["sure"] for row in paper] == 4 * [""]


def test_mended_predictions(peer_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [str(peer_folder), "--quiet", "--jobs", "1", "--only", "Bayrak*AS-3HT*"]
    for more in ([], ["--mended"]):
        assert main(["peer", *arguments, *more]) == 0
    printed = capsys.readouterr().out.splitlines()
    labelled, mended = (float(row.split()[4]) for row in printed if row.strip().startswith("all"))
    # A net force that is corrected once more loses far too much.
    assert mended < 0.7 * labelled
