"""Solving among obstacles: what is called free is free for plain numpy, one by one and in bulk."""

import pickle
import re

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.arrays import COLLIDING
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import NOTHING, make_obstacle, make_world
from ikde.solver import search as search_module
from ikde.solver.plain import compute_components, compute_gaps
from ikde.solver.plain_world import measure_obstacle
from ikde.solver.quick import find_quick
from ikde.solver.search import search
from tests.problems import problem_of
from tests.solids import random_world
from tests.three_joints import KINDS, ROBOT, free_q, meet
from tests.written import written_kernels

OWN = CollisionModel.of(ROBOT)


def post(x, y, radius=0.05, name="post", **options):
    T = np.eye(4)
    T[:2, 3] = x, y
    return make_obstacle(name, [make_solid("cylinder", (radius, 4.0))], T, **options)


def crowd(rng, count=6):
    """Some obstacles about the robot, whose floor and post may touch them."""
    return random_world(rng, count, kinds=("box", "cylinder", "cone", "hull"), far=0.7, ignore=("floor", "post"))


def is_free(model, q):
    """By distances alone, of every component and obstacle."""
    for name, (centres, radii) in compute_components(model, q).items():
        for obstacle in model.world.active:
            gap = (measure_obstacle(obstacle, centres) - radii).min()
            asked = model.margin_m + obstacle.margin_m
            if name not in (*obstacle.ignore, *model.fixed_components) and gap <= asked:
                return False
    return (compute_gaps(model, q, model.pairs) > model.limit_m).all()


@pytest.mark.parametrize("written", [False, True], ids=["tables", "written"])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_reached_is_free_of_the_world(kind, written, rng, monkeypatch):
    model = OWN.in_world(crowd(rng), 0.01)
    targets = [meet(ROBOT, q, kind) for q in free_q(30)]
    if written:
        with written_kernels(monkeypatch):
            rows = ikde.solve_many(ROBOT, targets, collision=model, bulk=ikde.BulkOptions(explain=False, verify="all"))
    else:
        rows = ikde.solve_many(ROBOT, targets, collision=model, bulk=ikde.BulkOptions(explain=False, verify="all"))
    assert rows.verified.all()
    assert 0 < rows.reached.sum() < len(rows)
    assert all(is_free(model, q) for q in rows.q[rows.reached])
    alone = ikde.solve_many(ROBOT, targets, bulk=ikde.BulkOptions(explain=False))
    assert any(not is_free(model, q) for q in alone.q[alone.reached])


def test_one_by_one_and_in_lanes_are_the_same_bits(rng, monkeypatch):
    model = OWN.in_world(crowd(rng), 0.01)
    problem, targets = problem_of(ROBOT, collision=model), [meet(ROBOT, q, "position") for q in free_q(16)]
    with written_kernels(monkeypatch):
        few = search(problem, targets, seed=5, streams=range(16))
        monkeypatch.setattr(search_module, "answer_few", lambda *arguments, **options: None)
        many = search(problem, targets, seed=5, streams=range(16))
    assert few.q.tobytes() == many.q.tobytes()
    assert few.counts[:, COLLIDING].sum() > 0
    for row in range(16):
        assert few.pair_counts.row(row).tolist() == many.pair_counts.row(row).tolist()


def test_an_empty_world_changes_no_bit():
    targets = [meet(ROBOT, q, "axis") for q in free_q(8)]
    rows = [ikde.solve_many(ROBOT, targets, collision=model) for model in (OWN, OWN.in_world(make_world([])))]
    assert rows[0].q.tobytes() == rows[1].q.tobytes()
    assert (rows[0].clearance_m == rows[1].clearance_m).all()
    assert OWN.world is NOTHING


def test_a_result_names_the_obstacle_that_is_nearest_and_those_that_blocked(rng):
    q = free_q(3)[2]
    target, tool = meet(ROBOT, q, "position"), ikde.forward(ROBOT, q)[ROBOT.tool][:3, 3]
    model = OWN.in_world(make_world([post(tool[0], tool[1], 0.02, "pole")]))
    result = ikde.solve(ROBOT, target, collision=model)
    assert (result.reached, result.stop_reason, result.collision) == (False, "world", True)
    assert result.blocking_pairs[ROBOT.name, "pole"] > 0
    assert result.closest_pair[1] == "pole"
    assert result.clearance_m == pytest.approx(result.grade.clearance_m, abs=1e-12)
    assert result.hint == "without pole: a solution was found that touches nothing else"
    assert pickle.loads(pickle.dumps(result)).closest_pair == result.closest_pair


def test_a_clearance_is_a_distance_and_margins_are_asked_for_beside_it():
    q = free_q(1)[0]
    target, tool = meet(ROBOT, q, "position"), ikde.forward(ROBOT, q)[ROBOT.tool][:3, 3]
    for margin_m, own_m in ((0.0, 0.0), (0.05, 0.0), (0.02, 0.03)):
        obstacle = post(tool[0] + 0.4, tool[1], 0.05, "pole", margin_m=own_m)
        model = OWN.in_world(make_world([obstacle]), margin_m)
        result = ikde.solve(ROBOT, target, collision=model, near=q)
        assert result.reached
        assert is_free(model, result.q)
        if result.closest_pair[1] == "pole":
            centres, radii = compute_components(model, result.q)[result.closest_pair[0]]
            gap = (measure_obstacle(obstacle, centres) - radii).min()
            assert result.clearance_m == pytest.approx(gap, abs=1e-12)
            assert gap > margin_m + own_m


def test_near_a_configuration_the_world_is_minded(rng):
    model = OWN.in_world(crowd(rng))
    for q in free_q(12):
        result = ikde.solve(ROBOT, meet(ROBOT, q, "position"), collision=model, near=q)
        assert not result.reached or is_free(model, result.q)


@pytest.mark.parametrize("method", ["memetic", "de"])
def test_the_other_engines_mind_it_too(method, rng):
    model, reached = OWN.in_world(crowd(rng), 0.01), 0
    for q in free_q(4):
        result = ikde.solve(ROBOT, meet(ROBOT, q, "position"), collision=model, method=method)
        reached += result.reached
        assert not result.reached or is_free(model, result.q)
    assert reached > 0


def test_a_world_needs_spheres_to_compare_it_with():
    with pytest.raises(InputError, match="a world needs a detector"):
        CollisionModel.of(ROBOT, "none").in_world(make_world([post(1.0, 1.0)]))
    with pytest.raises(InputError, match="no component is called 'hnad'"):
        OWN.in_world(make_world([post(1.0, 1.0, ignore=("hnad",))]))


def test_a_world_alone_comes_with_the_default_detector():
    world = make_world([post(1.5, 1.5)])
    checked = ikde.check(ROBOT, ROBOT.home, world)
    assert (checked.collision, checked.obstacles[0].obstacle, checked.obstacles[0].margin_m) == (False, "post", 0.0)


def test_a_reason_names_the_obstacle_and_what_touches_it(rng):
    q = free_q(3)[2]
    target, arm = meet(ROBOT, q, "position"), compute_components(OWN, q)["arm"][0][-1]
    knob = make_obstacle("knob", [make_solid("sphere", (0.06,))], np.c_[np.eye(3), arm])
    model = OWN.in_world(make_world([knob]))
    for method, who in (("memetic", "most often arm"), ("de", "the best by arm")):
        reason = ikde.solve(ROBOT, target, collision=model, method=method).reason
        assert re.search(rf"blocked by (.*, )?knob \(\d+ of \d+, {who}\)", reason), reason


def test_distinct_solutions_are_each_free(rng):
    model, target = OWN.in_world(crowd(rng), 0.01), meet(ROBOT, free_q(5)[4], "position")
    alone = ikde.solve_distinct(ROBOT, target, 3)
    found = ikde.solve_distinct(ROBOT, target, 3, collision=model, rank="clearance")
    assert 1 <= len(found) <= len(alone)
    assert found[0].reached
    for result in found:
        assert is_free(model, result.q)
        assert (result.collision, result.verified) == (False, True)
    room = [result.clearance_m for result in found]
    assert room == sorted(room, reverse=True)


def test_what_is_frozen_stays_and_is_checked_against_the_world(rng):
    q = free_q(3)[2]
    target, tool = meet(ROBOT, q, "position"), ikde.forward(ROBOT, q)[ROBOT.tool][:3, 3]
    frozen = dict(zip(ROBOT.joint_names, q.tolist(), strict=True))
    pole = make_world([post(tool[0], tool[1], 0.02, "pole")])
    far = make_world([post(tool[0] + 0.5, tool[1], 0.02, "pole")])
    free = ikde.solve(ROBOT, target, collision=OWN.in_world(far), freeze=frozen)
    assert (free.reached, free.q.tolist()) == (True, q.tolist())
    blocked = ikde.solve(ROBOT, target, collision=OWN.in_world(pole), freeze=frozen)
    assert (blocked.reached, blocked.stop_reason) == (False, "world")
    assert "pole" in blocked.reason
    model = OWN.in_world(crowd(rng), 0.01)
    result = ikde.solve(ROBOT, target, collision=model, freeze={"reach": float(q[2])})
    assert result.q[2] == q[2]
    assert not result.reached or is_free(model, result.q)


def test_a_moved_obstacle_is_answered_as_in_a_new_world(rng, monkeypatch):
    """What stays is laid out once for all worlds; no bit shows it."""
    target, world = ikde.Target((0.3, 0.2, 0.4)), crowd(rng)
    with written_kernels(monkeypatch):
        for k in range(4):
            T = world.obstacles[k].T_world_obstacle.copy()
            T[:, 3] += 0.01
            world = world.move(world.names[k], T)
            quick = ikde.solve(ROBOT, target, collision=OWN.in_world(world))
            find_quick.cache_clear()
            again = ikde.solve(ROBOT, target, collision=CollisionModel.of(ROBOT).in_world(world))
            assert quick.q.tobytes() == again.q.tobytes()
            assert (quick.reached, quick.clearance_m) == (again.reached, again.clearance_m)
