"""Few targets are answered one after the other: the bits are those of lanes."""

from functools import partial

import numpy as np
import pytest

import ikde
from ikde.kernels.answer import FIRST_COUNT, METRICS, pack_row
from ikde.kernels.arrays import ATTEMPTS, REACHED
from ikde.model.target import KINDS, Target, Targets
from ikde.solver import ask as ask_module
from ikde.solver import few, referee
from ikde.solver import search as search_module
from ikde.solver.background import MANY
from ikde.solver.engine_table import ENGINES, NAMES
from ikde.solver.engines.lm import DampedLeastSquares
from ikde.solver.metrics import COLUMNS
from ikde.solver.search import search
from ikde.solver.settings import SolveSettings
from tests.problems import problem_of
from tests.targets import free_q as free_q_of
from tests.targets import make_target
from tests.three_joints import ROBOT, free_q, meet
from tests.written import written_kernels

COUNT = 12
FAR = Target((50.0, 0.0, 0.0))


@pytest.fixture(autouse=True)
def _written(monkeypatch):
    with written_kernels(monkeypatch):
        yield


@pytest.fixture(scope="module")
def ur5():
    return ikde.load_robot("ur5")


def targets_of(*kinds):
    return [meet(ROBOT, q, kinds[k % len(kinds)]) for k, q in enumerate(free_q(COUNT))]


def answer_few(problem, targets):
    return few.answer_few(problem, Targets.of(targets), seed=0, streams=range(len(targets)))


def refuse_lanes(monkeypatch):
    monkeypatch.setattr(search_module, "make_engine", lambda *arguments: pytest.fail("lanes run"))


def assert_same(ours, theirs):
    for name in ("q", "score", "counts", "excess_m", "excess_rad", "ruled_out", "engine"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name
    for name in COLUMNS:
        assert getattr(ours.metrics, name).tolist() == getattr(theirs.metrics, name).tolist()
    for row in range(len(ours.q)):
        assert ours.pair_counts.row(row).tolist() == theirs.pair_counts.row(row).tolist()


def search_both(problem, targets, monkeypatch, *, lanes=False, seed=2**64 - 5):
    """What is found one by one, compared with what lanes find."""
    asked = {"seed": seed, "streams": range(7, 7 + len(targets))}
    with monkeypatch.context() as patch:
        if not lanes:
            refuse_lanes(patch)
        ours = search(problem, targets, **asked)
    with monkeypatch.context() as patch:
        patch.setattr(search_module, "answer_few", lambda *arguments, **options: None)
        assert_same(ours, search(problem, targets, **asked))
    return ours


@pytest.mark.parametrize("kinds", [("position",), ("pose",), KINDS], ids=str)
def test_the_answers_are_those_of_lanes(kinds, monkeypatch):
    found = search_both(problem_of(ROBOT), targets_of(*kinds), monkeypatch)
    assert (found.seconds > 0.0).all()
    assert set(found.engine.tolist()) == {NAMES.index("lm")}


@pytest.mark.parametrize("changes", [{"near": "home"}, {"freeze": 0}, {"near": "home", "freeze": 0}], ids=str)
def test_with_near_and_frozen_joints_too(changes, monkeypatch):
    q = free_q(COUNT)[3]
    known = {"near": q + 0.02, "freeze": {ROBOT.joint_names[0]: float(q[0])}}
    problem = problem_of(ROBOT, SolveSettings(method="lm"), **{name: known[name] for name in changes})
    search_both(problem, [meet(ROBOT, q, "position")] * 3, monkeypatch)


@pytest.mark.slow
def test_the_closed_form_answers_few_as_it_answers_many(ur5, rng, monkeypatch):
    far, problem = Target((50.0, 0.0, 0.0), R_world_tool=np.eye(3)), problem_of(ur5, SolveSettings())
    targets = [make_target(ur5, free_q_of(ur5, rng), "pose") for _ in range(6)]
    found = search_both(problem, [*targets, far], monkeypatch)
    assert found.engine[:6].tolist() == [NAMES.index("analytic")] * 6
    assert (found.excess_m > 0.0).tolist() == [False] * 6 + [True]


@pytest.mark.slow
def test_where_kinds_are_mixed_the_closed_form_is_not_asked(ur5, rng):
    """Lanes ask it about poses alone."""
    targets = [make_target(ur5, free_q_of(ur5, rng), kind) for kind in ("pose", "position")]
    problem = problem_of(ur5, SolveSettings())
    assert answer_few(problem, targets) is None
    assert answer_few(problem, targets[:1]) is not None


def test_a_timeout_needs_the_clocks_of_lanes():
    assert answer_few(problem_of(ROBOT, SolveSettings(timeout_s=9.0)), targets_of("position")) is None


def test_ranges_beyond_the_limits_are_not_asked_about():
    """What is proved of the robot's own ranges does not hold there: a probe asks what wider ones would bring."""
    problem = problem_of(ROBOT)
    wide = problem.with_ranges(problem.lower - 0.1, problem.upper)
    stiff = problem.with_ranges(problem.lower, np.where(np.arange(3) == 1, problem.lower, problem.upper))
    narrow = problem.with_ranges(problem.lower + 0.1, problem.upper)
    answered = [answer_few(asked, targets_of("position")) is not None for asked in (problem, narrow, wide, stiff)]
    assert answered == [True, True, False, False]


def test_pairs_that_blocked_are_counted(rng):
    problem = problem_of(ROBOT)
    pairs, asked = len(problem.collision.pairs), few._find_asked(problem, {0})
    blocked = rng.integers(0, 3, (3, pairs)) * np.array([[1], [0], [1]])
    counts = [[1, 5, 9, int(row.sum()), 0] for row in blocked]
    rows = few._Rows(problem, Targets.of(targets_of("position")[:3]), asked)
    for place, row in enumerate(zip(counts, blocked, strict=True)):
        rows._rows[place] = pack_row(rng.random(3), [1e-6, 1e-7, 0.1], 1, *row)
    found = rows._found(1.0)
    assert [found.pair_counts.filled[row].tolist() for row in range(3)] == blocked.tolist()
    assert found.counts.tolist() == counts
    assert found.metrics.closest_pair.tolist() == [1] * 3


@pytest.mark.parametrize("count", [few.MAX_FEW, few.MAX_FEW + 1])
def test_beyond_a_few_there_are_lanes(count):
    made = answer_few(problem_of(ROBOT), (targets_of("position") * 4)[:count])
    assert (made is not None) == (count <= few.MAX_FEW)


@pytest.mark.parametrize(("count", "plain"), [(few.MAX_FEW, 0), (few.MAX_FEW + 1, 1), (few.MAX_WITHOUT_LANES + 1, 0)])
def test_until_lanes_are_compiled_more_than_a_few_are_answered_one_by_one(count, plain, substitute):
    problem, asked = problem_of(ROBOT), []
    substitute(few.answers_plainly, lambda answer, question: asked.append(question) or True)
    few.prepare.cache_clear()  # no lanes have run
    made = answer_few(problem, (targets_of("position") * 100)[:count])
    assert (made is not None) == (count <= few.MAX_WITHOUT_LANES)
    assert [question.call for question in asked if question.call == MANY] == [MANY] * plain


def test_lanes_that_have_run_are_not_asked_for_again(substitute):
    problem, targets = problem_of(ROBOT), targets_of("position") * 3
    search(problem, targets, seed=0, streams=range(36))
    substitute(few.answers_plainly, lambda answer, question: pytest.fail("asked for"))
    assert answer_few(problem, targets) is None


def test_what_a_few_attempts_do_not_reach_is_proved_or_goes_on(monkeypatch):
    """After one attempt each, which reaches some of them; one is out of reach, which is proved before the next."""
    row = ENGINES["lm"]._replace(attempts_before_proof=1)
    for module in (ask_module, search_module):
        monkeypatch.setattr(module, "ENGINES", {**ENGINES, "lm": row})
    few.find_ask.cache_clear()
    few.find_asker.cache_clear()
    found = search_both(problem_of(ROBOT), [*targets_of("axis"), FAR], monkeypatch, seed=3)
    tried = found.counts[:, ATTEMPTS]
    assert (tried[:-1] > 1).any()
    assert (tried == 1).any()
    assert (tried[-1], found.excess_m[-1] > 0.0) == (1, True)


def test_rows_that_stay_open_are_left_to_lanes(monkeypatch):
    """What is reached is not searched or graded again."""
    problem, graded = problem_of(ROBOT, SolveSettings(method="lm", restarts=1)), []
    grade = referee.compute_metrics

    def count(collision, targets, *others, **limits):
        graded.append(len(targets))
        return grade(collision, targets, *others, **limits)

    monkeypatch.setattr(referee, "compute_metrics", count)
    found = search_both(problem, targets_of("axis", "pose"), monkeypatch, lanes=True, seed=3)
    missed = int((found.counts[:, REACHED] == 0).sum())
    assert 0 < missed < COUNT
    assert graded[0] == missed


def test_where_all_others_are_out_of_reach_nothing_else_is_compiled(monkeypatch):
    problem, targets = problem_of(ROBOT), [*targets_of("position"), FAR]
    monkeypatch.setattr(DampedLeastSquares, "call", lambda *arguments: pytest.fail("lanes run"))
    monkeypatch.setattr(referee, "compute_metrics", lambda *arguments, **options: pytest.fail("graded again"))
    found = search(problem, targets, seed=0, streams=range(len(targets)))
    assert found.counts[:-1, ATTEMPTS].all()
    assert found.excess_m[-1] > 0.0


def test_what_the_grader_refuses_is_left_to_lanes(monkeypatch):
    """They then say that it is refused, and go on."""
    problem, ask = problem_of(ROBOT), few.find_ask(problem_of(ROBOT), "pose")
    monkeypatch.setattr(few, "find_ask", lambda *asked: Refusing(ask))
    found = answer_few(problem, targets_of("pose"))
    assert not found.counts.any()
    assert not found.q.any()
    assert np.isinf(found.score).all()
    assert not found.is_settled


class Refusing:
    """Answers are reached, but not accepted."""

    is_ready = True

    def __init__(self, ask):
        self._ask, self.plan, self.ways, self.settle, self.engine = ask, ask.plan, ask.ways, ask.settle, ask.engine
        self.answer = partial(self._answer, ask.answer)

    def _answer(self, answer, *arguments):
        answer(*arguments)
        row = arguments[-1]
        assert row[3 + METRICS :].view(np.int64)[FIRST_COUNT + REACHED] == 1
        return False
