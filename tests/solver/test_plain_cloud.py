"""The nearest points of a cloud: those of comparing every sphere with every point."""

import gc

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver import plain_cloud as module
from ikde.solver.plain import compute_components, compute_world_gaps
from ikde.solver.plain_cloud import CloudBoxes, find_boxes, find_cloud_gaps
from ikde.solver.plain_world import measure_obstacle

CLOUDS = {
    "one": lambda rng: rng.normal(size=(1, 3)),
    "few": lambda rng: rng.normal(size=(5, 3)),
    "many": lambda rng: rng.normal(size=(3000, 3)),
    "a surface": lambda rng: rng.uniform(-1, 1, (3000, 3)) * [1, 1, 0] + [0, 0, 0.3],
    "a line": lambda rng: rng.uniform(-1, 1, (700, 1)) * np.array([[0.3, -0.2, 1.0]]),
    "twice the same": lambda rng: np.ones((200, 3)),
    "far from its origin": lambda rng: 1e4 + rng.normal(size=(500, 3)),
    "two heaps": lambda rng: rng.normal(size=(900, 3)) * 0.01 + np.where(np.arange(900)[:, None] < 300, -5.0, 5.0),
}


def brute(points, P, less, groups, count):
    best = np.full(count, np.inf)
    gaps = np.linalg.norm(P[:, None] - points, axis=-1).min(axis=1) - less
    np.minimum.at(best, groups, gaps)
    return best


@pytest.mark.parametrize("name", CLOUDS)
def test_gaps_are_those_of_every_point(rng, name):
    points = CLOUDS[name](rng)
    near = points[rng.integers(len(points), size=150)] + rng.normal(size=(150, 3)) * 0.05
    P = np.concatenate([near, points.mean(axis=0) + 3.0 * rng.normal(size=(150, 3))])[rng.permutation(300)]
    less, groups = rng.uniform(0.0, 0.4, 300), np.sort(rng.integers(0, 90, 300))
    groups[groups == 7] = 8  # which leaves a group without spheres
    found = find_cloud_gaps(points, P, less, groups, 91)
    np.testing.assert_allclose(found, brute(points, P, less, groups, 91), rtol=0, atol=1e-11)
    assert found[[7, 90]].tolist() == [np.inf, np.inf]


def test_many_spheres_are_asked_in_parts_that_may_cut_a_group(rng, monkeypatch):
    monkeypatch.setattr(module, "AT_ONCE", 7)
    points, P = rng.normal(size=(400, 3)), rng.normal(size=(100, 3))
    less, groups = rng.uniform(0.0, 0.4, 100), np.repeat(np.arange(10), 10)
    found = find_cloud_gaps(points, P, less, groups, 10)
    np.testing.assert_allclose(found, brute(points, P, less, groups, 10), rtol=0, atol=1e-12)


def test_boxes_hold_their_points_and_one_another(rng):
    points = rng.normal(size=(5000, 3)) * [1.0, 1.0, 0.01]
    boxes = CloudBoxes(points)
    assert len(boxes.sizes) > 1
    assert sorted(boxes.order.tolist()) == list(range(5000))
    assert len(boxes.sizes[0].middle) <= 512
    inside, cells = points[boxes.order].T, boxes.sizes[-1]
    for low, high, middle, first in boxes.sizes[::-1]:
        for k in range(len(middle)):
            some = slice(first[k], first[k + 1])
            assert (low[:, k] <= inside[:, some].min(axis=1)).all()
            assert (high[:, k] >= inside[:, some].max(axis=1)).all()
        assert ((low <= points[middle].T) & (high >= points[middle].T)).all()
        firsts = np.arange(len(inside.T))[first[:-1]]
        inside = inside[:, firsts]  # one point of each, which the box about it holds as well
    for some in np.array_split(rng.permutation(len(cells.middle)), 5):
        boxes.open(points, some)
        boxes.open(points, some)  # which changes nothing
    found = []
    for cell in range(len(cells.middle)):
        leaves = range(boxes.blocks[1][boxes.first[cell]], boxes.blocks[1][boxes.last[cell]])
        own = slice(boxes.leaves[1][leaves[0]], boxes.leaves[1][leaves[-1] + 1])
        found.append(boxes.points[:, own])
        there = points[boxes.order[cells.first[cell] : cells.first[cell + 1]]]
        assert sorted(found[-1].T.tolist()) == sorted(there.tolist())
    assert np.concatenate(found, axis=1).shape == (3, 5000)
    for (bounds, first), inside in ((boxes.leaves, boxes.points), (boxes.blocks, boxes.leaves[0])):
        for k in range(boxes._ends[1 if inside is boxes.points else 2]):
            some = slice(first[k], first[k + 1])
            assert 0 < some.stop - some.start <= module.LEAF
            np.testing.assert_array_equal(bounds[:3, k], inside[:3, some].min(axis=1))
            np.testing.assert_array_equal(bounds[3:, k], inside[-3:, some].max(axis=1))


def test_only_what_is_near_is_cut(rng):
    points = rng.uniform(-1.0, 1.0, (20_000, 3))
    points.setflags(write=False)
    P = np.array([[0.5, 0.5, 0.5]])
    find_cloud_gaps(points, P, np.array([0.1]), np.array([0]), 1)
    boxes = find_boxes(points)
    opened = (boxes.first >= 0).sum()
    assert 0 < opened < 0.01 * len(boxes.first)


def test_boxes_are_made_once_and_go_with_their_points(rng):
    points = rng.normal(size=(100, 3))
    assert find_boxes(points) is not find_boxes(points)  # they may change
    points.setflags(write=False)
    first, known = find_boxes(points), len(module._KNOWN)
    assert find_boxes(points) is first
    del first, points
    gc.collect()
    assert len(module._KNOWN) == known - 1


@pytest.mark.parametrize("beyond_m", [-1e-6, -1e-9, 0.0, 1e-9, 1e-6])
def test_verdicts_beside_contact_are_those_of_every_point(rng, beyond_m):
    points = rng.uniform(-1.0, 1.0, (4000, 3))
    P, radii = rng.uniform(-1.0, 1.0, (60, 3)), rng.uniform(0.01, 0.3, 60)
    touched = points[np.linalg.norm(P[:, None] - points, axis=-1).argmin(axis=1)]
    out = (P - touched) / np.linalg.norm(P - touched, axis=1, keepdims=True)
    P = touched + out * (radii + beyond_m)[:, None]
    found, groups = find_cloud_gaps(points, P, radii, np.arange(60), 60), np.arange(60)
    expected = brute(points, P, radii, groups, 60)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)
    sure = abs(expected) > 1e-12
    assert ((found <= 0.0) == (expected <= 0.0))[sure].all()


def test_a_robot_among_clouds_is_as_far_as_every_point_says(qiao, rng):
    P = rng.uniform(-1.0, 1.0, (400, 3))
    scan = {"cloud": {"points": P.tolist(), "radius": 0.02}, "position": [1, 0.2, 1], "rpy": [0.3, -0.4, 2.0]}
    dust = {"cloud": {"points": (0.1 * P[:50]).tolist(), "radius": 0.001}, "ignore": ["M"], "margin": 0.01}
    dust["position"] = [0.5, 1.5, 0.5]
    ball = {"sphere": {"radius": 0.1}, "position": [1, 1, 1]}
    world = ikde.load_world({"obstacles": {"scan": scan, "ball": ball, "dust": dust}})
    model = CollisionModel.of(qiao).in_world(world, 0.003)
    q = rng.uniform(*qiao.drawn, (9, 9))
    gaps = compute_world_gaps(model, q).reshape(9, -1, 3)
    for component, (centres, radii) in compute_components(model, q).items():
        row = gaps[:, model.components.index(component)]
        for k, name in enumerate(world.names):
            away = (measure_obstacle(world[name], centres) - radii).min(axis=1)
            extra = model.extra_m(len(model.pairs) + model.components.index(component) * 3 + k)
            expected = np.full(9, np.inf) if component in world[name].ignore else away - extra
            np.testing.assert_allclose(row[:, k], expected, rtol=0, atol=1e-12)
