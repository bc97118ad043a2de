"""Charts show the numbers that they are given."""

import numpy as np
import pytest

from ikde.plot.charts import (
    MAX_POINTS,
    Bars,
    Estimate,
    Event,
    Line,
    Panel,
    Sample,
    plot_bars,
    plot_cdf,
    plot_forest,
    plot_histogram,
    plot_lines,
    plot_panels,
)
from ikde.plot.images import INK, to_svg
from ikde.plot.style import COLORS, Axis

TIME, MM = Axis(label="time", unit="s"), Axis(label="clearance", unit="mm")
SECONDS = Axis(label="t", unit="s")


def labels(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def curves(figure):
    return {line.get_label(): line for line in figure.axes[0].lines}


def test_lines_carry_units_level_and_events():
    events = [Event(label="detected", x=1.5, line="b"), Event(label="contact", x=2.0)]
    lines = [Line(label=name, x=[0, 3], y=[k, -k]) for k, name in enumerate("ab")]
    figure = plot_lines(lines, x=TIME, y=MM, events=events, level=(0.0, "safe distance"))
    assert labels(figure) == ["a", "b", "safe distance", "detected", "contact"]
    drawn = curves(figure)
    assert drawn["detected"].get_xdata() == [1.5]
    assert drawn["detected"].get_color() == drawn["b"].get_color() == COLORS[1]
    assert drawn["contact"].get_color() == INK
    assert drawn["a"].get_linestyle() != drawn["b"].get_linestyle()
    assert figure.axes[0].get_xlabel() == "time [s]"
    assert figure.axes[0].get_ylabel() == "clearance [mm]"


def test_bars_carry_intervals_and_published_values():
    bars = [
        Bars(label="a", values=[70, 80], lower=[65, 75], upper=[80, 82], published=[75, float("nan")]),
        Bars(label="b", values=[60, 61], published=[60, 60]),
    ]
    figure = plot_bars(["one", "two"], bars, x=Axis(label="group"), y=Axis(label="rate", unit="%"))
    axes = figure.axes[0]
    assert [patch.get_height() for patch in axes.patches] == [70, 80, 60, 61]
    assert sorted(labels(figure)) == ["a", "b", "published"]
    whiskers = axes.collections[0].get_segments()
    np.testing.assert_allclose([segment[:, 1] for segment in whiskers], [[65, 80], [75, 82]])
    assert [text.get_text() for text in axes.get_xticklabels()] == ["one", "two"]
    assert axes.get_xlabel() == "group"


def test_a_forest_marks_intervals_that_miss_the_published_value():
    estimates = [Estimate(label=str(v), value=v, lower=v - 2, upper=v + 2) for v in (70.0, 74.0, 76.0)]
    figure = plot_forest(estimates, x=Axis(label="rate", unit="%"), published=75.0)
    assert sorted(labels(figure)) == ["interval holds it", "interval misses it", "published"]
    axes = figure.axes[0]
    points = {tuple(line.get_xdata()): line.get_fillstyle() for line in axes.lines if line.get_marker() == "o"}
    assert points == {(74.0, 76.0): "full", (70.0,): "none"}
    assert [text.get_text() for text in axes.get_yticklabels()] == ["70.0", "74.0", "76.0"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]  # the first on top


def test_a_forest_without_published_value_has_nothing_to_miss():
    assert plot_forest([Estimate(label="a", value=1, lower=0, upper=2)], x=MM).legends == []


def test_a_cdf_ends_at_the_share_that_has_a_value():
    figure = plot_cdf([Sample(label="a", values=[3.0, 1.0, np.nan, 2.0], total=4)], x=TIME, y="solves")
    line = curves(figure)["a"]
    assert list(line.get_xdata()) == [1.0, 1.0, 2.0, 3.0, 3.0]
    assert list(line.get_ydata()) == [0.0, 25.0, 50.0, 75.0, 75.0]
    assert figure.axes[0].get_ylabel() == "solves done [%]"


def test_curves_of_a_cdf_begin_at_zero_and_end_together():
    samples = [Sample(label="a", values=[2.0], total=2), Sample(label="b", values=[1.0, 7.0])]
    lines = curves(plot_cdf(samples, x=TIME))
    assert list(zip(*lines["a"].get_data(), strict=True)) == [(2.0, 0.0), (2.0, 50.0), (7.0, 50.0)]
    assert lines["b"].get_xdata()[-1] == 7.0


def test_a_cdf_of_many_values_has_few_points():
    line = curves(plot_cdf([Sample(label="a", values=np.arange(100_000))], x=TIME))["a"]
    assert len(line.get_xdata()) == MAX_POINTS + 2
    assert line.get_xdata()[-1] == 99_999
    assert line.get_ydata()[-1] == 100.0


@pytest.mark.parametrize("log", [False, True])
def test_a_histogram_counts_every_value_once(log):
    values = np.append(np.random.default_rng(0).uniform(1e-6, 1.0, 999), 0.0)
    samples = [Sample(label="a", values=values), Sample(label="b", values=values + 1.0)]
    figure = plot_histogram(samples, x=Axis(label="error", unit="m", log=log), bins=30)
    for stairs in figure.axes[0].patches:
        shares, edges, _ = stairs.get_data()
        assert len(edges) == 31
        assert sum(shares) == pytest.approx(100.0)


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("values", [[], [float("nan")], [2.0, 2.0], [0.0]])
def test_little_to_show_is_shown(values, log):
    axis = Axis(label="x", log=log)
    for plot in (plot_cdf, plot_histogram):
        figure = plot([Sample(label="a", values=values)], x=axis)
        assert ">a</text>" in to_svg(figure)


@pytest.mark.parametrize("log", [False, True])
def test_a_curve_of_nothing_but_nan_is_shown(log):
    line = Line(label="a", x=[1.0, 2.0], y=[np.nan, np.nan])
    assert ">clearance [mm]</text>" in to_svg(plot_lines([line], x=TIME, y=Axis(label="clearance", unit="mm", log=log)))


def test_bars_and_estimates_may_have_no_value():
    nan = [float("nan")]
    bars = [Bars(label="a", values=nan, lower=nan, upper=nan, published=nan)]
    assert ">one</text>" in to_svg(plot_bars(["one"], bars, x=MM, y=MM))
    assert ">rate</text>" in to_svg(plot_forest([], x=Axis(label="rate")))
    assert ">one</text>" in to_svg(plot_forest([Estimate(label="one", value=nan[0], lower=0, upper=1)], x=MM))


def test_a_name_that_begins_with_an_underscore_is_in_the_legend():
    figure = plot_lines([Line(label="_fast", x=[0, 1], y=[0, 1])], x=TIME, y=MM)
    assert labels(figure) == [" _fast"]


def panel(label, **changes):
    return Panel(y=Axis(label=label), lines=[Line(label=label, x=[0, 1], y=[1, 2])], **changes)


@pytest.fixture
def panels():
    same = Panel(y=Axis(label="again"), lines=[Line(label="a", x=[0, 1], y=[2, 1])])
    return plot_panels(
        [panel("a", bounds=[0.0, 3.0]), panel("b", bounds=[1.0], marks=[0.5]), same], x=SECONDS, columns=2
    )


def test_only_the_lowest_name_x(panels):
    assert [axes.get_xlabel() for axes in panels.axes] == ["", "t [s]", "t [s]"]


def test_one_legend_names_each_look_once(panels):
    assert [text.get_text() for text in panels.legends[0].get_texts()] == ["a", "limit", "b", "collision"]
    first, again = (panels.axes[k].lines[0] for k in (0, 2))
    assert first.get_color() == again.get_color()
    assert first.get_color() != panels.axes[1].lines[0].get_color()


def test_a_title_stands_above_its_chart():
    figure = plot_panels([panel("a", title="elbow"), panel("b")], x=SECONDS)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["elbow", ""]


@pytest.mark.parametrize(("min_span", "span"), [(0.0, 1.1), (1.0, 1.1), (5.0, 5.0)])
def test_an_axis_spans_what_it_must(min_span, span):
    low, high = plot_panels([panel("a", min_span=min_span)], x=SECONDS).axes[0].get_ylim()
    assert high - low == pytest.approx(span)
    assert 0.5 * (low + high) == pytest.approx(1.5)


def test_a_curve_without_a_label_needs_no_legend():
    assert plot_panels([Panel(y=SECONDS, lines=[Line(label="", x=[0], y=[0])])], x=SECONDS).legends == []


def test_a_spot_is_a_ring_with_its_name():
    panel = Panel(y=MM, lines=[Line(label="a", x=[0, 1], y=[1, 2])], spot=(0.5, 1.5), spot_label="least")
    figure = plot_panels([panel], x=SECONDS)
    assert labels(figure) == ["a", "least"]
    assert [value.tolist() for value in map(np.asarray, curves(figure)["least"].get_data())] == [[0.5], [1.5]]
    assert labels(plot_panels([Panel(y=MM, lines=panel.lines)], x=SECONDS)) == ["a"]
