"""Success-history adaptation against naive twins, and its laws."""

import numpy as np
import pytest

from ikde.kernels.arrays import MemeticArrays
from ikde.kernels.memetic import make_memetic_workspace
from ikde.kernels.success_history import (
    ARCHIVED,
    PLACE,
    TERMINAL,
    add_success,
    add_to_archive,
    draw_cauchy,
    draw_crossover,
    draw_normal,
    draw_weight,
    drop_worst,
    lehmer_mean,
    make_history,
    plan_population,
    pull_factor,
    reset_history,
    soften,
    sort_members,
    trim_archive,
    update_memory,
)
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests import reference, reference_memetic
from tests.kernels.arrays import make_state

pytestmark = pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # numpy's scalars, uncompiled


def draw(kernel, count, *arguments, seed=5):
    state = make_state(seed)
    return np.array([kernel(state, *arguments) for _ in range(count)])


def make_pair(memetic):
    """A kernel's history and its twin."""
    history = make_history(memetic.memory, 20, 20, 3)
    reset_history(history, memetic.first_weight, memetic.first_crossover, memetic.is_weighted)
    return history, reference_memetic.History(memetic)


def test_cauchy_numbers_equal_the_twin_and_have_their_quartiles():
    numbers, stream = draw(draw_cauchy, 4000), reference.Stream(5)
    np.testing.assert_allclose(numbers, [reference_memetic.draw_cauchy(stream) for _ in numbers], rtol=1e-9)
    np.testing.assert_allclose(np.quantile(numbers, [0.25, 0.5, 0.75]), [-1.0, 0.0, 1.0], atol=0.1)


def test_normal_numbers_equal_the_twin_and_have_their_moments():
    numbers, stream = draw(draw_normal, 4000), reference.Stream(5)
    np.testing.assert_allclose(numbers, [reference_memetic.draw_normal(stream) for _ in numbers], rtol=0, atol=1e-13)
    assert abs(numbers.mean()) < 0.06
    assert numbers.std() == pytest.approx(1.0, abs=0.04)
    assert np.mean(np.abs(numbers) < 1.0) == pytest.approx(0.683, abs=0.03)


@pytest.mark.parametrize("mean", [0.0, 0.3, 0.95])
def test_weights_and_crossovers_equal_the_twin_and_keep_their_bounds(mean):
    weights, stream = draw(draw_weight, 500, mean), reference.Stream(5)
    np.testing.assert_allclose(weights, [reference_memetic.draw_weight(stream, mean) for _ in weights], rtol=1e-9)
    assert np.all((weights > 0.0) & (weights <= 1.0))
    crossovers, stream = draw(draw_crossover, 500, mean), reference.Stream(5)
    np.testing.assert_allclose(
        crossovers, [reference_memetic.draw_crossover(stream, mean) for _ in crossovers], atol=1e-13
    )
    assert np.all((crossovers >= 0.0) & (crossovers <= 1.0))


def test_a_terminal_mean_gives_crossovers_of_0_and_draws_nothing():
    state = make_state(5)
    assert draw_crossover(state, TERMINAL) == 0.0
    assert state[0] == 5


def test_the_lehmer_mean_equals_its_formula(rng):
    for count in range(1, 10):
        success = rng.uniform(size=(12, 3))
        for column in (0, 1):
            expected = reference_memetic.lehmer_mean(success[:count, column], success[:count, 2])
            assert lehmer_mean(success, count, column) == pytest.approx(expected, rel=1e-13)
    assert lehmer_mean(np.zeros((3, 3)), 3, 1) == 0.0


@pytest.mark.parametrize("is_weighted", [False, True])
@pytest.mark.parametrize("memory", [2, 5])
def test_the_memory_is_written_like_the_twin(is_weighted, memory, rng):
    memetic = MemeticArrays(memory=memory, is_weighted=is_weighted)
    history, twin = make_pair(memetic)
    for generation in range(12):
        for _ in range(rng.integers(5)):
            win = (rng.uniform(0.1, 1.0), 0.0 if generation == 7 else rng.uniform(), rng.uniform())
            add_success(history, *win)
            twin.wins.append(win)
        update_memory(history, is_weighted)
        twin.update()
        np.testing.assert_allclose(history.weight, twin.weight, rtol=1e-12)
        expected = [TERMINAL if mean is None else mean for mean in twin.crossover]
        np.testing.assert_allclose(history.crossover, expected, rtol=1e-12)
        assert history.counts[PLACE] == twin.place
    if is_weighted:
        assert history.weight[-1] == history.crossover[-1] == 0.9


def test_wins_without_a_gain_teach_nothing():
    history, _ = make_pair(MemeticArrays())
    before = history.weight.tobytes(), history.crossover.tobytes(), history.counts[PLACE]
    add_success(history, 0.3, 0.3, 0.0)
    update_memory(history, True)
    assert before == (history.weight.tobytes(), history.crossover.tobytes(), history.counts[PLACE])


def test_the_archive_grows_replaces_and_is_trimmed_like_the_twin(rng):
    history, twin = make_pair(MemeticArrays())
    state, stream, x = make_state(9), reference.Stream(9), rng.uniform(size=(40, 3))
    for i in range(40):
        add_to_archive(state, history, 15, x, i)
        twin.put(stream, x[i], 15)
        assert history.counts[ARCHIVED] == min(i + 1, 15)
    for capacity in (15, 11, 4, 0):
        trim_archive(state, history, capacity)
        twin.trim(stream, capacity)
        assert history.counts[ARCHIVED] == capacity
        np.testing.assert_array_equal(history.archive[:capacity], np.reshape(twin.archive, (-1, 3)))
    add_to_archive(state, history, 0, x, 0)
    assert history.counts[ARCHIVED] == 0
    assert int(state[0]) == stream.state


def test_the_population_shrinks_linearly_from_first_to_last():
    sizes = [plan_population(60, 8, progress) for progress in np.linspace(0.0, 1.0, 53)]
    assert sizes == list(range(60, 7, -1))


def test_jso_rules_by_progress():
    assert [soften(0.9, 0.1, progress) for progress in (0.0, 0.3, 0.55, 0.7)] == [
        (0.7, 0.7),
        (0.7, 0.6),
        (0.7, 0.1),
        (0.9, 0.1),
    ]
    assert [pull_factor(progress) for progress in (0.0, 0.2, 0.39, 0.4, 1.0)] == [0.7, 0.8, 0.8, 1.2, 1.2]


def test_members_are_sorted_and_the_worst_dropped(qiao, rng):
    detector = CollisionModel.of(qiao).arrays
    work = make_memetic_workspace(pack_robot(qiao), detector, 9, MemeticArrays(first_population=30))
    members = work.members
    members.x[:], members.score[:, 0] = rng.uniform(size=(30, 9)), rng.uniform(size=30)
    members.score[:, 1] = np.maximum(0.0, rng.uniform(-0.5, 0.5, 30))
    work.order[:], work.fresh[:] = rng.permutation(30), rng.integers(2, size=30)
    everyone = sorted(zip(members.score[:, ::-1].tolist(), members.x.tolist(), work.fresh.tolist(), strict=True))
    sort_members(members.score, work.order, 30)
    for kept in (30, 29, 11, 4):
        drop_worst(members, work.order, work.fresh, 30 if kept == 29 else {30: 30, 11: 29, 4: 11}[kept], kept)
        order = work.order[:kept]
        assert sorted(order) == list(range(kept))
        left = [(members.score[i, ::-1].tolist(), members.x[i].tolist(), int(work.fresh[i])) for i in order]
        assert left == everyone[:kept]
