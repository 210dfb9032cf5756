"""Figures for publication, in mm, kN and s, and tables for the terminal in the same units.

Each record has a function of the name of its kind: `plot.envelope(result.envelope())`. Functions
take SI and draw millimetres and kilonewtons. Without axes they make a figure in the house style,
the dictionary `RC`; axes that are given keep the style of the caller.
"""

from rbsdem.output.loops import (
    Panel,
    calibration,
    code_comparison,
    comparison,
    envelope,
    four_panels,
    limit_states,
    loop,
    loops_over_test,
)
from rbsdem.output.many import cloud, fragilities, fragility, ida, motion, spectrum, stripes
from rbsdem.output.measured import band_sheet, contact_sheet, prediction, spread
from rbsdem.output.methods import methods
from rbsdem.output.response import energy, history, profile
from rbsdem.output.section import (
    interaction,
    moment_curvature,
    section,
    section_springs,
    section_state,
    shear_diagram,
)
from rbsdem.output.style import (
    MODEL_LINE,
    RC,
    TEST_LINE,
    TEST_POINTS,
    ZERO_LINE,
    axes_or_new,
    line_of,
    new_axes,
    save,
    style,
    style_of,
)
from rbsdem.output.tables import table

__all__ = [
    "MODEL_LINE",
    "RC",
    "TEST_LINE",
    "TEST_POINTS",
    "ZERO_LINE",
    "Panel",
    "axes_or_new",
    "band_sheet",
    "calibration",
    "cloud",
    "code_comparison",
    "comparison",
    "contact_sheet",
    "energy",
    "envelope",
    "four_panels",
    "fragilities",
    "fragility",
    "history",
    "ida",
    "interaction",
    "limit_states",
    "line_of",
    "loop",
    "loops_over_test",
    "methods",
    "moment_curvature",
    "motion",
    "new_axes",
    "prediction",
    "profile",
    "save",
    "section",
    "section_springs",
    "section_state",
    "shear_diagram",
    "spectrum",
    "spread",
    "stripes",
    "style",
    "style_of",
    "table",
]
