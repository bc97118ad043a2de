"""Adjacency: components that a joint connects are no pair, and a bare body in between does not part them."""

import pytest

from ikde.model.pairs import are_adjacent, component_bodies, non_adjacent_pairs
from ikde.model.robot import SphereRow
from ikde.model.tree import build_tree
from ikde.model.validate import NON_ADJACENT
from tests.random_robots import make_frame, make_robot, random_robot

Z = (0, 0, 1)


@pytest.fixture
def tree():
    """World, then a chain a - b - c - d, and a branch e that leaves a."""
    parents = {"a": "world", "b": "a", "c": "b", "d": "c", "e": "a"}
    frames = [make_frame(name, parents[name], (1, 0, 0), joint=f"j{name}", axis=Z) for name in parents]
    joints = {f"j{name}": "revolute" for name in "abcde"}
    return build_tree(make_robot(joints, frames, tool="d"))


def adjacent(tree, occupied, a, b):
    bodies = tree.frame_body
    found = are_adjacent(tree, {bodies[name] for name in occupied}, bodies[a], bodies[b])
    assert found == are_adjacent(tree, {bodies[name] for name in occupied}, bodies[b], bodies[a])
    return found


@pytest.mark.parametrize(
    ("occupied", "a", "b", "expected"),
    [
        ("abcde", "a", "a", True),
        ("abcde", "a", "b", True),
        ("abcde", "a", "c", False),
        ("acde", "a", "c", True),  # b carries nothing
        ("ade", "a", "d", True),
        ("abcde", "a", "e", True),
        ("abcde", "b", "e", False),  # siblings
        ("bcde", "b", "e", False),
        ("abcde", "d", "e", False),
    ],
)
def test_bodies_are_adjacent_when_a_joint_connects_them(tree, occupied, a, b, expected):
    assert adjacent(tree, occupied, a, b) == expected


def test_the_world_is_adjacent_to_the_first_body_that_carries_a_component(tree):
    assert adjacent(tree, ["world", "c"], "world", "c")
    assert not adjacent(tree, ["world", "a", "c"], "world", "c")


def test_listed_pairs_are_left_out_in_either_order(tree):
    bodies = {name.upper(): tree.frame_body[name] for name in "abcd"}
    assert non_adjacent_pairs(bodies, tree, ()) == (("A", "C"), ("A", "D"), ("B", "D"))
    assert non_adjacent_pairs(bodies, tree, (("D", "A"), ("B", "D"))) == (("A", "C"),)


def test_components_of_one_body_are_adjacent(tree):
    assert non_adjacent_pairs({"A": 1, "B": 1}, tree, ()) == ()


def test_a_component_lies_on_the_body_of_its_key_points(tree):
    rows = (
        SphereRow(component="A", start="a", end="a", radius_m=1.0),
        SphereRow(component="W", start="world", end="world", radius_m=1.0),
    )
    assert component_bodies(rows, tree) == {"A": tree.frame_body["a"], "W": 0}


def test_the_paper_looks_at_three_pairs_that_a_joint_connects(qiao):
    known = {frozenset(pair) for pair in qiao.pair_lists[NON_ADJACENT]}
    connected = {pair for pair in qiao.pair_lists["formula_22"] if frozenset(pair) not in known}
    assert connected == {("J2", "J4"), ("J2", "L2"), ("L1", "J4")}


@pytest.mark.parametrize("seed", range(10))
def test_no_pair_is_listed_twice_or_on_one_body(seed):
    robot = random_robot(seed)
    pairs = robot.pair_lists[NON_ADJACENT]
    bodies = component_bodies(robot.approximations["spheres"], build_tree(robot))
    assert len({frozenset(pair) for pair in pairs}) == len(pairs)
    assert all(bodies[a] != bodies[b] for a, b in pairs)
