"""A ground motion: accelerations at equal steps, what is computed of them, and how they act."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, atomic_write
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError

_MOST_DAMPING = 10.0
# An oscillator takes a step of a twentieth of its period: shorter periods only cost time.
_SHORTEST = 1e-4
_LONGEST = 1e4


@dataclass(frozen=True, repr=False, eq=False)
class Spectrum(Tabular):
    """Peaks of elastic oscillators under a ground motion.

    Attributes
    ----------
    period : ndarray, shape (n,)
        Natural periods [s].
    damping : float
        Damping ratio.
    displacement, velocity : ndarray, shape (n,)
        Largest displacement [m] and velocity [m/s] relative to the ground.
    acceleration : ndarray, shape (n,)
        Largest absolute acceleration [m/s2].
    """

    _columns = (
        "period s",
        "displacement m",
        "velocity m/s",
        "acceleration m/s2",
        "pseudo_acceleration m/s2",
    )

    period: Array
    damping: float
    displacement: Array
    velocity: Array
    acceleration: Array

    @property
    def pseudo_velocity(self) -> Array:
        """Displacement times the circular frequency [m/s], shape (n,); zero at period 0."""
        return self._times_frequency(1)

    @property
    def pseudo_acceleration(self) -> Array:
        """Displacement times the squared circular frequency [m/s2], shape (n,); PGA at period 0."""
        return np.where(self.period > 0, self._times_frequency(2), self.acceleration)

    def _times_frequency(self, power: int) -> Array:
        moving = self.period > 0
        omega = 2 * np.pi / np.where(moving, self.period, 1.0)
        return np.where(moving, omega**power * self.displacement, 0.0)


def response_spectrum(
    acceleration: Array, dt: float, periods: ArrayLike | None, damping: float
) -> Spectrum:
    """Return the spectrum of accelerations [m/s2] at steps dt [s]; see `GroundMotion.spectrum`."""
    if periods is None:
        periods = np.geomspace(0.02, 10.0, 100)
    period = _arguments.finite_vector(periods, "periods")
    if period.size == 0:
        raise InputError("periods is empty; give at least one natural period in s")
    allowed = (period == 0) | ((period >= _SHORTEST) & (period <= _LONGEST))
    if not allowed.all():
        first = int(np.flatnonzero(~allowed)[0])
        raise InputError(
            f"periods: value {first + 1} of {period.size} is {period[first]:g} s; natural periods "
            f"are 0 or from {_SHORTEST:g} to {_LONGEST:g} s"
        )
    why = "; it is a ratio, not a percentage"
    ratio = _arguments.number(damping, "damping", least=0, most=_MOST_DAMPING, why=why)
    peaks = _core.evaluate(
        "spectrum", acceleration=acceleration, dt=dt, period=period, damping=ratio
    ).rows
    return Spectrum(period, ratio, *np.ascontiguousarray(peaks.T))


#: Longest step that has a meaning for an earthquake [s]; a longer one is a slip in its unit.
_LONGEST_STEP = 10.0


@dataclass(frozen=True, repr=False, eq=False, init=False)
class GroundMotion:
    """An acceleration of the ground at equal steps, linear between them.

    Parameters
    ----------
    acceleration : array_like, shape (m,)
        Accelerations [m/s2]; kept as an array that cannot be written to.
    dt : float
        Step [s]; the first value is at time 0.
    name : str, optional
        Name in tables and figures; `read_motion` takes that of the file.
    description : str, optional
        What the file says of event, station and component.

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    acceleration: Array
    dt: float
    name: str
    description: str

    def __init__(
        self, acceleration: ArrayLike, dt: float, name: str = "", description: str = ""
    ) -> None:
        _arguments.text(description, "motion: description")
        who = f"motion {name}" if _arguments.text(name, "motion: name") else "motion"
        faults: list[str] = []
        values, step = np.empty(0), 0.0
        with _arguments.collected(faults):
            values = np.array(_arguments.finite_vector(acceleration, f"{who}: acceleration"))
            if values.size < 2:
                faults.append(f"{who}: acceleration has {values.size} values; give two or more")
        with _arguments.collected(faults):
            step = _arguments.number(dt, f"{who}: dt")
            if not 0 < step <= _LONGEST_STEP:
                faults.append(f"{who}: dt = {step:g} s must be above 0 and at most 10 s")
        _arguments.raise_faults(faults)
        values.flags.writeable = False
        given = {"acceleration": values, "dt": step, "name": name, "description": description}
        for key, value in given.items():
            object.__setattr__(self, key, value)

    @property
    def time(self) -> Array:
        """Times of the accelerations [s], shape (m,)."""
        return np.asarray(self.dt * np.arange(self.acceleration.size), dtype=np.float64)

    @property
    def length(self) -> float:
        """Time from the first to the last value [s]."""
        return self.dt * (self.acceleration.size - 1)

    @property
    def velocity(self) -> Array:
        """Velocity of the ground, zero at first [m/s], shape (m,)."""
        return _integral(self.acceleration, self.dt)

    @property
    def displacement(self) -> Array:
        """Displacement of the ground, zero at first [m], shape (m,)."""
        # Exact for an acceleration that is linear between its points.
        a, v = self.acceleration, self.velocity
        steps = self.dt * v[:-1] + self.dt**2 * (2 * a[:-1] + a[1:]) / 6
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def pga(self) -> float:
        """Largest absolute acceleration of the ground [m/s2]."""
        return float(np.abs(self.acceleration).max())

    @property
    def pgv(self) -> float:
        """Largest absolute velocity of the ground [m/s], at the points."""
        return float(np.abs(self.velocity).max())

    @property
    def arias(self) -> float:
        """Arias intensity [m/s]: pi/(2 g) times the integral of the squared acceleration."""
        return float(self._husid()[-1])

    def duration(self, start: float = 5.0, end: float = 95.0) -> float:
        """Return the significant duration [s].

        Parameters
        ----------
        start, end : float, optional
            Parts of the Arias intensity [%] between which the time counts: 5 and 95, or 5 and 75.
        """
        low, high = _arguments.number(start, "start"), _arguments.number(end, "end")
        if not 0 <= low < high <= 100:
            raise InputError(
                f"duration: start = {low:g} and end = {high:g} must be percentages, start < end"
            )
        husid = self._husid()
        if husid[-1] == 0:
            raise InputError(f"{self._who()}: a motion without acceleration has no duration")
        at = np.interp([low, high], 100 * husid / husid[-1], self.time)
        return float(at[1] - at[0])

    def spectrum(self, periods: ArrayLike | None = None, damping: float = 0.05) -> Spectrum:
        """Return the elastic response spectrum.

        The oscillators are solved in closed form for an acceleration that is linear between its
        points (Nigam and Jennings 1969). Peaks between points are found to 4e-5, and the free
        vibration after the end of the motion belongs to the response.

        Parameters
        ----------
        periods : array_like, shape (n,), optional
            Natural periods [s], 0 for a rigid oscillator; by default 100 from 0.02 to 10 s.
        damping : float, optional
            Damping ratio.
        """
        return response_spectrum(self.acceleration, self.dt, periods, damping)

    def sa(self, period: float, damping: float = 0.05) -> float:
        """Return the pseudo-spectral acceleration at a period [m/s2]."""
        value = _arguments.number(period, "period")
        return float(self.spectrum([value], damping).pseudo_acceleration[0])

    def sa_avg(self, periods: ArrayLike, damping: float = 0.05) -> float:
        """Return the geometric mean of the pseudo-spectral accelerations at periods [m/s2]."""
        sa = self.spectrum(periods, damping).pseudo_acceleration
        if not (sa > 0).all():
            raise InputError(f"{self._who()}: a motion without acceleration has no mean of Sa")
        return float(np.exp(np.log(sa).mean()))

    def scaled(
        self,
        factor: float | None = None,
        *,
        pga: float | None = None,
        sa: tuple[float, float] | None = None,
        damping: float = 0.05,
    ) -> GroundMotion:
        """Return the motion times a factor.

        Parameters
        ----------
        factor : float, optional
            The factor; exactly one of `factor`, `pga` and `sa` is given.
        pga : float, optional
            Peak acceleration that the motion gets [m/s2].
        sa : (float, float), optional
            A period [s] and the pseudo-spectral acceleration [m/s2] that the motion gets there.
        damping : float, optional
            Damping ratio for `sa`.
        """
        if sum(value is not None for value in (factor, pga, sa)) != 1:
            raise InputError("scaled: give exactly one of factor, pga and sa")
        if factor is not None:
            return replace(
                self, acceleration=self.acceleration * _arguments.number(factor, "factor")
            )
        if pga is not None:
            wanted, name, has = _arguments.number(pga, "pga"), "pga", self.pga
        else:
            try:
                period, wanted = sa  # type: ignore[misc]
            except (TypeError, ValueError):
                raise InputError(
                    f"scaled: sa = {sa!r} must be a period in s and an acceleration in m/s2"
                ) from None
            wanted, name = _arguments.number(wanted, "sa"), f"Sa({period:g} s)"
            has = self.sa(period, damping)
        _arguments.number(wanted, f"scaled: {name}", above=0, unit="m/s2")
        if has == 0:
            raise InputError(f"{self._who()}: its {name} is 0, which no factor changes")
        return replace(self, acceleration=self.acceleration * (wanted / has))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write time [s] and acceleration [m/s2] as csv, from which the same values come back.

        Parameters
        ----------
        path : path
            File to write; `read_motion` and the loading of a case read it.
        """
        head = f"# {_arguments.one_line(self.description or self.name)}\ntime_s,acceleration_m/s2\n"
        rows = zip(self.time.tolist(), self.acceleration.tolist(), strict=True)
        with atomic_write(path) as file:
            file.write((head + "".join(f"{t!r},{a!r}\n" for t, a in rows)).encode())

    def _husid(self) -> Array:
        return np.pi / (2 * STANDARD_GRAVITY) * _integral(self.acceleration**2, self.dt)

    def _who(self) -> str:
        return f"motion {self.name}" if self.name else "motion"

    def __repr__(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        size = self.acceleration.size
        return f"GroundMotion({name}{size} values, dt={self.dt:g} s, pga={self.pga:.4g} m/s2)"

    def __eq__(self, other: object) -> bool:
        """Return whether another motion has the same values, step, name and description."""
        if not isinstance(other, GroundMotion):
            return NotImplemented
        return self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[bytes, float, str, str]:
        return self.acceleration.tobytes(), self.dt, self.name, self.description


def checked_motion(motion: object, who: str = "") -> GroundMotion:
    """Return a motion, or raise `InputError` with what makes one."""
    remedy = "motions.read_motion(path) or motions.GroundMotion(acceleration, dt) makes one"
    return _arguments.instance(motion, f"{who}motion", GroundMotion, remedy)


def _integral(values: Array, dt: float) -> Array:
    """Return the integral by the rule of trapezoids, zero at first."""
    return np.concatenate([[0.0], np.cumsum(0.5 * dt * (values[:-1] + values[1:]))])


_OF_THE_GROUND = ("ground_acceleration", "vertical_acceleration")


def acting(
    time: ArrayLike | GroundMotion | None,
    loads: Mapping[str, ArrayLike | GroundMotion | None],
    who: str,
) -> tuple[ArrayLike | None, dict[str, ArrayLike]]:
    """Return times and loads as arrays, where loads may be ground motions.

    Parameters
    ----------
    time : array_like, GroundMotion or None
        Times of the loading [s]; None where a motion brings them. A motion in their place is that
        of the ground along x.
    loads : mapping
        Loads by name: arrays, ground motions, or None.
    who : str
        The function that was called, for messages.

    Returns
    -------
    tuple
        The times, and the loads that are given. Of two motions the shorter one is followed by rest.

    Raises
    ------
    InputError
        If the times are given twice, or two motions have different steps.
    """
    if isinstance(time, GroundMotion):
        if loads.get("ground_acceleration") is not None:
            raise InputError(
                f"{who}: a GroundMotion stands in the place of time, and ground_acceleration is "
                "given too; give one of them"
            )
        time, loads = None, {**loads, "ground_acceleration": time}
    given: dict[str, ArrayLike] = {}
    motions: dict[str, GroundMotion] = {}
    for name, load in loads.items():
        if isinstance(load, GroundMotion):
            motions[name] = load
        elif load is not None:
            given[name] = load
    if not motions:
        return time, given
    for name in motions:
        if name not in _OF_THE_GROUND:
            raise InputError(
                f"{who}: {name} is a GroundMotion; give it as {' or '.join(_OF_THE_GROUND)}"
            )
    if time is not None:
        raise InputError(
            f"{who}: time is given, and {next(iter(motions))} brings its own; leave time out, or "
            "give motion.acceleration"
        )
    steps = {motion.dt for motion in motions.values()}
    if len(steps) > 1:
        told = " and ".join(f"{name} {motion.dt:g} s" for name, motion in motions.items())
        raise InputError(
            f"{who}: steps differ ({told}); motions.resampled brings a motion to another step"
        )
    longest = max(motions.values(), key=lambda motion: motion.acceleration.size)
    size = longest.acceleration.size
    for name, motion in motions.items():
        given[name] = np.pad(motion.acceleration, (0, size - motion.acceleration.size))
    return longest.time, {name: given[name] for name in loads if name in given}
