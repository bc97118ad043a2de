"""The bound on reach is sound for any tree, and sharp for arms in the usual order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.model.bounds import find_bounds
from ikde.model.reach import arm_length_m
from tests import reference
from tests.random_robots import make_frame, make_robot, random_robot

few = settings(max_examples=150)
ROUNDING = 1e-12


def reach_excess_m(robot, p, lower, upper):
    return find_bounds(robot, lower, upper).reach.excess_m(np.asarray(p))


def tool_position(robot, q):
    return reference.compute_frames(robot, q)[robot.tool][:3, 3]


def random_ranges(robot, rng):
    """Sub-ranges of the limits, some of them frozen, and a configuration inside them."""
    ends = np.sort(rng.uniform(robot.lower, robot.upper, (2, len(robot.joints))), axis=0)
    ends = np.where(rng.random(len(robot.joints)) < 0.2, ends[:1], ends)
    return ends[0], ends[1], rng.uniform(ends[0], ends[1])


@few
@given(seed=st.integers(0, 10_000))
def test_no_random_robot_gets_beyond_its_bound(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    for _ in range(3):
        lower, upper, q = random_ranges(robot, rng)
        assert reach_excess_m(robot, tool_position(robot, q), lower, upper) <= ROUNDING


def test_no_shipped_robot_gets_beyond_its_bound(any_robot, rng):
    for _ in range(100):
        lower, upper, q = random_ranges(any_robot, rng)
        assert reach_excess_m(any_robot, tool_position(any_robot, q), lower, upper) <= ROUNDING


def test_home_is_within_reach(any_robot):
    p = tool_position(any_robot, any_robot.home)
    assert reach_excess_m(any_robot, p, any_robot.lower, any_robot.upper) <= ROUNDING


def test_wider_ranges_never_shorten_the_reach(qiao, rng):
    for _ in range(50):
        lower, upper, _ = random_ranges(qiao, rng)
        p = rng.uniform(-8.0, 8.0, 3)
        assert reach_excess_m(qiao, p, lower, upper) >= reach_excess_m(qiao, p, qiao.lower, qiao.upper)


def test_a_target_above_every_stretch_is_out_of_reach(qiao):
    assert reach_excess_m(qiao, np.array([0.0, 0.0, 5.0]), qiao.lower, qiao.upper) > 1.0


TURNS = {"j0": "revolute", "j1": "revolute"}


def make_planar_arm(first=0.5, second=0.3):
    """Two links in the plane, both joints about z."""
    return make_robot(
        TURNS,
        [
            make_frame("a", "world", joint="j0", axis=(0, 0, 1)),
            make_frame("b", "a", (first, 0, 0), joint="j1", axis=(0, 0, 1)),
            make_frame("tool", "b", (second, 0, 0)),
        ],
        lower=-np.pi,
        upper=np.pi,
    )


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.5])
def test_the_bound_of_a_planar_arm_is_its_stretched_length(angle):
    robot = make_planar_arm()
    for length, expected in ((0.8, 0.0), (0.801, 0.001), (2.0, 1.2)):
        p = length * np.array([np.cos(angle), np.sin(angle), 0.0])
        assert reach_excess_m(robot, p, robot.lower, robot.upper) == pytest.approx(expected, abs=1e-12)


def test_a_planar_arm_never_leaves_its_plane():
    robot = make_planar_arm()
    assert reach_excess_m(robot, np.array([0.1, 0.2, 0.001]), robot.lower, robot.upper) == pytest.approx(0.001)


def stretch_upwards(qiao):
    """Arm straight up; q4 and q5 bring the tool's line into it: the highest that the tool gets."""
    q = dict.fromkeys(qiao.joint_names, 0.0)
    q["q4"], q["q5"] = np.arctan2(0.0823 + 0.2, 0.09465), 0.5 * np.pi
    return np.array(list(q.values()))


def test_the_stretched_arm_of_qiao_is_within_the_bound_and_0_1_m_more_is_not(qiao):
    """The bound takes the wrist's right angle for stretched, so it allows 80 mm that the arm does not have."""
    p = tool_position(qiao, stretch_upwards(qiao))
    assert p[2] == pytest.approx(0.1 + 0.38 + 0.0892 + 0.425 + 0.39225 + np.hypot(0.09465, 0.2823))
    excess = [
        reach_excess_m(qiao, np.array([p[0], p[1], p[2] + more]), qiao.lower, qiao.upper)
        for more in (0.0, 0.1, 1.0, 1.001)
    ]
    assert excess[0] == 0.0
    assert excess[1] > 1e-5
    assert excess[3] == pytest.approx(excess[2] + 0.001)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_drives_end_at_their_limits(qiao, sign):
    frozen = np.zeros(9)
    lower, upper = frozen.copy(), frozen.copy()
    lower[0], upper[0] = qiao.lower[0], qiao.upper[0]
    here = tool_position(qiao, frozen)
    far = here + np.array([sign * 100.0, 0.0, 0.0])
    excess = reach_excess_m(qiao, far, lower, upper)
    assert reach_excess_m(qiao, far + np.array([sign, 0.0, 0.0]), lower, upper) == pytest.approx(excess + 1.0, abs=0.01)


def make_lift(axis=(0, 0, 1), offset=(0.3, 0, 0.5)):
    """A slide that carries a joint about the vertical."""
    return make_robot(
        {"lift": "prismatic", "turn": "revolute"},
        [
            make_frame("a", "world", joint="lift", axis=axis),
            make_frame("b", "a", joint="turn", axis=(0, 0, 1)),
            make_frame("tool", "b", offset),
        ],
    )


@pytest.mark.parametrize("height", [-1.0, -0.4, 0.0, 0.7, 1.0])
def test_a_lift_under_a_vertical_joint_reaches_all_its_heights(height):
    robot = make_lift()
    p = tool_position(robot, np.array([height, 0.2]))
    assert reach_excess_m(robot, p, robot.lower, robot.upper) <= ROUNDING


def test_a_lift_ends_at_its_limits():
    robot = make_lift()
    p = tool_position(robot, np.array([1.0, 0.2])) + np.array([0.0, 0.0, 0.001])
    assert reach_excess_m(robot, p, robot.lower, robot.upper) == pytest.approx(0.001)


@pytest.mark.parametrize("tilt", [1e-10, 1e-7, 4e-5, 1e-3, 0.5])
def test_a_tilted_lift_reaches_all_its_heights(tilt):
    robot = make_lift(axis=(tilt, 0, 1), offset=(1.2, 0, 0))
    for value in np.linspace(-0.9, 0.9, 7):
        p = tool_position(robot, np.array([value, 0.0]))
        assert reach_excess_m(robot, p, robot.lower, robot.upper) <= 1e-9


@pytest.mark.parametrize("slant", [(1, 0, 0), (1, 1, 0), (1, 2, 3), (0, 0, 1)])
def test_oblique_slides_are_sound(slant, rng):
    robot = make_robot(
        {"x": "prismatic", "s": "prismatic", "turn": "revolute", "bend": "revolute"},
        [
            make_frame("a", "world", joint="x", axis=(1, 0, 0)),
            make_frame("b", "a", joint="s", axis=slant),
            make_frame("c", "b", (0, 0, 0.2), joint="turn", axis=(0, 0, 1)),
            make_frame("d", "c", (0.4, 0, 0), joint="bend", axis=(0, 1, 0)),
            make_frame("tool", "d", (0.3, 0, 0)),
        ],
    )
    for _ in range(200):
        lower, upper, q = random_ranges(robot, rng)
        assert reach_excess_m(robot, tool_position(robot, q), lower, upper) <= ROUNDING


def make_quill_arm():
    """Two links about z, a quill along z between them and the tool."""
    return make_robot(
        {"j1": "revolute", "j2": "revolute", "quill": "prismatic"},
        [
            make_frame("a", "world", joint="j1", axis=(0, 0, 1)),
            make_frame("b", "a", (0.5, 0, 0), joint="j2", axis=(0, 0, 1)),
            make_frame("c", "b", (0.3, 0, 0), joint="quill", axis=(0, 0, -1)),
            make_frame("tool", "c", (0, 0, -0.1)),
        ],
    )


def test_a_slide_along_the_axes_of_its_run_adds_height_and_nothing_else():
    robot = make_quill_arm()
    lower, upper = robot.lower, robot.upper
    for far in (1.0, 1e5):
        upper[2] = far
        assert reach_excess_m(robot, np.array([2.0, 0.0, -0.3]), lower, upper) == pytest.approx(1.2)
        assert reach_excess_m(robot, np.array([0.4, 0.0, -1.4 - far]), lower, upper) == pytest.approx(1.3, abs=1e-9)
        assert reach_excess_m(robot, np.array([0.4, 0.0, 1.5]), lower, upper) == pytest.approx(0.6)


def test_a_slide_across_the_axes_of_its_run_adds_width():
    robot = make_robot(
        {"turn": "revolute", "out": "prismatic"},
        [
            make_frame("a", "world", joint="turn", axis=(0, 0, 1)),
            make_frame("b", "a", joint="out", axis=(1, 0, 0)),
            make_frame("tool", "b", (0.2, 0, 0.3)),
        ],
    )
    assert reach_excess_m(robot, np.array([0.0, 2.0, 0.3]), robot.lower, robot.upper) == pytest.approx(0.8)
    assert reach_excess_m(robot, np.array([0.0, 1.0, 0.8]), robot.lower, robot.upper) == pytest.approx(0.5)


def test_two_slides_one_behind_the_other_add_up_along_their_direction_only():
    robot = make_robot(
        {"rail": "prismatic", "reach": "prismatic", "turn": "revolute"},
        [
            make_frame("a", "world", joint="rail", axis=(1, 0, 0)),
            make_frame("b", "a", joint="reach", axis=(1, 0, 0)),
            make_frame("c", "b", joint="turn", axis=(0, 0, 1)),
            make_frame("tool", "c", (0.5, 0, 0)),
        ],
    )
    assert reach_excess_m(robot, np.array([3.0, 0.0, 0.0]), robot.lower, robot.upper) == pytest.approx(0.5)
    assert reach_excess_m(robot, np.array([0.0, 3.0, 0.0]), robot.lower, robot.upper) == pytest.approx(2.5)


def test_oblique_slides_are_sharp():
    """Where two slides span a parallelogram its sides are the bound."""
    robot = make_robot(
        {"x": "prismatic", "s": "prismatic"},
        [
            make_frame("a", "world", joint="x", axis=(1, 0, 0)),
            make_frame("b", "a", joint="s", axis=(3, 4, 0)),
            make_frame("tool", "b"),
        ],
    )
    assert reach_excess_m(robot, np.array([0.6, 1.8, 0.0]), robot.lower, robot.upper) == pytest.approx(1.0)
    assert reach_excess_m(robot, np.array([4.0, 0.8, 0.0]), robot.lower, robot.upper) == pytest.approx(2.4)
    assert reach_excess_m(robot, np.array([1.5, 0.7, 0.0]), robot.lower, robot.upper) == 0.0


def test_axes_that_are_only_nearly_parallel_are_no_proof_of_a_plane():
    """The second link leaves the plane by the little that its axis is askew."""
    askew = (5e-10, 0, 1)
    frames = [
        make_frame("a", "world", joint="j0", axis=(0, 0, 1)),
        make_frame("b", "a", (1e4, 0, 0), joint="j1", axis=askew),
        make_frame("tool", "b", (1e4, 0, 0)),
    ]
    robot = make_robot(TURNS, frames, lower=-np.pi, upper=np.pi)
    p = tool_position(robot, np.array([0.0, np.pi]))
    assert abs(p[2]) > 9e-6
    assert reach_excess_m(robot, p, robot.lower, robot.upper) == 0.0


@few
@given(seed=st.integers(0, 10_000))
def test_far_out_what_can_be_reached_is_not_called_out_of_reach_for_its_rounding(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    far = np.where(robot.is_prismatic, 5e4, 1.0)
    lower, upper = far * robot.lower, far * robot.upper
    q = rng.uniform(lower, upper)
    q = np.where(robot.is_prismatic, rng.choice([lower, upper]), q)
    assert reach_excess_m(robot, tool_position(robot, q), lower, upper) == 0.0


def test_a_robot_of_slides_only_reaches_its_box_and_no_more():
    robot = make_robot(
        {"x": "prismatic", "y": "prismatic"},
        [
            make_frame("a", "world", joint="x", axis=(1, 0, 0)),
            make_frame("b", "a", joint="y", axis=(0, 1, 0)),
            make_frame("tool", "b", (0.1, 0.2, 0.3)),
        ],
    )
    assert reach_excess_m(robot, np.array([1.1, -0.8, 0.3]), robot.lower, robot.upper) <= ROUNDING
    assert reach_excess_m(robot, np.array([1.1, -0.8, 0.8]), robot.lower, robot.upper) == pytest.approx(0.5)
    assert reach_excess_m(robot, np.array([4.1, -4.8, 0.3]), robot.lower, robot.upper) == pytest.approx(5.0)


def test_a_robot_whose_tool_no_joint_moves_stays_where_it_is():
    robot = make_robot(
        {"x": "prismatic"},
        [make_frame("a", "world", joint="x", axis=(1, 0, 0)), make_frame("tool", "world", (0, 0, 1))],
    )
    assert reach_excess_m(robot, np.array([0.0, 0.0, 1.0]), robot.lower, robot.upper) == 0.0
    assert reach_excess_m(robot, np.array([3.0, 4.0, 1.0]), robot.lower, robot.upper) == pytest.approx(5.0)


def test_many_positions_are_one_after_the_other(any_robot, rng):
    positions = rng.uniform(-8.0, 8.0, (40, 3))
    reach = find_bounds(any_robot, any_robot.lower, any_robot.upper).reach
    assert reach.excess_of_many_m(positions).tolist() == [reach.excess_m(p) for p in positions]


# ---- the length of an arm


@few
@given(seed=st.integers(0, 10_000))
def test_no_tool_gets_farther_from_the_first_turn_than_the_arm_is_long(seed):
    """With all slides at zero, wherever what comes before the turn stands."""
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    turns = [
        frame for frame in robot.frames if frame.joint is not None and not robot.is_prismatic[index_of(robot, frame)]
    ]
    carrying = [frame for frame in turns if carries_tool(robot, frame)]
    q = np.where(robot.is_prismatic, 0.0, rng.uniform(-np.pi, np.pi, len(robot.joints)))
    frames = reference.compute_frames(robot, q)
    p_tool = frames[robot.tool][:3, 3]
    if carrying:
        farthest = max(np.linalg.norm(p_tool - frames[frame.name][:3, 3]) for frame in carrying)
        assert farthest <= arm_length_m(robot) + ROUNDING
    assert np.linalg.norm(p_tool - lead_point(robot, frames)) <= arm_length_m(robot) + ROUNDING


def index_of(robot, frame):
    return robot.joint_names.index(frame.joint)


def carries_tool(robot, frame):
    parents = {each.name: each.parent for each in robot.frames}
    name = robot.tool
    while name not in ("world", frame.name):
        name = parents[name]
    return name == frame.name


def lead_point(robot, frames):
    """Where the arm begins: its first turn, or the tool itself if nothing turns."""
    parents, name, first = {each.name: each for each in robot.frames}, robot.tool, robot.tool
    while name != "world":
        frame = parents[name]
        if frame.joint is not None and not robot.is_prismatic[index_of(robot, frame)]:
            first = name
        name = frame.parent
    return frames[first][:3, 3]


def test_a_stretched_arm_is_as_long_as_its_links():
    frames = [
        make_frame("rail", "world", (3.0, 0, 0), joint="rail", axis=(1, 0, 0)),
        make_frame("shoulder", "rail", (5.0, 0, 0), joint="shoulder", axis=(0, 0, 1)),
        make_frame("elbow", "shoulder", (0, 0.4, 0.3), joint="elbow", axis=(0, 0, 1)),
        make_frame("slide", "elbow", (0.2, 0, 0), joint="slide", axis=(1, 0, 0)),
        make_frame("tool", "slide", (0, 0, 0.1)),
    ]
    kinds = {"rail": "prismatic", "shoulder": "revolute", "elbow": "revolute", "slide": "prismatic"}
    assert arm_length_m(make_robot(kinds, frames)) == pytest.approx(0.5 + 0.2 + 0.1)
