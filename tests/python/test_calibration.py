"""Calibration: known numbers come back, what a test cannot tell is said, wrong input is refused."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import Column, InputError, SolveError
from rbsdem.calibration import free_names, paths
from rbsdem.calibration.fit import COARSE, Misfit, Target
from rbsdem.curves.metrics import N_POINTS, half_cycle_numbers
from rbsdem.errors import AccuracyWarning
from rbsdem.model.column import Parameter
from rbsdem.peer import find_history, read_peer
from rbsdem.run import response as run_result
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered, Pinching, SteelSpring, Takeda

PEER = os.environ.get("RBSDEM_PEER_DIR") or Path(__file__).resolve().parents[3] / "shared" / "peer"
COLUMNS = rbsdem.peer.paper_columns("pdelta")
KEYS = list(COLUMNS)
TAKEDA = ("k_c", "k_y", "d_y", "k_u", "b0")
FREE = [f"flexure.{name}" for name in TAKEDA]
DRIFTS = [0.002, 0.005, 0.01, 0.015, 0.02]

ELASTIC = Column(height=2.0, mass=1.0, shear=Elastic(k=3e7), flexure=Elastic(k=8e7))


def path(column: Column, drifts=DRIFTS, points: int = 6) -> np.ndarray:
    return rbsdem.protocol([drift * column.height for drift in drifts], cycles=2, points=points)


def response(column: Column, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return displacement, rbsdem.cyclic(column, displacement=displacement).force


def noisy(column: Column, displacement: np.ndarray, share: float, seed: int = 1):
    d, f = response(column, displacement)
    noise = np.random.default_rng(seed).standard_normal(f.size)
    return d, f + share * np.max(np.abs(f)) * noise


def quiet(*args, **options) -> rbsdem.calibration.Calibration:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        return rbsdem.calibrate(*args, **options)


@pytest.mark.parametrize("reached", [1.0, 0.6, 0.02])
def test_error_is_the_nrmse_of_compare(reached):
    random = np.random.default_rng(3)
    d = np.cumsum(random.standard_normal(300))
    d[40:44] = d[40]  # rows without a step
    f, model = random.standard_normal((2, 300))
    rows = int(reached * 300)
    model[rows:] = np.nan
    error = Target((d, f)).error(model[:rows])
    assert error.shape == (N_POINTS,)
    expected = rbsdem.compare((d, model), (d, f)).nrmse
    assert np.sqrt(np.mean(error**2)) == pytest.approx(expected, rel=1e-12)


def test_half_cycles_of_a_protocol():
    d = rbsdem.protocol([0.01, 0.02], cycles=2, points=8)
    halves = half_cycle_numbers(d)
    # To the first peak, then peak to peak: 4 cycles have 8 peaks, and the way back to zero.
    assert halves[0] == 0
    assert halves[-1] == 8
    turns = d[np.flatnonzero(np.diff(halves)) + 1]
    assert turns == pytest.approx([0.01, -0.01, 0.01, -0.01, 0.02, -0.02, 0.02, -0.02])
    # Small turns do not count.
    assert np.all(half_cycle_numbers(np.array([0, 1, 0.99, 2, 1.97, 3.0])) == 0)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("key", KEYS)
def test_parameters_of_a_synthetic_test_come_back(key, seed):
    start = COLUMNS[key]
    random = np.random.default_rng((seed, KEYS.index(key)))
    factors = dict(zip(TAKEDA, 2.0 ** random.uniform(-1, 1, 5), strict=True))
    factors["k_y"] = min(factors["k_y"], 2 * factors["k_c"])
    factors["d_y"] = max(factors["d_y"], 0.7)
    flexure = start.flexure
    truth = {name: getattr(flexure, name) * factor for name, factor in factors.items()}
    test = response(replace(start, flexure=replace(flexure, **truth)), path(start))
    fit = quiet(start, test, FREE, seed=seed)
    assert fit.after.nrmse < 1e-6 < fit.before.nrmse
    for name, value in truth.items():
        assert fit.values[f"flexure.{name}"] == pytest.approx(value, rel=1e-4), name
        assert getattr(fit.column.flexure, name) == fit.values[f"flexure.{name}"]
    assert fit.column.flexure.d_c == flexure.d_c
    assert fit.start is start


def test_nearby_columns_are_no_better():
    start = COLUMNS["zahn_7"]
    test = noisy(replace(start, flexure=replace(start.flexure, b0=0.2, d_y=4e-3)), path(start), 0.1)
    fit = quiet(start, test, FREE)
    random = np.random.default_rng(0)
    for _ in range(100):
        near = {
            name: getattr(fit.column.flexure, name) * (1 + 0.01 * random.standard_normal())
            for name in TAKEDA
        }
        column = replace(start, flexure=replace(fit.column.flexure, **near))
        assert rbsdem.compare(response(column, test[0]), test).nrmse > fit.nrmse - 1e-5


def test_same_seed_same_fit_whatever_the_jobs():
    start = COLUMNS["soesianawati_1"]
    test = noisy(replace(start, flexure=replace(start.flexure, k_y=4e7)), path(start), 0.05)
    first, second, threads = (
        quiet(start, test, FREE[:3], seed=7, evaluations=150, jobs=jobs) for jobs in (1, 1, 2)
    )
    assert first.values == second.values == threads.values
    assert first.evaluations == second.evaluations == threads.evaluations


def test_balanced_loss_gives_better_ratios():
    start = COLUMNS["zahn_7"]
    test = noisy(replace(start, flexure=replace(start.flexure, b0=0.0, k_u=0.0)), path(start), 0.1)
    only = ["flexure.k_y"]
    plain, balanced = (quiet(start, test, only, loss=loss) for loss in ("nrmse", "balanced"))

    def off(scores):
        return (scores.peak_ratio - 1) ** 2 + (scores.energy_ratio - 1) ** 2

    assert off(balanced.after) < off(plain.after)
    assert balanced.nrmse > plain.nrmse


def lateral(shear: float, flexure: float, height: float) -> float:
    return 1 / (1 / shear + height**2 / flexure)


def test_elastic_column_closed_form_of_value_and_standard_error():
    d = rbsdem.protocol([0.01, 0.02, 0.03], cycles=2, points=10)
    f = lateral(5e7, 8e7, 2.0) * d
    f += 0.05 * np.max(f) * np.sin(40 * np.arange(d.size))
    fit = quiet(ELASTIC, (d, f), ["shear.k"])

    target = Target((d, f))
    points, groups = target._points(d), target.half_cycle
    force = target._points(f)
    stiffness = points @ force / (points @ points)
    shear = 1 / (1 / stiffness - 2.0**2 / 8e7)
    assert fit.values["shear.k"] == pytest.approx(shear, rel=1e-5)

    # Clustered by half cycles, and dK/dk_s = (K/k_s)^2.
    left = stiffness * points - force
    number = groups[-1] + 1
    scores = np.bincount(groups, points * left, number)
    variance = scores @ scores * number / (number - 1) / (points @ points) ** 2
    error = np.sqrt(variance) * (shear / stiffness) ** 2
    assert fit.parameters[0].standard_error == pytest.approx(error, rel=1e-3)


def test_springs_in_series_are_not_told_apart():
    test = response(replace(ELASTIC, shear=Elastic(k=4e7)), path(ELASTIC))
    with pytest.warns(AccuracyWarning, match=r"shear\.k and flexure\.k: correlation -1\.000"):
        fit = rbsdem.calibrate(ELASTIC, test, ["shear.k", "flexure.k"])
    assert fit.correlation[0, 1] == pytest.approx(-1, abs=1e-6)
    assert fit.nrmse < 1e-5


def test_too_few_half_cycles_for_standard_errors():
    d = np.linspace(0, 0.02, 30)
    test = noisy(ELASTIC, d, 0.01)
    fit = quiet(ELASTIC, test, ["shear.k"])
    assert np.isnan(fit.parameters[0].standard_error)
    assert "nan" not in fit.report


def test_standard_error_covers_the_truth():
    """Half cycles scaled at random: the value is within two standard errors about 95 % of times."""
    d = rbsdem.protocol([0.01, 0.015, 0.02], cycles=5, points=8)
    halves = half_cycle_numbers(d)
    random = np.random.default_rng(5)
    inside = 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        for _ in range(200):
            f = lateral(3e7, 8e7, 2.0) * d * (1 + 0.05 * random.standard_normal(31)[halves])
            free = {"shear.k": Parameter(3e7, 1e7, 1e8)}
            misfit = Misfit(
                lambda values: replace(ELASTIC, shear=Elastic(k=values["shear.k"])),
                free,
                Target((d, f)),
            )
            best = _elastic_best(misfit, free["shear.k"])
            misfit.best_fractions = np.array([free["shear.k"].fraction(best)])
            (found,), _ = misfit.determine()
            inside += abs(best - 3e7) < 2 * found.standard_error
    assert 175 <= inside <= 199


def _elastic_best(misfit: Misfit, number: Parameter) -> float:
    target = misfit.target
    points, force = target._points(target.displacement), target._points(target.force)
    stiffness = points @ force / (points @ points)
    return min(max(1 / (1 / stiffness - 2.0**2 / 8e7), number.low), number.high)


def test_number_beyond_the_test_stays_where_it_was():
    """What the test does not reach is told, and not taken from a random point."""
    start = COLUMNS["zahn_7"]
    stiff = replace(start.flexure, k_c=1.5 * start.flexure.k_c)
    test = response(replace(start, flexure=stiff), path(start, [2e-4]))
    with pytest.warns(AccuracyWarning, match=r"flexure\.k_u: no force of the test changes"):
        fit = rbsdem.calibrate(start, test, ["flexure.k_c", "flexure.k_u"])
    assert fit.values["flexure.k_u"] == start.flexure.k_u
    assert fit.values["flexure.k_c"] == pytest.approx(1.5 * start.flexure.k_c, rel=1e-4)


def test_number_without_effect_at_the_fit_is_warned_of():
    start = COLUMNS["zahn_7"]
    never = replace(start, flexure=replace(start.flexure, d_y=1.0))
    test = response(never, path(start, [5e-4, 1e-3]))
    bounds = {"flexure.d_y": (6e-4, 1.0)}
    with pytest.warns(AccuracyWarning, match=r"flexure\.d_y: no force of the test changes"):
        fit = rbsdem.calibrate(start, test, ["flexure.d_y", "flexure.k_y"], bounds)
    assert fit.parameters[0].standard_error == np.inf
    assert np.isnan(fit.correlation[0, 1])
    assert fit.parameters[1].standard_error < np.inf


def test_bound_is_told():
    test = response(replace(ELASTIC, shear=Elastic(k=9e7)), path(ELASTIC))
    with pytest.warns(AccuracyWarning, match=r"shear\.k: ended at its high bound"):
        fit = rbsdem.calibrate(ELASTIC, test, ["shear.k"], {"shear.k": (2e7, 5e7)})
    assert fit.parameters[0].at_bound == "high"
    assert fit.values["shear.k"] == pytest.approx(5e7, rel=1e-3)


def joints(*d_y: float) -> Column:
    springs = [Takeda(k_c=2e8, d_c=3e-4, k_y=6e7, d_y=y, k_u=5e6) for y in d_y]
    return Column(
        height=1.5, mass=600.0, shear=Bilinear(7e8, 1e-4, 7e6), flexure=springs, n=len(d_y)
    )


def test_paths_reach_one_or_all():
    column = joints(0.002, 0.003, 0.004)
    one = paths.with_values(column, {"flexure[1].d_y": 0.01, "shear.k": 6e8, "height": 1.6})
    assert [spring.d_y for spring in one.joints("flexure")] == [0.002, 0.01, 0.004]
    assert (one.shear.k, one.height, one.shear.d_y) == (6e8, 1.6, 1e-4)
    every = paths.with_values(column, {"flexure[*].d_y": 2.0, "flexure[0].k_y": 5e7})
    assert [spring.d_y for spring in every.joints("flexure")] == [0.004, 0.006, 0.008]
    assert [spring.k_y for spring in every.joints("flexure")] == [5e7, 6e7, 6e7]
    # What belongs together changes at a time: neither order would do one after the other.
    stiff = paths.with_values(column, {"flexure[2].k_y": 4e8, "flexure[2].k_c": 5e8})
    assert stiff.flexure[2].k_y == 4e8
    assert "flexure.d_y" not in free_names(column)


def test_paths_reach_layers():
    steel, concrete = SteelSpring(k=2e8, f_y=5e5, k_post=1e6), ConcreteSpring(6e9, 4e6, 2e-3, 1e8)
    layers = [(-0.2, concrete), (-0.15, steel), (0.15, steel), (0.2, concrete)]
    column = replace(joints(0.002), flexure=Layered(layers), axial_load=1e5)
    known = free_names(column)
    assert known["flexure.layers[1].f_y"].unit == "N"
    assert known["flexure.layers[*].f_y"].unit == ""
    assert "flexure.layers[0].f_y" not in known
    some = {"flexure.layers[*].f_y": 1.1, "flexure.layers[2].f_y": 6e5, "axial_load": 2e5}
    changed = paths.with_values(column, some)
    spring = changed.flexure
    assert [getattr(layer, "f_y", None) for _, layer in spring.layers] == pytest.approx(
        [None, 5.5e5, 6.6e5, None]
    )
    assert [y for y, _ in spring.layers] == [-0.2, -0.15, 0.15, 0.2]
    assert changed.axial_load == 2e5
    two = replace(column, n=2, flexure=[column.flexure] * 2)
    factor = {"flexure[*].layers[*].k": 0.5}
    softer = paths.with_values(two, factor).flexure
    assert [layer.k for _, layer in softer.layers] == [3e9, 1e8, 1e8, 3e9]
    # Joints with the same spring may get different ones.
    one = paths.with_values(two, {"flexure[1].layers[0].k": 7e9}).flexure
    assert [spring.layers[0][1].k for spring in one] == [6e9, 7e9]
    with pytest.raises(InputError, match=r"did you mean 'flexure.layers\[2\].k'.* more \(rbsdem"):
        quiet(column, (D, F), ["flexure.layer[2].k"])


def test_common_factor_comes_back():
    start, truth = joints(0.002, 0.003), joints(0.003, 0.0045)
    fit = quiet(start, response(truth, path(start)), ["flexure[*].d_y"])
    assert fit.values["flexure[*].d_y"] == pytest.approx(1.5, rel=1e-3)
    assert fit.parameters[0].unit == ""


def test_bounds_and_units():
    """By default a fifth and five times; they end where the keys do, or where the rule does."""
    start = COLUMNS["zahn_7"]
    known, flexure = free_names(start), start.flexure
    assert known["flexure.k_c"] == Parameter(
        flexure.k_c, flexure.k_c / 5, flexure.k_c * 5, "N m/rad", "flexure.k_c"
    )
    assert (known["flexure.d_y"].unit, known["shear.d_y"].unit) == ("rad", "m")
    b0, k_u = known["flexure.b0"], known["flexure.k_u"]
    assert (b0.low, b0.high, b0.unit) == (0, 1, "")
    assert (k_u.low, k_u.logarithmic) == (0.0, False)
    assert known["height"].high == pytest.approx(1.2 * 1.6)
    assert "mass" not in known
    # Of a share of 0.6, five times is beyond 1.
    capped = Pinching(
        d_y=2e-3, f_y=2e5, d_cap=0.02, f_cap=2.2e5, d_pc=0.1, kappa_f=0.6, kappa_d=0.9
    )
    column = replace(joints(0.002), flexure=capped)
    known = free_names(column)
    assert (known["flexure.kappa_f"].low, known["flexure.kappa_f"].high) == (0.02, 1.0)
    assert (known["flexure.c"].low, known["flexure.c"].high) == (1.0, 2.0)
    steel = SteelSpring(k=2e8, f_y=5e5, k_post=1e6, cr1=0.9)
    assert free_names(replace(column, flexure=steel))["flexure.cr1"].high == 1.0
    with pytest.raises(InputError, match=r"bounds of flexure.c: 0.5 to 2 go below 1, which the"):
        quiet(column, (D, F), ["flexure.c"], bounds={"flexure.c": (0.5, 2.0)})
    test = response(start, path(start))
    given = quiet(start, test, ["flexure.k_c"], {"flexure.k_c": (1e7, 1e9)}, evaluations=60)
    assert (given.parameters[0].low, given.parameters[0].high) == (1e7, 1e9)


def test_parameter_fractions():
    for number in (Parameter(3.0, 1.0, 10.0), Parameter(0.0, -2.0, 5.0), Parameter(0.5, 0.0, 1.0)):
        for fraction in (0.0, 0.2, 0.7, 1.0):
            assert number.fraction(number.at(fraction)) == pytest.approx(fraction, abs=1e-12)
        assert number.at(number.fraction(number.value)) == pytest.approx(number.value, abs=1e-12)
        step = 1e-6
        slope = (number.at(0.5 + step) - number.at(0.5 - step)) / (2 * step)
        assert number.per_fraction(number.at(0.5)) == pytest.approx(slope, rel=1e-6)
        assert (number.at(-0.1), number.at(1.1)) == (number.low, number.high)


def test_interrupt_keeps_the_best(monkeypatch):
    start = COLUMNS["zahn_7"]
    flexure = replace(start.flexure, k_y=4e7, d_y=4e-3)
    test = response(replace(start, flexure=flexure), path(start))
    calls, whole = [], run_result.follow

    def interrupted(column, call, **how):
        calls.append(column)
        if len(calls) == 60:
            raise KeyboardInterrupt
        return whole(column, call, **how)

    monkeypatch.setattr(run_result, "follow", interrupted)
    fit = quiet(start, test, ["flexure.k_y", "flexure.d_y"])
    assert fit.status == "interrupted"
    assert fit.nrmse < fit.before.nrmse


def test_paths_that_break_off_count_as_errors_of_the_peak(monkeypatch):
    whole = run_result.follow

    def broken(column, call, **how):
        channels, *rest, error, note = whole(column, call, **how)
        if column.shear.k > 4e7:
            # The last row is a state on the way to the next one.
            channels["force"] = channels["force"][: call["displacement"].size // 2 + 1]
            error = SolveError("broken off")
        return channels, *rest, error, note

    test = response(replace(ELASTIC, shear=Elastic(k=5e7)), path(ELASTIC))
    monkeypatch.setattr(run_result, "follow", broken)
    fit = quiet(ELASTIC, test, ["shear.k"])
    assert fit.failed > 0
    assert 3.9e7 < fit.values["shear.k"] < 4e7
    force, error = run_result.reached_force(replace(ELASTIC, shear=Elastic(k=5e7)), test[0])
    assert (force.size, str(error)) == (test[0].size // 2, "broken off")
    assert force == pytest.approx(test[1][: force.size])


def test_differences_look_the_other_way_where_a_column_is_refused():
    def build(values):
        if values["shear.k"] > 3.01e7:
            raise InputError("too stiff")
        return replace(ELASTIC, shear=Elastic(k=values["shear.k"]))

    number = Parameter(3e7, 1e7, 9e7)
    test = Target(response(ELASTIC, path(ELASTIC)))
    misfit = Misfit(build, {"shear.k": number}, test)
    fractions = misfit.start
    base, below = misfit.vectors([fractions, fractions - COARSE])
    found = misfit.jacobian(fractions, COARSE, base)[:, 0]
    assert np.max(np.abs(found)) > 0.01
    assert found == pytest.approx((base - below) / COARSE, abs=1e-9)


def test_limits_of_the_search():
    start = COLUMNS["zahn_7"]
    test = noisy(start, path(start), 0.1)
    few = quiet(start, test, FREE, evaluations=50)
    assert few.status == "evaluations used up"
    assert few.evaluations < 50 + 16 + 60
    late = quiet(start, test, FREE, seconds=1e-9)
    assert late.status == "time used up"
    assert late.nrmse <= late.before.nrmse * (1 + 1e-12)
    assert quiet(start, test, ["flexure.b0"]).status == "converged"


def test_warnings_of_columns_on_the_way_are_not_shown(recwarn):
    far = path(ELASTIC, [0.12])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        test = noisy(replace(ELASTIC, shear=Elastic(k=4e7)), far, 0.01)
    rbsdem.calibrate(ELASTIC, test, ["shear.k"])
    assert not recwarn.list


D, F = response(COLUMNS["zahn_7"], path(COLUMNS["zahn_7"]))


def test_zero_start_with_bounds():
    test = response(COLUMNS["zahn_7"], D)
    zero = replace(COLUMNS["zahn_7"], flexure=replace(COLUMNS["zahn_7"].flexure, k_u=0.0))
    fit = quiet(zero, test, ["flexure.k_u"], {"flexure.k_u": (0, 5e7)})
    assert fit.values["flexure.k_u"] == pytest.approx(COLUMNS["zahn_7"].flexure.k_u, rel=1e-3)
    assert fit.parameters[0].unit == "N m/rad"


def test_report():
    start = COLUMNS["zahn_7"]
    other = replace(start, flexure=replace(start.flexure, k_y=4e7, d_y=4e-3))
    fit = quiet(start, noisy(other, path(start), 0.05), ["flexure.k_y", "flexure.d_y"])
    text = fit.report
    for part in ("nrmse", "before", "after", "flexure.k_y", "N m/rad", "Std. error", "Correlation"):
        assert part in text
    assert f"{fit.before.nrmse:.4f} {fit.nrmse:.4f}" in " ".join(text.split())
    assert f"{fit.evaluations} analyses" in text
    assert f"{fit.values['flexure.k_y']:.4g}" in text
    assert max(map(len, text.splitlines())) <= 110
    frame = fit.to_pandas()
    assert list(frame["name"]) == list(fit.values)
    assert list(frame["value"]) == list(fit.values.values())


def test_progress_on_stderr(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    quiet(COLUMNS["zahn_7"], (D, F), ["flexure.k_y"], progress=True, evaluations=30)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "analyses" in printed.err


@pytest.mark.parametrize("key", KEYS)
def test_measured_columns_of_the_paper(key):
    found = find_history(key, PEER) if Path(PEER).is_dir() else None
    if found is None:
        pytest.skip("the measured histories are not here")
    fit = quiet(COLUMNS[key], read_peer(found), [*FREE, "flexure.b1"])
    assert fit.nrmse < 0.12 < fit.before.nrmse
    assert fit.evaluations < 900
    assert fit.after.energy_ratio == pytest.approx(1, abs=0.1)


def portal(column, beam):
    """Return two storeys whose columns have rigid ends, and whose beams have springs."""
    ends = Bilinear(k=6e7, d_y=beam / 6e7, k_post=6e5)
    kinds = (
        rbsdem.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=column, hardening=0.02, name="column"),
        rbsdem.FrameMember(30e9, 0.15, 3e-3, flexure=(ends, ends), shear=Elastic(6e7), name="beam"),
    )
    columns = {(line, 0): replace(kinds[0], rigid_end=0.1 * line) for line in (1, 2)}
    return rbsdem.Frame.grid([3.2, 3.0], [5.0], columns=columns, beams=kinds[1], beam_load=15e3)


def test_kinds_of_a_frame_are_fitted_to_its_loop():
    path = np.interp(np.linspace(0, 5, 101), range(6), [0, 0.05, -0.05, 0.1, -0.1, 0.15])
    test = rbsdem.cyclic(portal(260e3, 150e3), displacement=path)
    start = portal(200e3, 200e3)
    # The rigid lengths of the cells stay their own, and each kind is stated once.
    assert list(start.named_kinds) == ["column", "beam"]
    known = free_names(start)
    assert known["column.yield_moment"].unit == "N m"
    assert known["beam.flexure[0].d_y"].unit == "rad"
    assert known["beam.shear[0].k"].unit == "N/m"
    fit = rbsdem.calibrate(
        start, (test.displacement, test.force), ["column.yield_moment", "beam.flexure[*].d_y"],
        evaluations=200,
    )  # fmt: skip
    assert fit.column.named_kinds["column"].yield_moment == pytest.approx(260e3, rel=1e-6)
    # A factor on both ends.
    values = {one.name: one.value for one in fit.parameters}
    assert values["beam.flexure[*].d_y"] == pytest.approx(0.75, rel=1e-6)
    assert [fit.column.columns[line, 0].rigid_end for line in (1, 2)] == [0.1, 0.2]
    with pytest.raises(InputError, match=r"did you mean 'beam.flexure\[0\].d_y'"):
        rbsdem.calibrate(start, (test.displacement, test.force), ["beam.flexure[0].d_x"])
