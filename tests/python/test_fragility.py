"""Statistics of ensembles: fits against closed forms and scipy, hazard, regressions, samples."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas
import pytest
from scipy import optimize, special, stats

from rbsdem import InputError
from rbsdem._tables import STANDARD_GRAVITY as G
from rbsdem.errors import AccuracyWarning
from rbsdem.many.fragility import Capacities, Counts, Fragility, Hazard, fit_fragility
from rbsdem.many.lognormal import bounds_of_counts, fit_bounds
from rbsdem.many.runs import Intensity

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples" / "08-ida"))
import export


def counts(level, number, failures, paired=False) -> Counts:
    failed = np.full((len(level), max(number)), np.nan)
    for i, (n, k) in enumerate(zip(number, failures, strict=True)):
        failed[i, :n] = np.arange(n) < k
    return Counts(np.array(level, float), failed, paired)


def drawn(n: int, theta: float, beta: float, seed: int = 7) -> np.ndarray:
    return theta * np.exp(beta * np.random.default_rng(seed).standard_normal(n))


def test_known_capacities_have_the_moments_of_their_logarithms():
    """Baker 2015, eqs 1 and 2; variances of a normal sample: beta^2/n and beta^2/(2 (n - 1))."""
    values = drawn(25, 3.0, 0.4)
    found = fit_fragility("x", Capacities(values, values))
    assert found.theta == pytest.approx(stats.gmean(values), rel=1e-12)
    assert found.beta == pytest.approx(np.log(values).std(ddof=1), rel=1e-12)
    assert found.covariance[0, 0] == pytest.approx((found.theta * found.beta) ** 2 / 25)
    assert found.covariance[1, 1] == pytest.approx(found.beta**2 / 48)


def test_two_stripes_are_met_exactly():
    """Two levels, two parameters: the curve goes through both shares; its covariance from theirs.

    With z the normal quantile of a share p, var z = p (1 - p)/(n phi(z)^2); beta = dx/(z2 - z1) and
    ln theta = x1 - beta z1 carry it on.
    """
    level, number, failures = [2.0, 5.0], [40, 50], [8, 35]
    found = fit_fragility("x", counts(level, number, failures))
    x, p, n = np.log(level), np.array([0.2, 0.7]), np.array(number)
    z = special.ndtri(p)
    beta = (x[1] - x[0]) / (z[1] - z[0])
    theta = np.exp(x[0] - beta * z[0])
    assert found.beta == pytest.approx(beta, rel=1e-9)
    assert found.theta == pytest.approx(theta, rel=1e-9)
    variance = np.diag(p * (1 - p) / (n * stats.norm.pdf(z) ** 2))
    db = np.array([1, -1]) * beta / (z[1] - z[0])
    dmu = np.array([-beta, 0.0]) - z[0] * db
    jacobian = np.array([theta * dmu, db])
    assert found.covariance == pytest.approx(jacobian @ variance @ jacobian.T, rel=1e-5)


def test_many_samples_are_fitted_as_one_after_the_other():
    level = np.array([1.0, 2.0, 4.0, 8.0])
    failures = np.array([[0, 3, 9, 10], [1, 1, 2, 6], [0, 0, 0, 0], [5, 5, 5, 5], [0, 0, 10, 10]])
    bounds = bounds_of_counts(level, np.full(4, 10), failures)
    mu, beta, covariance = fit_bounds(bounds)
    for i, row in enumerate(failures):
        one = fit_bounds(bounds_of_counts(level, np.full(4, 10), row))
        assert [mu[i], beta[i]] == pytest.approx([float(v) for v in one[:2]], rel=1e-8, nan_ok=True)
        assert covariance[i] == pytest.approx(one[2], rel=1e-6, nan_ok=True) or i > 1
    # None failed; all shares alike; a step between two levels.
    assert np.isnan(mu[2:]).all()
    assert np.isinf(beta[3])
    low, high = bounds.gap()
    assert np.exp([low[4], high[4]]) == pytest.approx([2.0, 4.0])
    assert np.isnan(low[[0, 1, 3]]).all()


def test_a_fit_is_the_largest_likelihood_or_none():
    """200 small random sets of counts, near separation too, against a search by scipy."""
    random = np.random.default_rng(0)
    fitted = 0
    for _ in range(200):
        size = random.integers(2, 6)
        number = random.integers(1, 12, size)
        x = np.cumsum(random.exponential(random.choice([0.01, 0.3, 2.0]), size) + 1e-4)
        share = random.uniform(0, 1, size) ** random.choice([0.2, 1.0, 5.0])
        failures = random.binomial(number, share)
        bounds = bounds_of_counts(np.exp(x), number, failures)
        mu, beta, _ = (np.asarray(value) for value in fit_bounds(bounds))
        overlap = x[number > failures].max(initial=-9) > x[failures > 0].min(initial=99)
        assert np.isnan(bounds.gap()[0]) == overlap
        if not overlap or np.isinf(beta):
            assert np.isnan(mu)
            continue

        def loss(at, x=x, k=failures, n=number):
            z = (x - at[0]) / np.exp(at[1])
            return -(k * special.log_ndtr(z) + (n - k) * special.log_ndtr(-z)).sum()

        here = [float(mu), float(np.log(beta))]
        assert loss(here) <= optimize.minimize(loss, here, method="Nelder-Mead").fun + 1e-9
        fitted += 1
    assert fitted > 50


@pytest.mark.parametrize(
    ("data", "where"),
    [
        (counts([2, 5], [10, 10], [0, 10]), "between 2 and 5"),
        (counts([1, 2, 5], [10, 10, 10], [0, 8, 10]), "between 1 and 5"),
        (counts([1, 2, 5], [10, 10, 10], [0, 0, 3]), "above 2"),
        (counts([1, 2], [10, 10], [3, 10]), "between 0 and 2"),
        (Capacities(np.array([1.0, 2.0, 1.0]), np.array([4.0, 4.0, 2.5])), "between 2 and 2.5"),
        (Capacities(np.array([1.0, 2.0]), np.array([2.0, np.inf])), "above 1"),
    ],
)
def test_data_that_do_not_determine_beta_say_so(data, where):
    """At most one level has both outcomes, or all capacities may be one."""
    with pytest.raises(InputError, match=f"do not determine beta.*the median is {where}"):
        fit_fragility("x", data)
    # With a stated beta the median alone is fitted; its band and frequency follow.
    found = fit_fragility("x", data, beta=0.4)
    assert (found.beta, found.stated, found.covariance[1, 1]) == (0.4, True, 0.0)
    assert np.isfinite(found.covariance).all()
    assert "beta=0.4 stated" in repr(found)


def test_median_with_a_stated_beta():
    """One level with 3 of 10: ln theta = x - beta z of the share; two opposite levels: between."""
    found = fit_fragility("x", counts([2.0], [10], [3]), beta=0.5)
    z = special.ndtri(0.3)
    assert np.log(found.theta) == pytest.approx(np.log(2.0) - 0.5 * z, rel=1e-9)
    variance = 0.25 * 0.21 / (10 * stats.norm.pdf(z) ** 2)
    assert found.covariance[0, 0] == pytest.approx(found.theta**2 * variance, rel=1e-6)
    step = fit_fragility("x", counts([2.0, 5.0], [10, 10], [0, 10]), beta=0.4)
    assert step.theta == pytest.approx(np.sqrt(10.0), rel=1e-9)
    values = drawn(30, 2.0, 0.6)
    exact = fit_fragility("x", Capacities(values, values), beta=0.6)
    assert exact.theta == pytest.approx(stats.gmean(values), rel=1e-9)
    assert exact.covariance[0, 0] == pytest.approx((exact.theta * 0.6) ** 2 / 30, rel=1e-9)
    assert (exact.samples(50)[1] == 0.6).all()


def test_samples_without_a_curve_are_told():
    """A draw separates two levels if none fails at the lower one, or all do at the upper one.

    With 2 and 10 of 12: 1 - (1 - (10/12)^12)^2 = 0.21 of the draws; with 1 and 8 of 9: 0.57.
    """
    few = fit_fragility("x", counts([2.0, 5.0], [12, 12], [2, 10]))
    with pytest.warns(AccuracyWarning, match=r"(19|2\d) % of the bootstrap samples do not"):
        few.samples(1000)
    fewer = fit_fragility("x", counts([2.0, 5.0], [9, 9], [1, 8]))
    with pytest.raises(InputError, match=r"5\d % of the bootstrap samples do not determine beta"):
        fewer.band([3.0])


def test_bounds_of_capacities_have_the_largest_likelihood():
    """Against scipy's own fit of censored data: points, brackets, values not reached."""
    values = drawn(40, 3.0, 0.5)
    level = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    place = np.searchsorted(level, values)
    lower = level[place - 1]
    upper = np.append(level, np.inf)[place]
    lower[:5] = upper[:5] = values[:5]
    logs = np.log(np.maximum(lower, 1e-300))
    interval = [
        (low if start > 0 else -np.inf, np.log(end))
        for start, low, end in zip(lower, logs, upper, strict=True)
        if np.isfinite(end) and start < end
    ]
    data = stats.CensoredData(
        uncensored=np.log(values[:5]), right=logs[np.isinf(upper)], interval=interval
    )
    other = stats.norm.fit(data)
    found = fit_fragility("x", Capacities(lower, upper))
    assert (np.log(found.theta), found.beta) == pytest.approx(other, rel=1e-4)


def test_bootstrap_scatters_as_the_likelihood_says():
    """For many records both estimate the same spread; 2000 samples know it to a few percent."""
    values = drawn(200, 3.0, 0.4)
    level = np.linspace(1.0, 7.0, 8)
    failed = (values < level[:, None]).astype(float)
    for data in (
        Capacities(values, values),
        Counts(level, failed, False),
    ):
        found = fit_fragility("x", data)
        theta, beta = found.samples(2000)
        assert theta.std() == pytest.approx(np.sqrt(found.covariance[0, 0]), rel=0.12)
        assert beta.std() == pytest.approx(np.sqrt(found.covariance[1, 1]), rel=0.12)


def test_paired_records_are_drawn_together():
    """With the same records at all levels the curve is known as well as from their capacities."""
    values = drawn(200, 3.0, 0.4)
    level = np.geomspace(0.5, 15.0, 60)
    failed = (values < level[:, None]).astype(float)
    paired = fit_fragility("x", Counts(level, failed, True)).samples(500)[0].std()
    exact = fit_fragility("x", Capacities(values, values)).samples(500)[0].std()
    assert paired == pytest.approx(exact, rel=0.2)


def test_band_holds_the_curve():
    values = drawn(20, 3.0, 0.4)
    found = fit_fragility("x", Capacities(values, values))
    x = np.array([0.0, 1.0, 3.0, 9.0])
    low, high = found.band(x, 0.9)
    p = found.probability(x)
    assert (low <= p).all()
    assert (p <= high).all()
    narrow = found.band(x, 0.5)
    assert (narrow[1] - narrow[0] <= high - low).all()
    assert p[0] == 0
    assert found.probability(found.theta) == pytest.approx(0.5)


FOUND = Fragility("x", 3.0, 0.4, np.eye(2), Capacities(drawn(9, 3, 0.4), drawn(9, 3, 0.4)))


@pytest.mark.parametrize("k", [0.5, 2.0, 3.5])
def test_frequency_under_a_power_law(k):
    """Cornell et al. 2002: lambda(theta) exp(k^2 beta^2/2)."""
    x = np.geomspace(1e-3, 1e3, 30)
    hazard = Hazard(x, 0.01 * x**-k)
    wanted = 0.01 * 3.0**-k * np.exp(0.5 * (k * 0.4) ** 2)
    assert FOUND.mean_annual_frequency(hazard) == pytest.approx(wanted, rel=1e-12)


def test_intensity_of_an_exceedance():
    """2 % in 50 years is -ln(0.98)/50 a year; the power laws and the curve are turned round."""
    x = np.array([0.5, 1.0, 3.0, 9.0])
    hazard = Hazard(x, [0.1, 0.02, 1e-3, 1e-4])
    rate = -np.log1p(-0.02) / 50
    for given in ("2 % in 50 years", "2% in 50 yrs", (0.02, 50), rate, f"{1 / rate:.12f} years"):
        assert hazard.exceeded(hazard.intensity(given)) == pytest.approx(rate, rel=1e-9)
    assert [hazard.intensity(each) for each in hazard.frequencies] == pytest.approx(x, rel=1e-12)
    with pytest.warns(AccuracyWarning, match="beyond its points"):
        assert hazard.exceeded(hazard.intensity(1e-6)) == pytest.approx(1e-6)
    p = np.array([0.02, 0.5, 0.9])
    assert FOUND.probability(FOUND.intensity(p)) == pytest.approx(p, rel=1e-12)
    assert FOUND.intensity(0.5) == pytest.approx(FOUND.theta)


def by_quadrature(hazard: Hazard, mu: float, beta: float) -> float:
    """Return the hazard times the density of ln capacity, by Gauss's rule on panels of beta/4."""
    x, y = np.log(hazard.intensities), np.log(hazard.frequencies)
    slope = np.diff(y) / np.diff(x)
    low, high = mu - beta * (40 - beta * slope.min()), mu + 40 * beta
    ends = np.union1d(np.linspace(low, high, int(4 * (high - low) / beta)), x)
    points, weights = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(ends)[:, None]
    u = 0.5 * (ends[1:] + ends[:-1])[:, None] + half * points
    place = np.clip(np.searchsorted(x, u) - 1, 0, slope.size - 1)
    logs = y[place] + slope[place] * (u - x[place]) - 0.5 * ((u - mu) / beta) ** 2
    return float((half * weights * np.exp(logs)).sum() / (beta * np.sqrt(2 * np.pi)))


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_frequency_under_steep_hazards():
    """Steep segments are not lost: 150 random hazards, slopes to 30, and one of slope 24."""
    steep = Hazard([0.5, 1, 2, 2.2], [1e-1, 1e-2, 1e-3, 1e-4])
    assert steep.frequency_of(np.log(3), 0.4) == pytest.approx(4.193288e-4, rel=1e-6)
    random = np.random.default_rng(0)
    for _ in range(150):
        n = random.integers(2, 12)
        gaps = random.exponential(0.5, n) + 1e-3
        drops = np.minimum(random.exponential(2.0, n) + 1e-6, 30 * gaps)
        hazard = Hazard(np.exp(np.cumsum(gaps) - 2), np.exp(-np.cumsum(drops)))
        mu, beta = random.normal(0, 1.5), np.exp(random.uniform(np.log(0.02), 0))
        assert hazard.exceeded(hazard.intensities) == pytest.approx(hazard.frequencies, rel=1e-12)
        wanted = by_quadrature(hazard, mu, beta)
        assert hazard.frequency_of(mu, beta) == pytest.approx(wanted, rel=1e-9)


def test_a_hazard_that_ends_too_early_is_told():
    hazard = Hazard([0.1, 0.3, 1.0], [1.0, 0.1, 0.01])
    with pytest.warns(AccuracyWarning, match="come from intensities beyond its points"):
        FOUND.mean_annual_frequency(hazard)


def exported(intensity=None) -> tuple[dict[str, Fragility], Intensity]:
    data = Capacities(np.array([1.0, 2.0]), np.array([1.0, 2.0]))
    curves = {
        name: Fragility(name, theta * G, beta, np.zeros((2, 2)), data)
        for name, theta, beta in (("collapse", 1.2, 0.4), ("first yield", 0.3, 0.25))
    }
    return curves, intensity or Intensity("sa_t1", 0.5, 0.05)


def test_nrml_has_mean_and_deviation_of_the_intensity_in_g(tmp_path):
    """Those of a lognormal variable, as scipy has them; states by growing median."""
    curves, intensity = exported()
    export.write_nrml(tmp_path / "pier.xml", curves, intensity, "pier")
    space = {"n": "http://openquake.org/xmlns/nrml/0.5"}
    model = ElementTree.parse(tmp_path / "pier.xml").getroot().find("n:fragilityModel", space)
    assert model.findtext("n:limitStates", namespaces=space) == "first_yield collapse"
    function = model.find("n:fragilityFunction", space)
    assert (function.get("id"), function.get("shape")) == ("pier", "logncdf")
    assert function.find("n:imls", space).get("imt") == "SA(0.5)"
    for params, (theta, beta) in zip(
        function.findall("n:params", space), ((0.3, 0.25), (1.2, 0.4)), strict=True
    ):
        law = stats.lognorm(beta, scale=theta)
        assert float(params.get("mean")) == pytest.approx(law.mean(), rel=1e-12)
        assert float(params.get("stddev")) == pytest.approx(law.std(), rel=1e-12)
    export.write_nrml(tmp_path / "p.xml", curves, Intensity("pga", 0.0, 0.0), "pier")
    assert 'imt="PGA"' in (tmp_path / "p.xml").read_text()


def test_csv_of_pelicun(tmp_path):
    curves, intensity = exported()
    export.write_pelicun(tmp_path / "f.csv", curves, intensity, "pier")
    row = pandas.read_csv(tmp_path / "f.csv").iloc[0]
    assert row["ID"] == "pier"
    assert (row["Demand-Type"], row["Demand-Unit"]) == ("Peak Spectral Acceleration|0.50", "g")
    assert list(row[["LS1-Theta_0", "LS1-Theta_1"]]) == pytest.approx([0.3, 0.25])
    assert list(row[["LS2-Theta_0", "LS2-Theta_1"]]) == pytest.approx([1.2, 0.4])
