"""Strains of bars, core and cover: deformations of the layers over the lengths they stand for.

Before anything cracks or yields plane sections give them in closed form; at every row they follow
from opening and rotation.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from samples import SECTION, read_rows

import rbsdem
from rbsdem.springs import Elastic, Gauge, Layered


def test_elastic_layers_have_the_strains_of_a_plane_section() -> None:
    """Two layers: N/(2 k) each, and the moment as a couple; over the length the strain."""
    stiffness, places, length = 1e8, np.array([-0.1, 0.15]), (0.2, 0.4)
    joint = Layered([(y, Elastic(stiffness)) for y in places])
    column = rbsdem.Column(1.5, 1.0, Elastic(1e9), joint, axial_load=2e5)
    result = rbsdem.cyclic(column, displacement=[0.002, -0.001], openings=True)
    strains = result.strains(gauge=Gauge(("core", "bar"), length))
    moment = 1.5 * result.force
    # About the second layer, and about the first.
    forces = np.stack([-(2e5 * 0.15 + moment) / 0.25, -(2e5 * 0.1 - moment) / 0.25], axis=1)
    np.testing.assert_allclose(strains.value, forces / stiffness / length, rtol=1e-9)
    np.testing.assert_array_equal(strains.bar_tension, np.maximum(strains.value[:, 1], 0))
    np.testing.assert_array_equal(strains.core_compression, np.maximum(-strains.value[:, 0], 0))
    assert (strains.cover_compression == 0).all()


def test_a_column_from_its_drawing_knows_its_gauges(tmp_path: Path) -> None:
    """Kinds and places of the drawing; under the axial load alone all strains are equal."""
    column = rbsdem.section.column(SECTION, 1.6, axial_load=7e5)
    path = 1.6 * np.array([0.0, 0.0025, -0.0025, 0.01, -0.01, 0.02])
    result = rbsdem.cyclic(column, displacement=path, openings=True)
    strains = result.strains()
    assert set(strains.part) == {"bar", "core", "cover"}
    assert (strains.part == "bar").sum() == 8
    # Bars in rows between the faces; cover reaches farther than core.
    reach = {part: np.abs(strains.position[strains.part == part]).max() for part in strains.part}
    assert reach["bar"] == pytest.approx(0.2 - 0.02 - 0.01 - 0.01)
    assert reach["core"] < reach["cover"] < 0.2
    concrete = strains.value[0, strains.part != "bar"]
    np.testing.assert_allclose(concrete, concrete[0], rtol=1e-9)
    assert -3e-4 < concrete[0] < 0
    # Yield of the bars at 450 MPa is passed between 0.25 and 1 % of drift.
    assert strains.bar_tension[1] < 450e6 / 200e9 < strains.bar_tension[3]
    assert (strains.cover_compression >= strains.core_compression).all()
    # Each extreme is that of a layer, and of a layer's deformation over its length.
    bars = result.layer_deformation()[:, strains.part == "bar"].max(axis=1)
    gauge = column.gauge(1)
    assert gauge is not None
    np.testing.assert_allclose(
        strains.bar_tension, np.maximum(bars, 0) / gauge.length[-1], rtol=1e-14
    )
    strains.to_csv(tmp_path / "strains.csv")
    rows = read_rows(tmp_path / "strains.csv")
    assert [float(row["bar_tension_1"]) for row in rows] == strains.bar_tension.tolist()
