"""`forward`: every frame but the world, for one configuration or a stack, in any convention."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from tests.conftest import random_q


def test_every_frame_has_a_pose_and_the_world_is_left_out(any_robot):
    frames = ikde.forward(any_robot, any_robot.home)
    assert set(frames) == {frame.name for frame in any_robot.frames} | {"tool"}
    np.testing.assert_array_equal(frames["tool"], frames[any_robot.tool])
    assert all(T.shape == (4, 4) for T in frames.values())


def test_the_tool_of_the_paper_at_home(qiao):
    """d_x = d_y = q_z = 0, q1 = 90 deg, the arm straight up: heights add, sides add along -y turned to x."""
    frames = ikde.forward(qiao, qiao.home)
    height = 0.1 + 0.38 + 0.0892 + 0.425 + 0.39225 + 0.09465
    side = 0.12 - 0.12 + 0.08915 + 0.0823 + 0.2
    assert frames["tool"][:3, 3] == pytest.approx([0.54 + side, 0.0, height], abs=1e-15)


def test_a_stack_is_one_by_one(qiao, rng):
    q = random_q(qiao, rng, 4)
    stacked = ikde.forward(qiao, q)["tool"]
    assert stacked.shape == (4, 4, 4)
    for T, row in zip(stacked, q, strict=True):
        assert pytest.approx(ikde.forward(qiao, row)["tool"], abs=1e-15) == T


def test_a_mapping_is_read_by_name(qiao, rng):
    q = random_q(qiao, rng)
    by_name = ikde.forward(qiao, dict(zip(qiao.joint_names, q, strict=True)))
    assert by_name["tool"].tolist() == ikde.forward(qiao, q)["tool"].tolist()


def test_a_convention_is_another_way_to_say_the_same(qiao, rng):
    q = random_q(qiao, rng)
    said = ikde.to_convention(qiao, q, "classical")
    assert ikde.forward(qiao, said, "classical")["tool"] == pytest.approx(ikde.forward(qiao, q)["tool"], abs=1e-14)


def test_values_outside_the_limits_are_accepted(qiao):
    q = np.zeros(9)
    q[0] = 100.0
    assert ikde.forward(qiao, q)["Od"][:3, 3] == pytest.approx([100.0, 0.0, 0.1])


@pytest.mark.parametrize("q", [[0.0] * 8, [np.nan] * 9, {"q1": 0.0}])
def test_bad_values_are_refused(qiao, q):
    with pytest.raises(InputError):
        ikde.forward(qiao, q)
