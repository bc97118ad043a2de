"""A world as text and as plain data."""

import json

import pytest

from ikde.io.world_file import read_world
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world
from ikde.report.numbers import Units
from ikde.report.world import MAX_ROWS, describe_world, format_world, world_json
from tests.world_files import write_good


@pytest.fixture
def found(tmp_path):
    return read_world(write_good(tmp_path))


@pytest.mark.parametrize("width", [60, 100])
def test_every_solid_is_in_the_table_and_it_fits(found, width):
    text = format_world(found.world, Units("mm"), found.notes, width=width)
    assert max(map(len, text.splitlines())) <= width
    for words in ("100, 200, 300", "r 30, h 120", "800 x 600 x 30", "half-space", "4 corners", "flange", "margin 5 mm"):
        assert words in text or width == 60, words
    assert "can: group loose (off)" in text
    assert "top: ignores base, wheels" in text
    assert f"digest {found.world.digest[:16]}" in text


def test_frames_are_a_column_only_if_they_differ():
    ball = make_solid("sphere", [0.1])
    assert "frame" not in format_world(make_world([make_obstacle("a", [ball])]), Units("m"))
    assert "frame" in format_world(make_world([make_obstacle("a", [ball], frame="base")]), Units("m"))


def test_a_table_has_an_end():
    ball = make_solid("sphere", [0.1])
    text = format_world(make_world([make_obstacle("a", [ball] * (MAX_ROWS + 5), margin_m=1e-3)]), Units("m"))
    assert "and 5 more solids; --json has all" in text


def test_names_are_no_markup():
    world = make_world([make_obstacle("[red]a", [make_solid("sphere", [0.1])])])
    assert "[red]a" in format_world(world, Units("m"))


def test_a_world_in_a_line(found):
    assert describe_world(World()) == "no obstacle"
    text = describe_world(found.world)
    assert text.startswith("11 obstacles of 14 solids (5 boxes, 2 spheres, ")
    assert text.endswith("; off: loose")


def test_plain_data(found):
    data = json.loads(json.dumps(world_json(found.world), allow_nan=False))
    assert data["groups"] == {"loose": False}
    assert [entry["name"] for entry in data["obstacles"]] == list(found.world.names)
    scan = data["obstacles"][8]
    assert (scan["on"], scan["solids"][0]["points"], scan["solids"][0]["size_m"]) == (False, 1201, {"radius": 0.003})
    assert data["digest"] == found.world.digest
