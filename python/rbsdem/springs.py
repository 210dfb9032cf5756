"""Springs of the joints: one class for each rule."""

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

__all__ = [
    "SPRINGS",
    "Bilinear",
    "Compression",
    "ConcreteSpring",
    "Elastic",
    "Landmark",
    "Layered",
    "PeakOriented",
    "Pinching",
    "Spring",
    "SteelSpring",
    "Takeda",
]
