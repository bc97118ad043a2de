"""Tasks as values: what makes one, and what makes none."""

import pickle

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.target import Target
from ikde.track.velocity_task import VelocityTask


def test_a_task_is_a_value():
    made = [VelocityTask.tool((0.4, 0.2, 0.3), gain=2.0, level=1) for _ in range(2)]
    assert made[0] == made[1] == pickle.loads(pickle.dumps(made[0]))
    assert made[0] != VelocityTask.tool((0.4, 0.2, 0.3), gain=2.0, level=2)
    assert made[0].target == Target((0.4, 0.2, 0.3))
    given = np.array([0.1, 0.0, 0.0])
    task = VelocityTask.tool(twist=given)
    given[0] = 9.0
    np.testing.assert_array_equal(task.velocity, [0.1, 0, 0])
    with pytest.raises(ValueError, match="read-only"):
        task.velocity[0] = 1.0


def test_a_place_a_velocity_or_both():
    assert VelocityTask.tool(np.eye(4)).target.kind == "pose"
    assert len(VelocityTask.tool(twist=np.zeros(6)).velocity) == 6
    assert len(VelocityTask.base((1.0, 2.0)).place) == 2
    assert len(VelocityTask.base((1, 2, 3), velocity=(0, 0, 0.1)).velocity) == 3
    task = VelocityTask.joints({"a": 1}, rates={"b": 0.5}, gain=0)
    assert (dict(task.values), dict(task.rates), task.gain) == ({"a": 1.0}, {"b": 0.5}, 0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (VelocityTask.tool, "target: expected a target or a twist, got neither"),
        (lambda: VelocityTask.tool((1, 2)), r"target: expected a Target, a position \[3\]"),
        (lambda: VelocityTask.tool(twist=(1, 2)), r"twist: expected 3 or 6 numbers, got shape \(2,\)"),
        (lambda: VelocityTask.tool(twist=(1, 2, np.nan)), "twist: expected finite numbers"),
        (lambda: VelocityTask.tool((0, 0, 0), frame=3), "frame: expected the name of a frame, got 3"),
        (VelocityTask.base, "place: expected a place or a velocity, got neither"),
        (lambda: VelocityTask.base((1, 2, 3, 4)), r"place: expected 2 or 3 numbers, got shape \(4,\)"),
        (lambda: VelocityTask.base((1, 2), velocity=(1, 2, 3)), "velocity: expected 2 numbers, as many as"),
        (lambda: VelocityTask.base((1, np.inf)), "place: expected finite numbers"),
        (VelocityTask.joints, "values: expected values or rates"),
        (lambda: VelocityTask.joints([1, 2]), "values: expected numbers by joint name"),
        (lambda: VelocityTask.joints({"a": np.nan}), "values.a: expected a finite number, got nan"),
        (lambda: VelocityTask.joints(rates={"a": True}), "rates.a: expected a finite number, got True"),
        (lambda: VelocityTask.tool((0, 0, 0), gain=-1), "gain: expected a number from 0 to 10000 per second, got -1"),
        (lambda: VelocityTask.tool((0, 0, 0), gain=np.nan), "gain: expected a number from 0"),
        (lambda: VelocityTask.tool((0, 0, 0), max_speed=0), "max_speed: expected a number above 0, or None, got 0"),
        (lambda: VelocityTask.tool((0, 0, 0), level=1.5), "level: expected a whole number, or None, got 1.5"),
        (lambda: VelocityTask.tool((0, 0, 0), share=1.1), "share: expected a number from 0 to 1, got 1.1"),
    ],
)
def test_what_is_none_is_said_in_a_line(make, words):
    with pytest.raises(InputError, match=f"^{words}"):
        make()
