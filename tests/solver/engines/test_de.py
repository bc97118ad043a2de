"""The engine `de`, that of the papers."""

import ikde
from ikde.solver.engines.de import LANES_PER_CALL, DifferentialEvolution
from tests.solver.engines.questions import assert_solved, make_question, run

BEST = ikde.SolveSettings.for_method("de").with_changes(
    de={"strategy": "best/1", "collision": "feasibility"}, restarts=32
)


def test_targets_are_solved(qiao, rng):
    question, targets = make_question(qiao, rng, ("position",) * 3, settings=BEST)
    run(DifferentialEvolution(question), 3, 32)
    assert_solved(question, targets)


def test_short_searches_share_a_call_and_long_ones_do_not(qiao, rng):
    short = BEST.with_changes(de={"population": 6, "generations": 1}, restarts=1)
    assert (
        DifferentialEvolution(make_question(qiao, rng, ("position",), settings=short)[0]).rows_per_call
        == LANES_PER_CALL
    ), DifferentialEvolution
    assert DifferentialEvolution(make_question(qiao, rng, ("position",), settings=BEST)[0]).rows_per_call == 1
