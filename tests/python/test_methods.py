"""Facts of the methods of analysis: what the docs say is what the program has and does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rbsdem
from rbsdem import _core
from rbsdem.run.solver import IMPLICIT, IN_TIME, METHODS, STATIC
from rbsdem.springs import Bilinear, Elastic, Takeda

ROOT = Path(__file__).resolve().parents[2]
VALUES = {
    "dt": 1e-3,
    "events": "located",
    "tolerance": 1e-6,
    "rho_infinity": 0.9,
    "allow_unstable": True,
}


def cells(line: str) -> list[str]:
    return [cell.strip().strip("`'") for cell in line.strip().strip("|").split("|")]


def test_the_docs_have_the_table_of_the_program() -> None:
    lines = (ROOT / "docs/input.md").read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(lines) if cells(line)[:2] == ["method", "order"])
    body = lines[head + 2 : head + 2 + len(METHODS)]
    assert not lines[head + 2 + len(METHODS)].startswith("|")
    written = [dict(zip(cells(lines[head]), cells(line), strict=True)) for line in body]
    assert written == _core.methods()


def test_names_in_time() -> None:
    assert set(METHODS) == {*STATIC, *IN_TIME}
    assert set(IMPLICIT) == {"newmark", "hht", "generalised_alpha"}


def column(kinematics: str) -> rbsdem.Column:
    return rbsdem.Column(1.0, 100.0, Elastic(1e6), Elastic(1e6), kinematics=kinematics)


@pytest.mark.parametrize("method", IN_TIME)
@pytest.mark.parametrize("setting", sorted(VALUES))
def test_a_method_takes_the_settings_of_its_row(method: str, setting: str) -> None:
    def run() -> None:
        rbsdem.time_history(
            column("small"),
            time=[0.0, 0.01],
            force=np.array([0.0, 1.0]),
            method=method,
            **{setting: VALUES[setting]},
        )

    if setting in METHODS[method].settings:
        run()
    else:
        with pytest.raises(rbsdem.InputError, match=f"{setting} has no meaning for method"):
            run()


@pytest.mark.parametrize("method", ["rk4", *IMPLICIT])
def test_a_method_takes_the_step_of_its_row(method: str) -> None:
    row = METHODS[method]
    modes = rbsdem.modes(column("small"))
    own = row.limit_share * modes.stable_step + row.period_share / modes.frequency[0]
    duration = 1000.5 * own
    result = rbsdem.time_history(
        column("small"), time=[0.0, duration], force=np.array([0.0, 1.0]), method=method
    )
    assert result.summary["steps"] == 1001


SHEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
HINGE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
TIME = 0.02 * np.arange(51)
SHAKE = {"time": TIME, "ground_acceleration": 5 * np.sin(20 * TIME)}
STILL = {"time": [0.0, 0.01], "force": [0.0, 0.0]}


def yielding(**more: Any) -> rbsdem.Column:
    return rbsdem.Column(1.6, 614.4, SHEAR, HINGE, **more)


def stiff() -> rbsdem.Column:
    """Many short bodies, whose hinges share the flexibility of one."""
    n = 200
    shear, hinge = Elastic(SHEAR.k * n), HINGE.split(n)
    return rbsdem.Column(1.6, 614.4, shear, hinge, n=n, kinematics="pdelta", top_mass=2e4)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_the_choice_of_auto_and_its_reason() -> None:
    """Numbers of steps in the reason are bounds of those that are taken, to six digits."""
    for one, loads, settings, method, words in (
        (column("small"), STILL, {}, "rk4", ""),
        (yielding(), STILL, {}, "rk4", "located"),
        (yielding(kinematics="finite"), STILL, {}, "rk45", "finite rotations"),
        (yielding(), STILL, {"tolerance": 1e-8}, "rk45", "1e-08"),
        (stiff(), SHAKE, {}, "generalised_alpha", "stiff"),
    ):
        summary = rbsdem.time_history(one, **loads, method="auto", **settings).summary
        assert summary["method"] == method
        assert words in summary["reason"]
    told = {
        word: float(re.search(rf"{word} ([\d.e+]+)", summary["reason"])[1])
        for word in ("takes about", "would take")
    }
    assert 0.5 * told["takes about"] <= summary["steps"] <= 1.00001 * told["takes about"]
    named = rbsdem.time_history(one, **SHAKE, method="generalised_alpha").summary
    assert named["steps"] == summary["steps"]
    steps = np.ceil(np.diff(TIME) / (rbsdem.modes(one).stable_step / 5)).sum()
    assert 0.5 * told["would take"] <= steps <= 1.00001 * told["would take"]
