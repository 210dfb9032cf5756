"""What follows from the drawing of a section: diagrams, strengths, springs, its column.

Each function takes a `rbsdem.RectangularSection` or `rbsdem.CircularSection` first. Strains and
axial loads are positive in compression, y is positive to the face that a positive curvature puts in
tension.
"""

from rbsdem.section.axial_moment import InteractionDiagram, interaction
from rbsdem.section.columns import column
from rbsdem.section.curvature import Diagram, diagram, moment_curvature, strains
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.paper import paper_columns, paper_sections
from rbsdem.section.paper_springs import SectionSprings, springs
from rbsdem.section.parameters import ModelParameters, parameters
from rbsdem.section.shear import ShearDiagram, shear_diagram
from rbsdem.section.spread import Spread, spread
from rbsdem.section.strength import shear_strength

__all__ = [
    "Diagram",
    "InteractionDiagram",
    "LayeredColumn",
    "ModelParameters",
    "SectionSprings",
    "ShearDiagram",
    "Spread",
    "column",
    "diagram",
    "interaction",
    "moment_curvature",
    "paper_columns",
    "paper_sections",
    "parameters",
    "shear_diagram",
    "shear_strength",
    "spread",
    "springs",
    "strains",
]
