"""What analyses at several intensities have in common: fragilities of limit states, and a table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rbsdem.errors import InputError
from rbsdem.many.fragility import Fragility
from rbsdem.many.measures import limit_states
from rbsdem.many.runs import Runs

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Fragile"]

Curve = TypeVar("Curve", bound=Fragility)


class Fragile(ABC, Generic[Curve]):
    """Runs that fragility curves can be fitted to, each in its own way."""

    runs: Runs

    @abstractmethod
    def _fit(self, name: str, measure: str, limit: float, beta: float | None) -> Curve:
        """Return the fragility curve of a limit state under a name."""

    def _one(self, edp: str, threshold: float | None, beta: float | None = None) -> Curve:
        ((name, (measure, limit)),) = limit_states(edp, threshold).items()
        return self._fit(name, measure, limit, beta)

    def fragilities(
        self,
        limits: Mapping[str, Any],
        edp: str = "peak_drift",
        beta: Mapping[str, float] | None = None,
    ) -> dict[str, Curve]:
        """Return the fragility curves of several limit states.

        Parameters
        ----------
        limits : mapping
            By name a threshold of `edp`, or a pair of a measure and its threshold, as
            ``{"yield": ("first_yield", None), "repair": 0.01, "collapse": ("collapse", None)}``.
        edp : str, optional
            Measure of the thresholds that come alone.
        beta : mapping, optional
            By name a stated beta, as for `IDA.fragility`.

        Raises
        ------
        InputError
            If a curve is not determined, or a beta belongs to no limit state.
        """
        states, stated = limit_states(edp, limits), dict(beta or {})
        if unknown := stated.keys() - states.keys():
            raise InputError(
                f"beta of {', '.join(sorted(unknown))}: no such limit state; there are "
                f"{', '.join(states)}"
            )
        return {name: self._fit(name, *state, stated.get(name)) for name, state in states.items()}

    def to_frame(self) -> pd.DataFrame:
        """Return a DataFrame, a row for each run."""
        return self.runs.to_frame()
