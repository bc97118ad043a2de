"""Short runs: what the printed laws drag along, what exact priority keeps, switches, singular arms and limits."""

import numpy as np
import pytest

from ikde.paper.null_space_runs import (
    LIMITS,
    STRETCHES,
    Scene,
    State,
    Way,
    after,
    always,
    axis_ratio,
    by_axis_ratio,
    by_distance,
    simulate,
    stretch,
)
from tests.paper.zhang import ARM, START

STANDS = np.zeros(3)
TARGET, FAR = np.array([2.6, 0.4, 0.8]), np.array([1.2, 0.1, 0.25])
TOOL = ARM.place(STANDS, START).tool


def at(place):
    return lambda _: (np.array(place), STANDS)


def way(family, share, softest=0.0):
    return Way(name=family, family=family, share=share, softest=softest)


def test_a_held_tool_is_dragged_by_the_printed_law_alone():
    """117 mm with the wheels in rad/s, more with the platform in m/s; 0.36 mm of the step under exact priority."""
    ways = [way("printed", always(0.0)), way("printed in m/s", always(0.0)), way("printed", always(1.0))]
    ways += [way("exact", always(1.0)), way("exact", always(0.0))]
    run = simulate(ARM, START, ways, Scene(at(TOOL), at([-0.25, 0.15, 0.3]), 1.5, 0.01))
    largest = 1e3 * run.tool_m.max(axis=0)
    np.testing.assert_allclose(largest, [117.1, 290.5, 0.346, 0.355, 0.355], rtol=0.01)
    np.testing.assert_allclose(run.joints[:, 3], run.joints[:, 4], atol=1e-10)
    assert np.abs(run.wheels[:, 3:] @ [1, -1, -1, 1]).max() < 1e-10


def test_both_on_circles():
    w = 2 * np.pi / 60

    def platform(t):
        s, c = np.sin(w * t), np.cos(w * t)
        return 0.5 * np.array([s, 1 - c, 0]), 0.5 * w * np.array([c, s, 0])

    def tool(t):
        (place, v), a = platform(t), 5 * w
        return (
            TOOL + place + 0.1 * np.array([0, np.cos(a * t) - 1, np.sin(a * t)]),
            v + 0.1 * a * np.array([0, -np.sin(a * t), np.cos(a * t)]),
        )

    ways = [way("printed", always(0.0)), way("printed", always(1.0)), way("exact", always(0.0))]
    run = simulate(ARM, START, ways, Scene(tool, platform, 16.0, 0.08))
    tool_mm, platform_mm = 1e3 * run.tool_m.max(axis=0), 1e3 * run.platform_m.max(axis=0)
    assert 20.0 < tool_mm[0] < 30.0
    assert tool_mm[2] < 0.7  # of the step
    assert platform_mm[1] > 5.0 * platform_mm[2]


@pytest.fixture(scope="module")
def conflict():
    """Platform first, then the tool, whose target is out of reach from there; from 8 s on for one second."""
    ways = [
        way("printed in m/s", after(8.0, 0.0)),
        way("printed in m/s", after(8.0, 1.0)),
        way("exact", after(8.0, 0.0), 0.05),
        way("exact", after(8.0, 1.0), 0.05),
        way("enters", after(8.0, 1.0), 0.05),
    ]
    return simulate(ARM, START, ways, Scene(at(TARGET), at(FAR), 14.0, 0.04, (1.5, 1.0), (0.3, 0.4)))


def test_a_conflict_is_decided_by_priority(conflict):
    before = np.searchsorted(conflict.t_s, 7.9)
    np.testing.assert_allclose(conflict.tool_m[before, 2:], 0.2, atol=0.01)  # as far as the arm reaches
    np.testing.assert_allclose(conflict.tool_m[-1], 0.0, atol=2e-3)
    np.testing.assert_allclose(conflict.platform_m[-1], [0.367, 0.371, 0.207, 0.207, 0.207], atol=0.01)
    np.testing.assert_allclose(conflict.platform_m[before], 0.0, atol=2e-3)


def test_at_once_the_platform_jumps_and_smoothly_it_does_not(conflict):
    some = (conflict.t_s > 7.8) & (conflict.t_s < 9.2)
    jumps = np.abs(np.diff(conflict.twist[some], axis=0)).max(axis=(0, 2))
    np.testing.assert_allclose(jumps[[0, 2]], [0.265, 0.302], atol=0.01)
    assert jumps[[1, 3, 4]].max() < 0.03
    assert np.abs(conflict.joints[:, 2:]).max() < 6.5  # 0.3 m/s / 0.05 and what the platform adds


def test_limits_are_kept_and_priority_is_not_lost():
    ways = [way(f"enters {kind}", always(0.0), 0.05) for kind in ("in limits", "smoothly")]
    ways.append(way("weights in limits", always(0.0)))
    run = simulate(ARM, START, ways, Scene(at(TARGET), at(FAR), 3.5, 0.1, (1.5, 1.0), (0.3, 0.4)))
    assert (np.abs(run.joints) <= LIMITS[3:] + 1e-6).all()
    assert (np.abs(run.twist[:, :, :2]) <= 0.5 + 1e-6).all()
    assert np.abs(np.diff(run.joints[:, 1], axis=0)).max() <= 5.0 * 0.1 + 1e-6
    np.testing.assert_allclose(run.platform_m[-1, :2], run.platform_m[-1, 0], atol=0.1)


def test_shares():
    state = State(np.array([1.1, 0.9, 0.7]), np.array([5.0, 10.0, 20.0]))
    np.testing.assert_allclose(by_distance(0.8, 1.0, "at once")(0.0, state), [0, 1, 1])
    np.testing.assert_allclose(by_distance(0.8, 1.0, "linear")(0.0, state), [0, 0.5, 1])
    np.testing.assert_allclose(by_distance(0.8, 1.0, "smooth")(0.0, state), [0, 0.5, 1])
    np.testing.assert_allclose(by_axis_ratio(8.0, 12.0)(0.0, state), [0, 0.5, 1])
    assert (after(8.0, 0.0)(7.99, state), after(8.0, 0.0)(8.0, state), after(8.0, 1.0)(8.5, state)) == (0.0, 1.0, 0.5)


def test_axis_ratio_is_that_of_the_roots():
    J = np.diag([3.0, 1.0, 0.5])
    assert axis_ratio(J) == pytest.approx(6.0)
    values = np.linalg.eigvalsh(J @ J.T)
    assert axis_ratio(J) == pytest.approx(np.sqrt(values[-1] / values[0]))


def test_a_stretched_arm_stays_slow_where_it_is_damped():
    drawn = stretch(ARM, START, 360, 0.025)
    fastest = dict(zip(STRETCHES, drawn.speed.max(axis=0), strict=True))
    assert fastest["undamped"] > 40.0
    assert fastest["damped everywhere"] < 1.1
    assert fastest["damped near the singularity alone"] < 2.0
    everywhere, alone = drawn.error_m[120, 1:]
    assert everywhere > 1.3e-3
    assert alone == pytest.approx(drawn.error_m[120, 0], abs=1e-12)
    assert drawn.sigma[:, 2].min() < 0.05 < drawn.sigma[0, 2]


def test_slip_is_what_feedback_takes_away():
    """The floor sees 0.2 of the way for a second; without feedback that way is missing for ever."""
    v = np.array([0.1, 0.0, 0.0])

    def rolling(t):
        return np.full((2, 1), 0.2 if 1.0 <= t < 2.0 else 1.0)

    gains = np.array([[0.0], [1.0]])
    scene = Scene(lambda t: (TOOL + v * t, v), lambda t: (v * t, v), 8.0, 0.1, (2.0 * gains, gains))
    run = simulate(ARM, START, [way("exact", always(1.0), 0.05)] * 2, scene, rolling)
    assert run.platform_m[-1, 0] == pytest.approx(0.08, rel=0.05)
    assert run.platform_m[-1, 1] < 1e-3
    assert run.tool_m[-1, 1] < 1e-4
