"""A sample by itself: the evolution of `kernels/evolution.py` with random numbers of its own."""

import numpy as np

from ikde.kernels.evolution import evolve, make_workspace
from ikde.kernels.rng import seed_stream
from ikde.kernels.sample_evolution import evolve_alone
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.track.typical import TypicalSettings, bound_sample, pack_search
from tests.track.paper_tasks import follower_of, short_task, start_of


def test_it_is_one_population_on_the_stream_of_its_sample(qiao):
    follower, sample = follower_of(qiao, short_task(1), detector=False), 3
    settings = TypicalSettings(generations=20)
    robot, detector, search = pack_robot(qiao), CollisionModel.of(qiao, "none").arrays, pack_search(follower, settings)
    lower, upper = bound_sample(follower, settings, start_of("qiao2021", 1))
    work, q, state = make_workspace(robot, detector, 9, 50), np.zeros(9), np.zeros(1, dtype=np.uint64)
    evolve_alone(robot, detector, follower.target, sample, search, lower, upper, np.uint64(5), work, q)
    seed_stream(np.uint64(5), np.int64(sample), np.int64(0), state)
    best, _, _ = evolve(robot, detector, follower.target, sample, search, lower, upper, state, work)
    np.testing.assert_array_equal(q, work.x[best])
    assert ((q >= lower) & (q <= upper)).all()
