"""The certificate in a world: never above what dense sampling sees, on chords and on arcs, and near it."""

from itertools import pairwise

import numpy as np
import pytest

import ikde
from ikde.model.base_motion import find_wheels, step_base
from ikde.model.collision_model import CollisionModel
from ikde.track import certify_world
from ikde.track.certify import bound_all, certify, list_kept_m
from ikde.track.certify_world import bound_world, compute_room, find_middle, measure_steps, reach_radii
from tests.three_joints import ROBOT

DENSE = 100
SOLIDS = (
    {"sphere": {"radius": 0.2}},
    {"box": [0.3, 0.2, 0.6]},
    {"cylinder": {"radius": 0.1, "height": 0.8}},
    {"capsule": {"radius": 0.1, "height": 0.4}},
    {"cone": {"radius": 0.2, "height": 0.5}},
    {"hull": {"points": [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.5]]}},
    {"cloud": {"points": [[0, 0, 0], [0.1, 0, 0.1], [0, 0.2, 0.1]], "radius": 0.02}},
)


def place(rng, robot, margin_m=0.0, **margins_m):
    """A robot among one solid of each kind, about it."""
    obstacles = {"floor": {"half_space": {}, "position": [0, 0, -0.4], "margin": 0.01}}
    for k, solid in enumerate(SOLIDS):
        obstacles[f"o{k}"] = {**solid, "position": rng.uniform([-2, -2, 0.2], [2, 2, 1.5]).tolist()}
    world = ikde.load_world({"obstacles": obstacles})
    return CollisionModel.of(robot).in_world(world, margin_m, margins_m)


def drive(robot, rng, segments, size, on_arcs):
    """Joint values [segments + 1, N] from one random configuration to the next, a base on arcs."""
    q, base = [rng.uniform(*robot.drawn)], find_wheels(robot, "differential")
    q[0][base[:2]] = rng.uniform(-0.5, 0.5, 2)
    for _ in range(segments):
        end = q[-1] + size * rng.uniform(-1.0, 1.0, len(robot.joints))
        if on_arcs:
            end[base] = step_base(q[-1][base], *(np.array(size * rng.uniform(-1, 1)) for _ in range(2)), 1.0)
        q.append(end)
    return np.array(q)


def sample_densely(robot, q, on_arcs):
    """All configurations [M, 101, N] on the way."""
    found, base = [], find_wheels(robot, "differential")
    for a, b in pairwise(q):
        shares = np.linspace(0.0, 1.0, DENSE + 1)
        rows = a + shares[:, None] * (b - a)
        if on_arcs:
            along, angle = solve_arc(a[base], b[base])
            rows[:, base] = [step_base(a[base], np.array(along), np.array(angle), share) for share in shares]
        found.append(rows)
    return np.array(found)


def solve_arc(start, end):
    """Length and rotation of the arc between two places, by its circle."""
    angle, chord = end[2] - start[2], end[:2] - start[:2]
    middle = start[2] + 0.5 * angle
    forward = chord @ [np.cos(middle), np.sin(middle)]
    return (forward if abs(angle) < 1e-12 else forward * 0.5 * angle / np.sin(0.5 * angle)), angle


@pytest.mark.parametrize("on_arcs", [True, False])
@pytest.mark.parametrize("size", [0.02, 0.3])
def test_dense_sampling_never_sees_less(qiao, rng, size, on_arcs):
    model = place(rng, qiao, 0.02, M=0.0)
    q = drive(qiao, rng, 6, size, on_arcs)
    bounds = bound_world(model, q, "differential" if on_arcs else "omnidirectional")
    dense = sample_densely(qiao, q, on_arcs)
    seen = compute_room(model, dense.reshape(-1, q.shape[1])).reshape(*dense.shape[:2], *bounds.shape[1:]).min(axis=1)
    assert np.isfinite(bounds).any()
    assert (bounds <= seen + 1e-12).all()
    assert bounds.min() > seen.min() - max(2e-4, 0.03 * abs(seen.min())) - 2e-3 * size


def test_a_wide_arc_is_longer_than_its_chord(qiao):
    base, q = find_wheels(qiao, "differential"), np.tile(qiao.home, (2, 1))
    q[1, base] = step_base(q[0, base], np.array(1.0), np.array(3.0), 1.0)
    steps = measure_steps(q[:1], q[1:], base)
    assert steps[0, base].tolist() == pytest.approx([1.0, 0.0, 3.0], abs=1e-12)
    middle = find_middle(q[:1], q[1:], base)[0, base]
    np.testing.assert_allclose(middle, step_base(q[0, base], np.array(1.0), np.array(3.0), 0.5), atol=1e-12)
    assert np.linalg.norm(q[1, base[:2]] - q[0, base[:2]]) < 0.7


def test_an_obstacle_beside_the_chord_is_met_on_the_arc(qiao):
    """Both samples are free of it, and so is all of the chord."""
    base, q = find_wheels(qiao, "differential"), np.tile(qiao.home, (2, 1))
    q[1, base] = step_base(q[0, base], np.array(4.0), np.array(3.0), 1.0)
    middle = step_base(q[0, base], np.array(4.0), np.array(3.0), 0.5)
    post = {"cylinder": {"radius": 0.05, "height": 4.0}, "position": [*middle[:2].tolist(), 0.0]}
    model = CollisionModel.of(qiao).in_world(ikde.load_world({"obstacles": {"post": post}}))
    assert (compute_room(model, q) > 0.1).all()
    assert certify(model, q, "omnidirectional").is_free
    assert not certify(model, q, "differential").is_free


def test_every_joint_below_a_component_moves_it(qiao):
    radii = reach_radii(CollisionModel.of(qiao), qiao.upper)
    components = CollisionModel.of(qiao).components
    np.testing.assert_array_equal(radii[:, :2], 1.0)
    assert (radii[components.index("LT"), :8] > 0.0).all()
    assert (radii[components.index("M"), 3:] == 0.0).all()


def test_what_is_asked_for_is_kept_between_samples(qiao, rng):
    """The same motion is certified with less margin than its clearance, and not with more."""
    q = drive(qiao, rng, 3, 0.01, True)
    bare = place(np.random.default_rng(5), qiao)
    proof = certify(bare, q, "differential")
    world = bare.world
    for asked_m, kept in ((0.5, True), (1.5, False)):
        model = CollisionModel.of(qiao).in_world(world, max(asked_m * room_in(bare, q), 0.0))
        assert (bound_world(model, q, "differential").min() > 0.0) == kept
    assert proof.clearance_m == proof.segment_m.min()
    assert (list_kept_m(bare)[: len(bare.pairs)] == 0.0).all()


def room_in(model, q):
    """The least room at the samples, m; the motion is free of the world."""
    least = float(compute_room(model, q).min())
    assert least > 0.0
    return least


def test_what_is_ignored_does_not_count(qiao, rng):
    names = list(CollisionModel.of(qiao).components)
    floor = {"half_space": {}, "position": [0, 0, 3], "ignore": names}
    model = CollisionModel.of(qiao).in_world(ikde.load_world({"obstacles": {"floor": floor}}))
    assert (bound_world(model, drive(qiao, rng, 2, 0.1, True), "differential") == np.inf).all()


@pytest.mark.parametrize("samples", [0, 1])
def test_without_a_segment_there_is_nothing_to_bound(qiao, samples):
    ball = {"sphere": {"radius": 0.1}, "position": [3, 0, 1]}
    model = CollisionModel.of(qiao).in_world(ikde.load_world({"obstacles": {"ball": ball}}))
    q = np.tile(qiao.home, (samples, 1))
    assert bound_all(model, q, "differential").shape == (0, len(model.all_pairs))


def test_radii_are_those_of_the_whole_motion(monkeypatch):
    seen, radii = [], certify_world.reach_radii
    monkeypatch.setattr(certify_world, "reach_radii", lambda model, most: seen.append(most) or radii(model, most))
    wall = ikde.load_world({"obstacles": {"wall": {"box": [0.1, 2, 2], "position": [3, 0, 0]}}})
    q = np.array([[0.1, -0.5, 0.1], [0.1, 0.2, 0.3], [-0.4, 0.1, 0.2]])
    certify_world.bound_world(CollisionModel.of(ROBOT).in_world(wall), q, "omnidirectional")
    assert seen[0].tolist() == [0.4, 0.5, 0.3]
