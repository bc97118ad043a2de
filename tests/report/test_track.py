"""A motion as text and as plain data."""

import json

import numpy as np
import pytest

import ikde
from ikde.report.track import format_track, largest_wheel_speed, list_figures, track_json
from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.measured import make_measured

STOP = TrackStop(
    sample=21,
    reason=TrackStopReason.SELF_COLLISION,
    text="sample 21 (0.42 s): J4 and J6 overlap by 3 mm in the only step that was found",
    pair=("J4", "J6"),
)


@pytest.fixture(scope="module")
def plan():
    path = {"expressions": {"x": 1, "y": 0, "z": 1}}
    return ikde.load_track({"name": "wave [1]", "robot": "qiao2021", "dt_s": 0.02, "samples": 20, "path": path})


def test_a_followed_path_is_green_with_its_figures(qiao, plan):
    text = format_track(plan, make_measured(qiao))
    assert text.startswith("followed: 20 of 20 points of wave [1], 0.4 s, differential\n")
    rows = {name: (value, asked) for name, value, asked in list_figures(make_measured(qiao))}
    assert rows["points reached"] == ("20", "20")
    assert rows["largest error along x / y / z"] == ("0 / 0 / 0 mm", "0.001 mm")
    assert rows["largest speed, base, 40 %"] == ("0.2 m/s", "0.5 m/s")
    assert rows["time a sample, median / p99"] == ("20.0 / 20.0 µs", "20,000 µs")
    assert all(name in text for name in rows)


def test_a_stop_is_the_second_line(qiao, plan):
    motion = make_measured(qiao, further=5, stop=STOP)
    lines = format_track(plan, motion).splitlines()
    assert lines[:2] == ["stopped after 20 of 25 points of wave [1]", STOP.text]
    data = track_json(plan, motion)
    assert (data["reached"], data["stop"]["reason"], data["stop"]["pair"]) == (False, "self_collision", ("J4", "J6"))


def test_broken_limits_are_counted(qiao, plan):
    motion = make_measured(qiao, amplitude=2.6)
    text = format_track(plan, motion)
    assert text.startswith("followed 20 of 20 points of wave [1], against its limits: ")
    assert f"collision {motion.verification.breaches.collision} times" in text
    assert track_json(plan, motion)["accepted"] is False


def test_plain_data_is_json(qiao, plan):
    for motion in (make_measured(qiao), make_measured(qiao, detector="none", drive="omnidirectional")):
        data = track_json(plan, motion)
        assert json.loads(json.dumps(data, allow_nan=False))["reached_points"] == 20


def test_what_does_not_apply_has_no_row(qiao):
    names = [row[0] for row in list_figures(make_measured(qiao, detector="none", orientation="free", speed=None))]
    assert not any(word in name for name in names for word in ("clearance", "orientation", "speed,"))


def test_the_faster_wheel_counts(qiao):
    motion = make_measured(qiao)
    assert largest_wheel_speed(motion) == pytest.approx((0.2 + 0.259 * 0.3) / 0.1)
    assert largest_wheel_speed(make_measured(qiao, drive="omnidirectional")) is None
    assert np.isfinite(motion.wheel_limit_rad_s)
