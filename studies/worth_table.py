"""What the layered model is worth beside backbones of codes: the table of docs/codes.md.

    python studies/worth_table.py FOLDER

FOLDER holds the histories and the table of the tests; doubtful labels are mended. Every source
makes a column from the same drawing, which goes through the same path with the same second-order
effects:

- the layered model, with the numbers that were fitted without the series of the test
  (`studies/fit_model.py`);
- Haselton and others 2008, 2016, rectangles only: backbone of a hinge under one push with a
  peak-oriented rule, which deteriorates with an energy of 30 x 0.3^n theta_cap M_y;
- ASCE 41-17: backbone of chapter 10, not stronger than its shear strength; peak-oriented;
- nominal: yield moment and effective stiffness of ASCE 41-17, no loss; peak-oriented.

Then drifts at yield, as the largest force over the secant at 70 % of it, and at a loss of 20 %:
calculated over measured. At last the drift at axial failure of Elwood and Moehle (2005) beside the
largest drift of the columns of Lynn and Sezen, whose tests were ended by the loss of the axial
load, and `CodeValues.compare`'s idealised drift at yield by definition.
"""

from __future__ import annotations

import argparse
import json
import math
import warnings
from collections.abc import Callable
from pathlib import Path

import fit_model
import numpy as np

import rbsdem
from rbsdem import peer
from rbsdem.checks.code_values import yield_drift
from rbsdem.codes import CodeValues, code_values
from rbsdem.curves.envelope import IDEALISATIONS, envelope
from rbsdem.errors import InputError
from rbsdem.section.strength import (
    axial_failure_drift,
    column_shear_strength,
    shear_strength_mcft,
)
from rbsdem.springs import Elastic, PeakOriented

ROOT = Path(__file__).resolve().parents[1]
#: Ties of these columns are so few that they were tested to the loss of their axial load.
LOST = ("Lynn", "Sezen")
MODES = ("Flexure", "Flexure-Shear", "Shear")
CLASSES = [f"{a}, {b}" for a in ("rectangular", "round") for b in MODES]
_without: dict[str, np.ndarray] = {}


def layered(specimen: peer.Specimen) -> rbsdem.Column:
    """Return the column of the model that has not seen the series of the test."""
    if not _without:  # In a process of its own.
        _begin(str(specimen.folder))
    return peer.column(specimen, model_parameters=fit_model.at(_without[specimen.series]))


def values_of(specimen: peer.Specimen) -> CodeValues:
    """Return the values of the codes for a test."""
    return code_values(peer.draw(specimen).section, specimen.length, specimen.axial_load)


def lumped(specimen: peer.Specimen, **spring: float) -> rbsdem.Column:
    """Return a column that turns about its foot."""
    hinge = PeakOriented(**spring)
    stiff = Elastic(1e3 * hinge.f_y / hinge.d_y / specimen.length**2)
    return rbsdem.Column(
        specimen.length,
        specimen.mass,
        shear=stiff,
        flexure=hinge,
        axial_load=specimen.axial_load,
        axial_height=specimen.axial_height,
        kinematics="pdelta",
    )


def haselton(specimen: peer.Specimen) -> rbsdem.Column:
    """Return the column of Haselton's backbone."""
    values = values_of(specimen)
    turned, moment = yield_drift(values, "haselton.stiffness"), values["yield.moment"]
    cap = values["haselton.cap"]
    lasts = 30.0 * 0.3**specimen.axial_load_ratio * cap / turned
    return lumped(
        specimen,
        d_y=turned,
        f_y=moment,
        d_cap=turned + cap,
        f_cap=values["haselton.hardening"] * moment,
        d_pc=values["haselton.post_cap"],
        lambda_s=lasts,
        lambda_c=lasts,
    )


def asce_41(specimen: peer.Specimen) -> rbsdem.Column:
    """Return the column of the backbone of ASCE 41."""
    values = values_of(specimen)
    turned, moment = yield_drift(values, "asce_41.stiffness"), values["yield.moment"]
    share = min(1.0, values["asce_41.shear"] * specimen.length / moment)
    a, b, c = (values[f"asce_41.{name}"] for name in "abc")
    turned, moment = share * turned, share * moment
    return lumped(
        specimen,
        d_y=turned,
        f_y=moment,
        d_cap=turned + a,
        f_cap=moment,
        d_pc=max(b - a, 0.1 * turned),
        f_res=min(c, 0.99) * moment,
        d_u=turned + max(b, 1.1 * a),
    )


def nominal(specimen: peer.Specimen) -> rbsdem.Column:
    """Return the column with the yield moment and the stiffness of ASCE 41, without loss."""
    values = values_of(specimen)
    turned, moment = yield_drift(values, "asce_41.stiffness"), values["yield.moment"]
    return lumped(
        specimen, d_y=turned, f_y=moment, d_cap=1e3 * turned, f_cap=moment, d_pc=1e3 * turned
    )


SOURCES: dict[str, Callable[[peer.Specimen], rbsdem.Column]] = {
    "layered model, left out": layered,
    "Haselton, peak-oriented": haselton,
    "ASCE 41-17, peak-oriented": asce_41,
    "nominal moment, ASCE 41-17 stiffness": nominal,
}


def _begin(folder: str) -> None:
    cases = fit_model.load(folder)
    kept = json.loads((ROOT / "studies/results/fit_model.json").read_text("utf-8"))
    groups = fit_model.groups_of(cases, len(kept["without"]))
    for places, members in zip(kept["without"], groups, strict=True):
        for i in members:
            _without[cases[i].specimen.series] = np.array(places)


def ratios(logs: list[float]) -> str:
    """Return the median of ratios with their number, and their scatter, from their logarithms."""
    known = np.array([value for value in logs if math.isfinite(value)])
    if not known.size:
        return "| - | - "
    return f"| {math.exp(np.median(known)):.2f} ({known.size}) | {np.std(known):.2f} "


def by_class(found: dict[str, list[peer.Prediction]]) -> None:
    """Print errors by class."""
    print("| median nrmse | " + " | ".join(CLASSES) + " | all, mean of series means |")
    print("| --- |" + " ---: |" * (len(CLASSES) + 1))
    for name, rows in found.items():
        cells = []
        for kind in CLASSES:
            own = [row.score("nrmse") for row in rows if row.specimen.kind == kind]
            cells.append(f"{np.median(own):.3f}" if own else "-")
        series: dict[str, list[float]] = {}
        for row in rows:
            series.setdefault(row.specimen.series, []).append(row.score("nrmse"))
        mean = np.mean([np.mean(own) for own in series.values()])
        median = np.median([row.score("nrmse") for row in rows])
        print(f"| {name}, {len(rows)} tests | {' | '.join(cells)} | {median:.3f}, {mean:.3f} |")


def numbers(found: dict[str, list[peer.Prediction]]) -> None:
    """Print ratios of single numbers."""
    print(
        "\n| calculated over measured: median (tests), sd of ln | largest force | | work | "
        "| drift at yield | | drift at 20 % loss | |"
    )
    print("| --- |" + " ---: |" * 8)
    for name, rows in found.items():
        logs: dict[str, list[float]] = {key: [] for key in ("peak", "energy", "yield", "loss")}
        for row in rows:
            logs["peak"].append(_log(row.score("peak_ratio")))
            logs["energy"].append(_log(row.score("energy_ratio")))
            logs["yield"].append(_log(row.score("peak_ratio") / row.score("stiffness_ratio")))
            drifts = row.score("model_drift_at_loss"), row.score("test_drift_at_loss")
            logs["loss"].append(_log(drifts[0] / drifts[1]))
        print(f"| {name} {''.join(ratios(each) for each in logs.values())}|")


def strengths(specimens: list[peer.Specimen]) -> None:
    """Print the largest force of tests over the shear strength of sections and of columns."""
    print(
        "\n| largest force over shear strength: mean, sd of ln | tests | of sections | of columns |"
    )
    print("| --- | ---: | ---: | ---: |")
    for kind in [kind for kind in CLASSES if "Shear" in kind]:
        logs = []
        for s in specimens:
            if s.kind == kind and (kind.endswith(" Shear") or s.axial_load_ratio < 0.5):
                hinge = peer.draw(s).section, s.length, s.axial_load
                force = np.max(np.abs(s.test().force))
                law = [shear_strength_mcft(*hinge), column_shear_strength(*hinge)]
                logs.append(np.log(force / np.array(law)))
        if not logs:
            continue
        mean, sd = np.exp(np.mean(logs, axis=0)), np.std(logs, axis=0)
        cells = [f"{a:.2f}, {b:.3f}" for a, b in zip(mean, sd, strict=True)]
        print(f"| {kind} | {len(logs)} | {' | '.join(cells)} |")


def axial_failures(specimens: list[peer.Specimen]) -> None:
    """Print drifts at axial failure."""
    print("\n| test | n | drift at axial failure | largest drift of the test |")
    print("| --- | ---: | ---: | ---: |")
    logs = []
    for s in specimens:
        if s.name.startswith(LOST):
            drift = axial_failure_drift(peer.draw(s).section, s.axial_load)
            largest = float(np.max(np.abs(s.test().displacement))) / s.length
            logs.append(_log(largest / drift))
            print(f"| {s.name} | {s.axial_load_ratio:.2f} | {drift:.4f} | {largest:.4f} |")
    print(f"measured over calculated {ratios(logs)}|")


def idealised(rows: list[peer.Prediction]) -> None:
    """Print the drift at yield of the model over that of the test, by definition."""
    print("\n| drift at yield of the model over the test, by | median (tests) | sd of ln |")
    print("| --- | ---: | ---: |")
    for method in IDEALISATIONS:
        logs = []
        for row in rows:
            known = row.comparison
            d, side = known.displacement[: known.rows], 1
            pair = []
            for f in (known.model_force[: known.rows], known.test_force[: known.rows]):
                try:
                    side = 1 if f[np.argmax(np.abs(f) >= 0.75 * np.max(np.abs(f)))] > 0 else -1
                    pair.append(envelope((d, f), side).idealise(method).yield_displacement)
                except InputError:
                    pair.append(math.nan)
            logs.append(_log(pair[0] / pair[1]))
        print(f"| {method} {ratios(logs)}|")


def main() -> None:
    """Predict, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    _begin(given.folder)
    cases = fit_model.load(given.folder)
    specimens = [case.specimen for case in cases]
    depths = np.quantile([case.column.drawing.section.depth for case in cases], (0, 0.05, 0.95, 1))
    print("columns {:.2f} to {:.2f} ({:.2f} to {:.2f}) m deep: 90 % (all)\n".format(
        *depths[[1, 2, 0, 3]]))  # fmt: skip
    found = {}
    for name, model in SOURCES.items():
        rows = peer.predict(specimens, model=model)
        # A source that does not cover a test is not counted there.
        found[name] = [row for row in rows if row.status in ("completed", "stopped")]
    by_class(found)
    numbers(found)
    strengths(specimens)
    axial_failures(specimens)
    idealised(found["layered model, left out"])


def _log(value: float) -> float:
    return math.log(value) if value > 0 and math.isfinite(value) else math.nan


if __name__ == "__main__":
    main()
