"""URDF as Pinocchio reads it: the same frames, limits and sphere centres as ikde's own."""

import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.io.robots import load_robot
from ikde.io.urdf import format_urdf, rpy_from_rotation
from ikde.io.urdf_import.read_urdf import import_urdf
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import rotation_from_rpy
from ikde.solver.plain import compute_components
from tests.conftest import ROBOTS, random_q
from tests.endless_robot import ENDLESS
from tests.random_robots import make_frame, make_robot, random_robot
from tests.robot_files import load_text

COUNT = 50
EXACT = {"rtol": 0, "atol": 1e-12}
angles = st.floats(-np.pi, np.pi)
pitches = st.one_of(angles, st.sampled_from([-0.5 * np.pi, 0.5 * np.pi, 0.5 * np.pi - 1e-9, 1e-8 - 0.5 * np.pi]))


class Reader:
    """What Pinocchio makes of a robot's URDF, with q in the robot's order of joints."""

    def __init__(self, robot):
        text = format_urdf(robot)
        self.model = pin.buildModelFromXML(text)
        self.geometry = pin.buildGeomFromUrdfString(self.model, text, pin.GeometryType.COLLISION)
        self.data, self.places = self.model.createData(), self.geometry.createData()
        self.columns = [self.model.joints[self.model.getJointId(name)].idx_q for name in robot.joint_names]

    def order(self, q):
        values = np.empty(self.model.nq)
        values[self.columns] = q
        return values

    def move(self, q):
        pin.framesForwardKinematics(self.model, self.data, self.order(q))
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.places)

    def frame(self, name):
        return self.data.oMf[self.model.getFrameId(name, pin.FrameType.BODY)].homogeneous

    def spheres(self):
        """Centre and radius by the link that carries them, in order."""
        found = {}
        for shape, place in zip(self.geometry.geometryObjects, self.places.oMg, strict=True):
            link = self.model.frames[shape.parentFrame].name
            found.setdefault(link, []).append((*place.translation, shape.geometry.radius))
        return found


@pytest.fixture(params=[*ROBOTS, *range(6)])
def robot(request):
    """Every robot that ships, and random ones."""
    return random_robot(request.param) if isinstance(request.param, int) else ikde.load_robot(request.param)


def test_frames_are_those_of_pinocchio(robot, rng):
    reader = Reader(robot)
    for q in [robot.home, robot.lower, robot.upper, *random_q(robot, rng, COUNT)]:
        reader.move(q)
        Ts_world = ikde.forward(robot, q)
        for name in (frame.name for frame in robot.frames):
            np.testing.assert_allclose(reader.frame(name), Ts_world[name], **EXACT, err_msg=name)


def test_spheres_are_those_of_pinocchio(robot, rng):
    reader, detector = Reader(robot), CollisionModel.of(robot).detector
    for q in random_q(robot, rng, COUNT if detector else 0):
        reader.move(q)
        found = reader.spheres()
        components = compute_components(CollisionModel.of(robot), q)
        assert sorted(found) == sorted(f"component_{name}" for name in components)
        for name, (centres, radii) in components.items():
            expected = np.column_stack([centres, radii])
            np.testing.assert_allclose(found[f"component_{name}"], expected, **EXACT, err_msg=name)


def test_limits_are_the_robots_own_bits(robot):
    reader = Reader(robot)
    assert reader.model.lowerPositionLimit.tolist() == reader.order(robot.lower).tolist()
    assert reader.model.upperPositionLimit.tolist() == reader.order(robot.upper).tolist()


def test_joints_keep_their_names_and_kinds(robot):
    joints = {j.get("name"): j.get("type") for j in ET.fromstring(format_urdf(robot)).iter("joint")}
    assert {joint.name: joint.kind for joint in robot.joints}.items() <= joints.items()
    rest = [kind for name, kind in joints.items() if name not in robot.joint_names]
    assert set(rest) <= {"fixed"}


def test_every_frame_is_a_link(robot):
    links = [link.get("name") for link in ET.fromstring(format_urdf(robot)).iter("link")]
    assert len(links) == len(set(links))
    assert {"world", *(frame.name for frame in robot.frames)} <= set(links)


def test_a_frame_named_like_ours_makes_room():
    frames = [make_frame("tool", "world", joint="fixed_tip", axis=(0, 0, 1)), make_frame("tip", "tool", (1, 0, 0))]
    robot = make_robot({"fixed_tip": "revolute"}, frames)
    assert [j.get("name") for j in ET.fromstring(format_urdf(robot)).iter("joint")] == ["fixed_tip", "fixed_tip_"]


@settings(max_examples=200)
@given(roll=angles, pitch=pitches, yaw=angles)
def test_a_rotation_comes_back_from_its_angles(roll, pitch, yaw):
    R = rotation_from_rpy(np.array([roll, pitch, yaw]))
    np.testing.assert_allclose(rotation_from_rpy(rpy_from_rotation(R)), R, rtol=0, atol=3e-15)


def test_a_joint_without_limits_is_continuous(rng):
    """Pinocchio keeps such a joint as cosine and sine."""
    robot = load_text(ENDLESS)
    root = ET.fromstring(format_urdf(robot))
    for joint in robot.joints:
        element = next(found for found in root.iter("joint") if found.attrib["name"] == joint.name)
        limits = element.find("limit").attrib
        assert element.attrib["type"] == joint.kind
        assert ("lower" in limits, "upper" in limits) == (joint.kind != "continuous",) * 2
    model = pin.buildModelFromXML(format_urdf(robot))
    assert model.nq == len(robot.joints) + 2
    q, values = random_q(robot, rng), np.empty(model.nq)
    for joint, value in zip(robot.joints, q, strict=True):
        found = model.joints[model.getJointId(joint.name)]
        turned = [np.cos(value), np.sin(value)] if joint.kind == "continuous" else [value]
        values[found.idx_q : found.idx_q + found.nq] = turned
    data = model.createData()
    pin.framesForwardKinematics(model, data, values)
    seen = data.oMf[model.getFrameId("tip", pin.FrameType.BODY)].homogeneous
    np.testing.assert_allclose(seen, ikde.forward(robot, q)["tip"], **EXACT)


def test_an_import_of_what_is_exported_knows_the_tool(tmp_path):
    path = tmp_path / "ur5.urdf"
    path.write_text(format_urdf("ur5"), encoding="utf-8")
    assert import_urdf(path).tool == load_robot("ur5").tool
