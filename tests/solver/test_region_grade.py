"""The grader of regions beside definitions written out by hand, and beside scipy's rotations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target
from ikde.solver.region_grade import grade_region, measure_base, measure_part
from ikde.solver.settings import SolveSettings

SETTINGS = SolveSettings()
R_GOAL = Rotation.from_rotvec((0.4, -1.0, 0.7)).as_matrix()
P_GOAL = np.array([0.4, 0.2, 0.3])
POSE = Target(P_GOAL, R_world_tool=R_GOAL)


def tool(offset=(0, 0, 0), vector=(0, 0, 0)):
    """A pose off the goal by an offset and a rotation vector, both in the goal's frame."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R_GOAL @ Rotation.from_rotvec(vector).as_matrix(), P_GOAL + R_GOAL @ np.array(offset)
    return T


def measure(region, T):
    return measure_part(region.parts[0], T)


def test_a_box_is_counted_in_the_goals_frame():
    region = Region.box(POSE, [(-0.01, 0.02), (0, 0), (0, 0.1)], (0.1, 0.0, 0.3))
    assert measure(region, tool((0.02, 0, 0.05), (0.1, 0, -0.3))) == pytest.approx((0, 0), abs=1e-12)
    assert measure(region, tool((0.05, 0, -0.04))) == pytest.approx((0.05, 0), abs=1e-12)
    assert measure(region, tool((0, 0, 0), (0, 0, 0.5))) == pytest.approx((0, 0.2), abs=1e-12)


def test_a_box_along_the_world_is_not():
    region, T = Region.box(POSE, (0.1, 0.0, 0.0), frame="world"), tool()
    T[:3, 3] += (0.1, 0, 0)
    assert measure(region, T) == pytest.approx((0, 0), abs=1e-12)
    assert measure(Region.box(POSE, (0.1, 0.0, 0.0)), T)[0] > 0.05


def test_a_half_turn_has_two_vectors_of_which_one_is_enough():
    region = Region.box(POSE, 0.0, [(0, 0), (0, 0), (2.0, np.pi)])
    assert measure(region, tool(vector=(0, 0, np.pi - 1e-9)))[1] < 1e-8
    assert measure(region, tool(vector=(0, 0, -np.pi + 1e-9)))[1] < 1e-8
    assert measure(region, tool(vector=(0, 0, -np.pi + 0.2)))[1] == pytest.approx(0.2, abs=1e-9)


def test_a_turn_is_about_its_axis_and_anything_else_is_off():
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    region = Region.turn(POSE, axis, (-0.5, 2.0))
    assert measure(region, tool(vector=1.9 * axis))[1] < 1e-12
    assert measure(region, tool(vector=-0.7 * axis))[1] == pytest.approx(0.2, abs=1e-9)
    free = Region.turn(POSE, axis)
    for angle in (-3.1, 0.0, 1.0, np.pi, 6.0):
        assert measure(free, tool(vector=angle * axis))[1] < 1e-12
    tilted = R_GOAL @ Rotation.from_rotvec(2.5 * axis).as_matrix() @ Rotation.from_rotvec((0.1, -0.05, 0)).as_matrix()
    T = tool()
    T[:3, :3] = tilted
    swing = np.arccos(np.clip(axis @ R_GOAL.T @ tilted @ axis, -1, 1))
    assert measure(free, T)[1] == pytest.approx(swing, abs=1e-9)


def test_a_cone_is_about_the_goals_axis_z():
    region = Region.cone(POSE, 0.2, 0.01)
    assert measure(region, tool((0.01, 0, 0), (0, 0.2, 0)))[1] == pytest.approx(0.0, abs=1e-12)
    assert measure(region, tool((0, 0, 0), (0.5, 0, 0)))[1] == pytest.approx(0.3, abs=1e-12)
    assert measure(region, tool((0, 0, 0), (0, 0, 2.0)))[1] == pytest.approx(0.0, abs=1e-12)


def test_what_looks_at_a_point_does_so_from_a_distance():
    region = Region.look_at(P_GOAL + 0.5 * R_GOAL[:, 2], (0.3, 0.6))
    assert measure(region, tool()) == pytest.approx((0, 0), abs=1e-12)
    assert measure(region, tool((0, 0, 0.3))) == pytest.approx((0.1, 0), abs=1e-12)
    assert measure(region, tool((0, 0, 0), (0.1, 0, 0)))[1] == pytest.approx(0.1, abs=1e-9)
    narrow = Region.look_at(P_GOAL + 0.5 * R_GOAL[:, 2], (0.3, 0.6), R_GOAL[:, 0], 1.0)
    assert measure(narrow, tool())[1] == pytest.approx(np.pi / 2 - 1.0, abs=1e-9)


def test_the_alternative_that_it_is_in_is_named_else_the_nearest():
    far = Target(P_GOAL + 1.0, R_world_tool=R_GOAL)
    region = Region.any_of([far, Region.box(POSE, 0.01)])
    inside, outside = (
        grade_region(region, tool((0.005, 0, 0)), SETTINGS),
        grade_region(region, tool((0.02, 0, 0)), SETTINGS),
    )
    assert (inside.alternative, inside.is_inside) == (1, True)
    assert (outside.alternative, outside.is_inside) == (1, False)
    assert outside.position_m == pytest.approx(0.01)


def test_a_tolerance_is_beyond_the_edge():
    region = Region.box(POSE, 0.01)
    assert grade_region(region, tool((0.01 + 0.9e-5, 0, 0)), SETTINGS).is_inside
    assert not grade_region(region, tool((0.01 + 1.1e-5, 0, 0)), SETTINGS).is_inside


def test_a_base_stands_inside_or_so_far_out():
    region = BaseRegion([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 3), (1, 3)]])
    places = {(0.5, 0.5): 0.0, (1.5, 2.0): 0.5, (3, 3): 0.0, (5, 5): np.sqrt(2), (4, 2): 0.0, (0, 0): 0.0, (1, 2): 0.0}
    for place, far_m in places.items():
        assert measure_base(region, np.array(place, dtype=float)) == pytest.approx(far_m)


def test_the_grader_of_places_agrees_with_what_draws_them(rng):
    region = BaseRegion([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)], [[(0.2, 0.2), (0.8, 0.2), (0.5, 0.8)]])
    points = rng.uniform(-1, 5, (500, 2))
    assert np.array_equal(region.contains(points), [measure_base(region, point) == 0.0 for point in points])
