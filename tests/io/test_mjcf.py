"""MJCF as MuJoCo reads it: the same frames, limits, sphere centres and contacts as ikde's own."""

import mujoco
import numpy as np
import pytest

import ikde
from ikde.io.mjcf import format_mjcf
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_components, compute_gaps
from tests.conftest import ROBOTS, random_q
from tests.endless_robot import ENDLESS
from tests.random_robots import make_frame, make_robot, random_robot
from tests.robot_files import load_text

COUNT = 50
EXACT = {"rtol": 0, "atol": 1e-12}


class Reader:
    """What MuJoCo makes of a robot's MJCF, with q in the robot's order of joints."""

    def __init__(self, robot):
        self.model = mujoco.MjModel.from_xml_string(format_mjcf(robot))
        self.data = mujoco.MjData(self.model)
        self.columns = [self.model.joint(name).qposadr[0] for name in robot.joint_names]

    def move(self, q):
        self.data.qpos[self.columns] = q
        mujoco.mj_forward(self.model, self.data)

    def frame(self, name):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = self.data.body(name).xmat.reshape(3, 3), self.data.body(name).xpos
        return T

    def component(self, geom):
        return self.model.geom(geom).name.rpartition("_")[0]

    def touching(self):
        """Pairs of components with a contact."""
        return {frozenset(map(self.component, contact.geom.tolist())) for contact in self.data.contact}


@pytest.fixture(params=[*ROBOTS, *range(12)])
def robot(request):
    """Every robot that ships, and random ones: with pairs on one body, on neighbours, and on the world."""
    return random_robot(request.param) if isinstance(request.param, int) else ikde.load_robot(request.param)


def test_frames_are_those_of_mujoco(robot, rng):
    reader = Reader(robot)
    for q in [robot.home, robot.lower, robot.upper, *random_q(robot, rng, COUNT)]:
        reader.move(q)
        Ts_world = ikde.forward(robot, q)
        for name in (frame.name for frame in robot.frames):
            np.testing.assert_allclose(reader.frame(name), Ts_world[name], **EXACT, err_msg=name)


def test_spheres_are_those_of_mujoco(robot, rng):
    reader, detector = Reader(robot), CollisionModel.of(robot).detector
    for q in random_q(robot, rng, COUNT if detector else 0):
        reader.move(q)
        for name, (centres, radii) in compute_components(CollisionModel.of(robot), q).items():
            for index, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
                place = reader.data.geom(f"{name}_{index}").xpos
                np.testing.assert_allclose(place, centre, **EXACT, err_msg=name)
                assert reader.model.geom(f"{name}_{index}").size[0] == radius


def test_contacts_are_the_collisions(robot, rng):
    reader, detector = Reader(robot), CollisionModel.of(robot).detector
    seen = set()
    for q in random_q(robot, rng, 4 * COUNT if detector else 0):
        reader.move(q)
        pairs = CollisionModel(robot=robot, detector=detector).pairs
        gaps = compute_gaps(CollisionModel(robot=robot, detector=detector), q)
        collisions = {frozenset(pair) for pair, gap in zip(pairs, gaps, strict=True) if gap < 0.0}
        assert reader.touching() == collisions
        seen |= collisions
    assert seen or robot.name not in ("qiao2021", "ur5")


def test_limits_and_home_are_the_robots_own_bits(robot):
    reader = Reader(robot)
    ranges = np.array([reader.model.joint(name).range for name in robot.joint_names])
    assert ranges.tolist() == np.column_stack([robot.lower, robot.upper]).tolist()
    assert reader.model.key("home").qpos[reader.columns].tolist() == robot.home.tolist()
    assert all(reader.model.jnt_limited)
    assert not reader.model.opt.gravity.any()


def test_a_joint_that_cannot_move_is_read():
    frames = [make_frame("tool", "world", (1, 0, 0), joint="stiff", axis=(0, 0, 1))]
    reader = Reader(make_robot({"stiff": "revolute"}, frames, lower=0.25, upper=0.25))
    assert reader.model.joint("stiff").range == pytest.approx(0.25, abs=1e-15)


def test_a_joint_without_limits_has_none(rng):
    robot = load_text(ENDLESS)
    reader = Reader(robot)
    limited = [bool(reader.model.joint(name).limited) for name in robot.joint_names]
    assert limited == np.isfinite(robot.lower).tolist()
    reader.move(q := random_q(robot, rng) + 10.0 * np.isinf(robot.lower))
    np.testing.assert_allclose(reader.frame("tip"), ikde.forward(robot, q)["tip"], **EXACT)


def test_nothing_falls(qiao):
    reader = Reader(qiao)
    reader.move(qiao.home)
    for _ in range(20):
        mujoco.mj_step(reader.model, reader.data)
    np.testing.assert_allclose(reader.data.qpos[reader.columns], qiao.home, atol=1e-12)
