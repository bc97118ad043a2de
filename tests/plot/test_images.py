"""Figures as pictures."""

import re
from xml.etree import ElementTree

import pytest

from ikde.plot.charts import Bars, Line, plot_bars, plot_lines
from ikde.plot.images import INK, to_png, to_svg
from ikde.plot.style import Axis


def chart():
    lines = [Line(label="a & b", x=[0, 1, 2], y=[1, 4, 9]), Line(label="c", x=[0, 1], y=[2, 2])]
    return plot_lines(lines, x=Axis(label="time", unit="s"), y=Axis(label="y"))


def hatched():
    return plot_bars(["x"], [Bars(label=name, values=[1.0]) for name in "ab"], y=Axis(label="y"))


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
