"""Mutations against their vector formulas, drawing of members, and what each bound repair does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.kernels.mutation import MAX_DRAWN, REPAIRS, STRATEGIES, draw_members, mutate, repair_bound
from tests import reference
from tests.kernels.arrays import make_state

PARENT, LOWER, UPPER = 0.25, -1.0, 2.0
OUTSIDE = st.floats(-50.0, -1.0, exclude_max=True) | st.floats(2.0, 50.0, exclude_min=True)
few = settings(max_examples=60)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_strategy_equals_its_formula(strategy, rng):
    x = rng.normal(size=(9, 6))
    for _ in range(20):
        i, best, *r = rng.permutation(9)[:7]
        F = rng.uniform(0.1, 1.0)
        drawn = np.array(r, dtype=np.int64)
        donor = [mutate(STRATEGIES.index(strategy), x, int(i), int(best), drawn, F, k) for k in range(6)]
        np.testing.assert_array_equal(donor, reference.MUTATIONS[strategy](x, i, best, r, F))


def test_every_strategy_has_a_formula():
    assert tuple(reference.MUTATIONS) == STRATEGIES


def test_an_unknown_strategy_gives_nan():
    assert np.isnan(mutate(99, np.zeros((6, 2)), 0, 0, np.arange(5), 0.5, 0))


@few
@given(word=st.integers(0, 2**64 - 1), population=st.integers(MAX_DRAWN + 1, 60), data=st.data())
def test_drawn_members_are_distinct_and_never_the_current_one(word, population, data):
    current = data.draw(st.integers(0, population - 1))
    drawn = np.zeros(MAX_DRAWN, dtype=np.int64)
    draw_members(make_state(word), population, current, drawn)
    assert len(set(drawn)) == MAX_DRAWN
    assert current not in drawn
    assert drawn.min() >= 0
    assert drawn.max() < population


def test_members_are_drawn_in_the_order_of_the_stream():
    state, stream = make_state(7), reference.Stream(7)
    drawn = np.zeros(MAX_DRAWN, dtype=np.int64)
    for current in range(8):
        draw_members(state, 8, current, drawn)
        assert drawn.tolist() == reference.draw_members(stream, 8, current)
    assert int(state[0]) == stream.state


def test_every_other_member_is_drawn_equally_often():
    state, drawn, counts = make_state(1), np.zeros(MAX_DRAWN, dtype=np.int64), np.zeros(8)
    for _ in range(2000):
        draw_members(state, 8, 3, drawn)
        counts[drawn] += 1
    assert counts[3] == 0
    np.testing.assert_allclose(np.delete(counts, 3), 10000 / 7, rtol=0.08)


def repair(name, value, state=None):
    return repair_bound(REPAIRS.index(name), make_state(5) if state is None else state, value, PARENT, LOWER, UPPER)


@few
@given(value=st.floats(LOWER, UPPER), name=st.sampled_from(REPAIRS))
def test_a_value_inside_its_range_stays(value, name):
    assert repair(name, value) == value


@few
@given(value=OUTSIDE, name=st.sampled_from([name for name in REPAIRS if name != "none"]))
def test_a_repaired_value_lies_inside_its_range(value, name):
    assert LOWER <= repair(name, value) <= UPPER


@few
@given(value=OUTSIDE, name=st.sampled_from(REPAIRS), word=st.integers(0, 2**64 - 1))
def test_repair_equals_its_twin(value, name, word):
    state, stream = make_state(word), reference.Stream(word)
    assert repair(name, value, state) == reference.repair_bound(name, stream, value, PARENT, LOWER, UPPER)
    assert int(state[0]) == stream.state


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("clip", -1.5, -1.0),
        ("clip", 9.0, 2.0),
        ("parent", -1.5, 0.25),
        ("parent", 9.0, 0.25),
        ("midpoint", -1.5, -0.375),
        ("midpoint", 9.0, 1.125),
        ("none", -1.5, -1.5),
        ("none", 9.0, 9.0),
    ],
)
def test_repair_does_what_it_says(name, value, expected):
    assert repair(name, value) == expected


def test_redraw_takes_the_next_number_of_the_stream():
    assert repair("redraw", 9.0, make_state(11)) == LOWER + reference.Stream(11).uniform() * (UPPER - LOWER)


def test_only_redraw_moves_the_stream():
    for name in REPAIRS:
        state = make_state(3)
        repair(name, 9.0, state)
        assert (int(state[0]) != 3) == (name == "redraw")
