"""The chain in given ranges brings the tool where all joints bring it, and holds what is held."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.model.chain import find_chain
from ikde.model.rotation import rotation_about
from tests import reference
from tests.random_robots import make_frame, make_robot, random_robot


def place_tool(chain, values):
    """Rotation [3, 3] and place [3] of the tool, for the values of the links that may move."""
    R, p = np.eye(3), np.zeros(3)
    for link, value in zip(chain.links, values, strict=True):
        p, R = p + R @ link.p_before_link, R @ link.R_before_link
        if link.is_revolute:
            R = R @ rotation_about(link.axis, value)
        else:
            p = p + R @ (value * link.axis)
    return R @ chain.R_link_tool, p + R @ chain.p_link_tool


@settings(max_examples=100)
@given(seed=st.integers(0, 10_000), share=st.sampled_from([0.0, 0.4, 1.0]))
def test_what_is_held_is_part_of_a_link(seed, share):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = rng.uniform(robot.lower, robot.upper)
    held = rng.random(len(q)) < share
    chain = find_chain(robot, np.where(held, q, robot.lower), np.where(held, q, robot.upper))
    ends = [(link.lower, link.upper) for link in chain.links]
    moving = [k for low_high in ends for k in range(len(q)) if (robot.lower[k], robot.upper[k]) == low_high]
    assert not held[moving].any()
    T_world_tool = reference.compute_frames(robot, q)[robot.tool]
    R, p = place_tool(chain, q[moving])
    assert np.abs(R - T_world_tool[:3, :3]).max() < 1e-13
    assert np.abs(p - T_world_tool[:3, 3]).max() < 1e-12 * max(1.0, chain.length_m)
    assert np.abs(p).max() <= chain.length_m + 1e-12


def test_its_length_counts_slides_at_their_ends():
    robot = make_robot(
        {"rail": "prismatic", "turn": "revolute", "out": "prismatic"},
        [
            make_frame("a", "world", (3, 0, 4), joint="rail", axis=(1, 0, 0)),
            make_frame("b", "a", joint="turn", axis=(0, 0, 1)),
            make_frame("c", "b", joint="out", axis=(1, 0, 0)),
            make_frame("tool", "c", (0, 0, 0.5)),
        ],
        lower=-7.0,
        upper=2.0,
    )
    assert find_chain(robot, robot.lower, robot.upper).length_m == 5.0 + 7.0 + 7.0 + 0.5
    lower, upper = robot.lower, robot.upper
    lower[2] = upper[2] = -1.0
    held = find_chain(robot, lower, upper)
    assert [link.is_revolute for link in held.links] == [False, True]
    assert held.length_m == 5.0 + 7.0 + 1.0 + 0.5


def test_joints_that_do_not_carry_the_tool_are_no_links():
    frames = [make_frame("a", "world", joint="x", axis=(1, 0, 0)), make_frame("tool", "world", (0, 0, 1))]
    robot = make_robot({"x": "prismatic"}, frames)
    chain = find_chain(robot, robot.lower, robot.upper)
    assert chain.links == ()
    assert chain.p_link_tool.tolist() == [0.0, 0.0, 1.0]
