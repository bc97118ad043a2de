"""One configuration graded alone has the bits of the grader in lanes."""

import numpy as np
import pytest

import ikde
from ikde.kernels.flat_arguments import Terms, flatten_grader
from ikde.kernels.grade_one import grade_one
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.assemble import format_module
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import KINDS
from tests.conftest import random_q
from tests.kernels.grading import ROBOTS, grade, terms_of
from tests.targets import targets_near
from tests.three_joints import CROWDED
from tests.uncompiled import reachable, run_text


@pytest.mark.parametrize("robot", ROBOTS[::3], ids=lambda robot: robot.name)
def test_it_is_the_grader_in_lanes_bit_for_bit(robot, rng):
    Q = random_q(robot, rng, 12)
    targets = targets_near(robot, Q, rng)
    for detector in (None, *robot.detectors.values()):
        terms = terms_of(robot, 0.5, 1.0)
        figures, pairs, accepted = grade(robot, detector, targets, Q, terms)
        block = flatten_grader(pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays, terms)
        for row, q in enumerate(Q):
            *errors, pair, verdict = grade_one(*block, *pack_targets(targets.take(np.array([row]))), q)
            assert np.array(errors).tobytes() == figures[row].tobytes()
            assert (pair, verdict) == (pairs[row], accepted[row])


@pytest.mark.parametrize("robot", [ikde.load_robot("qiao2021"), CROWDED], ids=lambda robot: robot.name)
@pytest.mark.parametrize("kind", KINDS)
def test_it_shares_no_code_with_what_searches_by_written_kernels(robot, kind):
    """Sines, cosines and arc tangents excepted; arguments are taken apart by functions that compute nothing."""
    module = run_text(format_module(CollisionModel.of(robot), kind))
    search = reachable(module.solve_target) | reachable(module.solve_targets)
    shared = {name.rpartition(".")[0] for name in reachable(grade_one) & search}
    assert shared <= {"ikde.kernels.trig", "ikde.kernels.flat_arguments"}
    assert {"ikde.kernels.seeds.draw_seed", "ikde.kernels.trig.sin_cos"} <= search
    assert {"ikde.kernels.clearance.compute_clearance", "ikde.kernels.frames.compute_tool"} <= reachable(grade_one)


def test_what_is_outside_the_limits_is_not_accepted(qiao):
    q, wide = qiao.home.copy(), Terms(np.array([qiao.lower, qiao.upper]), np.inf, np.inf)
    block = flatten_grader(pack_robot(qiao), CollisionModel.of(qiao, "none").arrays, wide)
    target = pack_targets([ikde.Target((0.0, 0.0, 0.0))])
    assert grade_one(*block, *target, q)[4]
    q[4] = qiao.upper[4] + 1e-9
    assert not grade_one(*block, *target, q)[4]
