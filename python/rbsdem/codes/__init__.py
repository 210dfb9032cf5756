"""Values of codes and of regressions for a column, from the same drawing as the model.

`rbsdem.section.Section.code_values` collects them; the functions here are the formulas one by one.
"""

from rbsdem.codes import figure as figure
from rbsdem.codes import table as table
from rbsdem.codes.comparison import CodeComparison
from rbsdem.codes.drawing import Quantities, quantities
from rbsdem.codes.values import CodeValue, CodeValues

__all__ = ["CodeComparison", "CodeValue", "CodeValues", "Quantities", "quantities"]
