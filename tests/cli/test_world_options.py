"""`--world` and `--margin`: what they mean, and what is refused."""

import pytest

from ikde.cli.options import LengthUnit
from ikde.cli.world_options import place_in_world, read_margins
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from tests.three_joints import ROBOT

OWN = CollisionModel.of(ROBOT)


def test_margins_are_one_for_all_and_those_of_components():
    assert read_margins("10,hand=0", LengthUnit.mm) == (0.01, {"hand": 0.0})
    assert read_margins("hand=0.5", LengthUnit.m) == (0.0, {"hand": 0.5})
    assert read_margins(None, LengthUnit.m) == (0.0, {})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ten", r"^margin: expected a distance or component=distance, got 'ten'$"),
        ("hand=", r"^margin: expected a distance or component=distance, got 'hand='$"),
        ("1,2", r"^margin: this margin is given twice$"),
    ],
)
def test_what_is_no_margin_is_refused(text, message):
    with pytest.raises(InputError, match=message):
        read_margins(text, LengthUnit.m)


def test_a_world_comes_from_a_file_and_a_margin_needs_one(tmp_path, capsys):
    assert place_in_world(OWN, None, None, LengthUnit.m) is OWN
    with pytest.raises(InputError, match=r"^margin: a margin needs a --world"):
        place_in_world(OWN, None, "1", LengthUnit.m)
    path = tmp_path / "posts.json"
    path.write_text('{"cuboid": {"wall": {"dims": [0.1, 2, 2], "pose": [2, 0, 0, 1, 0, 0, 0]}}}', encoding="utf-8")
    model = place_in_world(OWN, path, "10,post=0", LengthUnit.mm)
    assert (model.world.names, model.margin_m, model.margins_m) == (("wall",), 0.01, (("post", 0.0),))
