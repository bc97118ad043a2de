"""What is proved of a region holds of every pose that is drawn from it."""

import numpy as np
import pytest

import ikde
from ikde.model.region import Region
from ikde.model.target import Target
from ikde.solver.proof import prove
from ikde.solver.region_draws import draw_poses
from ikde.solver.region_proof import cover, prove_region
from ikde.solver.tool_body import measure_shortage
from tests.goals import POSE, REGIONS
from tests.problems import problem_of

SETTINGS = ikde.SolveSettings()


@pytest.mark.parametrize("region", REGIONS, ids=repr)
def test_cells_cover_all_that_is_drawn(region):
    drawn = draw_poses(region, 0, 300, SETTINGS, 0, 0)
    for place, part in enumerate(region.parts):
        cells, poses = cover(part), drawn.targets.take(np.flatnonzero(drawn.parts == place))
        far = np.linalg.norm(poses.p_world_tool[:, None] - cells.targets.p_world_tool, axis=2).min(axis=1)
        assert far.max() <= cells.radius_m + 1e-12
        if cells.targets[0].kind == "axis":
            cosines = poses.axis_world_tool @ cells.targets.axis_world_tool[0]
            assert np.arccos(np.clip(cosines, -1, 1)).max() <= cells.angle_rad + 1e-7


def shift(x):
    """Regions of all kinds about a place that far from the base."""
    R, p = POSE.R_world_tool, np.array([x, 0.3, 0.5])
    goal, box = Target(p, R_world_tool=R), (0.1, 0.2, 0.05)
    yield from (Region.box(p, box), Region.box(goal, box, 0.2), Region.turn(goal, (1, 0, 0), position_m=box))
    yield from (
        Region.cone(goal, 0.4, box),
        Region.look_at(p, (0.1, 0.3)),
        Region.look_at(p, (0.1, 0.4), (1, 0, 0), 0.1),
    )


@pytest.mark.parametrize(("x", "proved"), [(0.5, 0), (1.05, 0), (1.2, 4), (1.4, 5), (2.0, 6)])
def test_where_a_region_is_out_of_reach_each_of_its_poses_is(x, proved):
    asked = problem_of(ikde.load_robot("ur5"))
    proofs = 0
    for region in shift(x):
        _, proof = prove_region(asked, region)
        poses = draw_poses(region, 0, 300, SETTINGS, 0, 0).targets
        if proof:
            proofs += 1
            assert all(prove(asked, target) != (0.0, 0.0) for target in poses)
    assert proofs == proved


def test_where_the_tool_cannot_be_its_body_is_too_near_in_each_pose():
    goal = Target((0.4, 0.2, 0.5), R_world_tool=POSE.R_world_tool)
    place = (goal.p_world_tool + np.array([0.02, 0, 0])).tolist()
    proved = 0
    for radius in (0.05, 0.1, 0.2, 0.3, 0.5):
        world = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": radius}, "position": place}}})
        asked = problem_of(ikde.load_robot("ur5"), collision=world)
        for region in (Region.box(goal, 0.1, 0.2), Region.cone(goal, 0.5, 0.1), Region.look_at(place, (0.1, 0.2))):
            _, proof = prove_region(asked, region)
            if proof is None:
                continue
            proved += 1
            assert proof.reason.endswith("puts what is fixed to the tool too near: ball")
            poses = draw_poses(region, 0, 200, SETTINGS, 0, 0).targets
            assert (measure_shortage(asked, poses) > 0.0).any(axis=(1, 2)).all()
    assert 5 <= proved < 15


def test_one_alternative_may_be_excluded_without_the_others():
    region = Region.any_of([(3.0, 0, 0), Region.box(POSE, 0.1), (0, 0, 4.0)])
    asked = problem_of(ikde.load_robot("ur5"))
    assert prove_region(asked, region) == ({0, 2}, None)
    _, proof = prove_region(asked, Region.any_of([(3.0, 0, 0), (0, 0, 4.0)]))
    assert proof is not None
    assert proof.reason.startswith("out of reach: every alternative is at least 1.870 m")
