"""The random stream is splitmix64, bit for bit, and every attempt has its own."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.kernels.rng import next_index, next_uniform, next_word, seed_stream
from tests import reference
from tests.kernels.arrays import make_state

few = settings(max_examples=100)
words = st.integers(0, 2**64 - 1)

pytestmark = pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # uncompiled words wrap around

# The first words from state 0, as published with the reference implementation [Steele2014; Vigna].
PUBLISHED = [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F, 0xF88BB8A8724C81EC, 0x1B39896A51A8749B]


def seeded(seed, target_index, attempt):
    state = make_state()
    seed_stream(np.uint64(seed), np.int64(target_index), attempt, state)
    return state


def test_the_published_words_come_out_of_state_zero():
    state = make_state()
    assert [int(next_word(state)) for _ in PUBLISHED] == PUBLISHED


@few
@given(word=words)
def test_words_equal_python_integers(word):
    state, stream = make_state(word), reference.Stream(word)
    assert [int(next_word(state)) for _ in range(5)] == [stream.word() for _ in range(5)]
    assert int(state[0]) == stream.state


@few
@given(seed=words, target_index=st.integers(0, 2**40), attempt=st.integers(0, 10_000))
def test_streams_start_like_the_twin(seed, target_index, attempt):
    expected = reference.Stream.for_attempt(seed, target_index, attempt).state
    assert int(seeded(seed, target_index, attempt)[0]) == expected


@few
@given(word=words)
def test_uniform_numbers_lie_from_zero_to_below_one(word):
    state = make_state(word)
    value = next_uniform(state)
    assert 0.0 <= value < 1.0
    assert value == reference.Stream(word).uniform()
    assert (value * 2**53).is_integer()


@few
@given(word=words, count=st.integers(1, 10_000))
def test_indices_lie_in_their_range(word, count):
    index = next_index(make_state(word), count)
    assert 0 <= index < count
    assert index == reference.Stream(word).index(count)


def test_the_largest_word_stays_below_one():
    assert (2**64 - 1 >> 11) * 2.0**-53 < 1.0


def test_uniform_numbers_are_uniform():
    state = make_state(20211)
    values = np.array([next_uniform(state) for _ in range(20_000)])
    counts = np.histogram(values, bins=20, range=(0.0, 1.0))[0]
    assert ((counts - 1000.0) ** 2 / 1000.0).sum() < 43.8  # chi squared, 19 degrees of freedom, 0.1 %
    assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 0.03


def test_streams_differ_by_seed_target_and_attempt():
    keys = list(itertools.product([0, 1, 2, 2**63, 2**64 - 1], range(6), range(6)))
    states = {int(seeded(*key)[0]) for key in keys}
    assert len(states) == len(keys)


def test_neighbouring_streams_share_no_number():
    numbers = set()
    for attempt in range(20):
        state = seeded(0, 0, attempt)
        numbers |= {int(next_word(state)) for _ in range(500)}
    assert len(numbers) == 10_000
