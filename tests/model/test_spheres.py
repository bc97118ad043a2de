"""Sphere approximations: the paper's volumes, where a row's centres stand, and bounding spheres."""

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from ikde.model.robot import SphereRow
from ikde.model.spheres import Sphere, approximation_volume_m3, bounding_sphere, expand_rows, row_offsets
from ikde.model.tree import build_tree
from tests import reference
from tests.random_robots import random_robot

# [Qiao2021, Table 2]: volumes of the typical and of the improved approximation, mm^3, as printed.
TABLE_2 = {
    "M": (3.8956e8, 3.8956e8),
    "G": (4.7080e7, 4.7080e7),
    "J1": (4.1888e6, 4.1888e6),
    "J2": (4.1888e6, 4.1888e6),
    "L1": (1.2566e7, 3.6191e6),
    "J3": (4.1888e6, 2.1447e6),
    "L2": (8.5786e6, 4.0532e6),
    "J4": (1.4368e6, 1.4368e6),
    "J5": (1.4368e6, 1.4368e6),
    "J6": (1.4368e6, 1.4368e6),
    "LT": (4.3103e6, 1.5268e6),
}


@pytest.mark.parametrize(("column", "name"), [(0, "typical"), (1, "improved")])
def test_volumes_are_those_of_table_2_to_five_digits(qiao, column, name):
    found = {component: f"{1e9 * volume:.4e}" for component, volume in approximation_volume_m3(qiao, name).items()}
    assert found == {component: f"{volumes[column]:.4e}" for component, volumes in TABLE_2.items()}


def make_row(count, spacing="touching", radius_m=0.1):
    return SphereRow(component="A", start="a", end="b", radius_m=radius_m, count=count, spacing=spacing)


@pytest.mark.parametrize(
    ("count", "spacing", "expected"),
    [
        (1, "touching", [0.0]),
        (1, "even", [0.0]),
        (2, "touching", [-0.1, 0.1]),
        (2, "even", [-0.5, 0.5]),
        (3, "touching", [-0.2, 0.0, 0.2]),
        (5, "even", [-0.5, -0.25, 0.0, 0.25, 0.5]),
    ],
)
def test_offsets_count_from_the_middle(count, spacing, expected):
    np.testing.assert_allclose(row_offsets(make_row(count, spacing), 1.0), expected, rtol=0, atol=1e-16)


@pytest.mark.parametrize("count", range(2, 8))
def test_touching_spheres_stand_two_radii_apart(count):
    np.testing.assert_allclose(np.diff(row_offsets(make_row(count, radius_m=0.03), 9.0)), 0.06, rtol=1e-14)


@pytest.mark.parametrize("count", range(2, 8))
def test_even_spheres_begin_and_end_with_their_line(count):
    offsets = row_offsets(make_row(count, "even"), 0.7)
    assert (offsets[0], offsets[-1]) == (-0.35, 0.35)


@pytest.mark.parametrize("seed", range(15))
def test_expanded_rows_are_the_twins_spheres(seed):
    robot = random_robot(seed)
    tree, detector = build_tree(robot), CollisionModel.of(robot).detector
    T_zero = reference.compute_frames(robot, np.zeros(len(robot.joints)))
    origin = {tree.frame_body[f.name]: f.name for f in robot.frames if f.joint is not None} | {0: "world"}
    looked_at = {component for pair in robot.pair_lists[detector.pairs] for component in pair}
    spheres = [s for s in expand_rows(robot, tree, "spheres") if s.component in looked_at]
    expected = reference.list_spheres(robot, detector, np.zeros(len(robot.joints)))
    assert [(s.component, s.radius_m) for s in spheres] == [(name, radius) for name, _, radius in expected]
    for sphere, (_, centre, _) in zip(spheres, expected, strict=True):
        found = T_zero[origin[sphere.body]] @ [*sphere.p_body_sphere, 1.0]
        np.testing.assert_allclose(found[:3], centre, rtol=0, atol=1e-14)


def make_sphere(p, radius_m):
    return Sphere(component="A", body=0, p_body_sphere=np.array(p), radius_m=radius_m, row=0, offset_m=0.0)


def test_a_bounding_sphere_holds_its_spheres(rng):
    for count in range(1, 12):
        spheres = [
            make_sphere(p, r) for p, r in zip(rng.normal(size=(count, 3)), rng.uniform(0.1, 1, count), strict=True)
        ]
        middle, radius = bounding_sphere(spheres)
        assert all(np.linalg.norm(s.p_body_sphere - middle) + s.radius_m < radius for s in spheres)


def test_the_bounding_sphere_of_one_sphere_is_that_sphere():
    middle, radius = bounding_sphere([make_sphere((1.0, 2.0, 3.0), 0.5)])
    np.testing.assert_allclose(middle, [1.0, 2.0, 3.0], rtol=1e-15)
    assert 0.5 < radius < 0.5 + 1e-8
