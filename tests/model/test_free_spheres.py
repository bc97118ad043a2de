"""Free spheres: anywhere in a frame, and the same to every grader as spheres with a frame each."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import FileError, InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.lattice import component_lattices
from ikde.model.pack import pack_collision
from ikde.model.plain_data import decode, encode
from ikde.model.robot import FreeSpheres, Robot
from ikde.model.spheres import approximation_volume_m3
from ikde.model.validate import check_robot
from ikde.solver.metrics import _sum_lengths
from ikde.solver.plain import compute_components, compute_gaps
from tests.kernels.arrays import run_spheres
from tests.regrade import Grader
from tests.robot_files import load_text

HEAD = """\
name: hammer
units: {length: mm, angle: deg}
joints:
  lift: {kind: revolute, lower: -60, upper: 60}
  swing: {kind: revolute, lower: -170, upper: 170}
frames:
  stand: {parent: world, xyz: [0, 0, 300]}
  boom: {parent: stand, joint: lift, axis: [0, 1, 0]}
  arm: {parent: boom, xyz: [400, 0, 0], joint: swing, axis: [0, 1, 0]}
  head: {parent: arm, xyz: [350, 0, 0], rpy: [0, 40, 25]}
"""
FREE = """\
tool: head
spheres:
  cover:
    - {component: stand, frame: stand, spheres: [[0, 0, 0, 60], [0, 0, -120, 80], [30, 20, -220, 55.5]]}
    - {component: head, from: arm, to: head, radius: 25, count: 3, spacing: even}
    - {component: head, frame: head, spheres: [[10, 0, 40, 45], [0, -30, -40, 35]]}
detectors: {cover: {spheres: cover}}
"""
POINTS = """\
  s1: {parent: stand, xyz: [0, 0, -120]}
  s2: {parent: stand, xyz: [30, 20, -220]}
  h0: {parent: head, xyz: [10, 0, 40]}
  h1: {parent: head, xyz: [0, -30, -40]}
"""
SINGLE = """\
tool: head
spheres:
  cover:
    - {component: stand, from: stand, radius: 60}
    - {component: stand, from: s1, radius: 80}
    - {component: stand, from: s2, radius: 55.5}
    - {component: head, from: arm, to: head, radius: 25, count: 3, spacing: even}
    - {component: head, from: h0, radius: 45}
    - {component: head, from: h1, radius: 35}
detectors: {cover: {spheres: cover}}
"""


@pytest.fixture
def free():
    return load_text(HEAD + FREE)


@pytest.fixture
def q(free):
    return np.random.default_rng(1).uniform(free.lower, free.upper, (50, 2))


def test_they_are_what_spheres_with_a_frame_each_are(free, q):
    other = load_text(HEAD + POINTS + SINGLE)
    for own, twin in zip(free_arrays(free), free_arrays(other), strict=True):
        np.testing.assert_allclose(own, twin, rtol=0, atol=1e-15)
    np.testing.assert_allclose(gaps(free, q), gaps(other, q), rtol=0, atol=1e-15)


def free_arrays(robot):
    packed = pack_collision(robot, robot.detectors["cover"])
    return packed.p_body_sphere, packed.radius, packed.components, packed.bounds, packed.rows[:, 2:], packed.offset


def gaps(robot, q):
    return compute_gaps(CollisionModel.of(robot), q)


def test_plain_numpy_the_kernels_and_a_reader_of_the_file_place_them_alike(free, q):

    collision = CollisionModel.of(free)
    read = Grader.of_text(HEAD + FREE).clearances(q, "cover")
    np.testing.assert_allclose(gaps(free, q)[:, 0], read[frozenset(("stand", "head"))], rtol=0, atol=1e-14)
    plain = np.concatenate([centres for centres, _ in compute_components(collision, q[0]).values()])
    np.testing.assert_allclose(run_spheres(free, collision.detector, q[0])[1].T, plain, rtol=0, atol=1e-14)


def test_each_is_a_lattice_of_its_own_radius(free):
    packed = pack_collision(free, free.detectors["cover"])
    assert sorted(lattice.radius for lattice in component_lattices(packed, 0)) == [0.0555, 0.06, 0.08]


def test_they_come_back_from_json_and_pickle(free):
    assert decode(Robot, encode(free)).approximations == free.approximations
    assert pickle.loads(pickle.dumps(free)).approximations == free.approximations


def test_their_volume_and_their_reach_are_counted(free):
    expected = 4.0 / 3.0 * np.pi * (0.06**3 + 0.08**3 + 0.0555**3)
    assert approximation_volume_m3(free, "cover")["stand"] == pytest.approx(expected, rel=1e-14)
    assert _sum_lengths(free) == pytest.approx(0.3 + 0.4 + 0.35 + 0.3255, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        ("[0, 0, 0, 60]", "[0, 0, 60]", "spheres.cover[0].spheres[0]", "expected 4 values, got 3"),
        ("[0, 0, 0, 60]", "[0, 0, 0, 0]", "spheres.cover[0].spheres[0][3]", "expected a radius above 0"),
        ("[0, 0, 0, 60]", "[0, 0, .nan, 60]", "spheres.cover[0].spheres[0][2]", "expected a finite number"),
        ("[0, 0, 0, 60]", "[0, 2e8, 0, 60]", "spheres.cover[0].spheres[0]", "expected a finite centre"),
        ("frame: stand, ", "", "spheres.cover[0].frame", "this key is missing"),
        ("frame: stand, ", "frame: stant, ", "spheres.cover[0].frame", "did you mean 'stand'"),
        ("frame: stand, ", "frame: stand, radius: 3, ", "spheres.cover[0].radius", "this key is of a row"),
        ("frame: head, ", "frame: boom, ", "spheres.cover[2].component", "a component is rigid"),
        (", spheres: [[10, 0, 40, 45], [0, -30, -40, 35]]", "", "spheres.cover[2].spheres", "this key is missing"),
        ("[[10, 0, 40, 45], [0, -30, -40, 35]]", "[]", "spheres.cover[2].spheres", "expected at least 1 value"),
        ("from: arm, to: head, radius: 25", "from: arm, to: head", "spheres.cover[1].radius", "this key is missing"),
        ("from: arm, to: head", "to: head", "spheres.cover[1].from", "this key is missing"),
    ],
)
def test_what_is_wrong_has_its_key(old, new, key, words):
    assert old in HEAD + FREE
    with pytest.raises(FileError) as caught:
        load_text((HEAD + FREE).replace(old, new, 1))
    assert key in str(caught.value)
    assert words in str(caught.value)


def test_none_at_all_is_refused(free):
    nothing = FreeSpheres(component="stand", frame="stand", spheres=())
    with pytest.raises(InputError, match="expected at least one sphere"):
        check_robot(replace(free, pair_lists={}, approximations={"cover": (nothing,)}))
