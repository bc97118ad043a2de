"""Plans of track files are followed as they say, or otherwise."""

import numpy as np
import pytest
import yaml

import ikde
from ikde.errors import FileError, InputError
from ikde.io.plan_file import load_track
from ikde.kernels.jit import compile_clock
from ikde.solver.warmup import warm_up
from ikde.track.follow_path import follow_path
from ikde.track.run import list_track_stages, run_track
from tests.track.tracks import load_task

PLAN = {
    "robot": "qiao2021",
    "dt_s": 0.02,
    "samples": 20,
    "path": {"expressions": {"x": "0.9", "y": "0.2*k/N", "z": "1"}},
    "drive": "omnidirectional",
    "limits": {"speed": {"d_x": 0.1, "q6": None}, "acceleration": {"q1": 3}, "position_error": 1e-5},
    "seed": 4,
}


def test_a_plan_is_followed():
    motion = run_track(load_track(PLAN))
    assert motion.reached
    assert (motion.drive, motion.method, motion.path.samples) == ("omnidirectional", "continuation", 20)
    assert motion.limits.position_error_m == 1e-5


def test_limits_that_are_left_out_are_those_of_the_paper():
    limits = load_track(PLAN).limits
    np.testing.assert_allclose(limits.speed, [0.1, 0.5] + [0.5 * np.pi] * 6 + [np.inf])
    assert limits.acceleration[3] == 3.0
    assert np.isinf(np.delete(limits.acceleration, 3)).all()
    assert limits.orientation_error_rad == 1e-4


@pytest.mark.parametrize("task", ["task1", "task3"])
def test_the_papers_tasks_ask_for_the_papers_limits(task):
    limits = load_task(task).limits
    np.testing.assert_allclose(limits.speed, [0.5, 0.5] + [0.5 * np.pi] * 7)
    assert limits.acceleration is None


def test_what_the_caller_wants_comes_before_the_file():
    motion = run_track(load_track(PLAN))
    other = run_track(load_track(PLAN), drive="differential", start=motion.q[0], seed=5)
    assert other.drive == "differential"
    np.testing.assert_array_equal(other.q[0], motion.q[0])


def test_what_is_no_plan_is_refused():
    path = load_track(PLAN).path
    with pytest.raises(InputError, match="expected what `load_track` gives, got ToolPath; `follow_path` takes a path"):
        run_track(path)


def test_a_wrong_method_is_refused():
    with pytest.raises(InputError, match="method"):
        run_track(load_track(PLAN), method="magic")


def test_a_start_of_the_file_that_does_not_fit_is_placed_there(tmp_path):
    file = tmp_path / "far.yaml"
    file.write_text(yaml.safe_dump({**PLAN, "start": {"q1": 0.1}}, sort_keys=False))
    with pytest.raises(FileError, match=r"far.yaml:\d+ → start: expected a configuration at the path's first pose"):
        load_track(file)
    with pytest.raises(InputError, match=r"^start: expected a configuration at") as caught:
        run_track(load_track(PLAN), start=ikde.load_robot("qiao2021").home)
    assert not isinstance(caught.value, FileError)


def test_a_start_outside_the_ranges_is_followed_if_joints_may_leave_them():
    motion = run_track(load_track(PLAN))
    q = dict(zip(motion.joint_names, motion.q[0].tolist(), strict=True))
    ranges = {"q2": [q["q2"] + 0.1, 2.8]}
    again = run_track(load_track({**PLAN, "start": q, "ranges": ranges, "limits": {"ranges": False}}))
    assert again.reached_points > 0
    np.testing.assert_array_equal(again.q[0], motion.q[0])


def test_a_robot_without_a_base_follows_too():
    path = {"expressions": {"x": "0.4 + 0.01*k/N", "y": "0.2", "z": "0.4"}}
    motion = run_track(load_track({"robot": "ur5", "dt_s": 0.02, "samples": 5, "path": path}))
    assert (motion.drive, motion.reached) == ("omnidirectional", True)


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
def test_a_track_then_compiles_nothing(qiao, drive):
    stage = next(stage for stage in list_track_stages(qiao) if stage.name == "track, continuation")
    warm_up([stage])
    p, R = np.array([[0.8, 0.2, 0.9], [0.8, 0.202, 0.9]]), np.tile(np.eye(3), (2, 1, 1))
    for turn in (None, R):
        with compile_clock() as clock:
            motion = follow_path(qiao, ikde.ToolPath.through(p, dt_s=0.02, R_world_tool=turn), drive=drive)
        assert motion.reached
        assert clock.seconds == 0.0


def test_every_method_has_a_stage():
    names = [stage.name for stage in list_track_stages(ikde.load_robot("ur5"))]
    assert names == ["track, continuation", "track, optimized", "track, typical", "servo"]
