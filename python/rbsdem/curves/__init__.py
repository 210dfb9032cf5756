"""Measured curves against computed ones: one definition of each quantity.

These definitions hold for everything that rbsdem reports: the scores of a prediction, the report of
a calibration, the tables of the examples.

path
    The two curves are interpolated linearly at `N_POINTS` points spaced evenly along the path of
    what drives the model: the sum of the absolute displacement steps when displacement drives, of
    the force steps when force drives. So an error counts by how far the test went, not by how many
    points somebody digitised there.
nrmse
    Root mean square of (model - test) over those points, over the largest absolute measured value
    of all rows. 0 is a copy of the test; a model without any force gives less than 1. What the
    analysis did not reach counts with an error of 1, as much as no prediction at a peak, so that
    stopping early does not pay: nrmse^2 = path_fraction nrmse_reached^2 + (1 - path_fraction).
peak
    The largest absolute force of the rows, and the first row that has it.
energy
    Work of the force over the whole path, by the trapezium rule over the rows. A path that does not
    end at zero force also holds a little energy that the column would give back.
stiffness
    Secant from the origin to the first crossing of 70 % of the curve's own peak force, interpolated
    between two rows. It is the effective stiffness to yield. The field takes the secant of an
    envelope at a similar level: 60 % of the yield strength (FEMA 356 section 3.3.3.2.4, ASCE 41-17
    section 7.4.3.2.4), 70 % of the peak (Sezen and Moehle 2004, J. Struct. Eng. 130(11), for
    columns), 75 % of the peak (Park 1989). A tangent at the origin, or a secant at a low level,
    would mostly measure the noise of the first digitised rows: one specimen of the paper shows 1.8
    times its gross elastic stiffness there, two show a force at no displacement. A share of the
    test's peak for both curves would give the model another stiffness in every comparison. The
    price is that a model which hardens without limit is measured after its yield; its peak ratio,
    well above 1, shows that.
cycles
    A half-cycle belongs to a turning point, where the displacement turns back by more than 2 % of
    its largest absolute value (`turning_points`). It lasts from zero force to zero force; what is
    dissipated there is its energy (`half_cycles`).
strength loss
    The first displacement past the peak of the envelope at which the force is down to 80 % of that
    peak, and does not come back in the same half-cycle (`strength_loss`): the usual limit of drift
    capacity.
ratios
    Model over test, over the rows that both have. They are not given if less than half of the path
    was reached.

Driven by displacement, a model misses the force: `compare`. Driven by force, it cannot miss the
force and misses the displacement: `displacement_metrics`.
"""

from rbsdem.curves.envelope import Envelope as Envelope
from rbsdem.curves.envelope import envelope as envelope
from rbsdem.curves.envelope import strength_loss as strength_loss
from rbsdem.curves.metrics import Loop as Loop
from rbsdem.curves.metrics import energy as energy
from rbsdem.curves.metrics import half_cycles as half_cycles
from rbsdem.curves.metrics import resample as resample
from rbsdem.curves.metrics import secant_stiffness as secant_stiffness
from rbsdem.curves.metrics import summarise as summarise
from rbsdem.curves.metrics import turning_points as turning_points
from rbsdem.curves.scores import SCORES as SCORES
from rbsdem.curves.scores import Comparison as Comparison
from rbsdem.curves.scores import compare as compare
from rbsdem.curves.scores import displacement_metrics as displacement_metrics
