"""Target displacements: worked examples with printed digits, and what follows from the formulas."""

from dataclasses import replace

import numpy as np
import pytest
import strategies_frames

import rbsdem
from rbsdem.checks.target import equivalent
from rbsdem.codes import Capacity, DesignSpectrum, check_target, target
from rbsdem.frames import FrameNode
from rbsdem.motions.design import damping_factor

#: g of the sources over that of the program.
EARTH = 9.81 / 9.80665


def points(text):
    return np.array([[float(x) for x in pair.split(",")] for pair in text.split()]).T


# Steltic/steltic_nonlinear, examples/Ex22_SMF: a steel frame in kip and in, g = 386.4 in/s2.
STEEL = points(
    "0,0 .688,624.14 4.816,4368.98 5.504,4974.042 6.192,5436.638 6.88,5681.301 7.568,5836.166 "
    "8.256,5984.361 8.944,6100.26 9.632,6201.803 10.32,6303.347 11.008,6404.89 11.696,6506.434 "
    "12.384,6607.977 13.072,6709.521 13.76,6811.064 14.448,6909.514 15.136,7007.27 15.824,7105.026 "
    "16.512,7201.174 17.2,7266.463 17.888,7324.787 18.576,7366.315 19.264,7406.821 19.952,7447.326 "
    "20.64,7487.832 21.328,7519.609 23.8565,6213.343"
)
# Three storeys of reinforced concrete (PyPI streng), thinned; m and kN.
S3 = points(
    "0,0 .021951,128.569 .030745,172.846 .042411,224.579 .045047,233.575 .05338,257.737 "
    ".05883,267.534 .068088,276.067 .080098,286.035 .085098,289.525 .095408,293.352 "
    ".132074,304.359 .18001,315.155 .234264,319.579"
)


@pytest.fixture(scope="module")
def steel():
    return Capacity(
        *STEEL, 1.30768638, 1.0, 13476 / 386.4, 4, 0.97505986, 907.18029, 0.0167547 * 907.18029
    )


@pytest.fixture(scope="module")
def s3():
    curve = S3[0], 1e3 * S3[1]
    masses, shape = [39.08e3] * 3, [0.0483, 0.0920, 0.1217]
    return Capacity.of_masses(*curve, masses, shape, period=0.753, stiffness=5857.0908e3)


def constant(sa):
    return DesignSpectrum.table([0.0, 10.0], [sa, sa])


def single(k, force, *, post=0.0, end=50.0, mass=1.0):
    """Return the curve of one mass: elastic, then with a share of the slope."""
    at = force / k
    return Capacity(
        [0, at, end * at], [0, force, force + post * k * (end - 1) * at], 1.0, mass, mass
    )


@pytest.mark.parametrize(
    ("level", "printed", "exact"),
    [
        # Vy, displacement at yield, alpha_1, mu_strength, C_1, target, mu_max. The iteration of the
        # source stops early: its yield force is 0.22 % off, its target 0.005 %.
        (
            1.0,
            (5328.612, 5.873818, 0.331590, 1.4005847, 1.0070223, 7.5405427, 1.8268935),
            (5316.8026, 5.860801, 0.3367505, 1.4036956, 1.00707685, 7.540951, 1.8298146),
        ),
        (
            1.5,
            (5576.058, 6.146582, 0.185922, 2.0076476, 1.0176642, 11.4303435, 2.4027647),
            (5573.9717, 6.1442826, 0.1862719, 2.0083989, 1.01767741, 11.430491, 2.4034847),
        ),
    ],
)
def test_coefficients_of_a_steel_frame(steel, level, printed, exact):
    sa = 0.6153468 * 386.4 * level
    found = target(steel, constant(sa), near_field=True)
    f = found.factors
    numbers = (
        found.lines.yield_force, found.lines.yield_displacement, f["alpha_1"], found.ductility,
        f["C_1"], found.displacement, f["mu_max"],
    )  # fmt: skip
    np.testing.assert_allclose(numbers, exact, rtol=2e-7)
    np.testing.assert_allclose(numbers, printed, rtol=0.016)
    assert found.displacement == pytest.approx(printed[5], rel=6e-5)
    # The slopes that mu_max has are printed without the iteration.
    slopes = f["alpha_2"], f["alpha_PDelta"], f["alpha_e"]
    np.testing.assert_allclose(slopes, (-0.5694755, -0.0167547, -0.4589315), rtol=1e-6)


def test_masses_and_shape_of_three_storeys(s3):
    # Printed: PF1 phi and the share of the mass, 0.8935.
    assert s3.gamma == pytest.approx(1.24514503, abs=5e-9)
    assert s3.modal_mass == pytest.approx(84132.7855, abs=5e-5)
    assert s3.gamma * s3.modal_mass / s3.total_mass == pytest.approx(0.8935, abs=5e-5)


def test_four_methods_on_three_storeys(s3):
    demand = DesignSpectrum.en_1998(0.24 * EARTH, "C")
    once = target(s3, demand, "en_1998", iterate=False)
    assert once.lines.yield_force / s3.gamma == pytest.approx(256660.06, abs=5e-3)
    assert once.lines.yield_displacement / s3.gamma == pytest.approx(0.0621670, abs=5e-8)
    assert once.period == pytest.approx(0.8969401, abs=5e-8)
    assert once.displacement == pytest.approx(0.1148929, abs=5e-8)
    settled = target(s3, demand, "en_1998")
    assert settled.lines.yield_force / s3.gamma == pytest.approx(237797.61, abs=5e-3)
    assert settled.period == pytest.approx(0.8160951, abs=5e-8)
    assert settled.acceleration == pytest.approx(4.9765524, abs=5e-8)
    assert settled.ductility == pytest.approx(1.7607040, abs=5e-8)
    assert settled.displacement == pytest.approx(0.1045371, abs=5e-8)
    coefficients = target(s3, demand, cm=0.9)
    assert coefficients.lines.stiffness == pytest.approx(5718039.4, abs=0.05)
    assert coefficients.period == pytest.approx(0.7621007, abs=5e-8)
    assert coefficients.lines.yield_force == pytest.approx(251776.15, abs=5e-3)
    assert coefficients.ductility == pytest.approx(2.2333701, abs=5e-8)
    assert coefficients.factors["C_1"] == pytest.approx(1.0353930, abs=5e-8)
    assert coefficients.displacement == pytest.approx(0.1010758, abs=5e-8)
    point = target(s3, demand, "capacity_spectrum")
    assert point.displacement / s3.gamma == pytest.approx(0.0787816, abs=5e-8)
    assert point.ductility == pytest.approx(2.2477326, abs=5e-8)
    f = point.factors
    np.testing.assert_allclose(
        [f["T_0"], f["T_eff"], 100 * f["beta_eff"], f["B"], f["T_sec"], f["alpha"]],
        [0.7617404, 0.9426932, 10.4917319, 1.2309918, 1.0524324, 0.1422784],
        rtol=0,
        atol=6e-8,
    )
    assert point.base_shear == pytest.approx(294158, abs=0.5)


@pytest.mark.parametrize(
    ("ag", "sae", "reached"),
    [(0.6, 1.133097, 0.177634), (0.3, 0.566548, 0.088817), (0.15, 0.283274, 0.044409)],
)
def test_four_storeys_of_fajfar(ag, sae, reached):
    # Fajfar 2000: printed m* 217 t, Gamma 1.34, T* 0.79 s; 17.7 and 23.7 cm at 0.6 g.
    masses, shape = [87e3, 86e3, 86e3, 83e3], [0.28, 0.52, 0.76, 1.0]
    gamma = 1.336047
    curve = gamma * np.array([0, 0.061, 0.61]), gamma * np.array([0, 830e3, 830e3])
    made = Capacity.of_masses(*curve, masses, shape)
    assert (made.modal_mass, made.gamma) == pytest.approx((217440, gamma), rel=1e-6)
    # Plateau of 2.5 a_g up to 0.6 s: that of soil C without its factor.
    found = target(made, DesignSpectrum.en_1998(ag * EARTH / 1.15, "C"), "en_1998")
    assert found.period == pytest.approx(0.79428, abs=5e-6)
    assert found.acceleration / 9.81 == pytest.approx(sae, abs=5e-6)
    assert found.displacement / made.gamma == pytest.approx(reached, abs=1e-6)


@pytest.mark.parametrize(
    ("force", "at", "period", "strength", "reached"),
    [
        (200e3, 0.020, 0.6283185, 2.927456, 0.0585491),  # long: equal displacements
        (500e3, 0.008, 0.2513274, 1.4715, 0.01550416),  # short and inelastic
        (250e3, 0.004, 0.2513274, 2.943, 0.0194619),
        (100e3, 0.0012, 0.2176559, 7.3575, 0.0187254),  # large q_u
    ],
)
def test_n2_of_single_masses(force, at, period, strength, reached):
    curve = single(force / at, force, mass=100e3)
    found = target(curve, DesignSpectrum.en_1998(0.25 * EARTH, "B"), "en_1998")
    numbers = found.period, found.factors["q_u"], found.displacement
    np.testing.assert_allclose(numbers, (period, strength, reached), rtol=3e-6)


def test_n2_is_capped_at_three_elastic_displacements():
    curve = single(1.0, 0.03, end=4e3)
    found = target(curve, DesignSpectrum.table([0, 20], [10.0, 10.0], corner=19.0), "en_1998")
    assert found.displacement == pytest.approx(3 * found.factors["d_et*"], rel=1e-9)


@pytest.mark.parametrize(
    ("strength", "period", "site", "c1", "c2"),
    [
        (3, 0.5, "D", 1.133333, 1.02),
        (3, 0.15, "D", 1.833333, 1 + (2 / 0.15) ** 2 / 800),  # only C_1 has a floor of 0.2 s
        (3, 0.5, "A", 1.0615385, 1.02),
        (3, 0.8, "F", 1.0520833, 1.0),
        (5, 0.3, "C", 1.4938272, 1.2222222),
        (3, 1.0001, "D", 1.0, 1.0),
        (0.5, 0.3, "D", 1.0, 1.0),
    ],
)
def test_coefficients_one_by_one(strength, period, site, c1, c2):
    k = (2 * np.pi / period) ** 2
    found = target(single(k, 1 / strength), constant(1.0), site_class=site)
    assert (found.factors["C_1"], found.factors["C_2"]) == pytest.approx((c1, c2), abs=1e-6)
    assert found.displacement == pytest.approx(c1 * c2 / k, rel=1e-6)


@pytest.mark.parametrize(("near", "limit"), [(True, 4.287992), (False, 5.647893)])
def test_largest_strength(near, limit):
    # Falls by 0.3 of the slope behind 0.20 m; P-Delta alone takes 0.05 of it.
    k = (2 * np.pi / 0.8) ** 2
    force = 0.06 * k
    end = 0.20 + 0.4 * force / (0.3 * k)
    curve = Capacity(
        [0, 0.06, 0.20, end], [0, force, force, 0.6 * force], 1.0, 1.0, 1.0, pdelta_slope=0.05 * k
    )
    found = target(curve, constant(0.21 * k), near_field=near)
    assert found.factors["mu_max"] == pytest.approx(limit, abs=1e-6)
    beyond = target(curve, constant(0.36 * k), near_field=near)
    assert bool(beyond.warnings) == (beyond.ductility > beyond.factors["mu_max"])


@pytest.mark.parametrize(
    ("ductility", "longer", "damping"),
    [
        (0.5, 1, 0), (1, 1, 0), (1.5, 1.04525, 1.0875), (2, 1.162, 3.8), (3, 1.496, 10.8),
        (4, 1.67, 14.96), (5, 1.80, 15.28), (6.5, 1.995, 15.76), (8, 2.175225, 15.587811),
    ],
)  # fmt: skip
def test_equivalent_oscillators(ductility, longer, damping):
    assert equivalent(ductility) == pytest.approx((longer, damping), abs=5e-7)


def test_spectra():
    demand = DesignSpectrum.en_1998(0.24, "C")
    g = 9.80665
    for period, sa, sd in [
        (0, 0.276, 0), (0.1, 0.483, 0.00120021), (0.3, 0.69, 0.01543124), (0.6, 0.69, 0.06172497),
        (1, 0.414, 0.10287494), (2, 0.207, 0.20574989), (3, 0.092, 0.20574989),
    ]:  # fmt: skip
        assert demand.sa(period) / g == pytest.approx(sa, abs=5e-7)
        assert demand.sd(period) * EARTH == pytest.approx(sd, abs=5e-9)
    # streng prints 0.72 g for soil B at 0.5 s; eta of 10, 20 and 30 %.
    assert DesignSpectrum.en_1998(0.24, "B").sa(0.5) / g == pytest.approx(0.72, abs=1e-12)
    for damping, eta in ((0.1, 0.816497), (0.2, 0.632456), (0.3, 0.55)):
        damped = DesignSpectrum.en_1998(0.24, "B", damping=damping)
        assert damped.sa(0.4) / g == pytest.approx(0.72 * eta, abs=1e-6)
    periods = [0, 0.05, 0.4 / 3, 0.5, 1, 2, 10]
    for damping, printed in (
        (0.05, [0.48, 0.75, 1.2, 1.2, 0.8, 0.4, 0.064]),
        (0.10, [0.48, 0.670959, 0.989224, 0.989224, 0.659483, 0.329741, 0.0527586]),
    ):
        general = DesignSpectrum.asce_41(1.2, 0.8, damping=damping)
        np.testing.assert_allclose([general.sa(t) / g for t in periods], printed, rtol=2e-6)
    assert damping_factor(0.2) == pytest.approx(1.535940, abs=5e-7)


def test_corner_and_mean_of_records():
    demand = DesignSpectrum.en_1998(0.24, "C")
    again = DesignSpectrum.table(demand.period, demand.acceleration)
    assert again.corner == pytest.approx(0.6, abs=0.02)  # between two of its periods
    records = rbsdem.motions.synthetic(3)
    mean = DesignSpectrum.mean_of(records)
    # A period of the table itself.
    at = float(mean.period[100])
    assert mean.sa(at) == pytest.approx(np.mean([one.sa(at) for one in records]), rel=1e-12)
    doubled = DesignSpectrum.mean_of([one.scaled(2.0) for one in records])
    assert doubled.sa(at) == pytest.approx(2 * mean.sa(at), rel=1e-12)


# ---- what follows from the formulas --------------------------------------------------------------


def test_a_bilinear_curve_is_its_own_line():
    # The first line is the curve's: its 0.6 lies on it, and so do the areas.
    # A steep second line may hold 0.6 of a higher yield force, too.
    for post in (0.0, 0.03, 0.1):
        curve = single(4.0, 2.0, post=post, end=20.0, mass=3.0)
        for sa in (1.0, 2.0, 4.0):
            lines = target(curve, constant(sa)).lines
            assert (lines.yield_displacement, lines.yield_force) == pytest.approx(
                (0.5, 2.0), rel=1e-9
            )


def test_methods_agree_on_an_elastic_mass():
    # T* = T_e = T_eff = T, and C_0 = Gamma = 1; 0.24 % of FEMA 440 is its B at 5 %.
    curve = single(40.0, 100.0, mass=2.0)
    demand = DesignSpectrum.en_1998(0.2, "B")
    period = 2 * np.pi * np.sqrt(2.0 / 40.0)
    for method, factor in (
        ("asce_41", 1.0), ("en_1998", 1.0), ("capacity_spectrum", 1 / damping_factor(0.05))
    ):  # fmt: skip
        found = target(curve, demand, method)
        assert found.period == pytest.approx(period, rel=1e-9)
        assert found.displacement == pytest.approx(factor * demand.sd(period), rel=1e-8)


@pytest.mark.parametrize("method", ["asce_41", "en_1998", "capacity_spectrum"])
def test_scales_of_masses_and_shapes(s3, method):
    demand = DesignSpectrum.en_1998(0.24, "C")
    whole = target(s3, demand, method).displacement
    heavier = Capacity.of_masses(
        S3[0], 4e3 * S3[1], [4 * 39.08e3] * 3, [0.966, 1.84, 2.434], period=0.753
    )
    once = replace(s3, stiffness=np.nan)
    assert target(heavier, demand, method).displacement == pytest.approx(
        target(once, demand, method).displacement, rel=1e-8
    )
    # Twice the demand moves further.
    assert target(s3, DesignSpectrum.en_1998(0.48, "C"), method).displacement > 1.5 * whole


def test_a_curve_that_ends_too_early_says_so(s3):
    for method in ("asce_41", "en_1998", "capacity_spectrum"):
        found = target(s3, DesignSpectrum.en_1998(1.0, "D"), method)
        assert not found.reached
        assert np.isnan(found.base_shear)
        assert "not reached" in repr(found)
        assert "nan" not in repr(found)


def test_a_falling_branch_without_lines_hides_no_point():
    # Behind the drop no two lines have its area; the point before it is found as without the drop.
    up, force = [0.0, 0.02, 0.10], [0.0, 1e5, 1.2e5]
    masses = 1.3, 1e5, 1.4e5, 3
    demand = DesignSpectrum.en_1998(0.1, "B")
    whole = target(Capacity(up, force, *masses), demand, "capacity_spectrum")
    cut = target(Capacity([*up, 0.11], [*force, 0.3e5], *masses), demand, "capacity_spectrum")
    assert cut.displacement == pytest.approx(whole.displacement, rel=1e-8)


def test_refusals(s3):
    demand = DesignSpectrum.en_1998(0.24, "C")
    for call, text in [
        (lambda: target(s3, demand, "n2"), "asce_41"),
        (lambda: target(s3, demand, "en_1998", cm=0.9), "it takes iterate"),
        (lambda: target(s3, 0.24), "DesignSpectrum"),
        (lambda: target(3.0, demand), "pushover"),
        (lambda: check_target(target(s3, demand), []), "push-over of a frame"),
        (lambda: DesignSpectrum.en_1998(2.45), "part of g"),
        (lambda: DesignSpectrum.asce_41(0.9 * 9.81, 0.5), "part of g"),
        (lambda: DesignSpectrum.en_1998(0.2, "F"), "A, B, C, D, E"),
        (lambda: DesignSpectrum.asce_41(0.01, 0.6), "is s_xs in g"),
        (lambda: DesignSpectrum.table([0, 1], [1, np.nan]), "nan"),
        (lambda: DesignSpectrum.table([0, 1], [1, 1]).sa(2.0), "outside of its points"),
        (lambda: Capacity.of_masses(*S3, [1, 2], [1]), "2 masses"),
    ]:
        with pytest.raises(rbsdem.InputError, match=text):
            call()


def test_a_curve_in_other_units_is_told():
    # In kN beside masses in kg the period of 0.7 s is one of 23 s.
    with pytest.warns(rbsdem.errors.AccuracyWarning, match=r"period of 23.* no building"):
        Capacity.of_masses(*S3, [39.08e3] * 3, [0.0483, 0.0920, 0.1217])
    # Its period may be given; 320 kN are 0.28 of the weight.
    with pytest.warns(
        rbsdem.errors.AccuracyWarning, match=r"strength of 0.000278 times the weight"
    ):
        Capacity.of_masses(*S3, [39.08e3] * 3, [0.0483, 0.0920, 0.1217], period=0.7)


# ---- frames --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def portal():
    """Return two storeys of yielding members, and their push-over by the first mode."""
    column = rbsdem.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=250e3, hardening=0.02)
    beam = rbsdem.FrameMember(30e9, 0.15, 2.0e-3, yield_moment=200e3, hardening=0.02)
    frame = rbsdem.Frame.grid(
        [3.2, 3.2], [6.0], columns=column, beams=beam, floor_mass=40e3, beam_load=20e3,
        kinematics="pdelta", pattern="modal",
    )  # fmt: skip
    return rbsdem.pushover(frame, drift=0.04)


def test_a_frame_has_its_own_modal_mass(portal):
    found = target(portal, DesignSpectrum.en_1998(0.35, "C"), "en_1998")
    modes = rbsdem.modes(portal.frame, 1)
    curve = found.curve
    # Gamma m* is the effective mass, and the elastic slope under the modal pattern m* omega^2.
    assert curve.gamma * curve.modal_mass == pytest.approx(modes.mass[0], rel=1e-12)
    slope = curve.force_at(1e-4) / 1e-4
    # But for the masses that move upward in the mode, which the load along x leaves alone.
    assert slope == pytest.approx(curve.modal_mass * modes.omega[0] ** 2, rel=1e-4)
    assert curve.pdelta_slope > 0


@pytest.mark.parametrize("pattern", ["modal", "uniform", "triangular", "nodes"])
@pytest.mark.parametrize("diaphragm", [False, True])
def test_the_period_belongs_to_the_slope_of_any_pattern(portal, pattern, diaphragm):
    # Before yield K_e is the slope of the curve, and T_e = T_i under every pattern.
    pushed = [FrameNode(f"N-1-{i}", push_x=x) for i, x in ((1, 0.5), (2, 0.5))]
    nodes = {"nodes": pushed} if pattern == "nodes" else {}
    frame = replace(portal.frame, pattern=pattern, diaphragm=diaphragm, **nodes)
    found = target(rbsdem.pushover(frame, drift=0.02), DesignSpectrum.en_1998(0.02, "C"))
    assert found.curve.stiffness == pytest.approx(found.curve.slope, rel=1e-9)
    assert found.period == pytest.approx(rbsdem.modes(frame, 1).period[0], rel=1e-9)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.filterwarnings("ignore")
def test_more_demand_never_moves_a_frame_less(seed):
    """Ends of lines at which the demand lies beyond them become more as the spectrum grows."""
    rng = np.random.default_rng(seed)
    frame = strategies_frames.frame(rng, list(strategies_frames.FAMILIES)[seed % 5])
    push = rbsdem.pushover(frame, drift=0.03, points=30)
    levels = np.exp(np.sort(rng.uniform(np.log(0.003), np.log(1.2), 6)))
    soil = str(rng.choice(list("ABCDE")))
    for method in ("asce_41", "en_1998", "capacity_spectrum"):
        found = [target(push, DesignSpectrum.en_1998(float(ag), soil), method) for ag in levels]
        assert (np.diff([each.displacement for each in found]) >= 0).all()
        for each, ag in zip(found, levels, strict=True):
            if each.displacement > each.curve.first_yield:
                continue
            assert each.ductility <= 1.0
            if method == "asce_41":
                assert each.factors["C_1"] == each.factors["C_2"] == 1.0
            if each.displacement > each.curve.elastic:
                continue
            # On the first line of the curve the answer is that of the elastic frame.
            first = 2 * np.pi * np.sqrt(each.curve.modal_mass / each.curve.slope)
            if method == "asce_41":
                first = each.curve.period * np.sqrt(each.curve.stiffness / each.curve.slope)
            factor = damping_factor(0.05) if method == "capacity_spectrum" else 1.0
            elastic = each.curve.gamma * DesignSpectrum.en_1998(float(ag), soil).sd(first) / factor
            assert each.displacement == pytest.approx(elastic, rel=1e-9)


def test_cracks_are_no_yield():
    # Cracked from 2 mm on with a third of the stiffness, yielding at 20 mm; one mass of 1e5 kg.
    u, v = [0, 0.002, 0.020, 0.060], [0, 60e3, 240e3, 250e3]
    curve = Capacity(u, v, 1.0, 1e5, 1e5, first_yield=0.020)

    def asked(stiffness):
        """Return the constant acceleration that takes the line to 10 mm."""
        return 0.010 * stiffness / 1e5

    # At 10 mm the force is 140 kN: 0.6 of it at 4.4 mm, or equal areas of 60 + 800 J.
    lines = {"asce_41": 84e3 / 0.0044, "en_1998": 140e3 / (2 * (0.010 - 860 / 140e3))}
    for method, stiffness in lines.items():
        found = target(curve, constant(asked(stiffness)), method)
        assert found.displacement == pytest.approx(0.010, rel=1e-8)
        assert found.ductility == pytest.approx(0.5, rel=1e-8)
        assert found.lines.stiffness == pytest.approx(stiffness, rel=1e-8)
        assert found.lines.yield_force == pytest.approx(240e3, rel=1e-12)
    # A frame of cracking sections has its first yield from its events.
    push = rbsdem.pushover(rbsdem.examples.portal(), drift=0.01)
    yields = next(event for event in push.events if event.name == "yield")
    found = target(push, DesignSpectrum.en_1998(0.1, "C"))
    assert found.curve.first_yield == pytest.approx(yields.displacement - push.displacement[0])
    assert found.ductility == pytest.approx(found.displacement / found.curve.first_yield)


def test_a_fall_at_one_displacement_has_no_slope():
    # A brittle loss: nothing of the strength is left behind the peak.
    curve = Capacity([0, 0.06, 0.06, 0.1], [0, 1e5, 1e4, 1e4], 1.0, 1e5, 1e5)
    found = target(curve, constant(4.0))
    assert found.factors["mu_max"] == pytest.approx(1.0)
    assert found.warnings


def test_the_state_at_the_target(portal):
    found = target(portal, DesignSpectrum.en_1998(0.35, "C"))
    assert found.storey_drift @ np.array([3.2, 3.2]) == pytest.approx(found.displacement, rel=1e-3)
    assert found.drift == pytest.approx(found.displacement / 6.4, rel=1e-12)
    # To the other side its mirror image, with the node on the other line.
    back = rbsdem.pushover(replace(portal.frame, control_node="N-2-2"), drift=-0.04)
    other = target(back, DesignSpectrum.en_1998(0.35, "C"))
    assert other.displacement == pytest.approx(found.displacement, rel=1e-9)
    assert other.signed == pytest.approx(-found.signed, abs=1e-9)


def test_records_of_an_elastic_frame_have_its_spectrum(portal):
    # What stays elastic follows its spectrum: with a record that has the demand itself as its
    # spectrum the estimate is right up to the higher modes.
    column, beam = (rbsdem.FrameMember(30e9, a, i) for a, i in ((0.16, 2.1e-3), (0.15, 2.0e-3)))
    frame = rbsdem.Frame.grid(
        [3.2, 3.2], [6.0], columns=column, beams=beam, floor_mass=40e3, beam_load=20e3,
        pattern="modal", damping=0.05,
    )  # fmt: skip
    record = rbsdem.motions.synthetic(1)[0]
    own = DesignSpectrum.mean_of([record])
    found = target(rbsdem.pushover(frame, drift=0.05), own, "en_1998")
    check = check_target(found, [record], progress=False, dt=0.0025)
    assert check.factor[0] == pytest.approx(1.0, abs=2e-3)
    row = check.to_pandas().set_index("where").loc["roof"]
    assert row["ratio"] == pytest.approx(1.0, abs=0.04)
    assert not check.collapsed.any()


def test_the_check_scales_records_to_the_demand(portal):
    found = target(portal, DesignSpectrum.en_1998(0.35, "C"))
    records = rbsdem.motions.synthetic(3)
    check = check_target(found, records, progress=False)
    halves = check_target(found, [one.scaled(0.5) for one in records], progress=False)
    np.testing.assert_allclose(halves.factor, 2 * check.factor, rtol=1e-12)
    np.testing.assert_allclose(halves.roof_drift, check.roof_drift, rtol=1e-9)
    table = check.to_pandas()
    assert list(table["where"]) == ["roof", "storey 1", "storey 2", "largest storey"]
    assert "3 records" in repr(check)
