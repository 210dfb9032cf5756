"""Springs of the joints: one class for each rule."""

from rbsdem.model.column import Parameter as Parameter
from rbsdem.model.springs import Bilinear as Bilinear
from rbsdem.model.springs import Compression as Compression
from rbsdem.model.springs import ConcreteSpring as ConcreteSpring
from rbsdem.model.springs import Elastic as Elastic
from rbsdem.model.springs import Gauge as Gauge
from rbsdem.model.springs import Layered as Layered
from rbsdem.model.springs import PeakOriented as PeakOriented
from rbsdem.model.springs import Pinching as Pinching
from rbsdem.model.springs import Spring as Spring
from rbsdem.model.springs import SteelSpring as SteelSpring
from rbsdem.model.springs import Strains as Strains
from rbsdem.model.springs import Takeda as Takeda
