"""Types of the compiled extension, which f2py makes of src/bindings/bindings.f90."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int32]
Floats = NDArray[np.float64]

def rbs_evaluate(
    what: str,
    statement: bytes,
    number: Sequence[float],
    names: str,
    values: Floats,
    made: Integers,
    control: Integers,
) -> tuple[Integers, Integers, Integers]: ...
def rbs_read(answer: Integers, length: int, count: int) -> tuple[bytes, Floats]: ...
def rbs_release(answer: Integers) -> None: ...
