"""`--world` and `--margin`: what they mean, and what is refused."""

import pytest

from ikde.cli.options import LengthUnit
from ikde.cli.world_options import place_in_world
from ikde.errors import FileError, InputError
from ikde.model.collision_model import CollisionModel
from tests.three_joints import ROBOT

OWN = CollisionModel.of(ROBOT)


def test_a_world_comes_from_a_file_and_a_margin_needs_one(tmp_path, capsys):
    assert place_in_world(OWN, None, None, LengthUnit.m) is OWN
    with pytest.raises(InputError, match=r"^margin: a margin needs a --world"):
        place_in_world(OWN, None, "1", LengthUnit.m)
    path = tmp_path / "posts.json"
    path.write_text('{"cuboid": {"wall": {"dims": [0.1, 2, 2], "pose": [2, 0, 0, 1, 0, 0, 0]}}}', encoding="utf-8")
    model = place_in_world(OWN, path, "10,post=0", LengthUnit.mm)
    assert (model.world.names, model.margin_m, model.margins_m) == (("wall",), 0.01, (("post", 0.0),))


def test_what_does_not_fit_the_robot_is_named_with_its_line(tmp_path):
    path = tmp_path / "world.yaml"
    path.write_text(
        "obstacles:\n  a: {box: [1, 1, 1], position: [9, 0, 0]}\n  b:\n    sphere: {radius: 1}\n", encoding="utf-8"
    )
    with pytest.raises(FileError, match=r"world.yaml:3 → obstacles.b: floor is -1200 mm from b in every configuration"):
        place_in_world(OWN, path, None, LengthUnit.m)
