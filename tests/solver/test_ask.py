"""How a question is asked: of which engine first, and how often."""

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver.ask import Ask, make_plan
from ikde.solver.asker import Asker
from ikde.solver.engine_table import ENGINES
from ikde.solver.quick import find_quick
from tests.problems import problem_of
from tests.quick_ways import AUTO, make_quick
from tests.targets import free_q, make_target

UR5 = ikde.load_robot("ur5")


def test_the_quick_way_for_poses_is_that_of_arms_that_alone_may_move(monkeypatch):
    monkeypatch.delenv("IKDE_KERNELS")
    qiao = ikde.load_robot("qiao2021")

    def is_closed(robot, method, kind):
        found = find_quick.__wrapped__(robot, None, method, None, kind)
        return found and found.plan.is_closed

    assert is_closed(UR5, "auto", "pose") is is_closed(UR5, "analytic", "pose") is True
    assert is_closed(UR5, "lm", "pose") is is_closed(UR5, "auto", "axis") is is_closed(qiao, "auto", "pose") is False
    assert is_closed(qiao, "analytic", "pose") is is_closed(UR5, "analytic", "axis") is None


def test_no_more_attempts_are_made_than_the_settings_allow(rng):
    panda = ikde.load_robot("panda")
    once, harder = AUTO.with_changes(method="lm", restarts=1), 0
    quick, way = make_quick(panda, "pose", once), make_quick(panda, "pose")
    for stream in range(40):
        target = make_target(panda, free_q(panda, rng), "pose")
        usual = way.solve(target, 4, stream, 0.0)
        if usual is None or usual.attempts == 1:
            continue
        assert quick.solve(target, 4, stream, 0.0) is None
        harder += 1
    assert harder > 0


def test_with_a_timeout_a_few_attempts_are_all_so_that_the_clock_is_heard(qiao):
    collision, free = CollisionModel.of(qiao), {*range(9)}
    usual, hurried = (make_plan(collision, s, "pose", free) for s in (AUTO, AUTO.with_changes(timeout_s=1e-6)))
    assert usual.few == hurried.few == hurried.all == ENGINES["lm"].attempts_before_proof
    assert usual.all == ENGINES["lm"].attempts_before_next > usual.few


def counted(quick, accepts):
    """The first attempts of the calls that are made; what they answer is `accepts`, but of the first one."""
    answer, begun = quick.answer, []

    def count(T, seed, stream, first, last, row):
        answer(T, seed, stream, first, last, row)
        begun.append(first)
        return accepts and len(begun) > 1

    quick.answer = count
    return begun


def test_what_is_reached_but_refused_is_not_searched_on_here(qiao):
    """The referee of the long way says that it is refused, and goes on from there."""
    quick = make_quick(qiao, "position")
    begun = counted(quick, accepts=True)
    assert quick.solve(make_target(qiao, qiao.home, "position"), 0, 0, 0.0) is None
    assert begun == [0]


def test_after_all_attempts_there_is_no_further_call(rng):
    panda = ikde.load_robot("panda")
    quick = make_quick(panda, "pose", AUTO.with_changes(method="lm", restarts=1))
    assert quick.plan.all == quick.plan.few
    answer = quick.answer
    for stream in range(40):
        quick.answer = answer
        begun = counted(quick, accepts=False)
        quick.solve(make_target(panda, free_q(panda, rng), "pose"), 4, stream, 0.0)
        assert begun == [0]


def test_on_tables_there_is_no_quick_way(qiao, monkeypatch):
    """Engine and grader would share their code."""
    problem, ways = problem_of(qiao, AUTO, near=qiao.home), []
    for kernels in ("tables", "written"):
        monkeypatch.setenv("IKDE_KERNELS", kernels)
        single = find_quick.__wrapped__(qiao, None, "auto", None, "position")
        ways.append((single is not None, Asker(problem.collision, AUTO, "position").make(problem, Ask) is not None))
    assert ways == [(False, False), (True, True)]
