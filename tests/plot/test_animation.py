"""A drawn motion as data to play: whole millimetres, roles with their colours."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from ikde.plot.animation import make_animation
from ikde.report import html
from ikde.scene.drawn_motion import draw_motion
from ikde.scene.drawn_pose import COLORS
from tests.track.measured import make_measured
from tests.track.worlds import TOUCHED, make_among, make_passing

OBSTACLES = {
    "post": {"cylinder": {"radius": 0.05, "height": 0.4}, "position": [0.74, -0.3, 0.96]},
    "board": {"box": [0.2, 0.3, 0.02], "position": [0.2, 0.3, 0.9]},
    "dust": {"cloud": {"points": [[0.3, 0.45, 0.4], [0.4, 0.48, 0.5]], "radius": 0.01}},
}


@pytest.fixture(scope="module")
def motion(qiao):
    return draw_motion(make_measured(qiao, amplitude=2.6), range(0, 21, 4))


def test_frames_are_in_time_along_the_path(motion):
    data = make_animation(motion)
    assert data["times_s"] == [0.0, 0.08, 0.16, 0.24, 0.32, 0.4]
    assert data["done"] == [1, 5, 9, 13, 17, 21]
    assert data["duration_s"] == 0.4
    np.testing.assert_allclose(data["path_mm"], 1e3 * motion.path_m, atol=0.5)


def test_links_lead_to_the_tool(motion):
    data = make_animation(motion)
    assert np.shape(data["links_mm"]) == (6, 10, 3)
    np.testing.assert_allclose(data["links_mm"], 1e3 * motion.robot.links_m, atol=0.5)


def test_spheres_have_their_components_and_those_their_roles(motion):
    data, robot = make_animation(motion), motion.robot
    np.testing.assert_allclose(data["centres_mm"], 1e3 * robot.centres_m, atol=0.5)
    np.testing.assert_allclose(data["radii_mm"], 1e3 * robot.radii_m, atol=0.5)
    assert data["parts"] == robot.parts.tolist()
    names = list(data["colors"])
    assert data["colors"] == COLORS
    assert [[names[role] for role in roles] for roles in data["roles"]] == robot.roles.tolist()


def test_a_long_path_is_shown_by_few_points(qiao):
    motion = draw_motion(make_measured(qiao, further=2000), [0, 20])
    data = make_animation(motion)
    assert len(data["path_mm"]) == 501
    assert data["done"] == [1, 6]  # points 0, 4, 8, 12, 16 and 20 of 2,021


def test_the_player_reads_no_key_that_is_not_written(motion):
    script = (Path(html.__file__).parent / "templates" / "motion.js").read_text()
    assert set(re.findall(r"motion\.(\w+)", script)) == set(make_animation(motion))


def test_it_is_json_also_without_a_detector(qiao):
    data = make_animation(draw_motion(make_measured(qiao, detector="none"), [0, 10, 20]))
    assert json.loads(json.dumps(data)) == data
    assert data["centres_mm"] == [[], [], []]


def test_obstacles_have_corners_edges_and_points(qiao):
    motion = make_among(qiao, obstacles=OBSTACLES)
    drawn = draw_motion(motion, [0, 10, 20])
    data = make_animation(drawn)
    assert json.loads(json.dumps(data)) == data
    post, board, dust = (next(one for one in data["obstacles"] if one["name"] == name) for name in OBSTACLES)
    assert (len(board["solids"][0]["corners"]), len(board["solids"][0]["faces"])) == (8, 6)
    np.testing.assert_allclose(np.ptp(board["solids"][0]["corners"], axis=0), [200, 300, 20])
    (solid,) = post["solids"]
    assert len(solid["faces"]) == 2  # its round ends
    assert (dust["solids"], dust["points"]) == ([], [[300, 450, 400], [400, 480, 500]])
    assert data["touched"] == [[], [], []]


def test_the_least_room_has_its_frame_if_it_is_drawn(qiao):
    motion = make_among(qiao, obstacles=OBSTACLES)
    sample = motion.closest_obstacle[0]
    data = make_animation(draw_motion(motion, sorted({0, sample, 20})))
    nearest = draw_motion(motion, [0]).nearest
    assert data["nearest"]["frame"] == sorted({0, sample, 20}).index(sample)
    np.testing.assert_allclose(data["nearest"]["points"], 1e3 * nearest.points_m, atol=0.5)
    assert data["nearest"]["text"] == f"{nearest.component} - {nearest.obstacle}: {1e3 * nearest.clearance_m:.1f} mm"
    assert make_animation(draw_motion(motion, [0 if sample else 1]))["nearest"]["frame"] == -1


def test_touched_obstacles_are_listed_by_frame(qiao):
    ball = {"far": {"sphere": {"radius": 0.1}, "position": [0.4, 0.3, 1.2]}, **TOUCHED}
    motion = make_among(qiao, obstacles=ball)
    data = make_animation(draw_motion(motion, [0, 10, 20]))
    assert [one["name"] for one in data["obstacles"]] == ["far", "ball"]
    assert data["touched"] == [[], [1], []]


def test_what_moves_has_its_poses_by_frame(qiao):
    data = make_animation(draw_motion(make_passing(qiao), [0, 20]))
    post, ball = data["obstacles"]
    assert (post["name"], post["poses"], ball["name"]) == ("post", None, "ball")
    np.testing.assert_allclose(np.linalg.norm(ball["solids"][0]["corners"], axis=1), 100.0, atol=1.0)
    turn = np.eye(3).ravel().tolist()
    np.testing.assert_allclose(ball["poses"], [[*turn, 1500, -500, 1000], [*turn, 1500, 500, 1000]])
