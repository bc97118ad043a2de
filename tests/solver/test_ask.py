"""How a question is asked: of which engine first, and how often."""

import ikde
from ikde.solver.quick import find_quick
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
