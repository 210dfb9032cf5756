"""Figures, every one: what is drawn and in which units, keywords, styles, axes of the caller."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.patches import Circle
from samples import EIGHT_BARS, SECTION, printed

import rbsdem
from rbsdem import codes, fragility, plot
from rbsdem._files import Tabular
from rbsdem.curves import Envelope
from rbsdem.output import frames
from rbsdem.section import shear
from rbsdem.springs import Elastic

mpl.use("Agg")

PAPER = rbsdem.peer.paper_sections()["soesianawati_1"]
COLUMN = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
HEIGHT = COLUMN.height
D = HEIGHT * rbsdem.protocol([0.005, 0.01], cycles=1, points=20)
RESULT = rbsdem.cyclic(COLUMN, displacement=D)
TEST = (D, 1.1 * RESULT.force)
LAYERED = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
BENT = rbsdem.cyclic(
    LAYERED, displacement=1.6 * rbsdem.protocol([0.01, 0.04, 0.09], points=6), openings=True
)
MANY = {"method": "newmark", "dt": 0.01}


def shaken(n: int = 3) -> rbsdem.Result:
    """A column of n bodies that is shaken at its top."""
    time = np.arange(0.0, 0.5, 0.01)
    column = rbsdem.Column(
        1.6, 600.0, COLUMN.shear, COLUMN.flexure, n=n, kinematics="pdelta", axial_load=1e5
    )
    return rbsdem.time_history(column, time, force=1e4 * np.sin(20 * time), method="rk4")


@pytest.fixture(scope="module")
def figures() -> dict[str, tuple[Callable[..., Any], tuple[Any, ...], list[Any]]]:
    """Function, arguments, and points that are drawn, in the units of the labels."""
    elastic = rbsdem.Column(2.0, 1e3, Elastic(4e5), Elastic(4e9), damping=0.05)
    records = rbsdem.motions.synthetic(3)
    ida = rbsdem.ida(elastic, records, levels=[2.0, 5.0, 30.0], **MANY)
    curve = fragility.fit_fragility("light", fragility.Capacities(*2 * [np.array([2.0, 3.0, 5.0])]))
    curves = {"light": curve, "heavy": curve}
    stripes = fragility.stripes(elastic, records, [2.0, 5.0], **MANY)
    diagram = rbsdem.section.diagram(PAPER.section, PAPER.axial_load)
    sheared = shear.shear_diagram(PAPER.section, 1.6, PAPER.axial_load, furthest=0.022)
    code = rbsdem.section.interaction(PAPER.section, "ec2")
    values = codes.code_values(SECTION, 1.6, 1.2e6)
    states, history, spectrum = BENT.limit_states(), shaken(), records[0].spectrum()
    line = Envelope(1, np.array([0.0, 0.02, 0.06]), np.array([0.0, 2e5, 2e5]))
    band = rbsdem.peer.band(LAYERED, BENT.displacement, samples=8)
    fit = rbsdem.calibrate(COLUMN, TEST, free=["flexure.k_u"])
    study = rbsdem.compare_methods(COLUMN, displacement=D[:40], budget=0.5)
    peak, first, p, knee = (
        RESULT.force.argmax(),
        states["first_yield"],
        diagram.events,
        sheared.knee,
    )
    x, y = 1e3 * D[peak], RESULT.force[peak] / 1e3
    end = history.time[-1]
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=2e5, hardening=0.01)
    bent = rbsdem.Frame.grid([3.2, 3.0], [6.0], columns=member, beams=member, beam_load=2e4)
    pushed = rbsdem.pushover(bent, drift=0.03, points=20)
    drawn = rbsdem.Frame.grid([3.2], [5.0], columns=SECTION, beams=SECTION, dead_load=1e4)
    bent_beams = rbsdem.pushover(drawn, drift=0.01, points=5)
    single = codes.Capacity([0, 0.01, 0.1], [0, 1e4, 1e4], 1.25, 1e3, 2e3)
    target = codes.target(single, codes.DesignSpectrum.en_1998(0.2, "C"), "en_1998")
    corner, massive = target.lines, 1.25e3
    house = rbsdem.Building.grid(
        [3.0], [6.0], [5.0], columns=member, beams_x=member, beams_y=member, floor_load=5e3
    )
    moved = rbsdem.pushover(house, displacement=0.01, points=2)
    roof, shear_of = 1e3 * pushed.displacement[-1], 1e-3 * pushed.base_shear[-1]
    first_of = {of: 100 * of.runs.response("peak_drift")[0] for of in (stripes,)}
    return {
        "loop": (plot.loop, (RESULT,), (x, y)),
        "loops_over_test": (plot.loops_over_test, (RESULT, TEST), (x, 1.1 * y)),
        "comparison": (plot.comparison, (rbsdem.compare(RESULT, TEST),), (x, y)),
        "calibration": (plot.calibration, (fit,), (x, 1.1 * y)),
        "envelope": (plot.envelope, (line,), (60.0, 200.0)),
        "limit_states": (
            plot.limit_states,
            (states,),
            (1e3 * first.displacement, first.force / 1e3),
        ),
        "code_comparison": (plot.code_comparison, (codes.compare(values, BENT),), None),
        "moment_curvature": (
            plot.moment_curvature,
            (diagram,),
            (1e3 * p.peak.curvature, p.peak.moment / 1e3),
        ),
        "shear_diagram": (
            plot.shear_diagram,
            (sheared,),
            (1e3 * knee.strain, knee.force / 1e3),
        ),
        "interaction": (plot.interaction, (code,), (0.0, code.axial_load[-1] / 1e3)),
        "section": (plot.section, (PAPER.section,), None),
        "section_state": (plot.section_state, (BENT, 3.0), None),
        "history": (plot.history, (history,), (end, 1e3 * history.displacement[-1])),
        "energy": (plot.energy, (history,), (end, history.energy["input"][-1] / 1e3)),
        "profile": (plot.profile, (history,), None),
        "methods": (plot.methods, (study,), None),
        "ida": (plot.ida, (ida,), (0.0, 0.0)),
        "stripes": (plot.stripes, (stripes,), (first_of[stripes], 2.0)),
        "fragility": (plot.fragility, (curve,), (3.0, 0.5)),
        "fragilities": (plot.fragilities, (curves,), (3.0, 0.5)),
        "motion": (plot.motion, records[:1], (0.0, records[0].acceleration[0])),
        "spectrum": (
            plot.spectrum,
            (spectrum,),
            (spectrum.period[9], spectrum.pseudo_acceleration[9]),
        ),
        "band": (plot.band, (band,), (0.0, band.force[0] / 1e3)),
        "frame": (plot.frame, (pushed,), None),
        "pushover": (plot.pushover, (pushed,), (roof, shear_of)),
        "storey_drift": (plot.storey_drift, (pushed,), (100 * pushed.storey_drift[-1, 0], 3.2)),
        "member_forces": (plot.member_forces, (pushed,), None),
        "mode": (
            plot.mode,
            (rbsdem.modes(replace(pushed.frame, floor_mass=2e4, beam_load=1e4), 2), 2),
            None,
        ),
        "plan": (plot.plan, (moved,), (3.0, 2.5)),
        "building": (plot.building, (moved,), None),
        "assessment": (plot.assessment, (codes.assess(bent_beams, at=0.01),), None),
        "target": (
            plot.target,
            (target,),
            (1e3 * corner.yield_displacement / 1.25, corner.yield_force / (massive * 9.80665)),
        ),
    }


#: Labels of the horizontal and the vertical axis.
LABELS = {
    **dict.fromkeys(
        ("loop", "loops_over_test", "comparison", "calibration", "limit_states", "envelope"),
        ("Top displacement (mm)", "Lateral force (kN)"),
    ),
    "code_comparison": ("Drift ratio (%)", "Lateral force (kN)"),
    "moment_curvature": ("Curvature (mrad/m)", "Moment (kN m)"),
    "shear_diagram": ("Shear strain (mm/m)", "Shear force (kN)"),
    "interaction": ("Moment (kN m)", "Axial load (kN), compression positive"),
    "section": ("Width (mm)", "$y$ (mm)"),
    "section_state": ("Width (mm)", "$y$ (mm)"),
    "history": ("Time (s)", "Top displacement (mm)"),
    "energy": ("Time (s)", "Energy (kJ)"),
    "profile": ("Drift (%)", "Height (m)"),
    "methods": ("Wall time (s)", "Relative error"),
    "ida": ("Peak drift (%)", "Sa(0.314 s, 5 %) (m/s²)"),
    "stripes": ("Peak drift (%)", "Sa(0.314 s, 5 %) (m/s²)"),
    "fragility": ("", "Probability"),
    "fragilities": ("", "Probability"),
    "motion": ("Time (s)", "Acceleration (m/s²)"),
    "spectrum": ("Period (s)", "Pseudo-acceleration (m/s²)"),
    "band": ("Path of displacement (mm)", "Force (kN)"),
    "frame": ("Distance (m)", "Height (m)"),
    "pushover": ("Roof displacement (mm)", "Base shear (kN)"),
    "storey_drift": ("Storey drift (%)", "Height (m)"),
    "member_forces": ("Distance (m)", "Height (m)"),
    "mode": ("Distance (m)", "Height (m)"),
    "assessment": ("Distance (m)", "Height (m)"),
    **dict.fromkeys(("plan", "building"), ("$x$ (m)", "$y$ (m)")),
    "target": ("Spectral displacement (mm)", "Spectral acceleration (g)"),
}


@pytest.fixture(autouse=True)
def closed():
    """Close the figures of a test."""
    yield
    plt.close("all")


def fonts(figure) -> set[tuple[str, float]]:
    """Family and size of every text; of an axis of drifts those above."""
    figure.draw_without_rendering()
    found = []
    for ax in figure.axes:
        found += [*ax.get_xticklabels(), *ax.get_yticklabels(), ax.xaxis.label, ax.yaxis.label]
        found += [ax.title, *ax.texts, *(ax.get_legend().get_texts() if ax.get_legend() else [])]
        for drift in ax.child_axes:
            found += [*drift.get_xticklabels(), drift.xaxis.label]
    shown = [text for text in found if text.get_text() and text.get_visible()]
    return {(text.get_fontfamily()[0], text.get_fontsize()) for text in shown}


def parameters(function: Any) -> dict[str, inspect.Parameter]:
    return dict(inspect.signature(function).parameters) if inspect.isfunction(function) else {}


def test_every_figure_is_tried(figures):
    found = {name for name, it in vars(plot).items() if {"ax", "axes"} & set(parameters(it))}
    assert set(figures) == set(LABELS) == found - {"style_of", "axes_or_new"}


@pytest.mark.parametrize("name", LABELS)
def test_figure(figures, name):
    """Units, data, the one style of new axes, the keywords of lines, and axes of the caller."""
    function, given, point = figures[name]
    before = dict(mpl.rcParams)
    axes = np.ravel(function(*given))
    assert (axes[0].get_xlabel(), axes[0].get_ylabel()) == LABELS[name]
    if point is not None:
        drawn = np.vstack([line.get_xydata() for line in axes[-1].get_lines()])
        scale = np.nanmax(np.abs(drawn), axis=0)
        assert np.nanmin(np.abs((drawn - point) / scale).max(axis=1)) < 5e-3
    families, sizes = zip(*fonts(axes[0].figure), strict=True)
    assert set(families) == {"STIXGeneral"}
    assert 6 < max(sizes) <= 9.6
    if "line" in parameters(function):
        for line in ({"lw": 2.5, "c": "red", "ls": ":"}, {"linewidth": 2.5, "color": "red"}):
            for ax in np.ravel(function(*given, **line)):
                ours = [one for one in ax.get_lines() if one.get_color() == "red"]
                assert 2.5 in {one.get_linewidth() for one in ours}
    assert {key for key in before if before[key] != mpl.rcParams[key]} == set()
    with mpl.rc_context({"font.family": "monospace", "font.size": 13.0}):
        space = {"projection": "3d"} if name == "building" else {}
        own = list(plt.subplots(1, 3, subplot_kw=space)[1][: axes.size])
        where = {"axes": own} if "axes" in parameters(function) else {"ax": own[0]}
        assert np.ravel(function(*given, **where)).tolist() == own
        assert {family for family, _ in fonts(own[0].figure)} == {"monospace"}


def test_loops_of_the_caller_keep_their_letters():
    """The axis of drifts has those of the axis below, also after new limits and a second loop."""
    with mpl.rc_context({"font.family": "serif", "font.size": 13.0}):
        figure, ax = plt.subplots()
        ax.set(xlabel="x", ylabel="y", title="mine")
        ax.plot([-1, 1], [-1, 1])
        before = fonts(figure)
    for _ in range(2):
        plot.loop(RESULT, height=HEIGHT, ax=ax)
    ax.set_xlim(-3, 3)
    assert fonts(figure) <= before
    assert (ax.get_title(), len(ax.child_axes)) == ("mine", 1)


def test_four_panels_are_lettered_symmetric_and_written(tmp_path):
    panels = []
    for key, section in rbsdem.peer.paper_sections().items():
        points = rbsdem.peer.shipped_reversals(key)
        half = (0.5 * points.displacement, points.force)
        panels.append(plot.Subplot(section.specimen, half, points, section.length, True))
    before = dict(mpl.rcParams)
    grid = plot.four_panels(panels)
    figure = grid[0].figure
    for letter, ax, panel in zip("abcd", grid, panels, strict=True):
        assert ax.texts[0].get_text() == f"({letter}) {panel.title}"
        for low, high in (ax.get_xlim(), ax.get_ylim()):
            assert low == -high
        furthest = 1e3 * np.abs(panel.test.displacement).max()
        assert furthest < ax.get_xlim()[1] < 1.2 * furthest
        (drift,) = ax.child_axes
        assert drift.get_xlim()[1] == pytest.approx(0.1 * ax.get_xlim()[1] / panel.height)
    assert len(figure.legends) == 1
    files = plot.save(figure, tmp_path / "figure", pdf=True)
    assert [file.name for file in files] == ["figure.png", "figure.pdf"]
    assert [file.read_bytes()[:4] for file in files] == [b"\x89PNG", b"%PDF"]
    assert dict(mpl.rcParams) == before


def test_records_print_as_one_line_and_write_what_they_hold(figures, tmp_path):
    """A line of numbers, no arrays; a table as text is that of rich; the csv is the DataFrame."""
    assert str(SECTION) == (
        "rectangle 400 x 400 mm, f'c 40 MPa, 8 bars of 20 mm (1.57 %, 450 MPa), "
        "ties 10 mm at 80 mm, 400 MPa, cover 20 mm"
    )
    assert "8 bars of 25 mm" in str(EIGHT_BARS)
    tables = [record for _, given, _ in figures.values() for record in given[:1]]
    tables = [record for record in tables if isinstance(record, Tabular)] + [BENT.half_cycles()]
    assert len(tables) > 10
    for record in tables:
        assert "\n" not in repr(record)
        assert "array" not in repr(record)
        assert str(plot.table(record)) == printed(record).rstrip("\n")
        record.to_csv(tmp_path / "table.csv")
        frame, read = record.to_pandas(), pd.read_csv(tmp_path / "table.csv")
        assert len(read) == len(frame) > 0
        for name in frame.select_dtypes("number"):
            assert np.allclose(read[name], frame[name].replace(np.inf, np.nan), 1e-5, 0, True)


def test_drawing_of_a_section():
    assert len(plot.section(PAPER.section).patches) == 1 + 2 + 4 + 12  # concrete, hoop, legs, bars
    texts = plot.moment_curvature(
        rbsdem.section.diagram(PAPER.section, PAPER.axial_load)
    ).get_legend()
    labels = [text.get_text() for text in texts.get_texts()]
    assert labels == ["Core confined", "Cracking", "Yielding", "Peak", "Ultimate"]


def test_what_is_written_and_marked(figures):
    """Scores, names in legends, lines of springs, envelopes and measured tests, demands."""
    (found,), (fit,), (compared,) = (
        figures[name][1] for name in ("comparison", "calibration", "code_comparison")
    )
    assert f"{found.nrmse:.3f}" in plot.comparison(found).texts[0].get_text()
    axes = plot.calibration(fit)
    assert f"(b) after: NRMSE {fit.nrmse:.3f}" in [t.get_text() for ax in axes for t in ax.texts]
    assert axes[0].get_ylim() == axes[1].get_ylim()
    labels = [text.get_text() for text in plot.code_comparison(compared).get_legend().get_texts()]
    assert labels[:3] == ["model", "ASCE 41", "EC 8-3"]
    spring = shear.fit_shear_spring(PAPER.section, 1.6, PAPER.axial_load, 0.022)
    ax = plot.shear_diagram(*figures["shear_diagram"][1], spring=spring)
    lines = {line.get_label(): line.get_xydata() for line in ax.get_lines()}
    assert lines["Spring"][1] == pytest.approx(lines["Knee"][0])
    assert lines["Knee"][0, 1] == pytest.approx(spring.knee.force / 1e3)
    (envelope,) = figures["envelope"][1]
    corner = plot.envelope(envelope, method="asce_41").get_lines()[1].get_xydata()[1]
    assert corner == pytest.approx([20.0, 200.0])
    (band,) = figures["band"][1]
    ax = plot.band(band, test=band)
    assert (len(ax.lines), len(ax.collections)) == (3, 1)
    springs = rbsdem.section.springs(PAPER.section, 1.6, PAPER.axial_load)
    assert len(plot.section_springs(springs)) == 2
    diagram = rbsdem.section.interaction(SECTION, "ec2")
    nominal, design, demand = plot.interaction(diagram, demand=[(1e6, -2e5)]).get_lines()[:3]
    assert nominal.get_ydata()[-1] == pytest.approx(1e-3 * diagram.axial_load[-1])
    assert design.get_xdata().max() == pytest.approx(1e-3 * diagram.design_moment.max())
    assert demand.get_xydata()[0] == pytest.approx([200.0, 1000.0])


def test_state_of_the_section():
    """Strains of the row, and bars by their state: some are beyond buckling."""
    row = int(np.argmax(BENT.displacement))
    section, strains = plot.section_state(BENT, float(BENT.time[row]))
    value = BENT.strains(1).value[row]
    bars = BENT.strains(1).part == "bar"
    assert strains.get_lines()[1].get_xdata() == pytest.approx(100 * value[bars])
    faces = [patch.get_facecolor()[0] for patch in section.patches if isinstance(patch, Circle)]
    buckled = rbsdem.section.criteria.buckling_strain(SECTION, LAYERED)
    assert (len(faces), faces.count(0.0)) == (8, int((value[bars] > buckled).sum()))
    assert 0 < faces.count(0.0) < 8


def test_energies_that_stay_zero_are_left_out():
    texts = [text.get_text() for text in plot.energy(shaken()).get_legend().get_texts()]
    assert texts == ["input", "kinetic", "springs", "axial load and weight"]


def test_profile_is_that_of_the_bodies():
    """The top has its drift; the moment falls in a straight line where nothing acts in between."""
    result = rbsdem.cyclic(shaken().column, displacement=[0.0, 0.01])
    drift, sheared, moment = plot.profile(result)
    at = drift.get_lines()[0].get_xydata()[-1]
    assert at == pytest.approx([100 * 0.01 / 1.6, 1.6])
    assert sheared.get_lines()[0].get_xdata() == pytest.approx(1e-3 * result.force[-1], rel=0.02)
    found = moment.get_lines()[0].get_xdata()
    assert found[[0, -1]] == pytest.approx([1e-3 * result.base_moment[-1], 0.0])


def test_history_of_a_path_and_of_forces():
    assert plot.history(RESULT).get_xlabel() == "Point of the path"
    ax = plot.history(shaken(), "base_shear")
    assert ax.get_ylabel() == "Base shear (kN)"
    assert ax.get_lines()[0].get_ydata() == pytest.approx(1e-3 * shaken().base_shear)
    # Shaken at its foot a column has no force at the top.
    moved = rbsdem.time_history(
        shaken().column, 0.01 * np.arange(20), ground_acceleration=np.ones(20), method="rk4"
    )
    assert plot.loop(moved).get_ylabel() == "Base shear (kN)"


def test_records_as_tables():
    """In mm, kN and per cent, with the words of the record."""
    values = codes.code_values(SECTION, 1.6, 1.2e6)
    states, found = BENT.limit_states(), rbsdem.compare(RESULT, TEST)
    for record, words in (
        (values, ["yield.shear", "no", f"{1e-3 * values['yield.shear']:.3g}"]),
        (codes.compare(values, BENT), ["strength_loss", "ASCE 41"]),
        (states, ["first_yield", "Goodnight", f"{1e3 * states['first_yield'].displacement:.3g}"]),
        (found, ["Test peak force", f"{1e-3 * found.test_cycles.peak_force[0]:.3g}"]),
        (RESULT, ["Displacement"]),
    ):
        shown = printed(record)
        for word in words:
            assert word in shown
    assert list(states.to_pandas()["name"]) == states.names()
    assert list(values.to_pandas()["name"]) == values.names()


def test_shape_and_moments_of_a_frame(figures):
    """Hinges by their state; rigid members stay straight; moments are those of the springs."""
    (pushed,) = figures["pushover"][1]
    shares = {line.get_label(): line for line in plot.frame(pushed).get_lines()}
    yielded = {(one.member, one.end) for one in pushed.events}
    assert len(shares["yielded"].get_xdata()) == len(yielded)
    assert len(plot.frame(pushed, row=0).get_legend().get_texts()) == 1
    labels = [text.get_text() for text in plot.pushover(pushed).get_legend().get_texts()]
    first = pushed.events[0]
    assert labels[0].startswith(f"{first.member}, {first.end}, yields, then")
    (beam,) = [i for i, name in enumerate(pushed.frame.parts.members) if name == "B-1-1"]
    member = pushed.frame.geometry["B-1-1"]
    along = frames._forces(pushed, beam, member, "moment", -1)
    axes = plot.member_forces(pushed, "moment")
    numbers = {text.get_text() for text in axes.texts}
    assert {f"{abs(1e-3 * along[at]):.0f}" for at in (0, 20)} <= numbers
    assert along[[0, 10, 20]] == pytest.approx(-pushed.member("B-1-1").force[-1])
    rigid = rbsdem.FrameMember(
        30e9, 0.16, 2.1e-3, flexure=rbsdem.springs.Bilinear(5e7, 4e-3, 5e5), interior="rigid"
    )
    bent = rbsdem.Frame.grid([3.0], [6.0], columns=rigid, beams=rigid, base="pinned")
    swayed = rbsdem.pushover(bent, drift=0.03, points=3)
    for member in bent.geometry.values():
        points = frames.deformed(swayed, member, -1, 1.0, frames.spring_rotations(swayed, -1))
        straight = points[0] + np.linspace(0, 1, len(points))[:, None] * (points[-1] - points[0])
        assert points == pytest.approx(straight, abs=1e-9)
    with pytest.raises(rbsdem.InputError, match="row = 99"):
        plot.frame(swayed, row=99)


def test_a_table_without_room_breaks_texts_and_no_numbers():
    """Numbers without their last digits are others, and texts are whole."""
    pandas = pytest.importorskip("pandas")
    names = [f"quantity_{i}_N" for i in range(18)]
    numbers = {name: [1.2345678e-9, -4.3216e5] for name in names}
    frame = pandas.DataFrame({"method": ["a" * 30, "b"], **numbers, "reason": ["c" * 58, "d"]})
    lines = str(rbsdem.plot.table(frame)).splitlines()
    assert sum(line.count("1.23e-12") for line in lines) == len(names)
    assert sum(line.count("-432") for line in lines) == len(names)
    assert "…" not in "".join(lines)
    assert sum(line.count("c") for line in lines) == 58
