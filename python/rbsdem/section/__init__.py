"""Sections of reinforced concrete: moment-curvature, springs of a column, figures.

Concrete, steel, bars and ties make a `RectangularSection` or a `CircularSection`; its
`moment_curvature`, `diagram` and `springs` do the rest. Strains and axial loads are positive in
compression, y is positive to the face that a positive curvature puts in tension.
"""

from rbsdem.section.circular import CircularSection
from rbsdem.section.diagram import Confinement, Diagram, Events, Point
from rbsdem.section.materials import Concrete, Steel
from rbsdem.section.rectangular import RectangularSection
from rbsdem.section.reinforcement import Bar, Layout, Spiral, Ties
from rbsdem.section.section import Section
from rbsdem.section.shear_diagram import ShearDiagram
from rbsdem.section.shear_spring import ShearSpring
from rbsdem.section.spring_fit import SectionSprings

__all__ = [
    "Bar",
    "CircularSection",
    "Concrete",
    "Confinement",
    "Diagram",
    "Events",
    "Layout",
    "Point",
    "RectangularSection",
    "Section",
    "SectionSprings",
    "ShearDiagram",
    "ShearSpring",
    "Spiral",
    "Steel",
    "Ties",
]
