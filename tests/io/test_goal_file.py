"""Goal files: what they hold, and what is wrong in them with its line."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.io.goal_file import load_base_region, load_goal
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target

POSE = Target.from_rpy((0.4, 0.2, 0.3), (np.pi, 0.0, 0.0))
TEXT = """\
units: {length: mm, angle: deg}
any_of:
  - {position: [400, 200, 300], rpy: [180, 0, 0], box: [[-50, 50], [0, 20], [0, 0]], rotation: [0, 0, 90]}
  - {position: [400, 200, 300], rpy: [180, 0, 0], turn: {axis: [1, 0, 0], angles: [-90, 90]}, box: 10, frame: world}
  - {position: [400, 200, 300], rpy: [180, 0, 0], cone: 90}
  - {look_at: {point: [600, 0, 0], distance: [300, 500], axis: [1, 0, 0], angle: 90}}
  - {position: [400, 200, 300]}
take: best
base: {corners: [[0, 0], [2000, 0], [2000, 2000]]}
"""
HALF = 90 * (np.pi / 180)


def test_a_file_holds_every_kind(tmp_path):
    path = tmp_path / "goal.yaml"
    path.write_text(TEXT)
    box = np.array([[-50, 50], [0, 20], [0, 0]]) * 1e-3
    expected = Region.any_of(
        [
            Region.box(POSE, box, (0, 0, HALF)),
            Region.turn(POSE, (1, 0, 0), (-HALF, HALF), 0.01, "world"),
            Region.cone(POSE, HALF),
            Region.look_at((0.6, 0, 0), np.array([300, 500]) * 1e-3, (1, 0, 0), HALF),
            (0.4, 0.2, 0.3),
        ],
        "best",
    ).with_base([(0, 0), (2, 0), (2, 2)])
    read = ikde.load_goal(path)
    assert isinstance(read, Region)
    assert (read.take, read.base, len(read.parts)) == (expected.take, expected.base, 5)
    for one, other in zip(read.parts, expected.parts, strict=True):
        assert one.rule == other.rule
        for name in ("numbers", "box_m", "R_world_box"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-15)


def test_a_goal_without_freedom_is_a_target():
    assert load_goal({"goal": {"position": [0.4, 0.2, 0.3]}}) == Target((0.4, 0.2, 0.3))
    with_base = load_goal({"goal": {"position": [0.4, 0.2, 0.3]}, "base": {"corners": [[0, 0], [2, 0], [2, 2]]}})
    assert with_base == Region.of((0.4, 0.2, 0.3)).with_base([(0, 0), (2, 0), (2, 2)])


def test_a_base_region_has_a_file_of_its_own(tmp_path):
    path = tmp_path / "room.yaml"
    path.write_text("corners: [[0, 0], [2, 0], [2, 2]]\nholes: [[[1.5, 0.5], [1.8, 0.5], [1.8, 0.8]]]\n")
    assert load_base_region(path) == BaseRegion([(0, 0), (2, 0), (2, 2)], [[(1.5, 0.5), (1.8, 0.5), (1.8, 0.8)]])
    path.write_text("corners: [[0, 0],\n  [2, 2], [2, 0], [0, 2]]\n")
    with pytest.raises(InputError, match=r"room.yaml:1 → corners: the polygon crosses or touches itself"):
        load_base_region(path)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("take: best", "expected a `goal`, or several in `any_of`"),
        ("goal: {position: [0, 0, 0]}\nany_of: [{position: [0, 0, 0]}]", "expected a `goal`, or several"),
        ("goal: {position: [0, 0, 0]}\ntake: best", ":2 → take: only alternatives"),
        ("goal:\n  rpy: [0, 0, 0]", "goal: a goal has a `position`, or `look_at`"),
        ("goal:\n  position: [0, 0, 0]\n  box: 0", "a region of zero size"),
        ("goal:\n  position: [0, 0, 0]\n  box: [[1, 0], [0, 0], [0, 0]]", ":3 → goal.box: inside out along x"),
        ("goal:\n  position: [0, 0, 0]\n  box: .nan", ":3 → goal.box: expected a finite number"),
        ("goal:\n  position: [0, 0, 0]\n  box: [1, 2]", ":3 → goal.box: expected 3 values, got 2"),
        ("goal:\n  position: [0, 0, 0]\n  boxes: 1", ":3 → goal.boxes: unknown key .did you mean 'box'"),
        ("goal:\n  position: [0, 0, 0]\n  rotation: 1", ":3 → goal.rotation: only a full pose"),
        ("goal:\n  position: [0, 0, 0]\n  axis: [0, 0, 1]\n  cone: 4", ":4 → goal.cone: expected an angle"),
        ("goal:\n  position: [0, 0, 0]\n  turn: {}", ":2 → goal.position: a turn is about"),
        (
            "goal:\n  position: [0, 0, 0]\n  rpy: [0, 0, 0]\n  turn: {angles: [1, 0]}",
            ":4 → goal.turn.angles: inside",
        ),
        (
            "goal:\n  position: [0, 0, 0]\n  rpy: [0, 0, 0]\n  turn: {axis: [0, 0, 0]}",
            ":4 → goal.turn.axis: an axis",
        ),
        (
            "goal:\n  position: [0, 0, 0]\n  cone: 1\n  turn: {}",
            "expected one of rotation, turn, cone, got turn and cone",
        ),
        ("goal:\n  look_at: {point: [0, 0, 0], distance: [2, 1]}", ":2 → goal.look_at.distance: inside out"),
        ("goal:\n  look_at: {point: [0, 0, 0], distance: [1, 2]}\n  box: 1", ":3 → goal.box: `look_at` says all"),
        (
            "any_of:\n  - {position: [0, 0, 0]}\n  - {position: [0, 0, 0], box: -1}",
            r":3 → any_of\[1\].box: inside out",
        ),
        ("goal: {position: [0, 0, 0]}\nbase:", ":2 → base: expected a value, got nothing; leave the key out"),
        ("goal:\n  position: [0, 0, 0]\n  cone:", ":3 → goal.cone: expected a value, got nothing"),
        ("goal: {position: [0, 0, 0]}\nbase: {corners: [[0, 0], [1, 0]]}", ":2 → base.corners: expected at least 3"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, lines, said):
    path = tmp_path / "goal.yaml"
    path.write_text(lines + "\n")
    with pytest.raises(InputError, match=said):
        load_goal(path)


def test_what_is_no_file_is_refused():
    with pytest.raises(InputError, match="expected the path of a goal file or a mapping, got 3"):
        load_goal(3)
