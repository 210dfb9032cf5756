"""Works to cite: those of what was used, all of it and nothing else."""

from __future__ import annotations

import re

import numpy as np
import pytest
from samples import SECTION

import rbsdem
from rbsdem import _core, _package
from rbsdem.springs import Bilinear, Elastic, PeakOriented

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

TIME = np.arange(0.0, 1.0, 0.01)
MOTION = np.sin(9.0 * TIME)


def keys(text: str) -> set[str]:
    """Return the keys of entries; each is closed, and has an author and a title."""
    found = re.findall(r"^@(\w+)\{(\w+),\n((?:  \w+ = \{.*\},?\n)+)\}$", text, re.MULTILINE)
    assert len(found) == text.count("@")
    for _, _, fields in found:
        assert {"author", "title"} <= set(re.findall(r"^  (\w+) =", fields, re.MULTILINE))
        assert fields.count("{") == fields.count("}")
    return {key for _, key, _ in found}


def test_every_rule_and_method_has_a_work():
    known = {part for row in _package.rows("references.csv") for part in row["of"].split()}
    methods = next(one for one in _core.keys()["groups"]["analysis"] if one["name"] == "method")
    wanted = {f"rule:{name}" for name in _core.keys()["rules"]}
    wanted |= {f"method:{name}" for name in methods["choices"] if name != "auto"}
    assert wanted <= known
    assert {part for part in known if ":" in part} <= wanted


@pytest.mark.parametrize(
    ("method", "work"),
    [
        ("newmark", "newmark_1959"),
        ("hht", "hilber_1977"),
        ("generalised_alpha", "chung_1993"),
        ("rk4", "kutta_1901"),
        ("rk45", "dormand_1980"),
    ],
)
def test_the_method_and_the_rules_that_were_used(method, work):
    column = rbsdem.Column(1.6, 600.0, Bilinear(7e7, 1.3e-3, 8e5), Elastic(1e8), top_mass=3e4)
    dt = None if method.startswith("rk") else 0.01
    run = rbsdem.time_history(column, TIME, ground_acceleration=MOTION, method=method, dt=dt)
    assert keys(run.citation()) == {"rbsdem", "governing_equations", work}
    assert _core.version() in run.citation()
    hinge = PeakOriented(d_y=2e-3, f_y=2e5, d_cap=0.05, f_cap=3e5, d_pc=0.1)
    bent = rbsdem.Column(1.6, 600.0, Elastic(7e7), hinge)
    found = keys(rbsdem.cyclic(bent, displacement=[0.01]).citation())
    assert found == {"rbsdem", "governing_equations", "takeda_1970", "ibarra_2005", "rahnama_1993"}


def test_drawn_columns_cite_the_tests_that_they_were_fitted_to():
    drawn = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
    found = keys(rbsdem.cyclic(drawn, displacement=[0.01]).citation())
    assert {"peer_database", "mander_1988", "kawai_1978", "popovics_1973", "iwan_1966"} <= found
    assert not {"newmark_1959", "elwood_moehle_2005_axial"} & found
    frame = rbsdem.Frame.grid([3.2], [5.0], columns=SECTION, beams=SECTION, dead_load=2e4)
    push = rbsdem.pushover(frame, drift=0.01, points=4)
    assert found | {"elwood_moehle_2005_axial"} <= keys(push.citation())


def test_an_ensemble_and_its_fragility():
    columns = [
        rbsdem.Column(1.6, 600.0, Elastic(7e7), spring, top_mass=3e4)
        for spring in (Elastic(1e8), rbsdem.springs.Takeda(2.5e8, 3e-4, 6e7, 3e-3, 7e6))
    ]
    runs = rbsdem.ensemble(columns, (TIME, MOTION), method="hht", dt=0.01)
    assert keys(runs.citation()) == {
        "rbsdem", "governing_equations", "takeda_1970", "hilber_1977",
    }  # fmt: skip
    curve = rbsdem.fragility.Fragility("collapse", 5.0, 0.4, np.eye(2), None)
    assert keys(curve.citation()) == {"rbsdem", "baker_2015"}
