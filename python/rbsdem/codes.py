"""Values of codes and of regressions for a column, from the same drawing as the model.

`code_values` collects them; the functions here are the formulas one by one.
"""

from rbsdem.checks.code_comparison import CodeComparison, compare
from rbsdem.checks.code_values import CodeValue, CodeValues, code_values
from rbsdem.checks.formulas import Quantities, quantities

__all__ = [
    "CodeComparison",
    "CodeValue",
    "CodeValues",
    "Quantities",
    "code_values",
    "compare",
    "quantities",
]
