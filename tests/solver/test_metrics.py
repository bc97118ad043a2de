"""The kernels' metrics in bulk: plain numpy confirms them, on every robot."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import VerificationError
from ikde.model.collision_model import CollisionModel
from ikde.solver.metrics import (
    AGREEMENT,
    compute_clearances,
    compute_disagreement,
    compute_metrics,
    judge_clearances,
    measure_scale,
)
from ikde.solver.plain import compute_gaps
from ikde.solver.verify import verify_many
from tests.conftest import random_q
from tests.random_robots import random_robot

SETTINGS = ikde.SolveSettings()


def targets_of_every_kind(robot, count):
    T = ikde.forward(robot, robot.home)[robot.tool]
    kinds = [{}, {"axis_world_tool": T[:3, 2]}, {"R_world_tool": T[:3, :3]}]
    return [ikde.Target(T[:3, 3], **kinds[k % 3]) for k in range(count)]


def test_kernels_and_plain_numpy_agree_on_every_robot(any_robot, rng):
    Q, targets = random_q(any_robot, rng, 60), targets_of_every_kind(any_robot, 60)
    for detector in [None, *any_robot.detectors.values()]:
        metrics = compute_metrics(CollisionModel(robot=any_robot, detector=detector), targets, Q)
        verdicts = verify_many(CollisionModel(robot=any_robot, detector=detector), targets, Q, SETTINGS)
        assert np.all(compute_disagreement(targets, metrics, verdicts) < 0.1 * AGREEMENT)
        if detector is None:
            assert set(metrics.closest_pair) == {-1}
        else:  # two pairs may be equally close, where one sphere belongs to both components
            closest = np.take_along_axis(verdicts.gaps_m, metrics.closest_pair[:, None], axis=1)[:, 0]
            assert closest == pytest.approx(verdicts.clearance_m, abs=1e-12)


def test_a_figure_that_is_not_a_number_never_agrees(qiao):
    targets, Q = targets_of_every_kind(qiao, 2), np.array([qiao.home, qiao.home])
    metrics = compute_metrics(CollisionModel.of(qiao), targets, Q)
    metrics.clearance_m[1] = np.nan
    verdicts = verify_many(CollisionModel.of(qiao), targets, Q, SETTINGS)
    agree = compute_disagreement(targets, metrics, verdicts) <= AGREEMENT
    assert agree.tolist() == [True, False]


def test_far_from_the_origin_agreement_is_relative(qiao):
    q = qiao.home
    target = [ikde.Target((5e4, 0.0, 0.0))]
    metrics = compute_metrics(CollisionModel.of(qiao, "none"), target, q[None])
    verdicts = verify_many(CollisionModel.of(qiao, "none"), target, q[None], SETTINGS)
    absolute = abs(metrics.position_error_m[0] - verdicts.position_error_m[0])
    assert compute_disagreement(target, metrics, verdicts)[0] == pytest.approx(absolute / 5e4)


def stretch(robot, share):
    """The robot with slides, places and spheres so many times as large, at most what a robot may be."""
    joints = [
        replace(joint, **{end: share * getattr(joint, end) for end in ("lower", "upper", "home")})
        for joint in robot.joints
    ]
    slides = tuple(new if new.kind == "prismatic" else old for new, old in zip(joints, robot.joints, strict=True))
    frames = tuple(replace(frame, p_parent_frame=share * frame.p_parent_frame) for frame in robot.frames)
    return replace(robot, joints=slides, frames=frames)


@pytest.mark.parametrize("seed", range(6))
def test_the_largest_robot_that_loads_is_graded_wherever_its_target_is(seed):
    robot, rng = stretch(random_robot(seed), 5e4), np.random.default_rng(seed)
    Q, targets = random_q(robot, rng, 60), targets_of_every_kind(random_robot(seed), 60)
    detector = CollisionModel.of(robot).detector
    metrics, verdicts = (
        compute_metrics(CollisionModel(robot=robot, detector=detector), targets, Q),
        verify_many(CollisionModel(robot=robot, detector=detector), targets, Q, SETTINGS),
    )
    assert np.all(compute_disagreement(targets, metrics, verdicts) <= 0.1 * AGREEMENT)
    assert len(compute_clearances(CollisionModel(robot=robot, detector=detector), Q).clearance_m) == 60


def test_a_small_robot_is_graded_to_the_last_digit(qiao):
    """What a robot below 100 m is graded by does not grow with it."""
    assert measure_scale(qiao, np.zeros((1, 3)), qiao.upper[None]) == 1.0


def test_clearances_are_what_check_says(qiao, rng):
    Q = random_q(qiao, rng, 50)
    for name in ("typical", "improved"):
        seen = compute_clearances(CollisionModel.of(qiao, name), Q)
        checked = [ikde.check(qiao, q, name) for q in Q]
        assert seen.clearance_m == pytest.approx([c.clearance_m for c in checked], abs=1e-12)
        assert seen.collides.tolist() == [c.collision for c in checked]


def test_a_clearance_that_only_the_kernels_see_raises(qiao, substitute):
    substitute(compute_gaps, lambda collision, Q: np.full((len(Q), 1), 0.5))
    with pytest.raises(VerificationError, match="disagree"):
        compute_clearances(CollisionModel.of(qiao), qiao.home[None])


def test_a_clearance_that_is_not_a_number_is_never_free(qiao):
    collision = CollisionModel.of(qiao)
    metrics = compute_metrics(collision, targets_of_every_kind(qiao, 3), np.tile(qiao.home, (3, 1)))
    metrics.clearance_m[1] = np.nan
    assert judge_clearances(metrics, collision).tolist() == [False, True, False]
