"""Plain numpy geometry against matrices that are written out here."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector, SphereRow
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver import plain
from ikde.solver.plain import (
    compute_components,
    compute_frames,
    compute_gaps,
    compute_row_centres,
    compute_sphere_gaps,
    joint_motion,
)
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot, random_robot

X, Y, Z = np.eye(3)


def slider_and_elbow():
    """A rail along x, 0.5 up a turn about y, 0.25 further up the tip."""
    frames = [
        make_frame("rail", "world", joint="slide", axis=(1, 0, 0)),
        make_frame("arm", "rail", (0, 0, 0.5), joint="turn", axis=(0, 1, 0)),
        make_frame("tip", "arm", (0, 0, 0.25), rpy=(0, 0, np.pi / 2)),
    ]
    return make_robot({"slide": "prismatic", "turn": "revolute"}, frames, tool="tip")


def tip_by_hand(d, a):
    """T_world_tip: columns are where x, y, z of the tip point, which is turned by a quarter about z."""
    c, s = np.cos(a), np.sin(a)
    return [[0, -c, s, d + 0.25 * s], [1, 0, 0, 0], [0, s, c, 0.5 + 0.25 * c], [0, 0, 0, 1]]


@pytest.mark.parametrize("q", [(0, 0), (0.3, 0.7), (-1.0, -2.5), (0.2, np.pi), (0.0, np.pi / 2)])
def test_frames_are_the_matrices_written_by_hand(q):
    frames = compute_frames(slider_and_elbow(), np.array(q, dtype=float))
    assert frames["tip"] == pytest.approx(np.array(tip_by_hand(*q)), abs=1e-15)
    assert frames["rail"][:3, 3].tolist() == [q[0], 0.0, 0.0]
    assert frames["world"].tolist() == np.eye(4).tolist()


def test_a_stack_of_q_gives_the_frames_one_by_one(any_robot, rng):
    q = random_q(any_robot, rng, 6).reshape(2, 3, -1)
    stacked = compute_frames(any_robot, q)
    for i, j in np.ndindex(2, 3):
        for name, T in compute_frames(any_robot, q[i, j]).items():
            assert stacked[name][i, j] == pytest.approx(T, abs=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_frames_of_a_random_tree_are_rigid(seed, rng):
    robot = random_robot(seed)
    for T in compute_frames(robot, random_q(robot, rng)).values():
        assert T[:3, :3] @ T[:3, :3].T == pytest.approx(np.eye(3), abs=1e-14)
        assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
        assert T[3].tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, np.pi - 1e-9, np.pi, -2.0, 7.0])
def test_a_turn_is_scipys_rotation(angle, rng):
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    T = joint_motion("revolute", axis, np.array(angle))
    assert T[:3, :3] == pytest.approx(Rotation.from_rotvec(angle * axis).as_matrix(), abs=1e-15)
    assert T[:3, 3].tolist() == [0, 0, 0]


def test_a_slide_moves_along_its_axis():
    T = joint_motion("prismatic", np.array([0.6, 0.0, 0.8]), np.array([-2.0, 0.5]))
    assert T.shape == (2, 4, 4)
    assert T[:, :3, 3] == pytest.approx(np.array([[-1.2, 0, -1.6], [0.3, 0, 0.4]]))
    assert T[0, :3, :3].tolist() == np.eye(3).tolist()


@pytest.mark.parametrize(
    ("count", "spacing", "xs"),
    [
        (1, "touching", [0.5]),
        (1, "even", [0.5]),
        (2, "touching", [0.4, 0.6]),
        (3, "touching", [0.3, 0.5, 0.7]),
        (2, "even", [0.0, 1.0]),
        (5, "even", [0.0, 0.25, 0.5, 0.75, 1.0]),
    ],
)
def test_rows_of_spheres_stand_as_the_paper_writes_them(count, spacing, xs):
    row = SphereRow(component="a", start="s", end="e", radius_m=0.1, count=count, spacing=spacing)
    centres = compute_row_centres(row, Y, Y + X)
    assert centres == pytest.approx(np.array([[x, 1.0, 0.0] for x in xs]))


def test_components_carry_their_spheres_along():
    rows = (
        SphereRow(component="bar", start="arm", end="tip", radius_m=0.05, count=2, spacing="even"),
        SphereRow(component="box", start="rail", end="rail", radius_m=0.2),
        SphereRow(component="bar", start="tip", end="tip", radius_m=0.07),
    )
    robot = replace(slider_and_elbow(), approximations={"rows": rows})
    collision = CollisionModel(robot=robot, detector=Detector(name="d", spheres="rows", pairs=""))
    components = compute_components(collision, np.array([0.5, np.pi / 2]))
    assert list(components) == ["bar", "box"]
    centres, radii = components["bar"]
    assert centres == pytest.approx(np.array([[0.5, 0, 0.5], [0.75, 0, 0.5], [0.75, 0, 0.5]]))
    assert radii.tolist() == [0.05, 0.05, 0.07]
    assert components["box"][0].tolist() == [[0.5, 0.0, 0.0]]


def test_the_gap_is_between_the_two_closest_surfaces():
    a = (np.array([[0.0, 0, 0], [1.0, 0, 0]]), np.array([0.1, 0.2]))
    b = (np.array([[5.0, 0, 0], [3.0, 0, 0], [0.0, 2.5, 0]]), np.array([2.0, 0.1, 0.3]))
    gaps = compute_sphere_gaps(a, b)
    assert gaps.shape == (2, 3)
    assert gaps.min() == gaps[1, 1] == pytest.approx(1.7)


def test_the_gap_of_spheres_within_each_other_is_negative():
    assert compute_sphere_gaps((np.zeros((1, 3)), np.array([0.5])), (np.zeros((1, 3)), np.array([0.2]))) == -0.7


def test_many_configurations_are_one_after_the_other(any_robot, rng):
    Q = random_q(any_robot, rng, 7)
    for detector in any_robot.detectors.values():
        collision = CollisionModel(robot=any_robot, detector=detector)
        one_by_one = [compute_gaps(collision, q) for q in Q]
        assert compute_gaps(collision, Q) == pytest.approx(np.array(one_by_one), abs=1e-14)


@pytest.mark.parametrize("at_once", [1, 60, 500, 10**6])
def test_pairs_measured_in_groups_are_those_of_component_by_component(qiao, rng, monkeypatch, at_once):
    collision, Q = CollisionModel.of(qiao), random_q(qiao, rng, 3)
    components = compute_components(collision, Q)
    expected = [compute_sphere_gaps(components[a], components[b]).min(axis=(-2, -1)) for a, b in collision.pairs]
    monkeypatch.setattr(plain, "AT_ONCE", at_once)
    assert compute_gaps(collision, Q).tobytes() == np.stack(expected, axis=-1).tobytes()
    frames = compute_frames(qiao, Q)
    assert compute_gaps(collision, Q, Ts_world=frames).tobytes() == np.stack(expected, axis=-1).tobytes()


@pytest.mark.parametrize("most", [1, 20, 100, 10**6])
def test_a_group_holds_no_more_pairs_of_spheres_than_asked_or_one_pair(qiao, most):
    collision = CollisionModel.of(qiao)
    sizes = tuple((name, len(radii)) for name, (_, radii) in compute_components(collision, qiao.home).items())
    groups, size = plain.list_sphere_pairs(sizes, collision.pairs, most), dict(sizes)
    pairs = [pair for some, *_ in groups for pair in collision.pairs[some]]
    assert pairs == list(collision.pairs)
    for some, i, j, starts in groups:
        tests = [size[a] * size[b] for a, b in collision.pairs[some]]
        assert len(i) == len(j) == sum(tests)
        assert starts.tolist() == (np.cumsum(tests) - tests).tolist()
        assert sum(tests) <= most or len(tests) == 1
    assert (len(groups) == 1) == (most == 10**6)


@pytest.mark.parametrize("frame", ["world", "base_link"])
def test_no_configurations_have_no_distances_from_a_world(frame):
    ball = make_obstacle("ball", [make_solid("sphere", (0.1,))], np.eye(4) + 2.0 * np.eye(4, k=3), frame=frame)
    model = CollisionModel.of("ur5").in_world(make_world([ball]))
    q = model.robot.home
    none = compute_gaps(model, np.empty((0, len(q))))
    assert none.shape == (0, len(model.all_pairs))
    one = compute_gaps(model, q)
    assert one.shape == (len(model.all_pairs),)
    np.testing.assert_array_equal(compute_gaps(model, np.stack([q, q])), np.stack([one, one]))
