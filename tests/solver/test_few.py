"""Few targets are answered one after the other: the bits are those of lanes."""

from functools import partial

import numpy as np
import pytest

from ikde.kernels.answer import pack_row
from ikde.kernels.arrays import ATTEMPTS
from ikde.model.target import KINDS, Target, Targets
from ikde.solver import few, referee
from ikde.solver import search as search_module
from ikde.solver.background import MANY
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.lm import DampedLeastSquares
from ikde.solver.engines.search_state import make_search_state
from ikde.solver.metrics import COLUMNS
from ikde.solver.search import search
from tests.problems import problem_of
from tests.three_joints import ROBOT, free_q, meet
from tests.written import written_kernels

COUNT = 12


@pytest.fixture(autouse=True)
def _written(monkeypatch):
    with written_kernels(monkeypatch):
        yield
    few.find_answer.cache_clear()


def targets_of(*kinds):
    return [meet(ROBOT, q, kinds[k % len(kinds)]) for k, q in enumerate(free_q(COUNT))]


def assert_same(ours, theirs):
    for name in ("q", "score", "counts", "excess_m", "engine"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name
    for name in COLUMNS:
        assert getattr(ours.metrics, name).tolist() == getattr(theirs.metrics, name).tolist()
    for row in range(len(ours.q)):
        assert ours.pair_counts.row(row).tolist() == theirs.pair_counts.row(row).tolist()


@pytest.mark.parametrize("kinds", [("position",), ("pose",), KINDS], ids=str)
def test_the_answers_are_those_of_lanes(kinds, monkeypatch):
    problem, asked = problem_of(ROBOT), {"seed": 2**64 - 5, "streams": range(7, 7 + COUNT)}
    ours = search(problem, targets_of(*kinds), **asked)
    assert few.find_answer.cache_info().currsize == len(kinds)  # lanes never ran
    assert (ours.seconds > 0.0).all()
    monkeypatch.setattr(few, "FEW", 0)
    assert_same(ours, search(problem, targets_of(*kinds), **asked))


def test_pairs_that_blocked_are_counted(rng):
    problem = problem_of(ROBOT)
    found, pairs = make_search_state(problem, 3), len(problem.collision.pairs)
    blocked = rng.integers(0, 3, (3, pairs)) * np.array([[1], [0], [1]])
    counts = [[1, 5, 9, int(row.sum()), 0] for row in blocked]
    rows = [pack_row(rng.random(3), [1e-6, 1e-7, 0.1], 1, *row) for row in zip(counts, blocked, strict=True)]
    few._unpack(np.array(rows), found)
    found.pair_counts.keep(0, np.arange(3))
    assert found.counts.tolist() == counts
    assert [found.pair_counts.row(row).tolist() for row in range(3)] == blocked.tolist()
    assert found.metrics.closest_pair.tolist() == [1] * 3


@pytest.mark.parametrize("count", [few.FEW, few.FEW + 1])
def test_beyond_a_few_there_are_lanes(count):
    problem, targets = problem_of(ROBOT), targets_of("position")
    some = make_search_state(problem, count)
    asked = (targets * 4)[:count]

    made = few.answer_few(problem, Targets.of(asked), some, 64, seed=0, streams=range(count))
    assert made == (16 if count <= few.FEW else 0)


@pytest.mark.parametrize(("count", "plain"), [(few.FEW, 0), (few.FEW + 1, 1), (few.FEW_WITHOUT_LANES + 1, 0)])
def test_until_lanes_are_compiled_more_than_a_few_are_answered_one_by_one(count, plain, substitute):
    problem, asked = problem_of(ROBOT), []
    substitute(few.answers_plainly, lambda answer, question: asked.append(question) or True)
    targets, some = (targets_of("position") * 100)[:count], make_search_state(problem, count)
    few.prepare.cache_clear()  # no lanes have run
    made = few.answer_few(problem, Targets.of(targets), some, 16, seed=0, streams=range(count))
    assert made == (16 if count <= few.FEW_WITHOUT_LANES else 0)
    assert [question.call for question in asked if question.call == MANY] == [MANY] * plain


def test_lanes_that_have_run_are_not_asked_for_again(substitute):
    problem, targets = problem_of(ROBOT), targets_of("position") * 3
    search(problem, targets, seed=0, streams=range(36))
    substitute(few.answers_plainly, lambda answer, question: pytest.fail("asked for"))
    assert not few.answer_few(
        problem, Targets.of(targets), make_search_state(problem, 36), 16, seed=0, streams=range(36)
    )


FAR = Target((50.0, 0.0, 0.0))


def test_what_a_few_attempts_do_not_reach_lanes_go_on_with(monkeypatch):
    """After one attempt each, which reaches some of them; one is out of reach, which is proved before the next."""
    row = ENGINES["lm"]._replace(attempts_before_proof=1)
    for module in (few, search_module):
        monkeypatch.setattr(module, "ENGINES", {**ENGINES, "lm": row})
    problem, targets = problem_of(ROBOT), [*targets_of("axis"), FAR]
    asked = {"seed": 3, "streams": range(len(targets))}
    ours = search(problem, targets, **asked)
    tried = ours.counts[:, ATTEMPTS]
    assert (tried[:-1] > 1).any()
    assert (tried == 1).any()
    assert (tried[-1], ours.excess_m[-1] > 0.0) == (1, True)
    monkeypatch.setattr(few, "FEW", 0)
    assert_same(ours, search(problem, targets, **asked))


def test_where_all_others_are_out_of_reach_nothing_else_is_compiled(monkeypatch):
    problem, targets = problem_of(ROBOT), [*targets_of("position"), FAR]
    monkeypatch.setattr(DampedLeastSquares, "call", lambda *arguments: pytest.fail("lanes run"))
    monkeypatch.setattr(referee, "compute_metrics", lambda *arguments, **options: pytest.fail("graded again"))
    found = search(problem, targets, seed=0, streams=range(len(targets)))
    assert found.counts[:-1, ATTEMPTS].all()
    assert found.excess_m[-1] > 0.0


def test_where_the_grader_refuses_one_nothing_is_filled(substitute):
    """Lanes then say that it is refused, and go on."""
    problem, find = problem_of(ROBOT), few.find_answer

    def find_refused(problem, kind):
        way, begin = find(problem, kind)
        return Refusing(way), partial(Refusing(way).begin, *begin.args)

    substitute(find, find_refused)
    found = make_search_state(problem, COUNT)
    assert not few.answer_few(problem, Targets.of(targets_of("pose")), found, 64, seed=0, streams=range(COUNT))
    assert not found.counts.any()
    assert np.isinf(found.score).all()


class Refusing:
    """A way whose answers are reached, but not accepted."""

    machine = None

    def __init__(self, way):
        self._way, self.take_waited_s = way, way.take_waited_s

    def begin(self, *arguments):
        """As of a way."""
        self._way.begin(*arguments)
        return False
