"""Printed numbers of textbooks, standards and other programs: inside their digits, or explained."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

import rbsdem
from rbsdem.cli import main
from rbsdem.methods.verification import PROBLEMS, PrintedValue, Problem


@pytest.mark.parametrize("problem", PROBLEMS, ids=[one.name for one in PROBLEMS])
def test_printed_numbers(problem):
    found = rbsdem.verify([problem.name])
    wrong = [one for one in found.comparisons if not one.holds and one.problem == problem]
    assert [(one.printed, one.value) for one in wrong] == []


@pytest.mark.parametrize(
    ("printed", "least", "most"), [("1.25", 1.24, 1.26), ("-3.0e2", -310, -290), ("40", 39, 41)]
)
def test_a_unit_of_the_last_digit_counts_as_inside(printed, least, most):
    """A printed number may be cut as well as rounded; beyond it a remark says why."""
    problem = Problem("A", "B", "C", printed, lambda: [0.0])
    for value, inside in ((0.999, True), (1.001, False)):
        for end in (least, most):
            value_there = float(printed) + value * (end - float(printed))
            one = PrintedValue(problem, printed, value_there)
            assert one.inside == one.holds == inside
            assert PrintedValue(replace(problem, remark="why", within=0.5), printed, end).holds


def test_command(capsys, tmp_path):
    assert main(["verify", "seven", "--all", "--output", str(tmp_path / "all.csv")]) == 0
    told = capsys.readouterr().out
    assert re.search(r"1\.45076\s+1\.450757\s+-0\.0002\d* %", told)
    assert "2 problems, 8 numbers: 8 inside the printed digits, 0 explained, 0 wrong" in told
    assert (tmp_path / "all.csv").read_text().count("SAP2000") == 8
    assert main(["verify", "nobody"]) == 2
    assert (
        "rbsdem: verify: there is no problem 'nobody'; there are Half-cycle sine pulse"
        in capsys.readouterr().err
    )
