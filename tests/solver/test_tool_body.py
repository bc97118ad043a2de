"""What the tool's body proves, against tool poses that are drawn from all that a target accepts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Frame
from ikde.model.solids import make_solid
from ikde.model.target import Targets
from ikde.model.world import make_obstacle, make_world
from ikde.solver.plain import compute_gaps
from ikde.solver.plain_world import measure_obstacle
from ikde.solver.result import STOP_REASONS, StopReason
from ikde.solver.tool_body import find_tool_body, measure_shortage, rule_out_by_tool
from tests import reference
from tests.conftest import random_q
from tests.problems import problem_of
from tests.solids import random_world
from tests.targets import target_at
from tests.three_joints import KINDS, ROBOT, free_q, meet
from tests.written import written_kernels

PANDA = ikde.load_robot("panda")
SIDE = Frame(name="side", parent="tip", p_parent_frame=np.array([0.1, 0.05, 0.02]), R_parent_frame=np.eye(3))
ROWS = (
    *ROBOT.approximations["balls"],
    *(
        replace(row, start=a, end=a, component=c, count=1)
        for row, a, c in (
            (ROBOT.approximations["balls"][-1], "side", "hand"),
            (ROBOT.approximations["balls"][-1], "tip", "arm"),
        )
    ),
)
BENT = replace(ROBOT, name="bent", frames=(*ROBOT.frames, SIDE), approximations={"balls": ROWS})
"""With a sphere beside the tool's axis, and a component of which a part alone is fixed to the tool."""
WORLD = STOP_REASONS.index(StopReason.WORLD)
WIDE = ikde.SolveSettings(position_tolerance_m=2e-3, orientation_tolerance_rad=0.02)


def spheres_of_the_tool(robot):
    """Component, centre in the tool's frame, and radius, of each sphere that is there at two configurations."""
    seen = []
    for q in (robot.home, 0.5 * (robot.home + robot.upper.clip(-3.0, 3.0))):
        T = np.linalg.inv(reference.compute_frames(robot, q)[robot.tool])
        listed = reference.list_spheres(robot, CollisionModel.of(robot).detector, q)
        seen.append([(name, T[:3, :3] @ c + T[:3, 3], r) for name, c, r in listed])
    return [one for one, other in zip(*seen, strict=True) if np.allclose(one[1], other[1], atol=1e-9)]


def accepted_pose(target, settings, rng):
    """A tool pose [4, 4] that a target accepts, mostly at the very edge of it."""
    T = np.eye(4)
    way, axis = rng.normal(size=(2, 3))
    T[:3, 3] = target.p_world_tool + settings.position_tolerance_m * way / np.linalg.norm(way)
    tilt = Rotation.from_rotvec(settings.orientation_tolerance_rad * axis / np.linalg.norm(axis))
    R = Rotation.from_matrix(target.R_world_tool)
    if target.kind == "axis":
        R = R * Rotation.from_rotvec([0.0, 0.0, rng.uniform(-np.pi, np.pi)])
    T[:3, :3] = (Rotation.random(rng=rng) if target.kind == "position" else tilt * R).as_matrix()
    return T


def true_shortage(model, spheres, T):
    """By how much each component of the tool and obstacle are too near at a pose, m."""
    found = {}
    for name, centre, radius in spheres:
        for obstacle in model.world.active:
            gap = float(measure_obstacle(obstacle, T[:3, :3] @ centre + T[:3, 3])) - radius
            key, asked = (name, obstacle.name), model.kept_m(name) + obstacle.margin_m
            short = -np.inf if name in obstacle.ignore else asked - gap
            found[key] = max(found.get(key, -np.inf), short)
    return found


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("robot", [ROBOT, PANDA, BENT], ids=["three joints", "panda", "bent"])
def test_what_is_claimed_holds_at_every_pose_that_a_target_accepts(robot, kind, rng):
    own, spheres, proved = CollisionModel.of(robot), spheres_of_the_tool(robot), 0
    body = find_tool_body(own)
    assert {own.components[k] for k in body.components} <= {name for name, *_ in spheres}
    ignored = own.components[int(body.components[0])]
    model = own.in_world(random_world(rng, 9, far=0.6, margin_m=0.004), 0.002, {ignored: 0.01})
    first = model.world.obstacles[0]
    spared = make_obstacle("spared", first.solids, first.T_world_obstacle, ignore=(ignored,))
    model = own.in_world(model.world.add(spared), 0.002, {ignored: 0.01})
    problem = replace(problem_of(robot, WIDE), collision=model)
    for q in random_q(robot, rng, 12):
        target = target_at(reference.compute_frames(robot, q)[robot.tool], kind)
        claimed = measure_shortage(problem, Targets.of([target]))[0]
        proved += (claimed > 0.0).any()
        for _ in range(12):
            true = true_shortage(model, spheres, accepted_pose(target, WIDE, rng))
            for part, component in enumerate(body.components):
                for other, obstacle in enumerate(model.obstacles):
                    assert claimed[part, other] <= true[own.components[component], obstacle.name] + 1e-9
    assert proved > 0


def test_of_a_pose_it_is_exact_but_for_the_tolerances(rng):
    model = CollisionModel.of(PANDA).in_world(random_world(rng, 8, far=0.7))
    problem, spheres, Q = (
        replace(problem_of(PANDA), collision=model),
        spheres_of_the_tool(PANDA),
        random_q(PANDA, rng, 40),
    )
    held = {model.components[k] for k in find_tool_body(model.own).components}  # not what only lies on the last axis
    Ts = [reference.compute_frames(PANDA, q)[PANDA.tool] for q in Q]
    claimed = measure_shortage(problem, Targets.of([target_at(T, "pose") for T in Ts]))
    for T, short in zip(Ts, claimed, strict=True):
        true = max(gap for (name, _), gap in true_shortage(model, spheres, T).items() if name in held)
        assert true - 1e-4 <= short.max() <= true


def test_what_a_configuration_reaches_free_of_the_world_is_not_ruled_out(rng):
    """An obstacle a micrometre away from the hand, of which tolerances alone could lead away."""
    own, body = CollisionModel.of(PANDA), find_tool_body(CollisionModel.of(PANDA))
    for q in random_q(PANDA, rng, 20):
        T, k = ikde.forward(PANDA, q)[PANDA.tool], int(rng.integers(len(body.radii)))
        way = rng.normal(size=3)
        centre = T[:3, :3] @ body.centres[k] + T[:3, 3] + (body.radii[k] + 0.05) * way / np.linalg.norm(way)
        ball = make_obstacle("ball", [make_solid("sphere", (0.05,))], np.c_[np.eye(3), centre])
        gap = compute_gaps(own.in_world(make_world([ball])), q)[len(own.pairs) + body.components].min()
        for shift_m in (1e-6, -1e-6):
            smaller = make_solid("sphere", (max(0.05 + gap - shift_m, 1e-3),))
            near = make_world([make_obstacle("ball", [smaller], np.c_[np.eye(3), centre])])
            problem = replace(problem_of(PANDA), collision=own.in_world(near))
            assert rule_out_by_tool(problem, Targets.of([target_at(T, "pose")])).tolist() == [-1]


@pytest.mark.parametrize("kind", KINDS)
def test_it_ends_the_search_and_is_said_with_the_obstacle(kind, monkeypatch):
    q = free_q(1)[0]
    target = meet(ROBOT, q, kind)
    ball = make_obstacle("ball", [make_solid("sphere", (0.03,))], np.c_[np.eye(3), target.p_world_tool])
    far = make_obstacle("far", [make_solid("sphere", (0.03,))], np.c_[np.eye(3), (3.0, 3.0, 3.0)])
    model = CollisionModel.of(ROBOT).in_world(make_world([far, ball]))
    with written_kernels(monkeypatch):
        one = ikde.solve(ROBOT, target, collision=model)
        many = ikde.solve_many(ROBOT, [target] * 3, collision=model)
    tables = ikde.solve(ROBOT, target, collision=model)
    for result in (one, *many, tables):
        assert not result.reached
        assert result.stop_reason is StopReason.WORLD
        assert result.attempts <= 16
        assert result.blocking_pairs == {(ROBOT.name, "ball"): 1}
        assert result.reason.startswith("no solution, proved: whatever the joints do, this ")
        assert "too near: hand - ball by at least 79." in result.reason
        assert result.hint is None or result.hint.startswith("without ball: ")


def test_without_a_world_or_a_tool_with_spheres_nothing_is_ruled_out():
    targets = Targets.of([ikde.Target((0.3, 0.2, 0.4))])
    assert rule_out_by_tool(problem_of(ROBOT), targets).tolist() == [-1]
    assert find_tool_body(CollisionModel.of(ROBOT, "none")) is None
