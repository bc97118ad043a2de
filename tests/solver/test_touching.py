"""Pairs that touch whatever the joints do are found, and the lines that leave them out load."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver import touching as module
from ikde.solver.plain import compute_gaps
from ikde.solver.touching import TO_FILL_IN, find_always_touching, find_standing
from tests.bare_robot import BARE
from tests.robot_files import load_text

FAT = BARE.replace("radius: 0.35", "radius: 0.9")  # the platform reaches the shoulder, and the upper arm with it
FATTER = BARE.replace("radius: 0.35", "radius: 2.0")
DECLARED = 'adjacent:\n  pairs:\n    platform: {upper_arm: "made of one casting"}\n'


def find(robot):
    return find_always_touching(CollisionModel.of(robot))


@pytest.mark.parametrize("name", ikde.robot_names())
def test_no_shipped_robot_touches_itself_always(name):
    robot = ikde.load_robot(name)
    assert CollisionModel.of(robot).detector is None or find(robot) is None


def test_one_sphere_a_component_is_known_to_touch_always(qiao):
    """[Qiao2021, section 5.3.1]: even at home. Its pairs are a list of the file, so no line would help."""
    touching = find_always_touching(CollisionModel.of(qiao, "single"))
    assert (touching.pairs, touching.lines) == ((("M", "L1"),), ())
    assert touching.remedy == "take it out of the pair list formula_22"


def test_a_pair_that_is_ever_apart_is_not_called_so():
    assert find(load_text(BARE)) is None


def test_the_safe_distance_counts():
    robot = load_text(BARE)
    far = CollisionModel.of(robot, replace(CollisionModel.of(robot).detector, safe_distance_m=10.0))
    assert find_always_touching(far).pairs == far.pairs


def test_a_pair_that_touches_always_stays_compared():
    robot = load_text(FAT)
    assert ("platform", "upper_arm") in CollisionModel.of(robot).pairs
    assert str(find(robot)) == "platform - upper_arm touches in each of 1,000 random configurations"


def test_the_line_to_add_loads_and_leaves_the_pairs_out():
    touching = find(load_text(FATTER))
    assert touching.remedy == "add to the robot file"
    (line,) = touching.lines
    assert line == f'adjacent: {{pairs: {{platform: {{upper_arm: "{TO_FILL_IN}", forearm: "{TO_FILL_IN}"}}}}}}'
    with pytest.raises(ikde.InputError, match="all 3 pairs are left out"):
        load_text(FATTER + line)
    (line,) = find(load_text(FAT)).lines
    assert find(load_text(FAT + line)) is None


def test_what_is_declared_already_keeps_its_reason():
    touching = find(load_text(FATTER + DECLARED))
    assert (touching.pairs, touching.remedy) == (
        (("platform", "forearm"),),
        "write under adjacent: pairs: of the robot file",
    )
    (line,) = touching.lines
    assert line == f'platform: {{upper_arm: "made of one casting", forearm: "{TO_FILL_IN}"}}'


@pytest.mark.parametrize("name", ["left arm", "a: b", "#1", "é", "[x]", "no", "12", 'say "hi"', "back\\slash", "手腕"])
def test_names_that_yaml_would_read_otherwise_are_quoted(name):
    quoted = "'" + name + "'"
    robot = load_text(FAT.replace("component: upper_arm", f"component: {quoted}"))
    (line,) = find(robot).lines
    again = load_text(FAT.replace("component: upper_arm", f"component: {quoted}") + line)
    assert [(pair.a, pair.b) for pair in again.adjacent] == [("platform", name)]


def test_configurations_lie_inside_the_limits(substitute):
    robot, seen = load_text(BARE), []

    def record(collision, q, pairs):
        seen.append(q)
        return -np.ones((len(q), len(pairs)))

    substitute(compute_gaps, record)
    find_always_touching.cache_clear()  # an equal robot was asked about before
    find(robot)
    find_always_touching.cache_clear()  # what was recorded is no answer
    drawn = np.concatenate(seen)
    assert len(drawn) == 1000
    assert (drawn >= robot.lower).all()
    assert (drawn <= robot.upper).all()


def test_many_spheres_are_compared_a_few_configurations_at_a_time(monkeypatch, substitute):
    robot, sizes = load_text(FATTER), []
    expected = find(robot).pairs
    find_always_touching.cache_clear()

    def record(collision, q, pairs):
        sizes.append(len(q) * len(pairs))
        return compute_gaps(collision, q, pairs)

    substitute(compute_gaps, record)
    monkeypatch.setattr(module, "ROOM", 300)
    assert find(robot).pairs == expected
    assert max(sizes) <= 300
    assert len(sizes) > 3


HUB = "tool: tip", "  hub: {parent: deck, xyz: [0.2, 0, 0.25]}\ntool: tip"  # below the shoulder, on its axis
LARGE = "platform, from: platform, radius: 0.35", "platform, from: hub, radius: 0.3"
ROW = "from: upper_arm_start, to: upper_arm_end, radius: 0.075, count: 8, spacing: even"
STANDING = BARE.replace(*HUB).replace(*LARGE).replace(ROW, "from: upper_arm, radius: 0.119")


def test_a_pair_that_never_moves_is_found_with_its_clearance():
    """The upper arm's sphere stands on two axes: 0.43 m above the hub, less 0.3 and 0.119."""
    (pair,) = find_standing(CollisionModel.of(load_text(STANDING)))
    assert (pair.a, pair.b) == ("platform", "upper_arm")
    assert pair.clearance_m == pytest.approx(0.011, abs=1e-12)


@pytest.mark.parametrize("radius", ["0.05", "0.121"])  # far apart, and within the safe distance of 10 mm
def test_what_stands_far_apart_or_touches_is_not_called_standing(radius):
    assert find_standing(CollisionModel.of(load_text(STANDING.replace("0.119", radius)))) == ()


def test_a_pair_that_moves_is_not_called_standing():
    moved = STANDING.replace("from: upper_arm,", "from: upper_arm_end,").replace("0.119", "0.3")
    assert find_standing(CollisionModel.of(load_text(moved))) == ()


def test_nothing_stands_where_nothing_is_compared(qiao):
    assert find_standing(CollisionModel.of(qiao, "none")) == ()
