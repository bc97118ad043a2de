"""Lattices are the spheres of a component: all of them but those inside others, and no others."""

import numpy as np
import pytest

from ikde.kernels.arrays import FIRST, LAST
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.lattice import component_lattices
from tests.collision_robots import CASES, make_row, name_case, two_arms


def assert_same_spheres(packed, component, lattices):
    """The spheres of a component that are not inside another: no other centre, none twice, none left out.

    A sphere that touches the one around it from inside may stay or go.
    """
    first, last = (int(packed.components[component, k]) for k in (FIRST, LAST))
    centres, radii = packed.p_body_sphere.T[first:last], packed.radius[first:last]
    made = np.array([(*centre, lattice.radius) for lattice in lattices for centre in lattice.centres])
    gaps = np.abs(made[:, None] - np.column_stack([centres, radii])[None]).max(axis=2)
    assert gaps.min(axis=1).max() < 1e-14
    kept = set(gaps.argmin(axis=1).tolist())
    assert len(kept) == len(made)
    room = radii[None] - radii[:, None] - np.linalg.norm(centres[:, None] - centres[None], axis=2)
    for i in range(last - first):
        others = [j for j in range(last - first) if j != i]
        outermost = not others or room[i, others].max() < -1e-12
        covered = [j for j in others if room[i, j] > 1e-12 or (room[i, j] == 0.0 == room[j, i] and j < i)]
        assert i in kept or not outermost
        assert i not in kept or not covered
        assert i in kept or room[i, sorted(kept)].max() >= 0.0  # what is left out lies inside one that stays


@pytest.mark.parametrize("case", CASES, ids=name_case)
def test_lattices_are_the_spheres_that_are_not_inside_others(case):
    packed = CollisionModel(robot=case[0], detector=case[1]).arrays
    for component in range(len(packed.components)):
        lattices = component_lattices(packed, component)
        assert_same_spheres(packed, component, lattices)
        assert {lattice.body for lattice in lattices} == {int(packed.components[component, 0])}


def lattices_of(rows, **points):
    """Lattices of component x, whose rows stand between points of one body."""
    far = {"far": ("f1", (5.0, 5.0, 5.0))}
    robot = two_arms(
        [*rows, make_row("y", "far", "far", 0.01)],
        [("x", "y")],
        {name: ("f0", xyz) for name, xyz in points.items()} | far,
    )
    packed = CollisionModel.of(robot).arrays
    component = int(np.argmin(packed.components[:, 0]))
    lattices = component_lattices(packed, component)
    assert_same_spheres(packed, component, lattices)
    return lattices


def counts(lattices):
    return [tuple(count for _, _, count in lattice.axes) for lattice in lattices]


@pytest.mark.parametrize("count", range(1, 8))
@pytest.mark.parametrize("spacing", ["even", "touching"])
def test_a_row_is_one_lattice(count, spacing):
    (lattice,) = lattices_of([make_row("x", "a", "b", 0.05, count, spacing)], a=(0.1, 0.2, 0.3), b=(0.5, -0.3, 1.0))
    assert counts([lattice]) == [(count,) if count > 1 else ()]


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_two_equal_rows_side_by_side_are_one_grid(count):
    rows = [make_row("x", "a", "b", 0.05, count), make_row("x", "c", "d", 0.05, count)]
    u, v = np.array([0.6, 0.48, 0.64]), np.array([0.8, -0.36, -0.48])
    corners = {"a": -0.3 * u, "b": 0.3 * u, "c": -0.3 * u + 0.2 * v, "d": 0.3 * u + 0.2 * v}
    assert counts(lattices_of(rows, **corners)) == [(count, 2)]


@pytest.mark.parametrize(
    "change",
    [
        {"c": (0.0, 0.2, 0.1), "d": (0.6, 0.2, 0.1), "radius": 0.06},
        {"c": (0.0, 0.2, 0.1), "d": (0.6, 0.2, 0.1), "count": 4},
        {"c": (0.1, 0.2, 0.1), "d": (0.7, 0.2, 0.1)},
        {"c": (0.0, 0.2, 0.1), "d": (0.65, 0.2, 0.1)},
        {"c": (0.0, 0.2, 0.1), "d": (0.6, 0.25, 0.1)},
    ],
    ids=["radius", "count", "shifted", "longer", "oblique"],
)
def test_other_rows_stay_rows(change):
    change = {"radius": 0.05, "count": 3, **change}
    rows = [make_row("x", "a", "b", 0.05, 3), make_row("x", "c", "d", change["radius"], change["count"])]
    lattices = lattices_of(rows, a=(0, 0, 0.1), b=(0.6, 0, 0.1), c=change["c"], d=change["d"])
    assert counts(lattices) == [(3,), (change["count"],)]


def test_a_third_row_stays_beside_the_grid():
    rows = [make_row("x", f"a{k}", f"b{k}", 0.05, 3) for k in range(3)]
    points = {f"{name}{k}": (x, 0.2 * k, 0.1) for k in range(3) for name, x in (("a", 0.0), ("b", 0.6))}
    assert sorted(counts(lattices_of(rows, **points))) == [(3,), (3, 2)]


def test_a_row_that_lost_its_end_is_a_shorter_row():
    rows = [make_row("x", "a", "b", 0.05, 5), make_row("x", "a", "a", 0.08)]
    assert sorted(counts(lattices_of(rows, a=(0, 0, 0), b=(0.8, 0, 0)))) == [(), (4,)]


def test_a_row_that_lost_its_middle_is_single_spheres():
    rows = [make_row("x", "a", "b", 0.05, 5), make_row("x", "c", "c", 0.08)]
    assert counts(lattices_of(rows, a=(0, 0, 0), b=(0.8, 0, 0), c=(0.4, 0.01, 0))) == [(), (), (), (), ()]


def test_of_equal_spheres_one_stays():
    rows = [make_row("x", "a", "a", 0.05), make_row("x", "a", "a", 0.05), make_row("x", "a", "b", 0.05, 3)]
    lattices = lattices_of(rows, a=(0.25, 0.125, 0.125), b=(0.75, 0.125, 0.125))
    assert sorted(counts(lattices)) == [(), (2,)]


def test_a_row_within_a_sphere_is_gone():
    rows = [make_row("x", "a", "b", 0.02, 4), make_row("x", "a", "b", 0.5)]
    assert counts(lattices_of(rows, a=(0, 0, 0), b=(0.1, 0, 0))) == [()]
