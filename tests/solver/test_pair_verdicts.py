"""What is said of a pair holds in configurations that it was not said of; reasons say how it is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.model.collision_model import CollisionModel
from ikde.solver import pair_verdicts
from ikde.solver.pair_verdicts import PairVerdict, judge_pairs
from ikde.solver.plain import compute_gaps
from tests.random_robots import random_robot


@given(seed=st.integers(0, 60))
def test_no_configuration_contradicts_what_is_proved(seed):
    robot = random_robot(seed)
    collision = CollisionModel.of(robot)
    q = np.random.default_rng(seed + 1).uniform(*robot.drawn, (100, len(robot.joints)))
    verdicts = judge_pairs(collision)
    assert tuple(verdicts) == collision.pairs
    for verdict, gaps in zip(verdicts.values(), compute_gaps(collision, q).T, strict=True):
        if verdict.is_proved and verdict.touches != "sometimes":
            touches = gaps <= collision.limit_m - verdict.depth_m + 1e-9
            assert touches.all() if verdict.touches == "always" else not (gaps <= collision.limit_m).any()


def test_without_a_budget_nothing_is_proved_but_what_was_seen(monkeypatch):
    collision = CollisionModel.of(random_robot(7))
    proved = judge_pairs(collision)
    pair_verdicts._judge.cache_clear()
    monkeypatch.setattr(pair_verdicts, "BOXES", 0)
    for pair, verdict in judge_pairs(collision).items():
        assert verdict.is_proved == (verdict.touches == "sometimes")
        assert verdict.touches == proved[pair].touches or proved[pair].touches == "sometimes"
    pair_verdicts._judge.cache_clear()


@pytest.mark.parametrize(
    ("verdict", "reason"),
    [
        (PairVerdict("always", True, ("a", "b")), "always touching: proved for all values of a, b"),
        (
            PairVerdict("always", True, ("a",), 0.0125),
            "always touching: 12.5 mm deep at least, proved for all values of a",
        ),
        (PairVerdict("always", True, ()), "always touching: they do not move"),
        (PairVerdict("never", True, ("a",)), "never touching: proved for all values of a"),
        (PairVerdict("always", False, ("a",)), "always touching: in each of 1,000 random configurations"),
        (PairVerdict("never", False, ("a",)), "never touching: in none of 1,000 random configurations"),
    ],
)
def test_reasons_say_how_it_is_known(verdict, reason):
    assert verdict.reason == reason


def test_nothing_is_said_without_a_detector():
    robot = random_robot(1)
    assert judge_pairs(CollisionModel.of(robot, "none")) == {}
