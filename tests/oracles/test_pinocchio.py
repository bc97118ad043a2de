"""Pinocchio as the oracle of kinematics: frames and Jacobians of every robot that ships.

The Pinocchio model is built from the robot's list of frames alone, so it shares no code with the tree of
bodies, the packing, the kernels or the plain numpy that `forward` uses.
"""

import numpy as np
import pinocchio as pin
import pytest

import ikde
from ikde.kernels.frames import compute_frames, compute_jacobian
from ikde.model.pack import frame_names, pack_robot
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies

COUNT = 200
EXACT = 1e-12  # m and entries of rotations; measured: at most 2e-15
STEP = 1e-6  # m and rad


def build_model(robot):
    """A Pinocchio model: a joint for every frame that moves, an operational frame for every frame."""
    model = pin.Model()
    carrier = {"world": (0, pin.SE3.Identity())}
    for frame in robot.frames:
        joint_id, placement = carrier[frame.parent]
        placement = placement * pin.SE3(frame.R_parent_frame, frame.p_parent_frame)
        if frame.joint is not None:
            joint_id = model.addJoint(joint_id, joint_model(robot, frame), placement, frame.joint)
            placement = pin.SE3.Identity()
        carrier[frame.name] = (joint_id, placement)
        model.addFrame(pin.Frame(f"frame {frame.name}", joint_id, 0, placement, pin.FrameType.OP_FRAME))
    return model


def joint_model(robot, frame):
    kind = next(joint.kind for joint in robot.joints if joint.name == frame.joint)
    types = {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}
    return types[kind](*frame.axis)


class Oracle:
    """Frames and tool Jacobian by Pinocchio, with q in the robot's order of joints."""

    def __init__(self, robot):
        self.robot = robot
        self.model = build_model(robot)
        self.data = self.model.createData()
        joints = [self.model.joints[self.model.getJointId(name)] for name in robot.joint_names]
        self.order = np.argsort([joint.idx_q for joint in joints])
        self.columns = [joint.idx_v for joint in joints]

    def frame_id(self, name):
        return self.model.getFrameId(f"frame {name}")

    def frames(self, q):
        pin.framesForwardKinematics(self.model, self.data, q[self.order])
        return {f.name: self.data.oMf[self.frame_id(f.name)].homogeneous for f in self.robot.frames}

    def jacobian(self, q):
        frame, axes = self.frame_id(self.robot.tool), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.model, self.data, q[self.order], frame, axes)
        return J[:, self.columns]


def kernel_frames(robot, q):
    arrays = pack_robot(robot)
    T_world_frame = np.empty((arrays.frame_body.size, 3, 4))
    compute_frames(arrays, run_bodies(robot, q), T_world_frame)
    return dict(zip(frame_names(robot), T_world_frame, strict=True))


def kernel_jacobian(robot, q):
    jacobian = np.empty((6, len(robot.joints)))
    compute_jacobian(pack_robot(robot), run_bodies(robot, q), kernel_frames(robot, q)[robot.tool], jacobian)
    return jacobian


def difference_jacobian(robot, q):
    """Central differences of `forward`: rows v then omega, omega from the skew part of dR R^T."""
    steps = STEP * np.eye(len(q))
    ahead, behind = (ikde.forward(robot, q + sign * steps)[robot.tool] for sign in (1.0, -1.0))
    v = (ahead[:, :3, 3] - behind[:, :3, 3]) / (2.0 * STEP)
    R = ikde.forward(robot, q)[robot.tool][:3, :3]
    W = (ahead[:, :3, :3] - behind[:, :3, :3]) @ R.T / (2.0 * STEP)
    omega = 0.5 * np.stack([W[:, 2, 1] - W[:, 1, 2], W[:, 0, 2] - W[:, 2, 0], W[:, 1, 0] - W[:, 0, 1]], axis=1)
    return np.vstack([v.T, omega.T])


@pytest.fixture
def configurations(any_robot, rng):
    """Random joint values, and the corners where trouble sits: home and both ends of every limit."""
    return np.vstack([any_robot.home, any_robot.lower, any_robot.upper, random_q(any_robot, rng, COUNT)])


def test_forward_gives_the_frames_of_pinocchio(any_robot, configurations):
    oracle, Ts_world = Oracle(any_robot), ikde.forward(any_robot, configurations)
    for index, q in enumerate(configurations):
        for name, T in oracle.frames(q).items():
            np.testing.assert_allclose(Ts_world[name][index], T, rtol=0, atol=EXACT, err_msg=name)


def test_kernels_give_the_frames_of_pinocchio(any_robot, configurations):
    oracle = Oracle(any_robot)
    for q in configurations:
        Ts_world = kernel_frames(any_robot, q)
        for name, T in oracle.frames(q).items():
            np.testing.assert_allclose(Ts_world[name], T[:3], rtol=0, atol=EXACT, err_msg=name)


def test_every_body_of_the_kernels_stands_and_slides_or_turns_as_its_joint_in_pinocchio(any_robot, configurations):
    arrays, oracle = pack_robot(any_robot), Oracle(any_robot)
    for q in configurations:
        oracle.frames(q)
        Ts_world_body = run_bodies(any_robot, q)
        for body in range(1, len(arrays.bodies)):
            joint = any_robot.joints[arrays.bodies[body, 1]]
            axis = next(frame.axis for frame in any_robot.frames if frame.joint == joint.name)
            T = oracle.data.oMi[oracle.model.getJointId(joint.name)]
            np.testing.assert_allclose(Ts_world_body[body, :, 3], T.translation, rtol=0, atol=EXACT)
            np.testing.assert_allclose(Ts_world_body[body, :, 2], T.rotation @ axis, rtol=0, atol=EXACT)


def test_kernel_jacobian_is_that_of_pinocchio(any_robot, configurations):
    oracle = Oracle(any_robot)
    for q in configurations:
        np.testing.assert_allclose(kernel_jacobian(any_robot, q), oracle.jacobian(q), rtol=0, atol=EXACT)


class PlanarOracle:
    """A base as Pinocchio's planar joint, whose speeds are the twist in the base's own frame."""

    def __init__(self, robot, joints=3):
        self.model = pin.Model()
        carrier = {"world": (0, pin.SE3.Identity())}
        for frame in robot.frames:
            joint_id, placement = carrier[frame.parent]
            placement = placement * pin.SE3(frame.R_parent_frame, frame.p_parent_frame)
            place = robot.joint_names.index(frame.joint) if frame.joint else 0
            if frame.joint and place >= joints - 1:
                kind = joint_model(robot, frame) if place >= joints else pin.JointModelPlanar()
                joint_id, placement = self.model.addJoint(joint_id, kind, placement, frame.joint), pin.SE3.Identity()
            carrier[frame.name] = (joint_id, placement)
            self.model.addFrame(pin.Frame(f"frame {frame.name}", joint_id, 0, placement, pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def jacobian(self, q, frame, axes):
        planar = np.concatenate([q[:2], [np.cos(q[2]), np.sin(q[2])], q[3:]])
        return pin.computeFrameJacobian(self.model, self.data, planar, self.model.getFrameId(f"frame {frame}"), axes)


@pytest.mark.parametrize("name", ["qiao2021", "qiao2021_dh", "ur5e_mecanum"])
def test_by_twist_and_by_wheels_a_jacobian_is_that_of_pinocchio_s_planar_base(name, rng):
    robot = ikde.load_robot(name)
    oracle, R, side = PlanarOracle(robot), robot.wheels.radius_m, robot.wheels.half_track_m
    if robot.wheels.half_wheelbase_m is None:  # twist = map @ wheels, as the papers have it
        kept, wheels = [0, 2], np.array([[R / 2, R / 2], [-R / (2 * side), R / (2 * side)]])
    else:
        turn = 1.0 / (side + robot.wheels.half_wheelbase_m)
        kept, wheels = [0, 1, 2], R / 4 * np.array([[1, 1, 1, 1], [-1, 1, -1, 1], [-turn, -turn, turn, turn]])
    for q in random_q(robot, rng, 20):
        for axes, theirs in (("world", "LOCAL_WORLD_ALIGNED"), ("frame", "LOCAL")):
            for frame in (robot.tool, robot.frames[6].name):
                J = oracle.jacobian(q, frame, getattr(pin.ReferenceFrame, theirs))
                base, arm = J[:, kept], J[:, 3:]
                ours = {by: ikde.jacobian(robot, q, frame=frame, axes=axes, by=by) for by in ("twist", "actuators")}
                np.testing.assert_allclose(ours["twist"], np.hstack([base, arm]), rtol=0, atol=EXACT)
                np.testing.assert_allclose(ours["actuators"], np.hstack([base @ wheels, arm]), rtol=0, atol=EXACT)


def test_jacobian_by_joints_is_that_of_pinocchio(any_robot, rng):
    oracle = Oracle(any_robot)
    for q in random_q(any_robot, rng, 20):
        np.testing.assert_allclose(ikde.jacobian(any_robot, q), oracle.jacobian(q), rtol=0, atol=EXACT)


def test_kernel_jacobian_is_the_derivative_of_forward(any_robot, rng):
    for q in random_q(any_robot, rng, COUNT):
        expected = difference_jacobian(any_robot, q)
        np.testing.assert_allclose(kernel_jacobian(any_robot, q), expected, rtol=0, atol=1e-6)
