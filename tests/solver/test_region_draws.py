"""What is drawn lies inside, fills the region, begins with its centre, and is the same again."""

import numpy as np
import pytest

from ikde.model.region import Region
from ikde.model.target import KINDS, Target
from ikde.solver.region_draws import draw_points, draw_poses, draw_streams
from ikde.solver.region_grade import measure_part
from ikde.solver.settings import SolveSettings
from tests.goals import POSE, REGIONS

SETTINGS = SolveSettings()


def pose(target):
    return np.vstack([target.T_world_tool, [0, 0, 0, 1]])


@pytest.mark.parametrize("region", REGIONS, ids=repr)
def test_all_that_is_drawn_lies_inside(region):
    drawn = draw_poses(region, 0, 200, SETTINGS, 5, 7)
    for target, part in zip(drawn.targets, drawn.parts.tolist(), strict=True):
        far_m, off_rad = measure_part(region.parts[part], pose(target))
        assert far_m < 1e-12
        assert off_rad < 1e-9


@pytest.mark.parametrize("region", REGIONS, ids=repr)
def test_a_draw_depends_on_its_number_alone(region):
    whole, part = draw_poses(region, 0, 90, SETTINGS, 5, 7), draw_poses(region, 30, 40, SETTINGS, 5, 7)
    rows = np.isin(whole.numbers, part.numbers)
    assert np.array_equal(whole.targets.T_world_tool[rows], part.targets.T_world_tool)
    assert np.array_equal(whole.parts[rows], part.parts)


def test_the_first_draw_is_the_centre_whatever_the_seed():
    region = Region.box(POSE, [(0.0, 0.1), (-0.1, 0.1), (0, 0)], [(0, 0), (0, 0), (0, 1.0)])
    one, other = (draw_poses(region, 0, 2, SETTINGS, seed, 0).targets.T_world_tool for seed in (0, 1))
    assert np.array_equal(one[0], other[0])
    assert not np.array_equal(one[1], other[1])
    assert (one[0, :, 3] - POSE.p_world_tool) @ POSE.R_world_tool == pytest.approx((0.05, 0, 0))
    cone = draw_poses(Region.cone(POSE, 0.2), 0, 1, SETTINGS, 0, 0).targets[0]
    assert cone.axis_world_tool == pytest.approx(POSE.axis_world_tool)


def test_each_kind_asks_for_what_says_it_best():
    kinds = [KINDS[draw_poses(region, 0, 1, SETTINGS, 0, 0).targets.kind[0]] for region in REGIONS]
    assert kinds == ["position", "axis", "pose", "axis", "pose", "axis", "axis", "axis", "position"]


def test_alternatives_take_turns():
    drawn = draw_poses(REGIONS[-1], 0, 9, SETTINGS, 0, 0)
    assert drawn.parts.tolist() == [0, 1, 2] * 3
    assert drawn.targets[0] == Target((0.4, 0.2, 0.3))
    assert drawn.targets[4] == POSE


@pytest.mark.parametrize("dimensions", [1, 2, 3, 6])
def test_points_fill_the_cube(dimensions):
    points = draw_points(np.arange(1, 513), dimensions, 3, 4)
    assert ((points >= 0) & (points < 1)).all()
    for column in points.T:
        assert np.bincount((column * 8).astype(int), minlength=8).min() >= 48


def test_directions_fill_the_sphere():
    region = Region.look_at((0, 0, 0), (0.3, 0.6))
    z = draw_poses(region, 1, 1000, SETTINGS, 0, 0).targets.axis_world_tool
    assert np.abs(z.mean(axis=0)).max() < 0.05
    assert (z @ z.T).min() < -0.95


def test_streams_are_those_of_numbers():
    streams = draw_streams(2**64 - 1, 2**63 - 1, np.arange(100))
    assert streams[0] == 2**63 - 1
    assert len(set(streams)) == 100
    assert all(0 <= stream < 2**63 for stream in streams)
    assert draw_streams(2**64 - 1, 2**63 - 1, np.arange(50, 60)) == streams[50:60]
