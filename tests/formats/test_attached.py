"""What a robot holds, as it is typed."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.formats.attached import list_held, pick_up, read_attached
from ikde.formats.entries import HeldEntry
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from tests.attached import place
from tests.three_joints import ROBOT


def test_objects_frames_and_what_they_may_touch():
    assert read_attached("mug=tool") == [("mug", "tool", ())]
    assert read_attached("mug = tool:table+left finger, lid=tool") == [
        ("mug", "tool", ("table", "left finger")),
        ("lid", "tool", ()),
    ]


@pytest.mark.parametrize("text", ["", "mug", "mug=", "=tool", "mug=tool,", "mug=tool:", "mug=tool:table+"])
def test_what_is_no_such_text_is_refused(text):
    with pytest.raises(InputError, match=r"^attach: expected OBJECT=FRAME or OBJECT=FRAME:T\+T, got '"):
        read_attached(text)


def test_files_say_it_by_a_frame_or_with_what_may_be_touched():
    entries = {"mug": "tool", "lid": HeldEntry(frame="tool", may_touch=["table"])}
    assert list_held(entries) == [("mug", "tool", ()), ("lid", "tool", ("table",))]


def test_it_is_picked_up_at_some_joint_values_or_at_home():
    own = CollisionModel.of(ROBOT)
    world = make_world([make_obstacle("mug", [make_solid("sphere", (0.02,))], place(3.0))])
    home, there = (pick_up(world, read_attached("mug=tip"), own, q) for q in (None, ROBOT.home + 0.2))
    assert home == pick_up(world, list_held({"mug": "tip"}), own.in_world(world), ROBOT.home)
    assert home.attached[0].frame == there.attached[0].frame == "tip"
    assert not np.allclose(home.attached[0].T_frame_object, there.attached[0].T_frame_object)


@pytest.mark.parametrize(
    ("entry", "key", "message"),
    [
        ("tap", "attached", "^attached.mug: three_joints has no frame 'tap'"),
        (HeldEntry(frame="tip", may_touch=["tabel"]), "attached", r"^attached.mug.may_touch\[0\]: no component and no"),
        (HeldEntry(frame="tip", may_touch=["tabel"]), "attach", "^attach.mug: no component and no obstacle is called"),
    ],
)
def test_what_cannot_be_picked_up_is_named(entry, key, message):
    world = make_world([make_obstacle("mug", [make_solid("sphere", (0.02,))], place(3.0))])
    with pytest.raises(InputError, match=message):
        pick_up(world, list_held({"mug": entry}), CollisionModel.of(ROBOT), None, key)
