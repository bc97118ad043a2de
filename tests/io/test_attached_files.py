"""What a robot holds, in world files: read, written, shown, and what is wrong with its line."""

import re

import numpy as np
import pytest

import ikde
from ikde.errors import FileError, InputError
from ikde.io.scene_writers import FORMATS
from ikde.io.world_file import read_world
from ikde.io.world_fit import check_fit
from ikde.report.numbers import Units
from ikde.report.world import describe_world, format_world, world_json
from tests.attached import OWN, hold
from tests.solids import random_world
from tests.world_files import assert_same

TEXT = """units: {length: mm, angle: deg}
frames:
  grip: {frame: tip, position: [0, 0, 10]}
obstacles:
  wall: {box: [100, 2000, 2000], position: [2000, 0, 0]}
attached:
  cup:
    frame: grip
    cylinder: {radius: 20, height: 60}
    position: [0, 0, 50]
    rpy: [0, 0, 90]
    may_touch: [hand, wall]
    protrusion: 8
    margin: 5
    picked_from: {position: [1000, 0, 0]}
"""


@pytest.fixture
def write(tmp_path):
    def call(text):
        (tmp_path / "world.yaml").write_text(text, encoding="utf-8")
        return tmp_path / "world.yaml"

    return call


def test_a_file_says_what_is_held(write):
    world = ikde.load_world(write(TEXT))
    (thing,) = world.attached
    assert (thing.name, thing.frame, thing.may_touch) == ("cup", "tip", ("hand", "wall"))
    assert np.allclose(thing.T_frame_object[:, 3], [0.0, 0.0, 0.06])
    assert 0.0 < thing.protrusion_m <= 0.008
    assert thing.obstacle.margin_m == 0.005
    assert thing.obstacle.T_world_obstacle[:, 3].tolist() == [1.0, 0.0, 0.0]
    assert OWN.in_world(world).components[-1] == "cup"
    given = ikde.load_world(write(TEXT.replace("protrusion: 8", "spheres: [[0, 0, 10, 30]]")))
    assert given.attached[0].spheres.tolist() == [[0.0, 0.0, 0.01, 0.03]]
    assert given.attached[0].protrusion_m is None


def test_worlds_with_held_objects_come_back_to_the_bit(tmp_path, rng):
    world = hold(random_world(rng, 3, ignore=("post",)), margin_m=0.01, may_touch=("o0",))
    picked = world.detach("ball", np.eye(4)).attach("ball", "tip", T_frame_object=np.eye(4), protrusion_m=0.003)
    for k, one in enumerate((world, picked, ikde.load_world({"obstacles": {}}))):
        ikde.write_world(one, tmp_path / f"{k}.yaml")
        again = ikde.load_world(tmp_path / f"{k}.yaml")
        assert_same(again, one)
        assert again == one
        assert again.digest == one.digest


def test_it_is_shown_with_how_far_its_spheres_stand_out(write):
    world = ikde.load_world(write(TEXT))
    assert describe_world(world).endswith("; attached: cup to tip")
    text = format_world(world, Units("mm"))
    assert re.search(r"cup: attached to tip; \d+ spheres that stand out by \d\.\d+ mm at most; margin 5 mm; may", text)
    (entry,) = world_json(world)["attached"]
    assert (entry["name"], entry["frame"], entry["protrusion_m"]) == ("cup", "tip", world.attached[0].protrusion_m)
    for word in ("moveit", "curobo"):
        assert "cup: left out, it is attached to tip" in FORMATS[word](world, "a", ()).lost


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("cylinder: {radius: 20, height: 60}", "half_space: {}", 7, "a half-space has no end"),
        ("cylinder: {radius: 20, height: 60}", "columns: {heights: [[1]], cell: 1}", 9, "a height field cannot be"),
        ("    frame: grip\n", "", 7, "this key is missing"),
        ("protrusion: 8", "protrusion: 0.2", 13, "protrusion: more than 2,000 spheres would be needed"),
        ("protrusion: 8", "protrusion: 0", 13, "expected a length of at least 0.0001 m"),
        ("protrusion: 8", "spheres: [[0, 0, 0, -1]]", 13, "a radius of at least 1e-06 m"),
        ("  cup:", "  wall:", 7, "'wall' is attached to tip, and another object has its name"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(write, old, new, line, message):
    with pytest.raises(FileError, match=rf"world.yaml:{line} → attached\..*{re.escape(message)}"):
        ikde.load_world(write(TEXT.replace(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("frame: grip", "frame: tup", r"world.yaml:8 → attached.cup.frame: three_joints has no frame 'tup'"),
        (
            "[hand, wall]",
            "[hnad]",
            r"world.yaml:12 → attached.cup.may_touch: no component and no obstacle is called 'hn",
        ),
        ("  cup:", "  hand:", r"world.yaml:7 → attached.hand: three_joints has a component of this name"),
    ],
)
def test_what_does_not_fit_a_robot_is_named_with_its_line(write, old, new, message):
    with pytest.raises(InputError, match=message):
        check_fit(read_world(write(TEXT.replace(old, new))), OWN)
