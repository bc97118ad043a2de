"""Draws by number: the kernels' own bits, on arrays; free is what plain numpy calls free."""

import numpy as np
import pytest

import ikde
from ikde.kernels import frames
from ikde.kernels.rng import next_uniform, seed_stream
from ikde.kernels.trig import sin_cos
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver.engines import draws
from ikde.solver.problem import pack_searched
from tests.collision_robots import CASES, away_from_contact, find_gaps, name_case
from tests.conftest import ROBOTS, random_q
from tests.random_robots import random_robot
from tests.uncompiled import plain, plain_module, quietly

FRAMES = plain_module(frames)


def test_draws_are_those_of_the_stream(qiao):
    state, q = np.empty(1, dtype=np.uint64), np.empty((20, 9))
    with quietly():
        plain(seed_stream)(draws.STREAM, 0, 0, state)
        for row in q:
            for k, (lower, upper) in enumerate(zip(qiao.lower, qiao.upper, strict=True)):
                row[k] = lower + plain(next_uniform)(state) * (upper - lower)
    assert draws.draw(np.arange(20), qiao.lower, qiao.upper).tobytes() == q.tobytes()
    few = np.array([3, 19, 7])
    assert draws.draw(few, qiao.lower, qiao.upper).tobytes() == q[few].tobytes()


def test_sines_of_arrays_are_those_of_the_kernels(rng):
    angles = [0.0, -0.0, *(k * np.pi / 4.0 for k in range(-9, 10)), *rng.uniform(-1e5, 1e5, 200)]
    expected = np.array([plain(sin_cos)(angle) for angle in angles]).T
    assert np.array(draws.sin_cos(np.array(angles))).tobytes() == expected.tobytes()


@pytest.mark.parametrize("robot", [*map(ikde.load_robot, ROBOTS), *map(random_robot, range(6))])
def test_tools_stand_where_the_kernels_put_them(robot, rng, monkeypatch):
    monkeypatch.setattr(draws, "CHUNK", 4)
    arrays, Q = pack_robot(robot), random_q(robot, rng, 10)
    expected = np.empty((12, 10))
    for row, q in enumerate(Q):
        T_world_body, T_world_tool = np.empty((len(arrays.bodies), 3, 4)), np.empty((3, 4))
        FRAMES.compute_bodies(arrays, q, T_world_body)
        FRAMES.compute_tool(arrays, T_world_body, T_world_tool)
        expected[:, row] = T_world_tool.ravel()
    assert draws.place_tools(arrays, Q).tobytes() == expected.tobytes()


@pytest.mark.parametrize("case", CASES, ids=name_case)
def test_free_is_what_plain_numpy_calls_free(case, rng):
    robot, detector = case
    Q, collision = random_q(robot, rng, 300), CollisionModel(robot=robot, detector=detector)
    arrays, searched = pack_searched(collision)
    gaps = find_gaps(robot, detector, Q)
    sure = away_from_contact(gaps, collision.limit_m)
    found = draws.find_free(searched, draws.place_bodies(arrays, Q))
    assert (found == (gaps > collision.limit_m).all(axis=1))[sure].all()
    assert sure.sum() > 200


def test_of_many_spheres_in_groups_none_that_touch_is_missed(qiao, monkeypatch):
    """Two clouds of spheres about the base and a link of the arm, against all distances at once."""
    draw = np.random.default_rng(4)
    arrays, searched = pack_searched(CollisionModel.of(qiao))
    spread, small = np.array([[0.5], [0.2], [0.1]]), np.array([[0.1], [0.1], [0.02]])
    p = np.concatenate([draw.normal(size=(3, 50)) * spread, draw.normal(size=(3, 37)) * small], axis=1)
    radius, last = draw.uniform(0.02, 0.09, 87), len(arrays.bodies) - 1
    near = np.array([[0.0, 0, 0, 9.0], [0, 0, 0, 9.0]])
    parts, pairs = np.array([[2, 0, 50], [last, 50, 87]]), np.array([[0, 1]])
    many = searched._replace(p_body_sphere=p, radius=radius, components=parts, bounds=near, pairs=pairs)
    T = draws.place_bodies(arrays, draws.draw(np.arange(400), qiao.lower, qiao.upper))
    own, other = (
        np.einsum("ijk,js->isk", T[body, :, :3], p[:, first:end]) + T[body, :, 3, None] for body, first, end in parts
    )
    away = np.linalg.norm(own[:, :, None] - other[:, None], axis=0) - (radius[:50, None] + radius[50:])[..., None]
    expected = away.min(axis=(0, 1)) > many.safe_distance
    assert 0.1 < expected.mean() < 0.9
    for most in (1, 7, 100):
        monkeypatch.setattr(draws, "GROUP", most)
        assert (draws.find_free(many, T) == expected).all()
        assert max(len(group.radii) for group in draws.group_spheres(many, 0)) <= most


def test_without_pairs_everything_is_free(qiao, rng):
    arrays, searched = pack_searched(CollisionModel.of(qiao, "none"))
    assert draws.find_free(searched, draws.place_bodies(arrays, random_q(qiao, rng, 9))).all()


@pytest.mark.parametrize("chunk", [7, 64, 4096])
def test_the_first_that_are_free_are_found_in_order(qiao, monkeypatch, chunk):
    monkeypatch.setattr(draws, "CHUNK", chunk)
    arrays, searched = pack_searched(CollisionModel.of(qiao))
    every = np.arange(400)
    is_free = draws.find_free(searched, draws.place_bodies(arrays, draws.draw(every, qiao.lower, qiao.upper)))
    found = draws.draw_free(arrays, searched, qiao.lower, qiao.upper, 40)
    assert found.tolist() == every[is_free][:40].tolist()


def test_what_is_never_free_comes_to_an_end(qiao):
    arrays, searched = pack_searched(CollisionModel.of(qiao))
    Q = draws.draw(np.arange(50), qiao.lower, qiao.upper)
    stuck = Q[~draws.find_free(searched, draws.place_bodies(arrays, Q))][0]
    assert len(draws.draw_free(arrays, searched, stuck, stuck, 10)) == 0
    few = draws.draw_free(arrays, searched._replace(safe_distance=0.0999), qiao.lower, qiao.upper, 10)
    assert len(few) < 10
    assert few.max(initial=0) < 10 * draws.DRAWS
