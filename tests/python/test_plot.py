"""Figures: keywords of matplotlib pass through, and nothing of the caller's is changed."""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem import plot

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
plt = pytest.importorskip("matplotlib.pyplot")

COLUMN = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
D = COLUMN.height * rbsdem.protocol([0.005, 0.01], cycles=1, points=20)
RESULT = rbsdem.cyclic(COLUMN, displacement=D)
TEST = (D, RESULT.force)
HEIGHT = COLUMN.height


@pytest.fixture(autouse=True)
def closed():
    """Close the figures of a test."""
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def views():
    """Whatever draws loops; each returns axes, the last line of which is the model's."""
    pytest.importorskip("scipy")
    fit = rbsdem.calibrate(COLUMN, TEST, free=["flexure.k_u"])
    return {
        "loop": lambda **line: plot.loop(RESULT, **line),
        "drift": lambda **line: plot.loop(RESULT, height=HEIGHT, **line),
        "over": lambda **line: plot.loops_over_test(RESULT, TEST, height=HEIGHT, **line),
        "comparison": lambda **line: plot.comparison(rbsdem.compare(RESULT, TEST), **line),
        "calibration": lambda **line: plot.calibration(fit, **line)[1],
    }


def ax_texts(drift):
    """What an axis of drifts shows: the upper of its axes."""
    return [*drift.get_xticklabels(), drift.xaxis.label]


def fonts(figure):
    """Family and size of every text."""
    figure.canvas.draw()
    found = set()
    for own in figure.axes:
        for ax in (own, *own.child_axes):
            texts = [*ax.get_xticklabels(), *ax.get_yticklabels(), ax.xaxis.label, ax.yaxis.label]
            texts += [ax.title, *ax.texts]
            texts += ax.get_legend().get_texts() if ax.get_legend() else []
            found |= {
                (text.get_fontfamily()[0], text.get_fontsize())
                for text in texts
                if text.get_text() and text.get_visible() and (ax is own or text in ax_texts(ax))
            }
    return found


@pytest.mark.parametrize("name", ["loop", "drift", "over", "comparison", "calibration"])
@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ({"lw": 1}, {"linewidth": 1, "color": "black"}),
        ({"linewidth": 2.5}, {"linewidth": 2.5}),
        ({"c": "red", "ls": ":"}, {"color": "red", "linestyle": ":"}),
        ({"color": "blue", "marker": "o", "ms": 3}, {"color": "blue", "markersize": 3}),
        ({"alpha": 0.5, "label": "mine"}, {"alpha": 0.5, "label": "mine"}),
    ],
)
def test_keywords_of_the_line_and_their_short_names(views, name, line, expected):
    ax = views[name](**line)
    wanted = line.get("label") or ("Model" if name in ("over", "comparison", "calibration") else "")
    drawn = [one for one in ax.get_lines() if one.get_gid() != "zero"]
    drawn = [one for one in drawn if one.get_label() == wanted or not wanted][-1]
    for key, value in expected.items():
        assert getattr(drawn, f"get_{key}")() == value


def test_no_figure_changes_the_style_of_the_session(views):
    before = dict(matplotlib.rcParams)
    for draw in views.values():
        draw()
        draw(lw=1)
    assert {key for key in before if before[key] != matplotlib.rcParams[key]} == set()


@pytest.mark.parametrize("name", ["loop", "drift", "over", "comparison", "calibration"])
def test_new_figure_has_one_style(views, name):
    """That of the house, on the drift axis and after a second loop with a legend, too."""
    ax = views[name]()
    assert {family for family, _ in fonts(ax.figure)} == {"STIXGeneral"}
    plot.loops_over_test(RESULT, TEST, height=HEIGHT, title="again", ax=ax)
    ax.set_xlim(-3, 3)  # new ticks
    assert {family for family, _ in fonts(ax.figure)} == {"STIXGeneral"}
    assert max(size for _, size in fonts(ax.figure)) == 9.0


@pytest.mark.parametrize("family", [None, "serif", "monospace"])
def test_axes_of_the_caller_keep_their_letters(family):
    """The axis of drifts has those of the axis below, whether from the session or from a block."""
    style = {} if family is None else {"font.family": family, "font.size": 13.0}
    with matplotlib.rc_context(style):
        figure, (left, right) = plt.subplots(1, 2)
        for ax in (left, right):
            ax.plot([-1, 1], [-1, 1])
            ax.set(xlabel="x", ylabel="y", title="mine")
        before = fonts(figure)
    plot.loop(RESULT, height=HEIGHT, ax=left)
    plot.loop(RESULT, ax=right)
    assert fonts(figure) <= before
    left.set_xlim(-3, 3)
    assert fonts(figure) <= before
    assert left.get_title() == "mine"
    (drift,) = left.child_axes
    assert drift.xaxis.label.get_fontfamily() == left.xaxis.label.get_fontfamily()


def test_trade_passes_keywords_on():
    found = rbsdem.compare_methods(COLUMN, displacement=D[:40], budget=2.0)
    ax = plot.methods(found, lw=2.5)
    assert {one.get_linewidth() for one in ax.get_lines() if one.get_marker() == "o"} == {2.5}
    figure, own = plt.subplots()
    before = {family for family, _ in fonts(figure)}
    plot.methods(found, ax=own)
    assert {family for family, _ in fonts(figure)} == before
    assert np.isfinite(own.get_ylim()).all()


# ---- over time and over the height ---------------------------------------------------------------


def shaken(n=3):
    """A column of n bodies that is shaken at its top."""
    time = np.arange(0.0, 0.5, 0.01)
    column = rbsdem.Column(
        1.6, 600.0, COLUMN.shear, COLUMN.flexure, n=n, kinematics="pdelta", axial_load=1e5
    )
    return rbsdem.time_history(column, time, force=1e4 * np.sin(20 * time), method="rk4")


def test_history_has_the_units_of_its_label():
    result = shaken()
    for over, factor, unit in (("drift", 100, "%"), ("base_shear", 1e-3, "kN")):
        ax = plot.history(result, over)
        assert ax.get_lines()[0].get_ydata() == pytest.approx(factor * getattr(result, over))
        assert f"({unit})" in ax.get_ylabel()
        assert ax.get_xlabel() == "Time (s)"
    assert plot.history(RESULT).get_xlabel() == "Point of the path"
    with pytest.raises(rbsdem.InputError, match="over = 'speed'"):
        plot.history(result, "speed")


def test_energies_that_stay_zero_are_left_out():
    ax = plot.energy(shaken())
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts == ["input", "kinetic", "springs", "axial load and weight"]
    assert ax.get_lines()[0].get_ydata()[-1] == pytest.approx(1e-3 * shaken().energy["input"][-1])


def test_profile_is_that_of_the_bodies():
    """The top has its drift; the moment falls in a straight line where nothing acts in between."""
    result = rbsdem.cyclic(shaken().column, displacement=[0.0, 0.01])
    drift, shear, moment = plot.profile(result)
    heights, drifts = drift.get_lines()[0].get_ydata(), drift.get_lines()[0].get_xdata()
    assert (heights[-1], drifts[-1]) == (pytest.approx(1.6), pytest.approx(100 * 0.01 / 1.6))
    assert shear.get_lines()[0].get_xdata() == pytest.approx(1e-3 * result.force[-1], rel=0.02)
    at = moment.get_lines()[0]
    assert at.get_xdata()[0] == pytest.approx(1e-3 * result.base_moment[-1])
    assert at.get_xdata()[-1] == 0
    with pytest.raises(rbsdem.InputError, match="outside"):
        plot.profile(result, [7.0])
    with pytest.raises(rbsdem.InputError, match="one to"):
        plot.profile(result, [0.0] * 9)


def test_views_of_a_response_keep_the_axes_of_the_caller():
    axes = plt.subplots(1, 3)[1]
    result = shaken()
    assert plot.profile(result, axes=axes) == list(axes)
    assert plot.history(result, ax=axes[0], color="red").get_lines()[-1].get_color() != "black"
    assert plot.energy(result, ax=axes[1]) is axes[1]
    with pytest.raises(rbsdem.InputError, match="three"):
        plot.profile(result, axes=axes[:2])
