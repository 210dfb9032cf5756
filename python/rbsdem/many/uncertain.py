"""Uncertain columns: samples of what is not known of a column, and what they add to the spread."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.column import Column, without_notes

_MOST = 1_000_000


def lognormal(median: float, beta: float) -> Any:
    """Return a lognormal distribution of scipy.

    Parameters
    ----------
    median : float
        Its median.
    beta : float
        Standard deviation of the logarithm, about the coefficient of variation.
    """
    middle = _arguments.number(median, "lognormal: median", above=0)
    spread = _arguments.number(beta, "lognormal: beta", above=0)
    from scipy.stats import lognorm as frozen  # noqa: PLC0415

    return frozen(spread, scale=middle)


@dataclass(frozen=True, eq=False, repr=False)
class Sample:
    """Values of uncertain variables, and the columns that they make.

    Attributes
    ----------
    names : tuple of str
        The variables.
    values : ndarray, shape (n, variables)
        Their values, a row for each column.
    columns : dict
        The columns under "sample 1" to "sample n".
    """

    names: tuple[str, ...]
    values: Array
    columns: dict[str, Column]

    def __repr__(self) -> str:
        return f"Sample({len(self.columns)} columns, {', '.join(self.names)})"


@dataclass(frozen=True, eq=False)
class Uncertain:
    """A column that depends on variables whose distributions are known.

    Parameters
    ----------
    make : callable
        Returns a `Column` for values of the variables, which it takes by name.
    variables : mapping
        Distribution of each variable: a frozen distribution of scipy.stats (it has `ppf`), or what
        `lognormal` returns.
    correlation : mapping, optional
        Correlation of pairs of variables, ``{("fc", "fy"): 0.3}``; that of the normal variables
        behind them (Gaussian copula). Pairs that are not named are independent.

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    make: Callable[..., Column]
    variables: Mapping[str, Any]
    correlation: Mapping[tuple[str, str], float] | None = None

    def __post_init__(self) -> None:
        faults = []
        if not callable(self.make):
            faults.append("uncertain: make must be a function that returns a Column")
        correlation = {} if self.correlation is None else self.correlation
        for name, given in (("variables", self.variables), ("correlation", correlation)):
            if not isinstance(given, Mapping):
                raise InputError(f"uncertain: {name} = {_arguments.shown(given)} must be a Mapping")
        if not self.variables:
            faults.append("uncertain: variables is empty; give at least one distribution")
        for name, distribution in self.variables.items():
            if not callable(getattr(distribution, "ppf", None)):
                faults.append(
                    f"uncertain: {name} = {distribution!r} is not a distribution; give one of "
                    "scipy.stats, or lognormal(median, beta)"
                )
        _arguments.raise_faults(faults)
        self._factor()

    def _factor(self) -> Array:
        """Return the lower triangle whose square is the matrix of correlations."""
        names = list(self.variables)
        matrix = np.eye(len(names))
        for pair, value in (self.correlation or {}).items():
            known = isinstance(pair, tuple) and len(pair) == 2 and set(pair) <= set(names)
            if not known or pair[0] == pair[1]:
                raise InputError(
                    f"uncertain: correlation of {pair!r}; give it for pairs of {', '.join(names)}"
                )
            i, j = names.index(pair[0]), names.index(pair[1])
            matrix[i, j] = matrix[j, i] = _arguments.number(value, f"correlation of {pair}")
        try:
            return np.asarray(np.linalg.cholesky(matrix), dtype=np.float64)
        except np.linalg.LinAlgError:
            raise InputError(
                "uncertain: the correlations contradict each other; their matrix must be positive "
                "definite"
            ) from None

    def values(
        self, n: int, method: Literal["sobol", "lhs", "random"] = "lhs", seed: int = 1
    ) -> Array:
        """Return values of the variables, shape (n, variables).

        Parameters
        ----------
        n : int
            How many; a power of two for "sobol".
        method : {"sobol", "lhs", "random"}, optional
            Scrambled Sobol points, a Latin hypercube, or random points.
        seed : int, optional
            The same seed gives the same values.
        """
        number = _arguments.integer(n, "uncertain: n", least=1, most=_MOST)
        start = _arguments.seed(seed)
        size = len(self.variables)
        random = np.random.default_rng(start)
        from scipy import special  # noqa: PLC0415
        from scipy.stats import qmc  # noqa: PLC0415

        method = _arguments.choice(method, "method", ("sobol", "lhs", "random"))
        if method == "sobol":
            if number & (number - 1):
                near = 2 ** round(np.log2(number))
                raise InputError(f"uncertain: n = {n} must be a power of 2 for 'sobol', as {near}")
            points = qmc.Sobol(size, rng=random).random(number)
        elif method == "lhs":
            points = qmc.LatinHypercube(size, rng=random).random(number)
        else:
            points = random.random((number, size))
        normal = special.ndtri(np.clip(points, 1e-12, 1 - 1e-12)) @ self._factor().T
        shares = special.ndtr(normal)
        parts = [d.ppf(shares[:, i]) for i, d in enumerate(self.variables.values())]
        return np.column_stack(parts)

    def sample(
        self, n: int, method: Literal["sobol", "lhs", "random"] = "lhs", seed: int = 1
    ) -> Sample:
        """Return columns for values of the variables; see `values`.

        Raises
        ------
        InputError
            With a line for each column that cannot be made.
        """
        values = self.values(n, method, seed)
        names = tuple(self.variables)
        columns: dict[str, Column] = {}
        faults = []
        for number, row in enumerate(values, 1):
            given = dict(zip(names, row.tolist(), strict=True))
            try:
                with without_notes():
                    made = self.make(**given)
                if not isinstance(made, Column):
                    raise InputError(f"make returned a {type(made).__name__}, not a Column")
                columns[f"sample {number}"] = made
            except (InputError, ValueError, TypeError) as error:
                text = ", ".join(f"{name} = {value:g}" for name, value in given.items())
                faults.append(f"sample {number} ({text}): {error}")
        _arguments.raise_faults(faults)
        return Sample(names, values, columns)


@dataclass(frozen=True)
class VarianceSplit:
    """The variance of the logarithm of a capacity, by where it comes from.

    Attributes
    ----------
    record, model : float
        Variances between records and between columns.
    residual : float
        What neither explains alone: records that are worse for some columns.
    """

    record: float
    model: float
    residual: float

    @property
    def total(self) -> float:
        """Variance of one record with one column."""
        return self.record + self.model + self.residual

    @property
    def beta(self) -> dict[str, float]:
        """Standard deviations of the logarithm, by name, and "total"."""
        parts = asdict(self) | {"total": self.total}
        return {name: float(np.sqrt(value)) for name, value in parts.items()}

    @property
    def share(self) -> dict[str, float]:
        """Parts of the total variance, by name."""
        whole = self.total
        return {name: value / whole if whole else 0.0 for name, value in asdict(self).items()}


def variance_split(capacity: ArrayLike) -> VarianceSplit:
    """Split the variance of capacities into that of the records and that of the columns.

    Analysis of variance of two crossed factors with random effects, one run a cell. A component
    that comes out negative is zero.

    Parameters
    ----------
    capacity : array_like, shape (columns, motions)
        Capacities of all columns under all motions, as `IDA.collapse_intensity`.

    Raises
    ------
    InputError
        If a capacity is missing, or there are fewer than two columns or motions.
    """
    values = _arguments.vector(capacity, "variance_split: capacity", shape="any")
    if values.ndim != 2 or min(values.shape) < 2:
        raise InputError(
            f"variance_split: capacities have shape {values.shape}; give two or more columns under "
            "two or more motions"
        )
    bad = ~(np.isfinite(values) & (values > 0))
    if bad.any():
        raise InputError(
            f"variance_split: {int(bad.sum())} of {values.size} capacities are not known; raise "
            "the highest level of intensity"
        )
    logs = np.log(values)
    n, m = logs.shape
    rows, columns = logs.mean(axis=1), logs.mean(axis=0)
    rest = logs - rows[:, None] - columns + logs.mean()
    error = float((rest**2).sum() / ((n - 1) * (m - 1)))
    model = (m * float(rows.var(ddof=1)) - error) / m
    record = (n * float(columns.var(ddof=1)) - error) / n
    return VarianceSplit(max(record, 0.0), max(model, 0.0), error)
