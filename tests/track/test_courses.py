"""The choice among courses, and the ways back from where they end."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.kernels.arrays import DRIFT
from ikde.track import courses
from ikde.track.courses import USES, ContinuationSettings, choose_course, farthest
from ikde.track.path import ToolPath
from ikde.track.starts import draw_starts
from tests.track.tracks import load_task, make_follower_along, robot

USUAL = ContinuationSettings()


def shorten(path, samples):
    """The first samples of a path."""
    R = path.R_world_tool[: samples + 1]
    return ToolPath(
        dt_s=path.dt_s, p_world_tool=path.p_world_tool[: samples + 1], orientation=path.orientation, R_world_tool=R
    )


def anything(sample):
    return True


def test_the_best_is_no_worse_than_any_other():
    follower = make_follower_along(shorten(load_task("task2").path, 120))
    starts, _ = draw_starts(follower, {}, 3)
    best = choose_course(follower, starts, 120, 0, anything, USUAL)
    each = [follower.follow(follower.begin(start, np.array(USES[0])), 120) for start in starts]
    complete = [course for course in each if course.last == 120]
    assert best.last == 120
    assert len(complete) > 3
    assert courses._badness(best) == min(map(courses._badness, complete))


def test_clearance_counts_in_steps_and_motion_decides_between_equals():
    follower = make_follower_along(shorten(load_task("task1").path, 60))
    starts, _ = draw_starts(follower, {}, 1)
    course = follower.follow(follower.begin(starts[0], np.array(USES[0])))
    near, far, little = course.copy(), course.copy(), course.copy()
    near.least[1:], far.least[1:], little.least[1:] = 0.011, 0.014, 0.004
    far.steps[1:] *= 0.9
    assert courses._badness(far) < courses._badness(near) < courses._badness(little)


def test_a_dead_end_is_left_by_going_back():
    follower = make_follower_along(load_task("task4_minus_x").path)
    starts, _ = draw_starts(follower, {}, 1)
    use = np.array((1.0, 0.3, 0.3))
    ends = [follower.follow(follower.begin(start, use)) for start in starts]
    stuck = [k for k, course in enumerate(ends) if 30 < course.last < 500]
    assert stuck
    only = ContinuationSettings(uses=(tuple(use),))
    further = [choose_course(follower, starts[[k]], 500, 0, anything, only).last - ends[k].last for k in stuck[:3]]
    assert max(further) > 0


def test_going_back_changes_what_comes_after_only():
    follower = make_follower_along(shorten(load_task("task1").path, 60))
    starts, _ = draw_starts(follower, {}, 1)
    course = follower.follow(follower.begin(starts[0], np.array(USES[0])))
    other = courses._rewind(course, 40, 8, np.random.default_rng(0), USES)
    assert (other.last, course.last) == (40, 60)
    np.testing.assert_array_equal(other.weights[:41], course.weights[:41])
    assert (other.weights[41:49, DRIFT:] != 0.0).all()
    assert (other.weights[49:, DRIFT:] == 0.0).all()
    assert (course.weights[:, DRIFT:] == 0.0).all()


def test_all_returns_are_made_however_short_the_course(monkeypatch):
    follower, rng = make_follower_along(shorten(load_task("task1").path, 60)), np.random.default_rng(0)
    stuck = replace(follower.begin(robot().home, np.array(USES[0])), last=5)
    begun = []
    monkeypatch.setattr(type(follower), "follow", lambda self, course, end: begun.append(course.last) or course)
    assert courses._return(follower, stuck, 60, 70, rng, USES) is stuck
    assert begun == [0] * 70


@pytest.mark.parametrize(("returns", "each"), [(1000, [125] * 8), (11, [2, 2, 2, 1, 1, 1, 1, 1]), (0, [0] * 8)])
def test_courses_share_the_returns_evenly(monkeypatch, returns, each):
    follower, spent = make_follower_along(shorten(load_task("task1").path, 60)), []
    starts = robot().home + np.arange(10.0)[:, None]
    monkeypatch.setattr(type(follower), "follow", lambda self, course, end: course)
    monkeypatch.setattr(courses, "_return", lambda follower, course, end, most, *_: spent.append(most) or course)
    choose_course(follower, starts, 60, 0, anything, ContinuationSettings(returns=returns))
    assert spent == each


def test_where_no_configuration_is_nothing_else_is_tried(monkeypatch):
    p = np.tile([0.9, 0.0, 1.0], (21, 1))
    p[10:, 2] = 3.0
    follower = make_follower_along(ToolPath.through(p, dt_s=0.02))
    starts, _ = draw_starts(follower, {}, 1)
    asked = []
    monkeypatch.setattr(courses, "_return", None)
    course = choose_course(follower, starts, 20, 0, lambda sample: asked.append(sample) or False, USUAL)
    assert (course.last, asked) == (9, [10])


def test_the_null_space_is_used_as_asked():
    follower = make_follower_along(shorten(load_task("task2").path, 120))
    starts, _ = draw_starts(follower, {}, 3)
    still = ContinuationSettings(uses=((0.0, 0.0, 0.0),))
    least, usual = (choose_course(follower, starts[:1], 120, 0, anything, way) for way in (still, USUAL))
    assert (least.weights[1:, :DRIFT] == 0.0).all()
    assert least.motion < usual.motion


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"uses": ()}, "settings.uses: expected rows of three numbers"),
        ({"uses": ((1.0, 0.3),)}, "settings.uses: expected rows of three numbers"),
        ({"uses": ((1.0, 0.3, -0.1),)}, "settings.uses: expected rows of three numbers"),
        ({"uses": "abc"}, "settings.uses: expected rows of three numbers"),
        ({"uses": ((1.0,), (1.0, 2.0))}, "settings.uses: expected rows of three numbers"),
        ({"returns": -1}, "settings.returns: expected a whole number of at least 0, up to 1,000,000,000, got -1"),
        ({"returns": 2.5}, "settings.returns: expected a whole number of at least 0, up to 1,000,000,000, got 2.5"),
    ],
)
def test_settings_that_mean_nothing_are_refused(given, words):
    with pytest.raises(InputError) as caught:
        ContinuationSettings(**given)
    assert str(caught.value).startswith(words)


def test_the_farthest_is_the_first_of_equals():
    follower = make_follower_along(shorten(load_task("task1").path, 10))
    begun = [follower.begin(robot().home, np.array(use)) for use in USES[:2]]
    assert farthest(begun) is begun[0]
