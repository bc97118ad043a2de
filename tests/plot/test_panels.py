"""Several charts share their x and one legend."""

import pytest

from ikde.plot.charts import Line
from ikde.plot.panels import Panel, plot_panels
from ikde.plot.style import Axis

TIME = Axis(label="t", unit="s")


def panel(label, **changes):
    return Panel(y=Axis(label=label), lines=[Line(label=label, x=[0, 1], y=[1, 2])], **changes)


@pytest.fixture
def figure():
    same = Panel(y=Axis(label="again"), lines=[Line(label="a", x=[0, 1], y=[2, 1])])
    return plot_panels([panel("a", bounds=[0.0, 3.0]), panel("b", bounds=[1.0], marks=[0.5]), same], x=TIME, columns=2)


def test_only_the_lowest_name_x(figure):
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "t [s]", "t [s]"]


def test_one_legend_names_each_look_once(figure):
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "limit", "b", "collision"]
    first, again = (figure.axes[k].lines[0] for k in (0, 2))
    assert first.get_color() == again.get_color()
    assert first.get_color() != figure.axes[1].lines[0].get_color()


def test_a_title_stands_above_its_chart():
    figure = plot_panels([panel("a", title="elbow"), panel("b")], x=TIME)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["elbow", ""]


@pytest.mark.parametrize(("least", "span"), [(0.0, 1.1), (1.0, 1.1), (5.0, 5.0)])
def test_an_axis_spans_what_it_must(least, span):
    low, high = plot_panels([panel("a", least=least)], x=TIME).axes[0].get_ylim()
    assert high - low == pytest.approx(span)
    assert 0.5 * (low + high) == pytest.approx(1.5)


def test_a_curve_without_a_label_needs_no_legend():
    assert plot_panels([Panel(y=TIME, lines=[Line(label="", x=[0], y=[0])])], x=TIME).legends == []
