"""Laps at the foot of columns: what bars develop, where it acts, both doors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import Concrete, Lap, Layout, RectangularSection, Steel, Ties
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.frames import Frame

STEEL = Steel(510e6, 700e6)
LAPPED = RectangularSection(
    0.4572, 0.4572, Concrete(36.2e6), layout=Layout(8, 0.0254, STEEL), cover=0.0381,
    ties=Ties(0.0095, 0.4572, STEEL), lap=Lap(0.508, 0.778),
)  # fmt: skip


@pytest.mark.parametrize(
    ("length", "share"), [(0.5, 0.78745), (0.71554, 1.0), (0.65, 0.93796), (1.2, 1.0)]
)
def test_the_share_of_the_yield_stress(length, share):
    """1.25 (l_b/l_d)^(2/3), at most 1."""
    section = replace(LAPPED, lap=Lap(length, 1.0))
    assert section.lapped(STEEL) == pytest.approx(share, abs=2e-5)
    # f_y/(1.1 sqrt f'c 2.373) d_b with c_b = 38.1 + 9.5 + 12.7 mm, of bars above 19 mm.
    by_aci = replace(LAPPED, lap=Lap(0.508))
    needed = 510 / (1.1 * 36.2**0.5 * (60.3 / 25.4)) * 0.0254
    assert by_aci.lapped(STEEL) == pytest.approx(1.25 * (0.508 / needed) ** (2 / 3), rel=1e-9)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_a_lap_limits_the_bars_of_the_foot_alone():
    share, whole = LAPPED.lapped(STEEL), replace(LAPPED, lap=None)

    def bars(section: RectangularSection, end: int) -> list:
        kind = rbsdem.section.member(section, 3.0, axial_load=5e5)
        layers = kind.at("flexure", float(end)).layers
        return [layer for _, layer in layers if isinstance(layer, rbsdem.springs.SteelSpring)]

    for lapped, plain in zip(bars(LAPPED, 0), bars(whole, 0), strict=True):
        assert lapped.f_y == pytest.approx(share * plain.f_y)
        assert lapped.k == plain.k
        assert lapped.k_post < 1e-3 * plain.k_post or lapped.k_post <= plain.k_post
        assert lapped.isotropic_hardening == 0.0
    assert bars(LAPPED, 1) == bars(whole, 1)
    # So slender that it does not fail in shear.
    push = [
        rbsdem.pushover(rbsdem.section.column(one, 3.0, axial_load=5e5), drift=0.02).force.max()
        for one in (LAPPED, whole)
    ]
    assert share - 0.06 < push[0] / push[1] < 1.0
    # A lap that develops the bars changes nothing.
    assert bars(replace(LAPPED, lap=Lap(2.0, 1.0)), 0) == bars(whole, 0)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_a_case_file_knows_the_lap(tmp_path):
    column = rbsdem.section.column(LAPPED, 1.8288, axial_load=5e5)
    frame = Frame.grid([3.0], [5.0], columns=LAPPED, beams=replace(LAPPED, lap=None), dead_load=2e4)
    for name, structure in (("column", column), ("frame", frame)):
        file = tmp_path / f"{name}.nml"
        loading = "&loading drive = 'displacement', amplitudes = 0.01 /\n"
        file.write_text(structure.to_namelist() + loading)
        assert "&lap length = 0.508, development_length = 0.778 /" in file.read_text()
        assert rbsdem.read_case(file).column == structure


def test_what_a_lap_does_not_do_is_told():
    with pytest.warns(AccuracyWarning, match="lap of 0.508 m: bars are limited to 0.94 f_y"):
        rbsdem.section.column(LAPPED, 1.8288, axial_load=5e5)
    with pytest.raises(InputError, match="lap is at the foot alone"):
        rbsdem.section.column(LAPPED, 1.8288, axial_load=5e5, top="fixed")
    with pytest.raises(InputError, match="length"):
        Lap(0.0)
    assert np.isfinite(LAPPED.lapped(STEEL))
