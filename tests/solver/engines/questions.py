"""Questions for engines: problems with targets that can be reached."""

import numpy as np

import ikde
from ikde.solver.engines.engine import SearchInputs
from ikde.solver.engines.pool import make_seeds
from ikde.solver.engines.search_state import make_search_state
from tests.problems import problem_of
from tests.targets import free_q, make_target


def make_question(robot, rng, kinds, *, settings=None, freeze=None, near=None, seed=1):
    """A question with a reachable target of each kind."""
    problem = problem_of(robot, settings, near=near, freeze=freeze)
    targets = ikde.Targets.of([make_target(robot, free_q(robot, rng), kind) for kind in kinds])
    found = make_search_state(problem, len(targets))
    return SearchInputs(problem, targets, found, seed=seed, streams=range(len(targets))), targets


def make_pool(robot, kind="pose", **options):
    """Seeds for targets of a kind."""
    return make_seeds(problem_of(robot, **options), kind)


def assert_solved(question, targets):
    """Plain numpy accepts every row."""
    problem, found = question.problem, question.found
    graded = ikde.solver.verify.verify_many(problem.collision, targets, found.q, problem.settings)
    assert found.counts[:, 0].all()
    assert graded.accepted.all()


def run(engine, count, attempts):
    """All attempts on all rows, call by call."""
    last = np.full(count, attempts)
    for first in range(0, attempts, engine.attempts_per_call):
        for begin in range(0, count, engine.rows_per_call):
            engine.call(range(begin, min(begin + engine.rows_per_call, count)), first, last)
