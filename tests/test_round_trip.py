"""A shipped robot, written for other programs and imported again, is the same robot."""

import re

import numpy as np
import pytest

import ikde
from ikde.io.sphere_writers import format_curobo, format_xrdf
from ikde.io.srdf_writer import format_srdf
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_components, compute_frames
from tests.conftest import random_q
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text

EXACT = {"rtol": 0, "atol": 1e-12}
BESIDE = {"srdf": format_srdf, "curobo": format_curobo, "xrdf": format_xrdf}
COUNT = 10


def read_back(folder, robot, beside, collision=None):
    """The robot out of its URDF, and what stands beside it."""
    urdf, other = folder / "robot.urdf", folder / f"robot.{beside}"
    urdf.write_text(ikde.format_urdf(robot, collision=collision), encoding="utf-8")
    other.write_text(BESIDE[beside](robot, collision=collision), encoding="utf-8")
    asked = {"srdf": other} if beside == "srdf" else {"spheres": other}
    return ikde.import_urdf(urdf, **asked)


def check_same(robot, again, rng, collision=None):
    """Joints with limits, speeds, efforts and home; tool; masses; frames, spheres and compared pairs."""
    assert again.name == robot.name
    assert again.joints == robot.joints
    assert again.tool == robot.tool
    assert [frame.name for frame in again.frames] == [frame.name for frame in robot.frames]
    assert list(again.inertias) == [frame.name for frame in robot.frames if frame.name in robot.inertias]
    for name, inertia in robot.inertias.items():
        assert again.inertias[name].mass_kg == inertia.mass_kg
        np.testing.assert_allclose(again.inertias[name].p_frame_com, inertia.p_frame_com, **EXACT)
        np.testing.assert_allclose(again.inertias[name].I_com_frame, inertia.I_com_frame, **EXACT)
    q = random_q(robot, rng, COUNT)
    for name, T in compute_frames(again, q).items():
        np.testing.assert_allclose(T, compute_frames(robot, q)[name], **EXACT, err_msg=name)
    ours, theirs = CollisionModel.of(robot, collision), CollisionModel.of(again)
    assert {frozenset(pair) for pair in theirs.pairs} == {frozenset(pair) for pair in ours.pairs}
    assert theirs.limit_m == ours.limit_m
    components = compute_components(theirs, q)
    assert list(components) == list(ours.components)
    for name, (centres, radii) in compute_components(ours, q).items():
        np.testing.assert_allclose(components[name][0], centres, **EXACT, err_msg=name)
        assert components[name][1].tolist() == radii.tolist()


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("name", ikde.robot_names())
def test_a_shipped_robot_comes_back(tmp_path, rng, name, beside):
    robot = ikde.load_robot(name)
    if beside != "srdf" and not robot.detectors:
        pytest.skip("without spheres there is no file of them")
    check_same(robot, read_back(tmp_path, robot, beside), rng)


@pytest.mark.parametrize("detector", ["single", "typical"])
def test_so_does_another_detector_even_if_a_pair_always_touches(tmp_path, rng, qiao, detector):
    check_same(qiao, read_back(tmp_path, qiao, "srdf", detector), rng, detector)


def test_so_do_joints_without_limits(tmp_path, rng):
    robot = load_text(ENDLESS)
    check_same(robot, read_back(tmp_path, robot, "srdf"), rng)


BRANCHES = """\
name: branches
joints:
  left: {kind: revolute, lower: -1, upper: 1, max_effort: 100, max_speed: 1}
  right: {kind: prismatic, lower: -1, upper: 1, max_acceleration: 3, home: 0.25}
frames:
  a: {parent: world, joint: right, axis: [0, 1, 0]}
  b: {parent: world, xyz: [0, 0, 1], joint: left, axis: [0, 0.6, 0.8]}
  tip: {parent: a, xyz: [0.3, 0, 0]}
inertias:
  a: {mass: 1.0, com: [0, 0, 0.1], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
tool: tip
spheres:
  own:
    - {component: tip, from: a, to: tip, radius: 0.05, count: 3, spacing: even}
    - {component: a, from: a, radius: 0.05}
    - {component: ground, from: world, radius: 0.1}
    - {component: b, from: b, radius: 0.05}
pairs:
  own: {pairs: {tip: [a, ground], b: [a]}}
detectors:
  own: {spheres: own, pairs: own, safe_distance: 0.002}
"""


def test_so_does_a_joint_that_does_not_move_the_tool_a_pair_of_one_body_and_a_number_that_looks_like_a_placeholder(
    tmp_path, rng
):
    robot = load_text(BRANCHES)
    check_same(robot, read_back(tmp_path, robot, "srdf"), rng)


@pytest.mark.parametrize("beside", BESIDE)
def test_names_as_long_as_names_may_be_come_back(tmp_path, rng, beside):
    names = {name: f"{name}{(100 - len(name)) * name[-1]}" for name in ("pan", "column", "post", "hand", "tip")}
    text = ENDLESS
    for name, long in names.items():
        text = re.sub(rf"\b{name}\b", long, text)
    robot = load_text(text)
    check_same(robot, read_back(tmp_path, robot, beside), rng)
