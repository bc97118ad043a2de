"""Regions are values, and what makes none is refused in a line."""

import pickle

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.region import Region, read_goals, read_region
from ikde.model.target import Target, Targets
from tests.goals import AXIS, POINT, POSE, REGIONS

ROOM = [(0, 0), (2, 0), (2, 2)]


@pytest.mark.parametrize("region", [*REGIONS, Region.any_of([POSE, AXIS]).with_base(ROOM)], ids=repr)
def test_a_region_is_a_value_in_a_line(region):
    again = pickle.loads(pickle.dumps(region))
    assert again == region
    assert hash(again) == hash(region)
    assert repr(again).count("\n") == 0
    assert len(repr(again)) < 200


def test_regions_differ_by_their_numbers():
    assert len(set(REGIONS)) == len(REGIONS)
    assert Region.box(POINT, 0.01) != Region.box(POINT, 0.02)
    assert Region.any_of([POINT, POSE]) != Region.any_of([POSE, POINT])


def test_alternatives_of_alternatives_count_one_by_one():
    inner = Region.any_of([POINT, POSE])
    assert [part.target for part in Region.any_of([AXIS, inner]).parts] == [AXIS, POINT, POSE]


def test_the_box_of_a_pose_stands_in_its_frame_unless_the_world_is_asked_for():
    assert np.array_equal(Region.box(POSE, 0.1).parts[0].R_world_box, POSE.R_world_tool)
    assert np.array_equal(Region.box(POSE, 0.1, frame="world").parts[0].R_world_box, np.eye(3))
    assert np.array_equal(Region.box(AXIS, 0.1).parts[0].R_world_box, np.eye(3))


def test_what_is_found_in_a_region_is_read_only():
    with pytest.raises(ValueError, match="read-only"):
        REGIONS[0].parts[0].box_m[0, 0] = 1.0


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Region.box(POSE), "a region of zero size"),
        (lambda: Region.turn(POSE, angle_rad=(0.2, 0.2)), "a region of zero size"),
        (lambda: Region.cone(AXIS, 0.0), "a region of zero size"),
        (lambda: Region.look_at((0, 0, 0), (0.3, 0.3), angle_rad=0.0), "a region of zero size"),
        (lambda: Region.box(POSE, -0.1), "position_m: inside out: expected at least 0 either way"),
        (lambda: Region.box(POSE, [(0.1, 0), (0, 0), (0, 0)]), "position_m: inside out along x: the least, 0.1"),
        (lambda: Region.box(POSE, np.nan), "position_m: expected finite numbers"),
        (lambda: Region.box(POSE, (0.1, 0.2)), r"position_m: expected a number, three, or least and largest \[3, 2\]"),
        (
            lambda: Region.box(POSE, 0.1, np.float64(4.0)),
            "rotation_rad: expected finite numbers up to 3.14159 rad, got 4.0",
        ),
        (lambda: Region.box(POINT, 0.1, 0.1), "rotation_rad: only a full pose has rotations"),
        (lambda: Region.box(POSE, 0.1, frame="tool"), "frame: expected one of goal, world, got 'tool'"),
        (lambda: Region.turn(AXIS), "target: a turn is about an axis of a full pose"),
        (lambda: Region.turn(POSE, angle_rad=(1, 0)), "angle_rad: inside out: the least, 1, is above"),
        (lambda: Region.turn(POSE, angle_rad=(0, 7)), "angle_rad: expected angles within 6.28319 rad, a whole turn"),
        (lambda: Region.turn(POSE, (0, 0, 0)), "an axis of length 0 has no direction"),
        (lambda: Region.cone(POINT, 0.1), "target: a cone needs a direction"),
        (lambda: Region.cone(AXIS, 3.2), r"angle_rad: expected an angle from 0 to pi \(180 degrees\), got 3.2"),
        (lambda: Region.cone(AXIS, np.nan), "angle_rad: expected an angle"),
        (lambda: Region.look_at((0, 0, 0), (0.6, 0.3)), "distance_m: inside out"),
        (lambda: Region.look_at((0, 0, 0), (-0.1, 0.3)), "distance_m: expected distances from 0 to"),
        (lambda: Region.look_at((0, 0), (0.1, 0.3)), r"p_world_point: expected a point \[3\] in m"),
        (lambda: Region.any_of([]), "goals: expected 1 to 1,000 alternatives, got 0"),
        (lambda: Region.any_of(POSE), "goals: expected a sequence"),
        (lambda: Region.any_of([POSE], "worst"), "take: expected one of first, best, got 'worst'"),
        (
            lambda: Region.any_of([POSE, Region.of(POSE).with_base(ROOM)]),
            r"goals\[1\]: alternatives share a base region",
        ),
        (lambda: Region.of(POSE).with_base(ROOM[:2]), "base: expected at least 3 corners"),
        (lambda: Region.any_of([POSE, "here"]), r"goals\[1\]: expected a Target"),
    ],
)
def test_what_makes_no_region_is_refused(make, said):
    with pytest.raises(InputError, match=said):
        make()


def test_goals_are_read_as_targets_where_all_are_and_by_their_rows_else():
    assert isinstance(read_goals(np.zeros((3, 3))), Targets)
    assert isinstance(read_goals([POSE, (1, 2, 3)]), Targets)
    assert isinstance(read_goals(iter([POSE, (1, 2, 3)])), Targets)
    assert read_goals(REGIONS[0]) == [REGIONS[0]]
    assert read_goals([POSE, REGIONS[0], (1.0, 2.0, 3.0)]) == [POSE, REGIONS[0], Target((1, 2, 3))]
    with pytest.raises(InputError, match=r"targets\[1\]: expected a Target"):
        read_goals([REGIONS[0], "here"])


def test_a_target_is_a_region_without_freedom():
    assert read_region(POSE).parts[0].target == POSE
    assert read_region(REGIONS[0]) is REGIONS[0]
