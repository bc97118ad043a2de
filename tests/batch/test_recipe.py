"""The recipe: plain data, and digests that change exactly when an answer can."""

import json
from dataclasses import replace

import numpy as np

import ikde
from ikde.batch.recipe import array_digest, as_plain, digest, ikde_version, robot_digest
from ikde.model.robot import Inertia
from ikde.solver.settings import SolveSettings
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text


def test_plain_data_survives_json(qiao):
    plain = as_plain({"a": (1, np.float64(0.1)), "b": np.arange(3), "c": SolveSettings(), "d": None, "e": qiao})
    assert json.loads(json.dumps(plain)) == plain
    assert plain["a"] == [1, 0.1]
    assert (plain["c"]["method"], plain["c"]["de"]) == ("auto", None)


def test_the_order_of_keys_does_not_matter_and_the_last_bit_does():
    assert digest({"a": 1, "b": 0.1}) == digest({"b": 0.1, "a": 1})
    assert digest({"a": 0.1}) != digest({"a": float(np.nextafter(0.1, 1))})


def test_a_robot_is_its_numbers_and_not_its_title(qiao):
    assert robot_digest(qiao) == robot_digest(replace(qiao, title="another", provenance={}, wheels=None))
    assert robot_digest(qiao) == robot_digest(replace(qiao, adjacent=(), neighbours=()))
    fast = tuple(replace(joint, max_speed=1.0, max_acceleration=2.0, max_effort=3.0) for joint in qiao.joints)
    assert robot_digest(qiao) == robot_digest(replace(qiao, joints=fast))
    inertia = Inertia(mass_kg=1.0, p_frame_com=np.zeros(3), I_com_frame=np.eye(3))
    heavy = replace(qiao, inertias={qiao.frames[0].name: inertia}, drive="omnidirectional")
    assert robot_digest(qiao) == robot_digest(heavy)
    wider = (replace(qiao.joints[0], upper=np.nextafter(qiao.joints[0].upper, np.inf)), *qiao.joints[1:])
    assert robot_digest(qiao) != robot_digest(replace(qiao, joints=wider))
    moved = replace(qiao.frames[5], p_parent_frame=np.nextafter(qiao.frames[5].p_parent_frame, np.inf))
    assert robot_digest(qiao) != robot_digest(replace(qiao, frames=(*qiao.frames[:5], moved, *qiao.frames[6:])))


def test_arrays_differ_by_shape_and_bits():
    a = np.arange(6.0)
    assert array_digest(a) == array_digest(a.copy())
    assert array_digest(a) != array_digest(a.reshape(2, 3))
    assert array_digest(a) != array_digest(np.nextafter(a, 9))


def test_the_version_is_that_of_the_package():
    assert ikde_version() == ikde.__version__


def test_what_has_no_end_is_null():
    robot = load_text(ENDLESS)
    assert as_plain((np.inf, -np.inf, np.array([np.inf, 1.0]))) == [None, None, [None, 1.0]]
    assert as_plain(robot.joints[0])["lower"] is None
    other = (replace(robot.joints[0], home=1.0), *robot.joints[1:])
    assert robot_digest(robot) != robot_digest(replace(robot, joints=other))


def test_what_kernels_are_written_for_changes_no_answer(qiao):
    other = replace(qiao, file_ranges=((-9.0, 9.0),) * len(qiao.joints))
    assert robot_digest(other) == robot_digest(qiao)
