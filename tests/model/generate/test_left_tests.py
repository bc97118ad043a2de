"""What stands written of the proofs is what proving gives, and nothing else is taken for it."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import left_tests
from ikde.model.generate.assemble import MAX_TESTS
from ikde.model.generate.collision import count_tests, list_tests
from ikde.model.generate.left_tests import digest_proofs, find_left, prove_left, read_written, write_left
from ikde.model.pack import pack_robot


def numbers(left):
    return (left.every, left.implied, left.proved, [test.number for test in left.tests])


SHIPPED = [(name, detector) for name in ikde.robot_names() for detector in ikde.load_robot(name).detectors]


@pytest.mark.parametrize(("name", "detector"), SHIPPED)
def test_what_is_written_down_of_a_shipped_robot_is_what_proving_gives(name, detector):
    collision = CollisionModel.of(ikde.load_robot(name), detector)
    robot = pack_robot(collision.robot)
    if count_tests(collision.arrays) > MAX_TESTS:
        return
    proved = prove_left(robot, collision)
    assert read_written().get(digest_proofs(robot, collision)) == write_left(proved), "run benchmarks/ship_proofs.py"
    assert numbers(find_left(robot, collision)) == numbers(proved)


def test_what_is_written_down_is_believed_and_not_proved_again(monkeypatch):
    collision = CollisionModel.of(ikde.load_robot("ur5"))
    robot = pack_robot(collision.robot)
    digest, every = digest_proofs(robot, collision), len(list_tests(collision.arrays))
    monkeypatch.setattr(left_tests, "read_written", lambda: {digest: [2, 0, 4]})
    assert numbers(find_left(robot, collision)) == (every, 2, every - 4, [0, 4])


def change_limits(robot):
    first = robot.joints[0]
    return replace(robot, joints=(replace(first, upper=first.upper + 0.1), *robot.joints[1:]))


def change_frames(robot):
    frame = robot.frames[-1]
    moved = replace(frame, p_parent_frame=np.asarray(frame.p_parent_frame) + 1e-6)
    return replace(robot, frames=(*robot.frames[:-1], moved))


@pytest.mark.parametrize("change", [change_limits, change_frames])
def test_another_robot_is_proved_anew(change):
    robot = ikde.load_robot("ur5")
    digests = {digest_proofs(pack_robot(r), CollisionModel.of(r)) for r in (robot, change(robot))}
    assert len(digests) == 2


def test_a_wider_safe_distance_and_other_code_prove_anew(substitute):
    robot = ikde.load_robot("ur5")
    detector = robot.detectors[robot.default_detector]
    wider = CollisionModel.of(robot, replace(detector, safe_distance_m=0.05))
    usual = CollisionModel.of(robot, detector)
    digests = {digest_proofs(pack_robot(robot), collision) for collision in (usual, wider)}
    substitute(left_tests._own_source, lambda: b"other code")
    digests.add(digest_proofs(pack_robot(robot), usual))
    assert len(digests) == 3
