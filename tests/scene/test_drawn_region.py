"""Outlines of regions lie on their edges."""

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.region import Region
from ikde.scene.drawn_pose import draw_pose
from ikde.scene.drawn_region import LENGTH_M, draw_region
from tests.goals import POSE, REGIONS


def list_lines(region):
    """Of the region itself."""
    return draw_region(region)[0].lines_m


def test_a_box_is_its_edges():
    lines = list_lines(Region.box(POSE, [(0, 0.1), (-0.1, 0.2), (0, 0.3)]))
    corners = (np.concatenate(lines[:2]) - POSE.p_world_tool) @ POSE.R_world_tool
    assert {tuple(np.round(corner, 9) + 0.0) for corner in corners[: -2 if len(lines) < 6 else None]} == {
        (x, y, z) for x in (0, 0.1) for y in (-0.1, 0.2) for z in (0, 0.3)
    }
    assert len(lines) == 6 + 1  # two loops, four posts; and the axis that is asked for


def test_a_cone_is_as_wide_as_its_angle():
    rim = list_lines(Region.cone(POSE, 0.3))[0] - POSE.p_world_tool
    assert np.linalg.norm(rim, axis=1) == pytest.approx(LENGTH_M)
    assert rim @ POSE.axis_world_tool == pytest.approx(LENGTH_M * np.cos(0.3))


def test_what_looks_at_a_point_is_so_far_from_it():
    near, far, *_ = list_lines(Region.look_at((1, 0, 0), (0.3, 0.6), (0, 0, -1), 0.5))
    for rim, distance in ((near, 0.3), (far, 0.6)):
        assert np.linalg.norm(rim - (1, 0, 0), axis=1) == pytest.approx(distance)
        assert rim[:, 2] == pytest.approx(distance * np.cos(0.5))


@pytest.mark.parametrize("region", REGIONS, ids=repr)
def test_every_kind_is_drawn(region):
    outlines = draw_region(region.with_base([(0, 0), (2, 0), (2, 2)]))
    assert len(outlines[0].lines_m) > 1
    assert all(np.isfinite(line).all() and line.shape[1] == 3 for each in outlines for line in each.lines_m)
    assert outlines[-1].is_base
    assert outlines[-1].lines_m[0][:, 2].tolist() == [0.0] * 4


def test_the_alternative_that_was_reached_is_told_from_the_others():
    several = Region.any_of([Region.box(POSE, 0.1), Region.cone(POSE, 0.3), POSE])
    chosen, others = draw_region(several, 1)
    assert [line.tolist() for line in chosen.lines_m] == [line.tolist() for line in list_lines(Region.cone(POSE, 0.3))]
    assert (chosen.text, chosen.is_faint) == ("region: alternative 2 of 3", False)
    assert (others.text, others.is_faint, len(others.lines_m)) == ("other alternatives", True, 7 + 1)
    (every,) = draw_region(several)
    assert every.text == "region: any pose in any of them will do"
    assert len(every.lines_m) == len(chosen.lines_m) + len(others.lines_m)


def test_what_is_looked_at_is_marked_with_lines_of_sight():
    seen, leading = draw_region(Region.look_at((1, 0, 0), (0.3, 0.6), (0, 0, -1), 0.5))
    assert (leading.text, leading.is_faint, seen.is_faint) == ("", True, False)
    assert {tuple(line.mean(axis=0)) for line in leading.lines_m[:3]} == {(1.0, 0.0, 0.0)}
    assert [np.linalg.norm(line[1] - line[0]) for line in leading.lines_m[3:]] == pytest.approx([0.3] * 8)
    assert len(draw_region(Region.look_at((1, 0, 0), (0.3, 0.6)))[1].lines_m) == 3


def test_an_exact_target_with_a_base_region_shows_where_the_base_may_stand():
    (floor,) = draw_region(Region.of(POSE).with_base([(0, 0), (2, 0), (2, 2)]))
    assert (floor.text, floor.is_base) == ("where the base may stand", True)


def test_a_drawn_pose_has_room_for_it():
    robot = ikde.load_robot("ur5")
    region = Region.box((1.5, 0.0, 0.3), 0.2)
    pose = draw_pose(CollisionModel.of(robot), robot.home, region=region)
    assert pose.compute_box()[1, 0] == pytest.approx(1.7)
