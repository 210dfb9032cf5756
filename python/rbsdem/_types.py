"""Types of annotations. Those of packages that are loaded late are `Any` when the program runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from typing_extensions import Self, Unpack
else:
    Axes = DataFrame = Self = Unpack = Any

__all__ = ["Array", "ArrayLike", "Axes", "DataFrame", "NDArray", "Self", "Unpack"]
Array = NDArray[np.float64]
