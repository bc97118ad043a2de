"""Figures as pictures."""

import re
import warnings
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from ikde.errors import printable
from ikde.model.collision_model import CollisionModel
from ikde.plot.charts import Bars, Line, Panel, plot_bars, plot_lines, plot_panels
from ikde.plot.images import INK, to_png, to_svg
from ikde.plot.pose import plot_pose, save_figure
from ikde.plot.style import Axis, drawing_space
from ikde.scene.drawn_pose import draw_pose
from tests.hostile_names import EVERYTHING


def chart():
    lines = [Line(label="a & b", x=[0, 1, 2], y=[1, 4, 9]), Line(label="c", x=[0, 1], y=[2, 2])]
    return plot_lines(lines, x=Axis(label="time", unit="s"), y=Axis(label="y"))


def hatched():
    return plot_bars(["x"], [Bars(label=name, values=[1.0]) for name in "ab"], x=Axis(label="group"), y=Axis(label="y"))


@pytest.mark.parametrize("make", [chart, hatched])
def test_a_drawing_is_whole_and_the_same_every_time(make):
    svg = to_svg(make())
    ElementTree.fromstring(svg)
    assert to_svg(make()) == svg


def test_a_drawing_follows_its_page():
    svg = to_svg(chart())
    assert "currentColor" in svg
    assert INK not in svg
    assert "#000000" not in svg
    assert "#ffffff" not in svg
    assert re.findall(r"DejaVu|<style|<metadata|xlink", svg) == []
    assert ">time [s]</text>" in svg
    assert ">a &amp; b</text>" in svg


@pytest.mark.parametrize("make", [chart, hatched])
def test_only_what_is_referred_to_has_a_name(make):
    svg = to_svg(make())
    names = re.findall(r' id="([^"]*)"', svg)
    assert len(names) == len(set(names))
    assert set(names) == set(re.findall(r'(?:href="#|url\(#)([^")]+)', svg))


def test_a_drawing_scales_with_its_box():
    head = to_svg(chart()).partition(">")[0]
    assert re.search(r'viewBox="0 0 388\.8 \d', head)
    assert "width=" not in head


def test_a_photograph_is_on_white_and_the_same_every_time():
    png = to_png(chart(), dpi=40)
    assert png.startswith(b"\x89PNG")
    assert b"Software" not in png
    assert to_png(chart(), dpi=40) == png


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_name_is_text_in_a_drawing(name):
    svg = to_svg(plot_bars([name], [Bars(label=name, values=[1.0])], x=Axis(label="group"), y=Axis(label=name)))
    texts = [element.text for element in ElementTree.fromstring(svg).iter() if element.tag.endswith("text")]
    assert texts.count(printable(name)) == 3
    assert "<script" not in svg


@pytest.mark.parametrize("name", ["$x$", "<b>", "a\x1bb"])
def test_a_name_is_text_above_a_chart_and_in_space(name):
    lines = [Line(label="a", x=[0, 1], y=[0, 1])]
    panels = plot_panels([Panel(y=Axis(label="y"), lines=lines, title=name)], x=Axis(label="x"))
    with drawing_space() as (space, axes):
        axes.plot([0, 1], [0, 1], [0, 1], label=name)
    for figure in (panels, space):
        texts = [element.text for element in ElementTree.fromstring(to_svg(figure)).iter()]
        assert printable(name) in texts


def test_what_looks_like_a_part_of_a_drawing_is_text():
    name = f'id="a" url(#b) {INK} xlink:href'
    svg = to_svg(plot_lines([Line(label=name, x=[0, 1], y=[0, 1])], x=Axis(label="x"), y=Axis(label="y")))
    assert name in [element.text for element in ElementTree.fromstring(svg).iter()]


def test_a_formula_that_is_none_is_drawn_as_text():
    figure = plot_bars(
        [r"$\frac{$"], [Bars(label=r"$\frac{$", values=[1.0])], x=Axis(label="group"), y=Axis(label=r"$\frac{$")
    )
    assert to_png(figure, dpi=40).startswith(b"\x89PNG")


def test_letters_that_the_type_does_not_have_are_no_news():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        to_png(plot_bars(["手"], [Bars(label="臂", values=[1.0])], x=Axis(label="group"), y=Axis(label="y")), dpi=40)
    assert told == []


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_robot_of_any_name_is_drawn(tmp_path, qiao, kind):
    robot = replace(qiao, name="手臂 $\\frac{ <b>")
    save_figure(plot_pose(draw_pose(CollisionModel.of(robot, "none"), robot.home)), tmp_path / f"a.{kind}")
    assert (tmp_path / f"a.{kind}").stat().st_size > 1000
