"""The box of a step: speeds, accelerations, ranges where it would stop, and the way to a target that may move on."""

import math

import pytest

from ikde.kernels import servo_rows as kernels
from tests.uncompiled import plain_module

PLAIN = plain_module(kernels)


def test_a_capped_step_stops_where_it_may(rng):
    for room, change in rng.uniform(0.0, 3.0, (50, 2)):
        step = PLAIN.cap_step(room, change)
        assert step * (1.0 + 0.5 * step / change) == pytest.approx(room)
    assert PLAIN.cap_step(0.7, math.inf) == 0.7
    assert PLAIN.cap_step(-0.1, 0.3) == 0.0


def test_what_moves_on_is_followed_at_its_speed():
    assert PLAIN.approach(0.4, 0.4, 0.05) == pytest.approx(0.4)
    assert PLAIN.approach(0.4, 0.0, 0.05) == pytest.approx(PLAIN.cap_step(0.4, 0.05))
    assert PLAIN.approach(0.4, -0.3, 0.05) == pytest.approx(PLAIN.cap_step(0.4, 0.05))
    assert PLAIN.approach(-0.2, 0.3, 0.05) == 0.0
