"""The limit states that a response has reached."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

    from rbsdem.model.response import Response

__all__ = ["LimitState", "LimitStates"]


@dataclass(frozen=True)
class LimitState:
    """One limit state, where it is reached first.

    Attributes
    ----------
    name : str
        "cracking", "first_yield", "nominal_moment", "hoop_yield", "spalling", "bar_buckling",
        "hoop_fracture", "bar_fracture", "cap", "shear_cracking", "shear_yield", "shear_failure",
        "strength_loss", "collapse" or "axial_failure".
    row : int
        First row of the result at or behind it.
    time : float
        Time [s], linear between two rows; or point of a static path, between two with the share of
        the way (`Result.path`).
    displacement, drift : float
        Of the top there [m], and over the height.
    force : float
        Of the loop there [N], see `Result.loop_force`.
    threshold : float
        What is reached: a strain, a rotation [rad], a slip [m] or a share.
    source : str
        Where the threshold comes from.
    """

    name: str
    row: int
    time: float
    displacement: float
    drift: float
    force: float
    threshold: float
    source: str


class LimitStates:
    """The limit states of a result in the order in which they are reached.

    Parameters
    ----------
    result : Result
        The response.
    states : list of LimitState
        Those that are reached.
    """

    def __init__(self, result: Response, states: list[LimitState]) -> None:
        self.result = result
        self._states = sorted(states, key=lambda state: (state.time, state.row))

    def __iter__(self) -> Iterator[LimitState]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def __contains__(self, name: object) -> bool:
        """Return whether a limit state is reached."""
        return any(state.name == name for state in self._states)

    def __getitem__(self, name: str) -> LimitState:
        """Return a limit state by its name; `KeyError` if it is not reached."""
        for state in self._states:
            if state.name == name:
                return state
        raise KeyError(f"{name!r} is not reached; reached are {', '.join(self.names()) or 'none'}")

    def names(self) -> list[str]:
        """Return the names in the order in which they are reached."""
        return [state.name for state in self._states]

    def drift(self, name: str) -> float:
        """Return the drift, in size, at which a state is reached; NaN if it is not."""
        return abs(self[name].drift) if name in self else float("nan")

    def to_frame(self) -> pd.DataFrame:
        """Return a DataFrame, a row for each state: the attributes of `LimitState`."""
        import pandas  # noqa: PLC0415

        names = list(LimitState.__dataclass_fields__)
        frame = pandas.DataFrame([asdict(state) for state in self], columns=names)
        units = {"time": "time_s", "displacement": "displacement_m", "force": "force_N"}
        return frame.rename(columns=units)

    def __repr__(self) -> str:
        states = ", ".join(f"{state.name} {100 * state.drift:.2f} %" for state in self)
        return f"LimitStates({states})"
