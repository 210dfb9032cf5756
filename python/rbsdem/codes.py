"""Codes: values for a column from its drawing, target displacements and acceptance of frames.

`code_values` collects the values of a column; `target` has the displacement that a spectrum asks of
a frame.
"""

from rbsdem.checks.acceptance import Assessment as Assessment
from rbsdem.checks.acceptance import assess as assess
from rbsdem.checks.asce_41 import beam_rotations as beam_rotations
from rbsdem.checks.code_values import CodeValues as CodeValues
from rbsdem.checks.code_values import code_values as code_values
from rbsdem.checks.code_values import compare as compare
from rbsdem.checks.target import Capacity as Capacity
from rbsdem.checks.target import Target as Target
from rbsdem.checks.target import target as target
from rbsdem.many.check_target import check_target as check_target
from rbsdem.many.judgement import Judgement as Judgement
from rbsdem.many.judgement import judge as judge
from rbsdem.motions.design import DesignSpectrum as DesignSpectrum
from rbsdem.section.quantities import quantities as quantities
