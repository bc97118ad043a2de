"""A no that a sweep of the joint under an arm proves: never of what can be reached, and said with what stands there."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.kernels.arrays import REACHED
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target, Targets
from ikde.solver.explain import explain
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.proof import rule_out
from ikde.solver.result import NO_SOLUTION, StopReason
from ikde.solver.search import search
from ikde.solver.sweep import ask_pieces, find_carrier, rule_out_by_sweep, tell_sweep
from ikde.solver.verify import verify
from tests.conftest import random_q
from tests.problems import problem_of

QIAO = ikde.load_robot("qiao2021")
BOXES = [[0.7, 0.3, 1.0], [-0.5, 0.6, 0.9], [0.2, -0.8, 1.3], [1.1, -0.2, 0.6], [0.5, 0.8, 1.4]]
WORLD = ikde.load_world({"obstacles": {f"b{k}": {"box": [0.3] * 3, "position": p} for k, p in enumerate(BOXES)}})
MODEL = CollisionModel.of(QIAO).in_world(WORLD)
RAIL, TURN = {"d_y": 0.0, "q_z": 0.4}, {"d_x": 0.1, "d_y": 0.0}


def on(held, model=MODEL):
    """The robot with one joint under its arm; a rail of a metre."""
    problem = problem_of(QIAO, collision=model, freeze=held)
    is_rail = np.arange(9) == 0 if "d_x" not in held else np.zeros(9, dtype=bool)
    return replace(problem, lower=np.where(is_rail, -0.5, problem.lower), upper=np.where(is_rail, 0.5, problem.upper))


def poses(rng, count):
    """Anywhere about the robot."""
    places, turns = rng.uniform([-1, -1, 0.3], [1, 1, 1.6], (count, 3)), Rotation.random(count, rng=rng).as_matrix()
    return [Target(tuple(p), R_world_tool=R) for p, R in zip(places, turns, strict=True)]


def draw_nearly_touching(problem, rng, *, is_stretched=False, is_overhead=False):
    """Free configurations with hardly any room: anywhere, with a straight elbow, or with the tool over the joint."""
    Q = random_q(QIAO, rng, 12_000)
    if is_stretched:
        arm = find_ur_arm(QIAO)
        straight = -arm.signs[2] * arm.offsets[2] + rng.choice([-1, 1], len(Q)) * 10.0 ** rng.uniform(-5, -1, len(Q))
        Q[:, arm.coordinates[2]] = straight
    Q = np.clip(Q, problem.lower, problem.upper)
    gaps = compute_gaps(MODEL, Q).min(axis=1)
    if is_overhead:
        T = compute_frames(QIAO, Q)[QIAO.tool]
        gaps[np.hypot(T[:, 0, 3] - 0.1, T[:, 1, 3]) > 0.3] = -1.0
    free = np.flatnonzero(gaps > 0.0)
    return Q[free[np.argsort(gaps[free])][:40]]


@pytest.mark.parametrize(
    ("held", "drawn"),
    [(RAIL, {}), (TURN, {}), (RAIL, {"is_stretched": True}), (TURN, {"is_overhead": True})],
    ids=["rail", "turn", "stretched", "overhead"],
)
def test_what_a_free_configuration_reaches_within_the_tolerances_is_never_ruled_out(held, drawn, rng):
    problem = on(held)
    settings, Q = problem.settings, draw_nearly_touching(problem, rng, **drawn)
    assert len(Q) == 40
    for T in compute_frames(QIAO, Q)[QIAO.tool]:
        way, axis = (vector / np.linalg.norm(vector) for vector in rng.normal(size=(2, 3)))
        p = T[:3, 3] + 0.99 * settings.position_tolerance_m * way
        R = Rotation.from_rotvec(0.99 * settings.orientation_tolerance_rad * axis).as_matrix() @ T[:3, :3]
        assert rule_out_by_sweep(problem, Target(tuple(p), R_world_tool=R)) is None


@pytest.mark.parametrize("held", [RAIL, TURN], ids=["rail", "turn"])
def test_what_carries_the_arm_sees_the_pose_no_further_off_than_is_said(held, rng):
    problem, half, nearest = on(held), 0.05, 0.0
    for target in poses(rng, 20):
        carrier = find_carrier(problem, target)
        middle = rng.uniform(carrier.lower, carrier.upper)
        others = middle + half * np.array([-1.0, -0.3, 0.5, 1.0])
        asked, seen = (ask_pieces(problem, target, carrier, places, half) for places in (np.array([middle]), others))
        moved = np.linalg.norm(seen.T_carrier_tool[:, :3, 3] - asked.T_carrier_tool[0, :3, 3], axis=1)
        turned = Rotation.from_matrix(asked.T_carrier_tool[0, :3, :3].T @ seen.T_carrier_tool[:, :3, :3]).magnitude()
        assert (moved <= asked.moves_m + 1e-12).all()
        assert (turned <= asked.rotates_rad + 1e-9).all()
        nearest = max(nearest, (moved / asked.moves_m).max())
        assert held is RAIL or turned.max() > 0.999 * half
    assert nearest > 0.99


@pytest.mark.parametrize("held", [RAIL, TURN], ids=["rail", "turn"])
def test_nearly_all_poses_without_a_solution_are_proved_to_have_none(held, rng):
    problem, proved, missed = on(held), 0, 0
    for target in poses(rng, 40):
        swept = rule_out_by_sweep(problem, target)
        is_reached = search(problem, [target], seed=0, streams=[0]).counts[0, REACHED] == 1
        assert not (swept and is_reached)
        proved, missed = proved + bool(swept), missed + (not swept and not is_reached)
    assert proved > 5
    assert missed <= 0.3 * proved


def test_the_search_says_it_with_the_range_and_what_stands_there(rng):
    """What neither bounds nor the tool's body tell."""
    problem = on(RAIL)
    for target in poses(rng, 100):
        swept = rule_out_by_sweep(problem, target)
        if swept and swept.stop_reason is StopReason.WORLD and rule_out(problem, Targets.of([target]))[0] < 0:
            break
    found = search(problem, [target], seed=0, streams=[0])
    told = explain(problem, target, found.row(0), verify(QIAO, target, found.q[0], collision=MODEL), seed=0, stream=0)
    assert (told.stop_reason, told.blocking_pairs) == (StopReason.WORLD, swept.blocking)
    assert told.reason.startswith(
        f"{NO_SOLUTION}: wherever d_x is from -0.5 to 0.5 m, the arm does not reach this pose inside its limits "
        f"without touching: "
    )
    assert {name for _, name in swept.blocking} & {f"b{k}" for k in range(5)}


def test_what_no_one_joint_carries_is_left_to_the_search(rng):
    (target,) = poses(rng, 1)
    far = Target((9.0, 0.0, 1.0), R_world_tool=np.eye(3))
    assert rule_out_by_sweep(problem_of(QIAO), far) is None  # three joints
    assert rule_out_by_sweep(problem_of(QIAO, freeze={**RAIL, "d_x": 0.0}), far) is None  # none
    assert rule_out_by_sweep(problem_of(ikde.load_robot("panda")), far) is None  # no closed form
    assert rule_out_by_sweep(on(RAIL), Target((9.0, 0.0, 1.0))) is None  # no pose
    assert rule_out_by_sweep(on(RAIL), far).stop_reason is StopReason.OUT_OF_REACH
    assert tell_sweep(QIAO, rule_out_by_sweep(on(TURN), far)).startswith(NO_SOLUTION)
    assert target.kind == "pose"
