"""The house style of charts."""

import pytest

from ikde.plot.style import COLORS, DASHES, HATCHES, HEIGHT_IN, MARKERS, Axis, drawing, format_tick, pick

PLAIN = Axis(label="x")


def luminance(color):
    values = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("paper", ["#fbfaf7", "#15171b"])
def test_the_first_colours_are_seen_on_both_papers(paper):
    assert min(contrast(color, paper) for color in COLORS[:3]) >= 3.0


def test_series_differ_without_colour():
    for looks in (DASHES, MARKERS, HATCHES):
        assert len(set(looks)) == len(looks) == len(COLORS)
    assert pick(COLORS, len(COLORS)) == COLORS[0]


def test_an_axis_says_its_unit():
    assert Axis(label="time", unit="ms").title == "time [ms]"
    assert PLAIN.title == "x"


@pytest.mark.parametrize(
    ("value", "text"), [(0.01, "0.01"), (20, "20"), (5000.0, "5,000"), (1e-6, "1e-06"), (1e7, "1e+07")]
)
def test_ticks_are_plain_numbers(value, text):
    assert format_tick(value) == text


@pytest.mark.parametrize(("last", "expected"), [(20.0, {1.0, 2.0, 5.0, 10.0, 20.0}), (1e4, {1.0, 10.0, 1e3, 1e4})])
def test_a_short_logarithmic_axis_has_more_ticks(last, expected):
    with drawing(Axis(label="x", log=True), PLAIN) as (_, axes):
        axes.plot([1.0, last], [0.0, 1.0])
    assert expected <= set(axes.xaxis.get_major_locator()())
    assert axes.get_xscale() == "log"
    low, high = axes.get_xlim()
    assert low < 1.0 < last < high < 10 * last


def test_an_axis_without_a_logarithm_is_linear():
    with drawing(Axis(label="x", log=True), PLAIN) as (_, axes):
        axes.plot([0.0, -1.0], [0.0, 1.0])
    assert axes.get_xscale() == "linear"


def test_a_count_is_marked_at_whole_numbers():
    with drawing(Axis(label="attempts", whole=True), PLAIN) as (_, axes):
        axes.plot([1.0, 4.0], [0.0, 1.0])
    assert all(tick == round(tick) for tick in axes.xaxis.get_major_locator()())


def test_limits_hold():
    with drawing(PLAIN, Axis(label="rate", unit="%", limits=(0, None))) as (_, axes):
        axes.plot([0.0, 1.0], [5.0, 90.0])
    assert axes.get_ylim()[0] == 0.0
    assert axes.get_ylim()[1] >= 90.0


def test_a_chart_grows_by_the_lines_of_its_legend():
    heights = []
    for labels in ([], ["a", "b"], ["a long label that fills its line " * 2] * 4):
        with drawing(PLAIN, PLAIN) as (figure, axes):
            for label in labels:
                axes.plot([0, 1], [0, 1], label=label)
        heights.append(figure.get_figheight())
    assert heights[0] == heights[1] == HEIGHT_IN
    assert heights[2] > HEIGHT_IN + 0.5
