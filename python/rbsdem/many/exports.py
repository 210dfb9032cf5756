"""Fragility curves for programs of seismic risk: NRML of the OpenQuake engine, csv of pelicun."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

from rbsdem import _arguments
from rbsdem._files import atomic_write, write_csv
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem.errors import InputError
from rbsdem.many.fragility import Fragility
from rbsdem.many.runs import Intensity

#: Standard deviations of the logarithm that the levels of a curve reach to.
_ENDS = 4.0


def write_nrml(
    path: str | os.PathLike[str],
    curves: Mapping[str, Fragility],
    *,
    intensity: Intensity,
    name: str = "column",
) -> None:
    """Write fragility curves as a fragility model of NRML 0.5, for the OpenQuake engine.

    Parameters
    ----------
    path : path-like
        File to write, as ``"pier.xml"``.
    curves : mapping of str to Fragility
        Lognormal curves of one analysis, as of `IDA.fragilities`. They are the limit states of the
        model, by growing median.
    intensity : Intensity
        Of the curves, as ``analysis.runs.measure``. The engine gets accelerations in g, and knows
        the spectral ones for 5 % of damping.
    name : str, optional
        Taxonomy of the structure: the exposure model asks for it.

    Raises
    ------
    InputError
        If a curve is not lognormal, or the intensity has another damping.
    """
    states, name = _states(curves, intensity), _arguments.text(name, "name")
    period = f"({intensity.period:.6g})"
    imt = {"pga": "PGA", "sa_t1": f"SA{period}", "sa_avg": f"AvgSA{period}"}[intensity.name]
    nrml = ElementTree.Element("nrml", xmlns="http://openquake.org/xmlns/nrml/0.5")
    kind = {"assetCategory": "buildings", "lossCategory": "structural"}
    model = ElementTree.SubElement(nrml, "fragilityModel", {"id": name, **kind})
    ElementTree.SubElement(model, "description").text = f"Fragility of {name}, by rbsdem"
    ElementTree.SubElement(model, "limitStates").text = " ".join(states)
    given = {"id": name, "format": "continuous", "shape": "logncdf"}
    function = ElementTree.SubElement(model, "fragilityFunction", given)
    least = min(theta * math.exp(-_ENDS * beta) for theta, beta in states.values())
    most = max(theta * math.exp(_ENDS * beta) for theta, beta in states.values())
    levels = {"imt": imt, "noDamageLimit": "0", "minIML": repr(least), "maxIML": repr(most)}
    ElementTree.SubElement(function, "imls", levels)
    for state, (theta, beta) in states.items():
        # Of the intensity itself, not of its logarithm.
        mean = theta * math.exp(beta**2 / 2)
        spread = mean * math.sqrt(math.expm1(beta**2))
        values = {"ls": state, "mean": repr(mean), "stddev": repr(spread)}
        ElementTree.SubElement(function, "params", values)
    ElementTree.indent(nrml)
    with atomic_write(path) as file:
        ElementTree.ElementTree(nrml).write(file, encoding="utf-8", xml_declaration=True)


def write_pelicun(
    path: str | os.PathLike[str],
    curves: Mapping[str, Fragility],
    *,
    intensity: Intensity,
    name: str = "column",
) -> None:
    """Write fragility curves as the csv of a damage model of pelicun.

    Parameters
    ----------
    path : path-like
        File to write, as ``"fragility.csv"``.
    curves, intensity : optional
        As of `write_nrml`; pelicun has no averaged spectral acceleration.
    name : str, optional
        Of the component, its ID.

    Raises
    ------
    InputError
        As of `write_nrml`.
    """
    states, name = _states(curves, intensity), _arguments.text(name, "name")
    if intensity.name == "sa_avg":
        raise InputError("intensity: pelicun has no averaged spectral acceleration; take 'sa_t1'")
    spectral = f"Peak Spectral Acceleration|{intensity.period:.2f}"
    demand = "Peak Ground Acceleration" if intensity.name == "pga" else spectral
    row: dict[str, Any] = {
        "ID": name,
        "Incomplete": 0,
        "Demand-Type": demand,
        "Demand-Unit": "g",
        "Demand-Offset": 0,
        "Demand-Directional": 1,
    }
    for number, (theta, beta) in enumerate(states.values(), 1):
        values = {"Family": "lognormal", "Theta_0": theta, "Theta_1": beta}
        row |= {f"LS{number}-{key}": value for key, value in values.items()}
    write_csv(path, [list(row), list(row.values())])


def _states(
    curves: Mapping[str, Fragility], intensity: Intensity
) -> dict[str, tuple[float, float]]:
    """Return median [g] and dispersion of each limit state, by growing median."""
    _arguments.instance(intensity, "intensity", Intensity, "analysis.runs.measure has it")
    if not isinstance(curves, Mapping) or not curves:
        raise InputError("curves must be a mapping of curves, as of analysis.fragilities(...)")
    if intensity.name != "pga" and intensity.damping != 0.05:
        raise InputError(
            f"intensity: damping = {intensity.damping:g}; these programs know spectral "
            "accelerations for 0.05"
        )
    for state, curve in curves.items():
        if type(curve) is not Fragility:
            raise InputError(
                f"curves: {state!r} is a {type(curve).__name__} and not lognormal; give curves of "
                "ida or stripes"
            )
    ordered = sorted(curves.items(), key=lambda item: item[1].theta)
    return {
        "_".join(state.split()): (curve.theta / STANDARD_GRAVITY, curve.beta)
        for state, curve in ordered
    }
