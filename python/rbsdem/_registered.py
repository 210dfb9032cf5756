"""Views that methods of records still ask for; who drops the methods drops them here."""

from __future__ import annotations

from typing import Any

from rbsdem._views import view_of
from rbsdem.checks import code_comparison, code_values  # noqa: F401
from rbsdem.checks.code_comparison import CodeComparison
from rbsdem.checks.limit_states import LimitStates
from rbsdem.many.cloud import Cloud
from rbsdem.many.fragility import Fragility
from rbsdem.many.ida import IDA
from rbsdem.many.stripes import Stripes
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.predictions import Predictions
from rbsdem.model.section import Section
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.spectrum import Spectrum
from rbsdem.output import (  # noqa: F401
    band_views,
    code_table,
    ensemble_table,
    ensemble_tables,
    limit_state_table,
    loops,
    many,
    measured,
    peer_tables,
    section,
)
from rbsdem.section.diagram import Diagram
from rbsdem.section.interaction import InteractionDiagram
from rbsdem.section.shear_diagram import ShearDiagram
from rbsdem.section.spread import Spread
from rbsdem.section.spring_fit import SectionSprings
from rbsdem.web.gallery import gallery


def _draw(kind: type, function: Any, *names: str) -> None:
    def draw(record: Any, *given: Any, **line: Any) -> Any:
        return function(record, **dict(zip(names, given, strict=False)), **line)

    view_of(kind, "plot")(draw)


_draw(CodeComparison, loops.code_comparison, "ax")
_draw(LimitStates, loops.limit_states, "ax")
_draw(Cloud, many.cloud, "ax")
_draw(Fragility, many.fragility, "ax")
_draw(IDA, many.ida, "ax")
_draw(Stripes, many.stripes, "ax")
_draw(GroundMotion, many.motion, "ax")
_draw(Spectrum, many.spectrum, "ax")
_draw(Prediction, measured.prediction)
_draw(Section, section.section, "ax")
_draw(Diagram, section.moment_curvature, "ax")
_draw(SectionSprings, section.section_springs)
_draw(ShearDiagram, section.shear_diagram, "ax")
_draw(InteractionDiagram, section.interaction, "ax", "demand", "design")
_draw(Spread, measured.spread, "test", "ax")
view_of(Predictions, "gallery")(gallery)
view_of(Predictions, "contact_sheet")(measured.contact_sheet)
view_of(Predictions, "band_sheet")(measured.band_sheet)
