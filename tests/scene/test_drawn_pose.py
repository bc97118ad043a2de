"""A pose as data: every sphere with its role, the closest pair, frames with their labels, and what the title says."""

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.world import make_world
from ikde.scene.drawn_pose import Role, base_components, draw_frames, draw_pose
from tests.attached import OWN, STICK, hold
from tests.three_joints import ROBOT, free_q

TARGET = ikde.Target((0.8, 0.5, 1.0))


@pytest.fixture(scope="module")
def folded_q(qiao):
    """The arm in the load."""
    q = qiao.home
    q[4:6] = 2.6, 2.6
    return q


@pytest.fixture(scope="module")
def home(qiao):
    return draw_pose(CollisionModel.of(qiao, "improved"), qiao.home, target=TARGET)


@pytest.fixture(scope="module")
def folded(qiao, folded_q):
    return draw_pose(CollisionModel.of(qiao, "improved"), folded_q)


def test_spheres_are_those_of_the_robot_component_by_component(qiao, home):
    robot = home.robot
    for row in qiao.approximations["improved"]:
        own = robot.parts == robot.components.index(row.component)
        assert (robot.radii_m[own] == row.radius_m).sum() >= row.count
    assert robot.centres_m.shape == (sum(row.count for row in qiao.approximations["improved"]), 3)


def test_platform_and_load_are_the_base_and_all_else_is_arm(home):
    roles = dict(zip(home.robot.components, home.robot.roles, strict=True))
    assert {name for name, role in roles.items() if role == Role.BASE} == {"M", "G"}
    assert set(roles.values()) == {Role.BASE, Role.ARM}


def test_components_collide_that_a_check_finds_colliding(qiao, folded, folded_q):
    colliding = {name for pair in ikde.check(qiao, folded_q).pairs if pair.collides for name in (pair.a, pair.b)}
    roles = zip(folded.robot.components, folded.robot.roles, strict=True)
    assert {name for name, role in roles if role == Role.COLLIDING} == colliding
    assert colliding


def test_the_closest_pair_is_marked_with_its_clearance(qiao, home):
    pair = ikde.check(qiao, qiao.home).pairs[0]
    mark = home.marks[0]
    assert (mark.role, mark.text) == (Role.CLOSEST, f"closest pair, {pair.a}-{pair.b}: {pair.clearance_m * 1e3:.1f} mm")
    frames = ikde.forward(qiao, qiao.home)
    expected = [frames["O3"][:3, 3], frames["O6"][:3, 3]]  # J4 and J6
    assert sorted(map(tuple, mark.points_m.round(9))) == sorted(map(tuple, np.array(expected).round(9)))


def test_a_target_is_marked(qiao, home):
    assert [mark.role for mark in draw_pose(CollisionModel.of(qiao, "none"), qiao.home, target=TARGET).marks] == [
        Role.TARGET,
        Role.BASE,
    ]
    np.testing.assert_array_equal(home.marks[-2].points_m, [TARGET.p_world_tool])


def test_links_lead_to_the_tool_whose_axes_are_shown(qiao, home):
    tool = ikde.forward(qiao, qiao.home)["tool"]
    np.testing.assert_allclose(home.robot.links_m[-1], tool[:3, 3], atol=1e-15)
    np.testing.assert_allclose(home.Ts_world_frame, [tool], atol=1e-15)


def test_links_begin_where_the_arm_does_and_a_mark_points_where_the_base_does(qiao):
    q = qiao.home
    q[:3] = 0.5, -0.25, 1.2
    pose = draw_pose(CollisionModel.of(qiao, "none"), q)
    mount = ikde.forward(qiao, q)["O1"][:3, 3]
    assert np.linalg.norm(pose.robot.links_m[0] - mount) < np.linalg.norm(pose.robot.links_m[0][:2] - q[:2])
    nose = pose.marks[-1].points_m[0, :2] - q[:2]
    assert np.arctan2(nose[1], nose[0]) == pytest.approx(1.2)
    assert pose.heading_rad == pytest.approx(1.2)


def test_the_title_says_the_verdict(home, folded):
    assert home.title == "qiao2021  ·  detector improved: free of self-collision"
    assert folded.title == "qiao2021  ·  detector improved: self-collision"


def test_an_unchecked_pose_is_not_called_free(qiao, folded_q):
    pose = draw_pose(CollisionModel.of(qiao, "none"), folded_q)
    assert pose.title == "qiao2021  ·  self-collision not checked"
    assert Role.COLLIDING not in pose.robot.roles


def test_the_box_holds_spheres_links_and_marks(home):
    low, high = home.compute_box()
    robot = home.robot
    points = np.concatenate(
        [robot.links_m, robot.centres_m - robot.radii_m[:, None], robot.centres_m + robot.radii_m[:, None]]
    )
    points = np.concatenate([points, *(mark.points_m for mark in home.marks)])
    np.testing.assert_allclose([low, high], [points.min(axis=0), points.max(axis=0)])


def test_without_a_detector_there_are_no_spheres(qiao):
    robot = draw_pose(CollisionModel.of(qiao, "none"), qiao.home).robot
    assert robot.centres_m.shape == (0, 3)
    assert robot.components == ()


def test_frames_at_one_place_share_their_label(qiao):
    pose = draw_frames(qiao, qiao.home, ["Ob", "O1", "O1"], title="")
    assert [text for text, _ in pose.labels] == ["Ob", "O1, O1"]
    assert pose.Ts_world_frame.shape == (3, 4, 4)
    np.testing.assert_array_equal(pose.robot.links_m, pose.Ts_world_frame[:, :3, 3])


def test_the_base_of_the_paper_is_platform_and_load(qiao):
    for name in qiao.detectors:
        assert base_components(CollisionModel.of(qiao, name)) == {"M", "G"}


@pytest.mark.parametrize(("name", "base"), [("ur5", {"base"}), ("panda", {"link0"})])
def test_the_base_of_a_fixed_robot_is_its_foot(name, base):
    robot = ikde.load_robot(name)
    assert base_components(CollisionModel.of(robot)) == base


def test_what_is_held_is_drawn_with_the_robot_in_its_own_role():
    model, q = OWN.in_world(hold(make_world([]), ball=False)), free_q(1)[0]
    pose = draw_pose(model, q)
    roles = dict(zip(pose.robot.components, pose.robot.roles, strict=True))
    assert roles["stick"] == Role.HELD
    assert pose.robot.list_spheres("stick")[1].tolist() == [radius for *_, radius in STICK]
    colliding = next(q for q in free_q(100) if ikde.check(ROBOT, q, model).collision)
    roles = dict(zip(pose.robot.components, draw_pose(model, colliding).robot.roles, strict=True))
    assert roles["stick"] == Role.COLLIDING
