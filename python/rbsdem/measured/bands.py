"""The band of the prediction of one test."""

from __future__ import annotations

from typing import Any

from rbsdem.measured.columns import column
from rbsdem.measured.specimen import Specimen
from rbsdem.section.spread import Spread

__all__ = ["band"]


def band(specimen: Specimen, *, samples: int = 16, **options: Any) -> Spread:
    """Predict a test with the band that holds 80 % of the points of left-out tests.

    `rbsdem.peer.predict` does it with scores and the nearest tests.

    Parameters
    ----------
    specimen : Specimen
        The test; of what was measured only the displacement is used.
    samples : int, optional
        As for `rbsdem.section.model.LayeredColumn.spread`.
    **options
        As for `rbsdem.peer.column`.

    Raises
    ------
    InputError
        If there is no history, the section is refused, or the version has no bands.
    """
    test = specimen.test()
    return column(specimen, **options).spread(test.displacement, samples=samples)
