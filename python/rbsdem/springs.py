"""Springs of the joints: one class for each rule."""

from rbsdem.model.parameter import Parameter
from rbsdem.model.springs import (
    SPRINGS,
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Landmark,
    Layered,
    PeakOriented,
    Pinching,
    Spring,
    SteelSpring,
    Takeda,
)
from rbsdem.model.strains import Gauge, Strains

__all__ = [
    "SPRINGS",
    "Bilinear",
    "Compression",
    "ConcreteSpring",
    "Elastic",
    "Gauge",
    "Landmark",
    "Layered",
    "Parameter",
    "PeakOriented",
    "Pinching",
    "Spring",
    "SteelSpring",
    "Strains",
    "Takeda",
]
