"""The engine `memetic`: what is asked beyond the everyday."""

from dataclasses import replace

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver.engines.memetic import Memetic
from tests.solver.engines.questions import assert_solved, make_question, run


def test_targets_of_all_kinds_are_solved(qiao, rng):
    question, targets = make_question(qiao, rng, ("pose", "position", "axis"))
    run(Memetic(question), 3, 3)
    assert_solved(question, targets)


def test_a_clearance_with_a_horizontal_axis_is_found_and_with_a_vertical_one_its_pair_is_named(qiao):
    wide = replace(CollisionModel.of(qiao).detector, safe_distance_m=0.03)
    brief = ikde.SolveSettings(method="memetic", restarts=2)
    flat = ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0), axis_world_tool=(1, 0, 0)), brief, collision=wide)
    assert flat.reached
    assert flat.clearance_m > 0.03
    upright = ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0), axis_world_tool=(0, 0, -1)), brief, collision=wide)
    assert upright.stop_reason == "collision"
    assert next(iter(upright.blocking_pairs)) == ("J4", "J6")
    assert "J4-J6" in upright.reason
