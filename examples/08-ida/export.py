"""Fragility curves for other programs: NRML 0.5 of the OpenQuake engine, and csv of pelicun.

Both take lognormal curves of one analysis, as of `IDA.fragilities`, and the intensity that they are
of, `analysis.runs.measure`. Accelerations are in g, and spectral ones for 5 % of damping, as the
programs know them. `case.py` writes both.
"""

import csv
import math
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

from rbsdem.fragility import Fragility
from rbsdem.motions import STANDARD_GRAVITY

#: Standard deviations of the logarithm that the levels of a curve reach to.
ENDS = 4.0


def states(curves: Mapping[str, Fragility]) -> dict[str, tuple[float, float]]:
    """Return median [g] and dispersion of each limit state, by growing median."""
    ordered = sorted(curves.items(), key=lambda item: item[1].theta)
    return {
        "_".join(state.split()): (curve.theta / STANDARD_GRAVITY, curve.beta)
        for state, curve in ordered
    }


def write_nrml(path: str, curves: Mapping[str, Fragility], intensity: Any, name: str) -> None:
    """Write a fragility model for the engine; `name` is the taxonomy of the exposure model."""
    known, period = states(curves), f"({intensity.period:.6g})"
    imt = {"pga": "PGA", "sa_t1": f"SA{period}", "sa_avg": f"AvgSA{period}"}[intensity.name]
    nrml = ElementTree.Element("nrml", xmlns="http://openquake.org/xmlns/nrml/0.5")
    kind = {"assetCategory": "buildings", "lossCategory": "structural"}
    model = ElementTree.SubElement(nrml, "fragilityModel", {"id": name, **kind})
    ElementTree.SubElement(model, "description").text = f"Fragility of {name}, by rbsdem"
    ElementTree.SubElement(model, "limitStates").text = " ".join(known)
    shape = {"id": name, "format": "continuous", "shape": "logncdf"}
    function = ElementTree.SubElement(model, "fragilityFunction", shape)
    least = min(theta * math.exp(-ENDS * beta) for theta, beta in known.values())
    most = max(theta * math.exp(ENDS * beta) for theta, beta in known.values())
    levels = {"imt": imt, "noDamageLimit": "0", "minIML": repr(least), "maxIML": repr(most)}
    ElementTree.SubElement(function, "imls", levels)
    for state, (theta, beta) in known.items():
        # Of the intensity itself, not of its logarithm.
        mean = theta * math.exp(beta**2 / 2)
        spread = mean * math.sqrt(math.expm1(beta**2))
        values = {"ls": state, "mean": repr(mean), "stddev": repr(spread)}
        ElementTree.SubElement(function, "params", values)
    ElementTree.indent(nrml)
    ElementTree.ElementTree(nrml).write(path, encoding="utf-8", xml_declaration=True)


def write_pelicun(path: str, curves: Mapping[str, Fragility], intensity: Any, name: str) -> None:
    """Write a damage model; pelicun has no averaged spectral acceleration."""
    demand = {
        "pga": "Peak Ground Acceleration",
        "sa_t1": f"Peak Spectral Acceleration|{intensity.period:.2f}",
    }[intensity.name]
    row: dict[str, object] = {
        "ID": name,
        "Incomplete": 0,
        "Demand-Type": demand,
        "Demand-Unit": "g",
        "Demand-Offset": 0,
        "Demand-Directional": 1,
    }
    for number, (theta, beta) in enumerate(states(curves).values(), 1):
        values = {"Family": "lognormal", "Theta_0": theta, "Theta_1": beta}
        row |= {f"LS{number}-{key}": value for key, value in values.items()}
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([list(row), list(row.values())])
