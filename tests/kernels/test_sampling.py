"""Random targets against a plain twin, the laws that they obey, and the same bits with and without compilation."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.kernels.draws import SAMPLING, draw_free
from ikde.kernels.sampling import place_tools, sample_ball, sample_box
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests import reference
from tests.random_robots import random_robot

ROOT = Path(__file__).parents[2]
SCRIPT = "import json; from tests.kernels.test_sampling import sample_all; print(json.dumps(sample_all()))"
few = settings(max_examples=25)
seeds = st.integers(0, 2**64 - 1)
coordinates = st.floats(-10, 10)
points = st.tuples(coordinates, coordinates, coordinates)

pytestmark = pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # uncompiled words wrap around


def run(kernel, *shape, seed=0, first=0, out):
    kernel(*shape, np.uint64(seed), np.int64(first), out)
    return out


def box(lower, upper, seed, first, count):
    return run(
        sample_box, np.array(lower, float), np.array(upper, float), seed=seed, first=first, out=np.empty((count, 3))
    )


def ball(center, radius, filled, seed, first, count):
    out = np.empty((count, 3))
    return run(sample_ball, np.array(center, float), float(radius), filled, seed=seed, first=first, out=out)


def poses(robot, seed, first, count):
    """Of the first free configurations, by the tables."""
    packed, q = pack_robot(robot), np.empty((count, len(robot.joints)))
    run(draw_free, packed, CollisionModel.of(robot).arrays, robot.lower, robot.upper, seed=seed, first=first, out=q)
    out_T = np.empty((count, 3, 4))
    place_tools(packed, q, out_T)
    return out_T


def sample_all():
    """The bits of some targets of every kind, as hexadecimal text."""
    robot = ikde.load_robot("qiao2021")
    arrays = [
        box((-1, 0, 1), (1, 2, 4), 3, 10**9, 5),
        ball((0.1, 0.2, 0.3), 0.7, True, 3, 5, 5),
        ball((0.1, 0.2, 0.3), 0.7, False, 2**64 - 1, 5, 5),
        poses(robot, 3, 0, 5),
    ]
    return [array.tobytes().hex() for array in arrays]


def draw_from(stream, lower, upper):
    return np.array([a + stream.uniform() * (b - a) for a, b in zip(lower, upper, strict=True)])


@few
@given(seed=seeds, first=st.integers(0, 2**40), lower=points, upper=points)
def test_a_box_equals_the_twin(seed, first, lower, upper):
    for k, p in enumerate(box(lower, upper, seed, first, 3)):
        stream = reference.Stream.for_attempt(seed, first + k, int(SAMPLING))
        np.testing.assert_array_equal(p, draw_from(stream, lower, upper))


@few
@given(seed=seeds, first=st.integers(0, 2**40), center=points, filled=st.booleans())
def test_a_ball_equals_the_twin(seed, first, center, filled):
    for k, p in enumerate(ball(center, 2.5, filled, seed, first, 3)):
        stream = reference.Stream.for_attempt(seed, first + k, int(SAMPLING))
        v = np.full(3, 2.0)
        while not (0.0 if filled else 1e-4) <= v @ v <= 1.0:
            v = draw_from(stream, (-1, -1, -1), (1, 1, 1))
        expected = center + 2.5 * (v if filled else v / np.linalg.norm(v))
        np.testing.assert_allclose(p, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", range(6))
def test_a_tool_is_where_its_frame_is(seed):
    robot = random_robot(seed)
    q = np.random.default_rng(seed).uniform(robot.lower, robot.upper, (4, len(robot.joints)))
    out_T = np.empty((4, 3, 4))
    place_tools(pack_robot(robot), q, out_T)
    for row, T in zip(q, out_T, strict=True):
        np.testing.assert_allclose(T, reference.compute_frames(robot, row)["tool"][:3], rtol=0, atol=1e-13)


@few
@given(seed=seeds, first=st.integers(0, 10**9), cut=st.integers(0, 6))
def test_any_cut_gives_the_same_bits(qiao, seed, first, cut):
    for sample in (
        lambda k, n: box((-1, -1, -1), (1, 2, 3), seed, k, n),
        lambda k, n: ball((0, 0, 0), 1, False, seed, k, n),
        lambda k, n: poses(qiao, seed, k, n),
    ):
        parts = sample(first, cut), sample(first + cut, 6 - cut)
        np.testing.assert_array_equal(sample(first, 6), np.concatenate(parts))


def test_points_fill_a_ball_and_its_surface_evenly():
    inside, surface = ball((1, 2, 3), 2.0, True, 1, 0, 20_000), ball((1, 2, 3), 2.0, False, 1, 0, 20_000)
    radii = np.linalg.norm(inside - (1, 2, 3), axis=1)
    assert radii.max() <= 2.0
    assert np.mean(radii <= 2.0 * 0.5 ** (1 / 3)) == pytest.approx(0.5, abs=0.02)  # half of the volume
    assert np.linalg.norm(surface - (1, 2, 3), axis=1) == pytest.approx(2.0, abs=1e-14)
    assert np.histogram(surface[:, 2], bins=4, range=(1, 5))[0] == pytest.approx(5_000, abs=300)  # Archimedes


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_uncompiled_kernels_give_the_same_bits():
    command = [sys.executable, "-W", "error", "-W", "ignore:overflow encountered:RuntimeWarning", "-c", SCRIPT]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == sample_all()
