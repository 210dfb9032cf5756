"""Figures for publication, in mm, kN and s, and tables for the terminal in the same units.

Each record has a function of the name of its kind: `plot.envelope(result.envelope())`. Functions
take SI and draw millimetres and kilonewtons. Without axes they make a figure in the house style;
axes that are given keep the style of the caller.
"""

from rbsdem.output.buildings import building as building
from rbsdem.output.buildings import plan as plan
from rbsdem.output.frames import assessment as assessment
from rbsdem.output.frames import frame as frame
from rbsdem.output.frames import member_forces as member_forces
from rbsdem.output.frames import mode as mode
from rbsdem.output.frames import pushover as pushover
from rbsdem.output.frames import storey_drift as storey_drift
from rbsdem.output.frames import target as target
from rbsdem.output.loops import Subplot as Subplot
from rbsdem.output.loops import calibration as calibration
from rbsdem.output.loops import code_comparison as code_comparison
from rbsdem.output.loops import comparison as comparison
from rbsdem.output.loops import energy as energy
from rbsdem.output.loops import envelope as envelope
from rbsdem.output.loops import four_panels as four_panels
from rbsdem.output.loops import history as history
from rbsdem.output.loops import limit_states as limit_states
from rbsdem.output.loops import loop as loop
from rbsdem.output.loops import loops_over_test as loops_over_test
from rbsdem.output.loops import profile as profile
from rbsdem.output.many import fragilities as fragilities
from rbsdem.output.many import fragility as fragility
from rbsdem.output.many import ida as ida
from rbsdem.output.many import motion as motion
from rbsdem.output.many import spectrum as spectrum
from rbsdem.output.many import stripes as stripes
from rbsdem.output.measured import band as band
from rbsdem.output.measured import prediction as prediction
from rbsdem.output.methods import methods as methods
from rbsdem.output.section import interaction as interaction
from rbsdem.output.section import moment_curvature as moment_curvature
from rbsdem.output.section import section as section
from rbsdem.output.section import section_springs as section_springs
from rbsdem.output.section import section_state as section_state
from rbsdem.output.section import shear_diagram as shear_diagram
from rbsdem.output.style import MODEL_LINE as MODEL_LINE
from rbsdem.output.style import TEST_LINE as TEST_LINE
from rbsdem.output.style import axes_or_new as axes_or_new
from rbsdem.output.style import new_axes as new_axes
from rbsdem.output.style import save as save
from rbsdem.output.style import style as style
from rbsdem.output.tables import table as table
from rbsdem.output.units import units as units
