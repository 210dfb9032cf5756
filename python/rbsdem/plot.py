"""Figures for publication, in mm, kN and s.

matplotlib is imported when a figure is asked for.
Functions take SI and draw millimetres and kilonewtons. Without axes they make a figure in the house
style, the dictionary `RC`; axes that are given keep the style of the caller.
"""

from rbsdem.output.loops import Panel, four_panels, loop, loops_over_test
from rbsdem.output.response import energy, history, profile
from rbsdem.output.state_figure import section_state
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

__all__ = [
    "MODEL_LINE",
    "RC",
    "TEST_LINE",
    "TEST_POINTS",
    "ZERO_LINE",
    "Panel",
    "axes_or_new",
    "energy",
    "four_panels",
    "history",
    "line_of",
    "loop",
    "loops_over_test",
    "new_axes",
    "profile",
    "save",
    "section_state",
    "style",
    "style_of",
]
