"""Results that follow from the drawing of a section: diagrams, strengths, springs, its column.

Most functions take a `rbsdem.RectangularSection` or `rbsdem.CircularSection` first, or a
`rbsdem.frames.TeeSection` or a `rbsdem.WallSection`. Strains and axial loads are positive in
compression, y is positive to the face that a positive curvature puts in tension.
"""

from rbsdem.section.columns import column as column
from rbsdem.section.columns import member as member
from rbsdem.section.curvature import diagram as diagram
from rbsdem.section.curvature import moment_curvature as moment_curvature
from rbsdem.section.curvature import strains as strains
from rbsdem.section.layered import LayeredColumn as LayeredColumn
from rbsdem.section.panel import flange_width as flange_width
from rbsdem.section.panel import rigid_ends as rigid_ends
from rbsdem.section.paper import SectionSprings as SectionSprings
from rbsdem.section.paper import springs as springs
from rbsdem.section.parameters import parameters as parameters
from rbsdem.section.shear import shear_diagram as shear_diagram
from rbsdem.section.strength import interaction as interaction
from rbsdem.section.strength import shear_strength as shear_strength
from rbsdem.section.walls import wall as wall
from rbsdem.section.walls import wall_members as wall_members
