"""Values of codes and of regressions for a column, from the same drawing as the model.

`code_values` collects them; the functions here are the formulas one by one.
"""

from rbsdem.checks.code_values import CodeComparison as CodeComparison
from rbsdem.checks.code_values import CodeValue as CodeValue
from rbsdem.checks.code_values import CodeValues as CodeValues
from rbsdem.checks.code_values import code_values as code_values
from rbsdem.checks.code_values import compare as compare
from rbsdem.checks.formulas import Quantities as Quantities
from rbsdem.checks.formulas import quantities as quantities
