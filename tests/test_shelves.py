"""`benchmarks/shelves.py` on few of its scenes: paths among shelves are certified, and dense samples show no less."""

import importlib
from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain_world import measure_obstacle

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def shelves():
    """The script."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield importlib.import_module("benchmarks.shelves")


@pytest.mark.parametrize(("cart", "seed"), [(False, 3), (True, 1)])
def test_paths_among_shelves_are_certified_and_dense_samples_show_no_less(shelves, qiao, cart, seed):
    robot = shelves.make_cart() if cart else qiao
    obstacles, points = shelves.draw_scene(seed)
    model = CollisionModel.of(robot).in_world(ikde.load_world({"obstacles": obstacles}), shelves.MARGIN_M)
    motion = ikde.follow_path(robot, ikde.ToolPath.through(points[::4], dt_s=0.08), collision=model)
    assert motion.reached, motion.stop.line
    assert motion.certificate.is_free
    dense = shelves.compare_densely(motion, model, obstacles)
    assert dense["above_world_m"] >= 0.0
    assert dense["above_own_m"] >= 0.0
    assert dense["dense_clearance_m"] > shelves.MARGIN_M
    assert dense["dense_clearance_m"] >= motion.certificate.world_m.min()


def test_dense_samples_are_on_the_arc_and_end_at_the_samples(shelves, qiao):
    line = np.column_stack([np.full(5, 0.9), np.linspace(0.0, 0.04, 5), np.full(5, 0.9)])
    motion = ikde.follow_path(qiao, ikde.ToolPath.through(line, dt_s=0.02))
    base = [qiao.joint_names.index(name) for name in motion.base_joints]
    for segment in range(4):
        q = shelves.sample_densely(motion, segment, 8)
        np.testing.assert_allclose(q[[0, -1]], motion.q[segment : segment + 2], rtol=0, atol=1e-12)
        start, v, omega = motion.q[segment, base], motion.v[segment], motion.omega[segment]
        arc = [step_base(start, v, omega, share * 0.02) for share in np.linspace(0.0, 1.0, 9)]
        np.testing.assert_allclose(q[:, base], arc, rtol=0, atol=1e-12)


def test_distances_of_scenes_are_those_of_the_graders(shelves, rng):
    obstacles, _ = shelves.draw_scene(7)
    world, P = ikde.load_world({"obstacles": obstacles}), rng.uniform(-2.0, 2.0, (200, 3))
    graded = np.min([measure_obstacle(obstacle, P) for obstacle in world], axis=0)
    np.testing.assert_allclose(shelves.measure_distances(obstacles, P), graded, rtol=0, atol=1e-12)
    kinds = {next(iter(solid)) for solid in obstacles.values()}
    assert kinds == {"box", "cylinder"}


def test_a_scene_is_its_seed(shelves):
    (one, path), (again, same), (other, _) = (shelves.draw_scene(seed) for seed in (5, 5, 6))
    assert one == again
    assert one != other
    np.testing.assert_array_equal(path, same)
