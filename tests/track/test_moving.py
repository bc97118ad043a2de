"""Obstacles that move along a track: where they are, what is certified beside them, and what is refused."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import rotation_about
from ikde.solver.plain import compute_components, compute_world_gaps
from ikde.solver.plain_world import measure_obstacle
from ikde.track.certify import bound_all, certify
from ikde.track.certify_world import bound_world, compute_room
from ikde.track.continuation import Continuation
from ikde.track.follower import make_follower
from ikde.track.make_plan import make_plan
from ikde.track.moving import Around, MovingWorld, ObjectMotion, check_moving, place_at
from ikde.track.plan import TrackPlan
from ikde.track.spec import TrackSpec
from tests.track.measured import wave
from tests.track.shelf import make_path

UP = np.array([0.0, 0.0, 1.0])


def pose(p, axis=UP, angle=0.0):
    return np.column_stack([rotation_about(np.asarray(axis, dtype=float), angle), p])


def make_motion(rng, around, steps=4, last_s=0.4):
    """Poses about a point, each turned by less than half a turn from the one before."""
    times = np.sort(np.concatenate([[0.0, last_s], rng.uniform(0.0, last_s, steps - 2)]))
    R, poses = np.eye(3), []
    for _ in times:
        axis = rng.normal(size=3)
        R = R @ rotation_about(axis / np.linalg.norm(axis), rng.uniform(-1.5, 1.5))
        poses.append(np.column_stack([R, around + rng.uniform(-0.3, 0.3, 3)]))
    return ObjectMotion(times_s=times, T_world_object=np.array(poses))


SOLIDS = {
    "box": {"box": [0.3, 0.1, 0.2]},
    "ball": {"sphere": {"radius": 0.08}},
    "can": {"cylinder": {"radius": 0.05, "height": 0.3}},
    "bar": {"capsule": {"radius": 0.03, "height": 0.4}},
    "tip": {"cone": {"radius": 0.1, "height": 0.2}},
    "wedge": {"hull": {"points": [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]]}},
    "dust": {"cloud": {"points": [[0.1, 0, 0], [0, 0.2, 0], [0, -0.1, 0.1]], "radius": 0.02}},
}
PARTS = [
    {**solid, "position": [0.1 * k, -0.1, 0.05 * k], "rpy": [0.3, k, 0]} for k, solid in enumerate(SOLIDS.values())
]


def make_world(names=("still", "arm", "base")):
    everything = {name: {"parts": PARTS} for name in names}
    return ikde.load_world({"obstacles": everything})


@pytest.fixture
def around(qiao, rng):
    """The 9-DoF robot with a heap of solids that stands and two that move, for 0.4 s."""
    model = CollisionModel.of(qiao).in_world(make_world(), 0.01, {"LT": 0.0})
    moving = {"arm": make_motion(rng, [1.2, 0.3, 1.2]), "base": make_motion(rng, [0.3, 0.8, 0.3])}
    return MovingWorld.of(place_at(model, moving, 0.0), moving, 0.02 * np.arange(21))


def test_it_moves_straight_and_turns_at_constant_speed():
    motion = ObjectMotion(
        times_s=[0.0, 1.0, 3.0], T_world_object=[pose([0, 0, 0]), pose([1, 0, 0], UP, 1.0), pose([1, 2, 0], UP, -1.0)]
    )
    R, p = motion.place(np.array([-1.0, 0.5, 1.0, 2.0, 9.0]))
    np.testing.assert_allclose(p, [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 1, 0], [1, 2, 0]], atol=1e-12)
    np.testing.assert_allclose(R, [rotation_about(UP, angle) for angle in (0.0, 0.5, 1.0, 0.0, -1.0)], atol=1e-12)
    np.testing.assert_allclose(
        motion.measure_travel(np.array([0.0, 0.5, 3.0]), 0.1), [0.0, 0.55, 1.1 + 2.2], atol=1e-12
    )


def test_no_point_moves_farther_than_the_travel(rng):
    for seed in range(20):
        motion = make_motion(np.random.default_rng(seed), np.zeros(3))
        points, radius = rng.normal(size=(50, 3)), 0.7
        points *= radius / np.linalg.norm(points, axis=1)[:, None]
        times = np.linspace(0.0, 0.4, 81)
        R, p = motion.place(times)
        placed = np.einsum("tij,nj->tni", R, points) + p[:, None]
        moved = np.linalg.norm(placed[:, None] - placed[None], axis=-1).max(axis=-1)
        way = motion.measure_travel(times, radius)
        assert (moved <= np.abs(way[:, None] - way[None]) + 1e-12).all()


def test_gaps_are_those_of_a_world_that_stands_where_it_is(qiao, around, rng):
    q, times = rng.uniform(*qiao.drawn, (6, 9)), rng.uniform(0.0, 0.4, 6)
    gaps = around.compute_gaps(q, times)
    for k, time in enumerate(times):
        there = place_at(around.collision, around.moving, time)
        np.testing.assert_allclose(gaps[k], compute_world_gaps(there, q[k]), rtol=0, atol=1e-12)


def test_kernels_have_the_world_of_the_sample(around):
    for sample in (0, 7, 20, 3):
        arrays = around.set_sample(sample)
        there = place_at(around.collision, around.moving, 0.02 * sample).arrays
        np.testing.assert_allclose(arrays.world, there.world, rtol=0, atol=1e-12)
        assert not arrays.world.flags.writeable


@pytest.mark.parametrize("on_arcs", [True, False])
def test_dense_sampling_never_shows_less_than_the_certificate(qiao, on_arcs):
    for seed in range(3):
        rng = np.random.default_rng(seed)
        model = CollisionModel.of(qiao).in_world(make_world(), 0.01, {"LT": 0.0})
        moving = {"arm": make_motion(rng, [1.2, 0.3, 1.2]), "base": make_motion(rng, [0.3, 0.8, 0.3])}
        q, times = wave(qiao, 4, 0.6), np.linspace(0.0, 0.4, 5)
        world = MovingWorld.of(place_at(model, moving, 0.0), moving, times)
        q[:, :3] *= 5.0
        drive = "differential" if on_arcs else "omnidirectional"
        if on_arcs:
            for k in range(4):
                q[k + 1, :3] = step_base(q[k, :3], rng.uniform(-1, 1), rng.uniform(-2, 2), 0.1)
        bounds, seen = bound_world(world.collision, q, drive, Around(world, times)), np.inf
        for k in range(4):
            share = np.linspace(0.0, 1.0, 101)
            dense = (1.0 - share[:, None]) * q[k] + share[:, None] * q[k + 1]
            if on_arcs:
                dense[:, :3] = along_arc(q[k, :3], q[k + 1, :3], share)
            room = compute_room(world.collision, dense, Around(world, times[k] + 0.1 * share))
            assert (room >= bounds[k] - 1e-12).all()
            seen = min(seen, float(room.min()))
        least = float(compute_room(world.collision, q, Around(world, times)).min())
        assert bounds.min() >= min(least - max(1e-4, 0.02 * abs(least)), seen - 1e-3)  # and hardly too little


def along_arc(start, end, share):
    """x, y, heading on the arc that leaves along the heading."""
    turn, chord = end[2] - start[2], end[:2] - start[:2]
    middle = start[2] + 0.5 * turn
    length = chord @ [np.cos(middle), np.sin(middle)] / np.sinc(0.5 * turn / np.pi)
    return np.array([step_base(start, length, turn, part) for part in share])


def test_an_obstacle_that_passes_between_two_samples_is_seen(qiao):
    """Free at both ends of a step in which it flies through the robot; without its way it would be called free."""
    ball = {"ball": {"sphere": {"radius": 0.02}, "position": [9, 0, 1]}}
    model = CollisionModel.of(qiao).in_world(ikde.load_world({"obstacles": ball}))
    through = ObjectMotion(times_s=[0.0, 0.02], T_world_object=[pose([1.5, -2, 0.35]), pose([-0.3, 2, 0.35])])
    world = MovingWorld.of(place_at(model, {"ball": through}, 0.0), {"ball": through}, np.array([0.0, 0.02]))
    q, times = np.tile(qiao.home, (2, 1)), np.array([0.0, 0.02])
    assert (compute_room(world.collision, q, Around(world, times)) > 0.5).all()
    assert certify(world.collision, q, "differential").is_free  # where it stands still
    proof = certify(world.collision, q, "differential", Around(world, times))
    assert not proof.is_free


def test_a_fixed_part_is_compared_with_what_moves():
    ur5 = ikde.load_robot("ur5")
    model = CollisionModel.of(ur5).in_world(ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 0.1}}}}))
    motion = ObjectMotion(times_s=[0.0, 1.0], T_world_object=[pose([2, 0, 0.05]), pose([0, 0, 0.05])])
    world = MovingWorld.of(place_at(model, {"ball": motion}, 0.0), {"ball": motion}, np.array([0.0, 0.5, 1.0]))
    gaps = world.compute_gaps(np.tile(ur5.home, (2, 1)), np.array([0.0, 1.0]))
    for row, name in enumerate(model.components):
        centres, radii = compute_components(model, ur5.home)[name]
        for k in range(2):
            ball = place_at(model, {"ball": motion}, float(k)).world["ball"]
            assert gaps[k, row] == pytest.approx((measure_obstacle(ball, centres) - radii).min())
    assert np.isinf(compute_world_gaps(model, ur5.home)).any()  # which a world that stands still leaves out


def test_what_is_held_is_compared_with_what_moves_unless_it_may_touch_it(qiao, rng):
    obstacles = {name: {"sphere": {"radius": 0.05}, "position": [2, 0, 1]} for name in ("rod", "belt", "ball")}
    world = ikde.load_world({"obstacles": obstacles})
    held = {"T_frame_object": np.eye(4), "spheres": [[0, 0, 0.1, 0.03]], "may_touch": ["belt"]}
    model = CollisionModel.of(qiao).in_world(world.attach("rod", "tool", **held), 0.01)
    moving = {name: make_motion(rng, [1.2, 0.3, 1.2]) for name in ("belt", "ball")}
    moved = MovingWorld.of(place_at(model, moving, 0.0), moving, 0.02 * np.arange(21))
    q, times = rng.uniform(*qiao.drawn, (4, 9)), rng.uniform(0.0, 0.4, 4)
    gaps = moved.compute_gaps(q, times)
    for k, time in enumerate(times):
        there = place_at(moved.collision, moving, time)
        np.testing.assert_allclose(gaps[k], compute_world_gaps(there, q[k]), rtol=0, atol=1e-12)
    row = gaps.reshape(4, len(model.components), 2)[:, model.components.index("rod")]
    assert np.isinf(row[:, 0]).all()
    assert np.isfinite(row[:, 1]).all()


def plan_with(moving, **changes):
    ball = {
        "ball": {"sphere": {"radius": 0.05}, "position": [9, 0, 0]},
        "floor": {"half_space": {}, "position": [0, 0, -1]},
    }
    ball["mount"] = {"sphere": {"radius": 0.05}, "position": [9, 0, 0], "frame": "world"}
    model = CollisionModel.of("qiao2021").in_world(ikde.load_world({"obstacles": ball}), 0.01)
    plan = TrackPlan.of(model.robot, make_path(), collision=model)
    return replace(plan, moving=moving, **changes)


def line(start, end, last_s=0.4):
    return ObjectMotion(times_s=[0.0, last_s], T_world_object=[pose(start), pose(end)])


def test_a_ball_that_comes_is_given_way():
    """It crosses where the elbow would be; the tool stays on its path, everything keeps 10 mm, certified."""
    alone = ikde.follow_path("qiao2021", make_path())
    elbow = compute_components(CollisionModel.of("qiao2021"), alone.q)["J4"][0][10, 0]
    comes = line(elbow + 0.5 * UP, elbow + 0.1 * UP)
    motion = ikde.run_track(plan_with({"ball": comes}))
    assert motion.reached, motion.stop
    assert motion.certificate.is_free
    assert motion.moving.keys() == {"ball"}
    for k, (R, p) in enumerate(zip(*comes.place(motion.times_s), strict=True)):
        ball = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 0.05}, "position": p.tolist()}}})
        rows = ikde.check("qiao2021", motion.q[k], ball).obstacles
        assert min(row.clearance_m for row in rows) > 0.01
        np.testing.assert_allclose(R, np.eye(3), atol=1e-12)
    assert not np.array_equal(motion.q, alone.q)


def test_from_python_the_same_motion_is_a_keyword():
    comes = line([0.9, 0.1, 1.6], [0.9, 0.1, 0.9])
    plan = plan_with({})
    asked = {"collision": plan.collision, "moving": {"ball": comes}}
    motion = ikde.follow_path("qiao2021", make_path(), **asked)
    assert motion.q.tobytes() == ikde.run_track(plan_with({"ball": comes})).q.tobytes()
    assert motion.stop.pair[1] == "ball"
    with pytest.raises(InputError, match=r"^moving.ball: expected an ObjectMotion, got \[\[0, 0, 0\]\]$"):
        ikde.follow_path("qiao2021", make_path(), collision=plan.collision, moving={"ball": [[0, 0, 0]]})
    with pytest.raises(InputError, match=r"^moving: expected motions of obstacles by name, got 3$"):
        ikde.follow_path("qiao2021", make_path(), moving=3)
    with pytest.raises(TypeError, match=r"^follow_path\(\) got an unexpected keyword argument 'mooving'$"):
        ikde.follow_path("qiao2021", make_path(), mooving={})


def test_where_the_world_has_it_does_not_matter():
    ball = {"obstacles": {"ball": {"sphere": {"radius": 0.5}, "position": [0, 0, 0]}}}
    comes = line([9, 0, 0], [9, 1, 0])
    plan = TrackPlan.of(ikde.load_robot("ur5"), make_path(), collision=ikde.load_world(ball), moving={"ball": comes})
    assert plan.collision.world["ball"].T_world_obstacle[:, 3].tolist() == [9, 0, 0]
    keys = {
        "robot": "ur5",
        "dt_s": 0.1,
        "path": {"waypoints": [[0.4, 0.2, 0.4], [0.4, 0.1, 0.4]]},
        "world": "ball.json",
    }
    moving = {"ball": {"times_s": [0, 1], "poses": [[9, 0, 0], [9, 1, 0]]}}
    read = {"folder": Path(), "read_world": lambda name: (ikde.load_world(ball), nullcontext)}
    made = make_plan(TrackSpec.model_validate({**keys, "moving": moving}), plan.robot, **read)
    assert made.collision.world["ball"].T_world_obstacle[:, 3].tolist() == [9, 0, 0]
    with pytest.raises(InputError, match="in every configuration"):
        make_plan(TrackSpec.model_validate(keys), plan.robot, **read)


def test_poses_are_taken_as_they_come():
    whole = ObjectMotion([0, 1], [np.vstack([pose([0, 1, 2]), [0, 0, 0, 1]]), [3.0, 4.0, 5.0]])
    assert whole.T_world_object.tolist() == [pose([0, 1, 2]).tolist(), pose([3, 4, 5]).tolist()]
    assert ObjectMotion([0, 1], np.array([[0.0, 1, 2], [3, 4, 5]])).T_world_object.shape == (2, 3, 4)
    other = type("Other", (), {"homogeneous": np.eye(4)})()
    assert ObjectMotion([0, 1], [other, other]).place(np.array([0.5]))[1].tolist() == [[0, 0, 0]]
    assert repr(whole) == "<ObjectMotion: 2 poses from 0 to 1 s>"
    assert not whole.T_world_object.flags.writeable
    assert not whole.times_s.flags.writeable


def test_a_ball_that_comes_to_the_tool_stops_it_where_it_is_met():
    to = line([0.9, 0.1, 1.6], [0.9, 0.1, 0.9])
    motion = ikde.run_track(plan_with({"ball": to}))
    stop = motion.stop
    assert stop.pair[1] == "ball"
    assert 1 < stop.sample < 20
    assert stop.hint.startswith("without ball it goes on to the end")
    assert motion.certificate.is_free
    assert motion.grade.accepted
    away = [np.linalg.norm(to.place(motion.times_s)[1] - make_path().p_world_tool[: stop.sample], axis=1)]
    assert np.min(away) > 0.06


@pytest.mark.parametrize(
    ("moving", "words"),
    [
        (
            {"bal": line([9, 0, 0], [9, 1, 0])},
            "moving.bal: no obstacle that counts is called 'bal' (did you mean 'ball'?)",
        ),
        (
            {"floor": line([9, 0, 0], [9, 1, 0])},
            "moving.floor: floor has a half-space, which has no end: it can't move",
        ),
        (
            {"ball": line([9, 0, 0], [9, 1, 0], 0.3)},
            "moving.ball.times_s: ball is known from 0 to 0.3 s, the path lasts from 0 to 0.4 s",
        ),
    ],
)
def test_what_may_not_move_is_one_line(moving, words):
    with pytest.raises(InputError) as caught:
        plan_with(moving)
    assert str(caught.value) == words


def test_the_solver_is_asked_about_the_world_of_the_sample():
    to = line([0.9, 0.2, 1.6], [0.9, 0.2, 0.9])
    search = Continuation(follower=make_follower(plan_with({"ball": to})))
    assert search._solve(0).reached
    assert search._solve(20).stop_reason == "world"


def test_a_foot_that_is_run_into_stops_the_motion():
    ur5 = ikde.load_robot("ur5")
    tool = ikde.forward(ur5, ur5.home)["tool"][:3, 3]
    path = ikde.ToolPath.through(np.linspace(tool, tool + 0.01 * UP, 11), dt_s=0.1)
    ball = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 0.05}}}})
    model = CollisionModel.of(ur5).in_world(ball)
    comes = {"ball": line([1, 0.6, 0.05], [0, 0, 0.05], 1.0)}
    motion = ikde.run_track(replace(TrackPlan.of(ur5, path, collision="none"), collision=model, moving=comes))
    assert motion.stop.pair[1] == "ball"
    assert motion.certificate.is_free
    assert 0 < motion.reached_points < 10


def test_other_methods_do_not_know_what_moves():
    with pytest.raises(
        InputError, match=r"^moving: obstacles that move need the method continuation, typical does not"
    ):
        plan_with({"ball": line([9, 0, 0], [9, 1, 0])}, method="typical")


@pytest.mark.parametrize(
    ("times", "poses", "words"),
    [
        ([0, 0], [pose([0, 0, 0])] * 2, "times_s[1]: expected a later time than 0 s, got 0"),
        ([0, 2, 1], [pose([0, 0, 0])] * 3, "times_s[2]: expected a later time than 2 s, got 1"),
        ([0, np.nan], [pose([0, 0, 0])] * 2, "times_s[1]: expected a later time than 0 s, got nan"),
        ([0, np.inf], [pose([0, 0, 0])] * 2, "times_s[1]: expected a later time than 0 s, got inf"),
        ([0], [pose([0, 0, 0])], "times_s: expected a pose a time, two at least, got 1 and 1"),
        ([0, 1, 2], [pose([0, 0, 0])] * 2, "times_s: expected a pose a time, two at least, got 3 and 2"),
        ([0, 1], [pose([0, 0, 0]), pose([0, 0, 0], UP, np.pi)], "T_world_object[1]: half a turn from the"),
        ([0, 1], [pose([0, 0, 0]), np.zeros((3, 4))], "T_world_object[1]: expected a rotation"),
        ([0, 1], [[0, 0, 0], [0, 0, np.nan]], "T_world_object[1]: expected a rotation and a place of finite numbers"),
        ([0, 1], [[0, 0], [0, 0]], "T_world_object[0]: expected a pose [4, 4], got shape (2,)"),
        ([0, 1], 3, "T_world_object: expected poses [K, 4, 4] or places [K, 3] in m, got 3"),
        ([[0, 1]], [[0, 0, 0]] * 2, "times_s: expected times [K] in s, got shape (1, 2)"),
        (["a", 1], [[0, 0, 0]] * 2, "times_s: expected numbers, got ['a', 1]"),
    ],
)
def test_what_is_no_motion_is_one_line(times, poses, words):
    with pytest.raises(InputError) as caught:
        ObjectMotion(times_s=times, T_world_object=poses)
    assert str(caught.value).startswith(words)


def test_nothing_that_moves_is_nothing(qiao):
    model = CollisionModel.of(qiao)
    assert MovingWorld.of(model, {}, np.zeros(1)) is None
    assert place_at(model, {}, 1.0) is model
    check_moving(model, {}, 1.0)
    assert bound_all(model, wave(qiao, 2, 0.1), "differential").shape == (2, len(model.pairs))
