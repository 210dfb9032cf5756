"""Sections of reinforced concrete: moment-curvature, springs of a column, figures.

Concrete, steel, bars and ties make a `RectangularSection` or a `CircularSection`; its
`moment_curvature`, `diagram`, `springs` and `column` do the rest. Strains and axial loads are
positive in compression, y is positive to the face that a positive curvature puts in tension.
"""

from rbsdem.section import figure as figure
from rbsdem.section import interaction_figure as interaction_figure
from rbsdem.section import shear_figure as shear_figure
from rbsdem.section import spread_figure as spread_figure
from rbsdem.section.circular import CircularSection
from rbsdem.section.diagram import Confinement, Diagram, Events, Point
from rbsdem.section.hollow import HollowCircularSection, HollowRectangularSection
from rbsdem.section.interaction import InteractionDiagram
from rbsdem.section.materials import Concrete, Steel
from rbsdem.section.model import MODELS, LayeredColumn, LayeredModel
from rbsdem.section.parameters import (
    HingeParameters,
    ModelParameters,
    ShearParameters,
    parameters,
    versions,
)
from rbsdem.section.rectangular import RectangularSection
from rbsdem.section.reinforcement import Bar, Layout, Spiral, Ties
from rbsdem.section.scatter import Scatter
from rbsdem.section.section import Section
from rbsdem.section.shear_diagram import ShearDiagram
from rbsdem.section.shear_spring import ShearSpring
from rbsdem.section.spread import Interval, Spread
from rbsdem.section.spring_fit import SectionSprings

__all__ = [
    "MODELS",
    "Bar",
    "CircularSection",
    "Concrete",
    "Confinement",
    "Diagram",
    "Events",
    "HingeParameters",
    "HollowCircularSection",
    "HollowRectangularSection",
    "InteractionDiagram",
    "Interval",
    "LayeredColumn",
    "LayeredModel",
    "Layout",
    "ModelParameters",
    "Point",
    "RectangularSection",
    "Scatter",
    "Section",
    "SectionSprings",
    "ShearDiagram",
    "ShearParameters",
    "ShearSpring",
    "Spiral",
    "Spread",
    "Steel",
    "Ties",
    "parameters",
    "versions",
]
