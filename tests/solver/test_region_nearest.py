"""The nearest pose of a region: inside, and no draw is nearer in what is free."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.model.region import Region
from ikde.solver.region_draws import draw_poses
from ikde.solver.region_grade import measure_part
from ikde.solver.region_nearest import find_nearest
from tests.goals import POSE, REGIONS

SETTINGS = ikde.SolveSettings()


def pose(target):
    return np.vstack([target.T_world_tool, [0, 0, 0, 1]])


def draw_tool(rng, size=0.3):
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(rng.normal(0, 1.5, 3)).as_matrix()
    T[:3, 3] = POSE.p_world_tool + rng.normal(0, size, 3)
    return T


@pytest.mark.parametrize("region", REGIONS, ids=repr)
def test_it_lies_inside(region, rng):
    for _ in range(50):
        tool = draw_tool(rng)
        for part in region.parts:
            far_m, off_rad = measure_part(part, pose(find_nearest(part, tool, SETTINGS)))
            assert far_m < 1e-12
            assert off_rad < 1e-7


@pytest.mark.parametrize("region", REGIONS[:-1], ids=repr)
def test_what_is_inside_stays(region):
    (part,) = region.parts
    for target in draw_poses(region, 0, 50, SETTINGS, 1, 2).targets:
        found = find_nearest(part, pose(target), SETTINGS)
        assert found.kind == target.kind
        assert found.p_world_tool == pytest.approx(target.p_world_tool, abs=1e-9)
        if target.kind == "pose":
            assert pose(found) == pytest.approx(pose(target), abs=2e-4)
        if target.kind == "axis":
            assert found.axis_world_tool == pytest.approx(target.axis_world_tool, abs=1e-7)


def test_no_draw_of_a_box_or_a_cone_is_nearer(rng):
    for region in (
        Region.box(POSE, (0.1, 0.2, 0.0)),
        Region.cone(POSE, 0.4, 0.1),
        Region.turn(POSE, (1, 0, 0), (-1, 1)),
    ):
        (part,), tool = region.parts, draw_tool(rng)
        found, draws = find_nearest(part, tool, SETTINGS), draw_poses(region, 0, 300, SETTINGS, 0, 0).targets
        far = np.linalg.norm(draws.p_world_tool - tool[:3, 3], axis=1)
        assert np.linalg.norm(found.p_world_tool - tool[:3, 3]) <= far.min() + 3e-5
        if part.rule == "cone":
            assert found.axis_world_tool @ tool[:3, 2] >= (draws.axis_world_tool @ tool[:3, 2]).max() - 3e-4
        if part.rule == "turn":
            likeness = np.einsum("tij,ij->t", draws.R_world_tool, tool[:3, :3])
            assert np.sum(found.R_world_tool * tool[:3, :3]) >= likeness.max() - 1e-3
