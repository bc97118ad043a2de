"""The scenes: what is asked for is where it should be, and begins where the robot is."""

import numpy as np
import pytest

from ikde.paper import null_space_scenes as module
from ikde.paper.null_space_scenes import run_circle, run_conflict, run_held, run_near, run_slip
from tests.paper.zhang import ARM, NUMBERS, START

TOOL = ARM.place(np.zeros(3), START).tool


@pytest.fixture
def asked(monkeypatch):
    """Scenes, and what rolls, as they are handed on; nothing is simulated."""
    seen = []
    monkeypatch.setattr(module, "simulate", lambda arm, start, ways, scene, *rolling: seen.append((scene, *rolling)))
    return seen


def test_references_move_as_their_velocities_say(asked):
    for run in (run_held, run_circle, run_conflict, run_near):
        run(ARM, START, 0.1)
    run_slip(ARM, START, 0.1, NUMBERS["published"]["slip"])
    for scene, *_ in asked:
        for reference in (scene.tool, scene.platform):
            for t in (0.0, 3.0, 17.0):
                change = (reference(t + 1e-5)[0] - reference(t - 1e-5)[0]) / 2e-5
                np.testing.assert_allclose(change, reference(t)[1], atol=1e-8)


def test_they_begin_where_the_robot_is(asked):
    run_held(ARM, START, 0.1)
    run_circle(ARM, START, 0.1)
    run_slip(ARM, START, 0.1, NUMBERS["published"]["slip"])
    for scene, *_ in asked:
        np.testing.assert_allclose(scene.tool(0.0)[0], TOOL, atol=1e-14)
    for scene, *_ in asked[1:]:
        np.testing.assert_array_equal(scene.platform(0.0)[0], np.zeros(3))


def test_wheels_slip_as_printed(asked):
    run_slip(ARM, START, 0.1, NUMBERS["published"]["slip"])
    ((scene, rolling),) = asked
    assert scene.seconds == 300.0
    for t, slips in ((49.9, False), (50.0, True), (99.9, True), (100.0, False), (225.0, True), (250.0, False)):
        np.testing.assert_allclose(rolling(t)[:, 0], np.tile([1, 1.8, 0.2] if slips else [1, 1, 1], 2))


def test_the_far_target_is_out_of_reach_and_the_near_one_is_not():
    """From the platform's middle: the arm reaches 0.98 m or so from its shoulder."""
    for platform, is_near in ((module.NEAR, True), (module.FAR, False)):
        c, s = np.cos(platform[2]), np.sin(platform[2])
        shoulder = np.array([platform[0] + 0.3 * c, platform[1] + 0.3 * s, 0.35 + 0.1625])
        assert (np.linalg.norm(module.TARGET - shoulder) < 0.9) == is_near
