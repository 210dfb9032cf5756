"""A ground motion: accelerations at equal steps, what is computed of them, and how they act.

Of synthetic records, white noise, its strength over time shaped as that of an earthquake, goes
through the ground of Kanai (1957) and Tajimi (1960), with the filter of Clough and Penzien (1975)
that leaves no velocity behind. They are like each other as records of one magnitude and distance
are: peak, frequency and damping of the ground, rise and length of the strong part are drawn.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeGuard

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, atomic_write
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError, warn

_MOST_DAMPING = 1.0
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
        """Return the displacement times a power of the circular frequency; 0 at period 0."""
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
    hint = "; it is a ratio, not a percentage"
    ratio = _arguments.number(damping, "damping", least=0, most=_MOST_DAMPING, hint=hint)
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
        Event, station and component, as the file names them.

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
        peak = float(np.abs(values).max())
        if peak > _core.note_limits()[2]:
            warn(
                f"{who}: its peak is {peak / STANDARD_GRAVITY:.4g} g; no ground has moved with "
                "more than 5 g, and accelerations are in m/s2"
            )
        _arguments.put(self, acceleration=values, dt=step, name=name, description=description)

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
            raise InputError(f"{self._who()}: a motion at rest has no duration; leave it out")
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
        path : path-like
            File to write; `read_motion` and the loading of a case read it.
        """
        head = f"# {_arguments.one_line(self.description or self.name)}\ntime_s,acceleration_m/s2\n"
        rows = zip(self.time.tolist(), self.acceleration.tolist(), strict=True)
        with atomic_write(path) as file:
            file.write((head + "".join(f"{t!r},{a!r}\n" for t, a in rows)).encode())

    def _husid(self) -> Array:
        """Return the Arias intensity up to each time [m/s]."""
        return np.pi / (2 * STANDARD_GRAVITY) * _integral(self.acceleration**2, self.dt)

    def _who(self) -> str:
        """Return how messages call the motion."""
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
        """Return what two equal motions have in common."""
        return self.acceleration.tobytes(), self.dt, self.name, self.description


def checked_motion(motion: object, who: str = "") -> GroundMotion:
    """Return a motion, or raise `InputError` with what makes one."""
    remedy = "motions.read_motion(path) or motions.GroundMotion(acceleration, dt) makes one"
    return _arguments.instance(motion, f"{who}motion", GroundMotion, remedy)


#: A motion along x, or two at once along x and y.
Record: TypeAlias = GroundMotion | tuple[GroundMotion, GroundMotion]


def is_pair(record: object) -> TypeGuard[tuple[GroundMotion, GroundMotion]]:
    """Return whether a record is two motions, along x and y."""
    if not isinstance(record, tuple) or len(record) != 2:
        return False
    return all(isinstance(part, GroundMotion) for part in record)


def components(record: Record) -> tuple[GroundMotion, ...]:
    """Return the motion of a record, or its two along x and y."""
    return (record,) if isinstance(record, GroundMotion) else record


def _integral(values: Array, dt: float) -> Array:
    """Return the integral by the rule of trapezoids, zero at first."""
    return np.concatenate([[0.0], np.cumsum(0.5 * dt * (values[:-1] + values[1:]))])


_OF_THE_GROUND = ("ground_acceleration", "vertical_acceleration", "ground_acceleration_y")


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
    histories: dict[str, ArrayLike] = {}
    motions: dict[str, GroundMotion] = {}
    for name, load in loads.items():
        if isinstance(load, GroundMotion):
            motions[name] = load
        elif load is not None:
            histories[name] = load
    if not motions:
        return time, histories
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
        histories[name] = np.pad(motion.acceleration, (0, size - motion.acceleration.size))
    return longest.time, {name: histories[name] for name in loads if name in histories}


_MOST_DEGREE = 8
_MOST_VALUES = 20_000_000


def corrected(motion: GroundMotion, degree: int = 1) -> GroundMotion:
    """Return a motion with its baseline corrected.

    A polynomial is taken off the acceleration such that what is left of the velocity is smallest in
    the sense of least squares; the velocity starts from zero before and after.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    degree : int, optional
        Degree of the polynomial in the acceleration: 0 takes off a constant, 1 a straight line.
    """
    checked_motion(motion)
    most = min(_MOST_DEGREE, motion.acceleration.size - 2)
    wanted = _arguments.integer(degree, "corrected: degree", least=0, most=most)
    tau = np.linspace(0.0, 1.0, motion.acceleration.size)
    powers = np.arange(1, wanted + 2)
    # Velocities over the length of the record: their slope is what comes off the acceleration.
    drift = tau[:, None] ** powers
    parts = np.linalg.lstsq(drift, motion.velocity, rcond=None)[0]
    slope: Array = (powers * tau[:, None] ** (powers - 1)) @ parts / motion.length
    return replace(motion, acceleration=motion.acceleration - slope)


def resampled(motion: GroundMotion, dt: float) -> GroundMotion:
    """Return a motion at other steps.

    Shorter steps lie on the straight lines between the values; where they divide the old step, the
    motion is the same. Before longer steps are taken, frequencies that they cannot show are
    removed.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    dt : float
        New step [s].
    """
    checked_motion(motion)
    step = _arguments.number(dt, "dt")
    if not 0 < step <= motion.length:
        raise InputError(
            f"resampled: dt = {step:g} s must be above 0 and at most the length of the motion, "
            f"{motion.length:g} s"
        )
    if motion.length / step > _MOST_VALUES:
        raise InputError(f"resampled: dt = {step:g} s makes more than {_MOST_VALUES} values")
    values = motion.acceleration
    if step > motion.dt * (1 + 1e-9):
        values = _without_high(values, motion.dt, 0.5 / step)
    count = int(np.ceil(motion.length / step * (1 - 1e-12))) + 1
    time = step * np.arange(count)
    # The last step may end after the record, where the ground is at rest.
    return replace(motion, acceleration=np.interp(time, motion.time, values, right=0.0), dt=step)


def sequence(
    motions: Sequence[GroundMotion], rest: float = 10.0, name: str | None = None
) -> GroundMotion:
    """Return records one after another, as a main shock and its aftershocks.

    Parameters
    ----------
    motions : sequence of GroundMotion
        The records in their order, all with the same step.
    rest : float, optional
        Time without motion between two records [s].
    name : str, optional
        Name of the whole, by default those of the parts, joined.
    """
    records = _arguments.several(motions, "sequence: motions", "GroundMotion")
    parts = [checked_motion(motion) for motion in records]
    if not parts:
        raise InputError("sequence: there are no motions; give at least one")
    pause = _arguments.number(rest, "sequence: rest", least=0, most=1e6, unit="s")
    dt = parts[0].dt
    other = next((motion for motion in parts if motion.dt != dt), None)
    if other is not None:
        raise InputError(
            f"sequence: {parts[0].name or 'the first motion'} has dt = {dt:g} s and "
            f"{other.name or 'another one'} {other.dt:g} s; bring them to one step with "
            f"resampled(motion, {min(dt, other.dt):g})"
        )
    quiet = np.zeros(round(pause / dt))
    values = [parts[0].acceleration]
    for motion in parts[1:]:
        values += [quiet, motion.acceleration]
    joined = " + ".join(motion.name for motion in parts) if name is None else name
    return GroundMotion(np.concatenate(values), dt, joined)


def _without_high(values: Array, dt: float, highest: float) -> Array:
    """Return values without the frequencies above one [Hz]; zeros around keep the ends apart."""
    size = 2 * values.size
    parts = np.fft.rfft(values, size)
    parts[np.fft.rfftfreq(size, dt) > highest] = 0
    return np.fft.irfft(parts, size)[: values.size]


_MOST = 100_000
#: Medians and spreads (of the logarithm) of what is drawn for a motion.
_PGA = (0.30 * STANDARD_GRAVITY, 0.35)
_GROUND_FREQUENCY = (2.5, 0.35)
_GROUND_DAMPING = (0.6, 0.20)
_STRONG_PART = (8.0, 0.35)
#: The filter of Clough and Penzien: its frequency as a part of the ground's, and its damping.
_LOW_CUT, _LOW_DAMPING = 0.10, 0.6
#: Powers of e by which the slowest part of the motion decays after the noise.
_DECAYS = 8.0
#: Duration of the noise over that of its strong part (5 to 95 %), and where in it the peak is.
_WHOLE, _PEAK_AT = 2.5, 0.25


def synthetic(n: int = 20, seed: int = 1, dt: float = 0.01) -> tuple[GroundMotion, ...]:
    """Return synthetic ground motions, the same for the same arguments.

    Parameters
    ----------
    n : int, optional
        How many. The first ones do not depend on how many follow.
    seed : int, optional
        Another seed gives other motions.
    dt : float, optional
        Step [s], at most 0.05.
    """
    number = _arguments.integer(n, "synthetic: n", least=1, most=_MOST)
    start = _arguments.seed(seed, "synthetic: seed")
    step = _arguments.number(dt, "synthetic: dt", least=1e-4, most=0.05, unit="s")
    return tuple(_one(start, i, step) for i in range(1, number + 1))


def _one(seed: int, number: int, dt: float) -> GroundMotion:
    """Return synthetic motion `number`, whose properties and noise are drawn by its own seed."""
    # The sequence of this generator is fixed for all versions of numpy.
    draw = np.random.RandomState([seed, number])
    pga, ground, damping, strong = (
        median * np.exp(spread * draw.standard_normal())
        for median, spread in (_PGA, _GROUND_FREQUENCY, _GROUND_DAMPING, _STRONG_PART)
    )
    size = int(np.ceil(_WHOLE * strong / dt))
    # The ground comes to rest after the noise has ended.
    rest = int(np.ceil(_DECAYS / (_LOW_DAMPING * _LOW_CUT * 2 * np.pi * ground * dt)))
    noise = np.pad(draw.standard_normal(size) * _envelope(size), (0, rest))
    values = _through_ground(noise, dt, 2 * np.pi * ground, damping)
    motion = GroundMotion(values, dt, f"synthetic_{number:02d}", f"synthetic, seed {seed}")
    return motion.scaled(pga=pga)


def _envelope(size: int) -> Array:
    """Return the shape t^a exp(-b t), its peak 1, near zero at the end."""
    tau = np.arange(size) / size
    return np.asarray((tau / _PEAK_AT * np.exp(1 - tau / _PEAK_AT)) ** 2)


def _through_ground(noise: Array, dt: float, omega: float, damping: float) -> Array:
    """Return the noise after the two filters, by its Fourier transform."""
    size = 2 * noise.size
    w = 2 * np.pi * np.fft.rfftfreq(size, dt)
    low = _LOW_CUT * omega
    soil = (omega**2 + 2j * damping * omega * w) / (omega**2 - w**2 + 2j * damping * omega * w)
    cut = -(w**2) / (low**2 - w**2 + 2j * _LOW_DAMPING * low * w)
    return np.fft.irfft(np.fft.rfft(noise, size) * soil * cut, size)[: noise.size]
