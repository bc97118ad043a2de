"""Neighbours: components of one body, joined by a joint, or declared, whatever the bodies in between carry."""

from dataclasses import replace
from itertools import combinations

import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.pairs import component_bodies, describe_link, explain_no_detector
from ikde.model.robot import AdjacentPair, Detector, LeftOutPair, SphereRow
from ikde.model.tree import build_tree
from ikde.model.validate import NON_ADJACENT
from tests.bare_robot import BARE
from tests.conftest import ROBOTS
from tests.random_robots import make_frame, make_robot, random_robot

Z = (0, 0, 1)
PARENTS = {"a": "world", "b": "a", "c": "b", "d": "c", "e": "a"}  # a chain, and a branch that leaves a
EVERY = Detector(name="every", spheres="s", pairs=NON_ADJACENT)


def make_chain(carriers="abcd", **changes):
    """World, a - b - c - d and a - e; each of `carriers` carries a component that is called like it in capitals."""
    rows = tuple(SphereRow(component=name.upper(), start=name, end=name, radius_m=0.1) for name in carriers)
    spheres = {"approximations": {"s": rows} if rows else {}}
    frames = [make_frame(name, parent, (1, 0, 0), joint=f"j{name}", axis=Z) for name, parent in PARENTS.items()]
    return make_robot({f"j{name}": "revolute" for name in PARENTS}, frames, tool="d", **{**spheres, **changes})


def reasons(robot, detector=EVERY):
    return {f"{pair.a}{pair.b}": pair.reason for pair in CollisionModel(robot=robot, detector=detector).left_out_pairs}


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ("a", "a", "one body"),
        ("world", "world", "one body"),
        ("a", "b", "joined by joint jb"),
        ("world", "a", "joined by joint ja"),
        ("a", "e", "joined by joint je"),
        ("a", "c", None),
        ("world", "b", None),
        ("b", "e", None),  # siblings
        ("a", "d", None),
    ],
)
def test_bodies_are_linked_when_they_are_one_or_a_joint_joins_them(a, b, expected):
    robot = make_chain()
    tree = build_tree(robot)
    bodies = tree.frame_body
    assert describe_link(robot, tree, bodies[a], bodies[b]) == expected
    assert describe_link(robot, tree, bodies[b], bodies[a]) == expected


def test_pairs_two_joints_apart_are_compared_although_the_body_in_between_is_bare():
    assert make_chain("ac").pair_lists[NON_ADJACENT] == (("A", "C"),)
    assert make_chain("ad").pair_lists[NON_ADJACENT] == (("A", "D"),)


def test_the_platform_is_compared_with_the_upper_arm_beyond_a_bare_shoulder(tmp_path):
    (tmp_path / "bare.yaml").write_text(BARE)
    robot = ikde.load_robot(tmp_path / "bare.yaml")
    assert CollisionModel.of(robot).pairs == (("platform", "upper_arm"), ("platform", "forearm"))


def test_declared_pairs_are_left_out_in_either_order_with_their_reason():
    assert make_chain().pair_lists[NON_ADJACENT] == (("A", "C"), ("A", "D"), ("B", "D"))
    declared = (AdjacentPair(a="D", b="A", reason="welded"), AdjacentPair(a="B", b="D", reason="a hose"))
    robot = make_chain(adjacent=declared)
    assert robot.pair_lists[NON_ADJACENT] == (("A", "C"),)
    assert reasons(robot)["AD"] == "adjacent: welded"
    assert reasons(robot)["BD"] == "adjacent: a hose"


def test_what_is_declared_comes_before_what_the_tree_shows_and_that_before_lists():
    declared = (AdjacentPair(a="A", b="B", reason="welded"), AdjacentPair(a="A", b="C", reason="welded"))
    robot = make_chain(adjacent=declared, pair_lists={"some": (("D", "B"),)})
    found = reasons(robot, replace(EVERY, pairs="some"))
    assert found == {
        "AB": "adjacent: welded",
        "AC": "adjacent: welded",
        "AD": "not in the pair list some",
        "BC": "joined by joint jc",
        "CD": "joined by joint jd",
    }


def test_what_the_file_says_is_compared_is_compared_although_a_joint_joins_it():
    robot = make_chain("abc", compared=(("B", "A"),))
    assert robot.pair_lists[NON_ADJACENT] == (("A", "B"), ("A", "C"))
    assert reasons(robot) == {"BC": "joined by joint jc"}


def test_a_pair_is_not_both_compared_and_adjacent():
    with pytest.raises(InputError, match=r"compare\.B: 'A' and 'B' are declared adjacent as well"):
        make_chain(compared=(("B", "A"),), adjacent=(AdjacentPair(a="A", b="B", reason="glued"),))
    with pytest.raises(InputError, match=r"compare\.A: no component is called 'Z'"):
        make_chain(compared=(("A", "Z"),))


def test_a_list_may_compare_what_is_linked():
    robot = make_chain("ab", pair_lists={"some": (("A", "B"),)})
    assert CollisionModel(robot=robot, detector=replace(EVERY, pairs="some")).left_out_pairs == ()


def test_components_of_one_body_are_neighbours():
    rows = tuple(SphereRow(component=name, start="a", end="a", radius_m=0.1) for name in "AB")
    robot = make_chain(approximations={"s": rows})
    assert robot.pair_lists[NON_ADJACENT] == ()
    assert robot.neighbours == (LeftOutPair(a="A", b="B", reason="one body"),)


def test_without_a_detector_nothing_is_listed(qiao):
    assert CollisionModel.of(qiao, "none").left_out_pairs == CollisionModel.of(qiao, "none").pairs == ()


def every_case():
    for name in ikde.robot_names():
        robot = ikde.load_robot(name)
        yield from ((robot, detector) for detector in robot.detectors.values())
    for robot in map(random_robot, range(20)):
        yield robot, CollisionModel.of(robot).detector
        if robot.pair_lists[NON_ADJACENT]:
            yield robot, replace(CollisionModel.of(robot).detector, pairs=NON_ADJACENT)


@pytest.mark.parametrize("case", list(every_case()), ids=lambda case: f"{case[0].name}-{case[1].name}-{case[1].pairs}")
def test_every_pair_of_components_is_compared_or_left_out_with_a_reason(case):
    robot, detector = case
    compared = [frozenset(pair) for pair in CollisionModel(robot=robot, detector=detector).pairs]
    left_out = [frozenset((pair.a, pair.b)) for pair in CollisionModel(robot=robot, detector=detector).left_out_pairs]
    every = {frozenset(pair) for pair in combinations(robot.components(detector.spheres), 2)}
    assert set(compared) | set(left_out) == every
    assert len(compared) + len(left_out) == len(every)
    assert all(pair.reason for pair in CollisionModel(robot=robot, detector=detector).left_out_pairs)


def test_the_shipped_robots_compare_as_many_pairs_as_ever():
    count = {name: len(CollisionModel.of(r).pairs) for name in ROBOTS for r in [ikde.load_robot(name)]}
    assert count == {"panda": 21, "qiao2021": 35, "qiao2021_dh": 0, "ur5": 15}
    assert len(ikde.load_robot("qiao2021").pair_lists[NON_ADJACENT]) == 33


def test_why_there_is_no_detector_is_told_apart(qiao):
    assert explain_no_detector(make_chain("")) == "made has no spheres"
    assert explain_no_detector(make_chain()) == "made has spheres, but no detector"
    off = replace(qiao, default_detector="none")
    assert explain_no_detector(off) == "the default detector of qiao2021 is none; it has single, typical, improved"


def test_a_component_lies_on_the_body_of_its_key_points():
    rows = (
        SphereRow(component="A", start="a", end="a", radius_m=1.0),
        SphereRow(component="W", start="world", end="world", radius_m=1.0),
    )
    tree = build_tree(make_chain())
    assert component_bodies(rows, tree) == {"A": tree.frame_body["a"], "W": 0}


def test_the_paper_looks_at_three_pairs_that_a_joint_connects(qiao):
    known = {frozenset(pair) for pair in qiao.pair_lists[NON_ADJACENT]}
    connected = {pair for pair in qiao.pair_lists["formula_22"] if frozenset(pair) not in known}
    assert connected == {("J2", "J4"), ("J2", "L2"), ("L1", "J4")}
