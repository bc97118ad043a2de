"""Track files: the shipped ones are the paper's tasks, and what is wrong is said with file, line and key."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import FileError, InputError
from ikde.io.plan_file import load_track

SHIPPED = {path.stem: path for path in sorted((Path(__file__).parents[2] / "configs" / "tracks").glob("*.yaml"))}
GOOD = """\
robot: qiao2021
units: {length: mm, angle: deg}
dt_s: 0.02
samples: 100
path:
  expressions:
    x: "900"
    y: 200*sin(2*pi*k/N)
    z: 920
orientation: {axis: [0, 0, 1]}
drive: differential
limits:
  speed: {prismatic: 500}
"""
Y = "y: 200*sin(2*pi*k/N)"

# [Qiao2022, section 4], mm: written a second time, in numpy.
k = np.arange(501)
turn = 2 * np.pi * k / 500
PRINTED = {
    "task1": (
        900 + 0 * k,
        200 * np.sin(2 * turn) + 200 * np.cos(turn),
        920 + 200 * np.sin(turn) + 200 * np.cos(2 * turn),
    ),
    "task2": (572 + 4 * k, 300 * np.sin(3 * turn), 920 + 300 * np.cos(3 * turn)),
    "task3": (53.1 + 2.0378 * k, 241 + 0 * k, 1068.2 + 0 * k),
    "task4": (np.where(k <= 250, 600 + 0.8 * k, 1000 - 0.8 * k), 150 * np.sin(2 * turn), 1220 + 150 * np.cos(turn)),
}
AXES = {"task3": [0, 0, 1], "task4": [1, 0, 0], "task4_minus_x": [-1, 0, 0]}


def complaint(text, folder):
    path = folder / "track.yaml"
    path.write_text(text)
    with pytest.raises(FileError) as caught:
        load_track(path)
    assert "\n" not in str(caught.value)
    return str(caught.value).replace(f"{folder}/", "")


@pytest.mark.parametrize("path", SHIPPED.values(), ids=SHIPPED)
def test_the_shipped_tracks_load_and_say_how_to_run_them(path):
    plan = load_track(path)
    assert path.read_text().startswith("# ")
    assert f"ikde track configs/tracks/{path.name}" in path.read_text()
    assert plan.file == str(path)


@pytest.mark.parametrize("task", ["task1", "task2", "task3", "task4", "task4_minus_x"])
def test_the_tasks_are_as_the_paper_has_them(task):
    plan = load_track(SHIPPED[f"qiao2022_{task}"])
    assert (plan.path.samples, plan.path.dt_s, plan.method, plan.drive) == (500, 0.02, "continuation", "differential")
    printed = np.column_stack(PRINTED[task.removesuffix("_minus_x")]) / 1e3
    np.testing.assert_allclose(plan.path.p_world_tool, printed, rtol=0, atol=1e-12)
    assert plan.path.orientation == ("axis" if task in AXES else "free")
    np.testing.assert_array_equal(plan.path.R_world_tool[:, :, 2], np.tile(AXES.get(task, [0, 0, 1]), (501, 1)))
    np.testing.assert_allclose(plan.limits.speed, [0.5] * 2 + [np.pi / 2] * 7)


def test_the_shipped_robot_has_the_angle_limits_of_the_tasks(qiao):
    limits = {"q_z": 180, "q1": 169, "q2": 165, "q3": 150, "q4": 102.5, "q5": 167.5, "q6": 167.5}  # deg, symmetric
    upper = dict(zip(qiao.joint_names, np.degrees(qiao.upper), strict=True))
    assert {name: upper[name] for name in limits} == pytest.approx(limits)
    np.testing.assert_allclose(qiao.lower, -qiao.upper)


def test_a_world_stands_beside_its_track_file(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "wall.yaml").write_text("obstacles: {wall: {box: [1, 1, 1], position: [9, 0, 0]}}")
    (tmp_path / "track.yaml").write_text(f"{GOOD}world: a/wall.yaml\nmargin: 10,LT=2\n")
    plan = load_track(tmp_path / "track.yaml")
    assert plan.collision.world.names == ("wall",)
    assert (plan.collision.margin_m, plan.collision.margins_m) == (0.01, (("LT", 0.002),))
    assert plan.world_file == "a/wall.yaml"
    (tmp_path / "track.yaml").write_text(f"{GOOD}world: a/wall.yaml\nmargin: 10\n")
    assert load_track(tmp_path / "track.yaml").collision.margin_m == 0.01


WALL = "obstacles: {wall: {box: [1, 1, 1], position: [9, 0, 0]}}"


def test_a_track_picks_up_what_it_carries_at_its_start(tmp_path):
    (tmp_path / "world.yaml").write_text(WALL)
    (tmp_path / "track.yaml").write_text(f"{GOOD}world: world.yaml\nattached: {{wall: tool}}\n")
    plan = load_track(tmp_path / "track.yaml")
    (thing,) = plan.collision.world.attached
    q = plan.robot.home if plan.start is None else plan.start
    stood = ikde.forward(plan.robot, q)["tool"] @ np.vstack([thing.T_frame_object, [0, 0, 0, 1]])
    assert (thing.name, thing.frame) == ("wall", "tool")
    assert np.allclose(stood[:3], thing.obstacle.T_world_obstacle, atol=1e-12)


@pytest.mark.parametrize(
    ("keys", "world", "message"),
    [
        ("world: nothing.yaml", WALL, "track.yaml:14 → world: no such file: nothing.yaml"),
        ("world: 5", WALL, "track.yaml:14 → world: expected text, got 5"),
        ("world: world.yaml\nmargin: -1", WALL, "track.yaml:15 → margin: expected at least 0, got -1"),
        ("world: world.yaml\nmargin: {}", WALL, "track.yaml:15 → margin: expected a number, got {}"),
        ("world: world.yaml\nmargin: {a: 1}", WALL, "track.yaml:15 → margin: expected a number, got {'a': 1}"),
        ("attached: {wall: LT}", WALL, "track.yaml:14 → attached: what is picked up is an obstacle of a `world`"),
        ("world: world.yaml\nattached: {wal: tool}", WALL, "track.yaml:15 → attached.wal: no obstacle is called 'wal'"),
        ("world: world.yaml\nmargin: ten", WALL, "track.yaml:15 → margin: expected a distance or component=distance"),
        ("world: world.yaml\nmargin: 1,hnad=2", WALL, "track.yaml:15 → margin.hnad: no component is called 'hnad'"),
        ("margin: 1", WALL, "track.yaml:14 → margin: a margin needs a `world` to be kept from"),
        ("detector: none\nworld: world.yaml", WALL, "track.yaml:14 → detector: a world needs a detector"),
        ("world: world.yaml", "obstacles: {wall: {box: [1, 0, 1]}}", "world.yaml:1 → obstacles.wall.box.y: expected"),
        ("world: world.yaml", "obstacles: {wall: {half_space: {}}}", "world.yaml:1 → obstacles.wall: "),
        ("world: world.yaml", "- 1\n", "world.yaml"),
    ],
)
def test_a_world_that_is_wrong_is_one_line_with_its_place(tmp_path, keys, world, message):
    (tmp_path / "world.yaml").write_text(world)
    assert complaint(f"{GOOD}{keys}\n", tmp_path).startswith(message)


MOVING = """world: world.yaml
moving:
  wall:
    times_s: [0, 1, 2]
    poses: [[9000, 0, 0], {position: [9000, 500, 0], rpy: [0, 0, 90]}, {position: [9, 0, 0], quat_wxyz: [1, 0, 0, 0]}]
"""


def test_obstacles_move_in_the_units_of_the_file(tmp_path):
    (tmp_path / "world.yaml").write_text(WALL)
    (tmp_path / "track.yaml").write_text(GOOD + MOVING)
    plan = load_track(tmp_path / "track.yaml")
    motion = plan.moving["wall"]
    assert motion.times_s.tolist() == [0.0, 1.0, 2.0]
    np.testing.assert_allclose(motion.T_world_object[:, :, 3], [[9, 0, 0], [9, 0.5, 0], [0.009, 0, 0]])
    turned = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    np.testing.assert_allclose(motion.T_world_object[:, :, :3], [np.eye(3), turned, np.eye(3)], atol=1e-15)
    np.testing.assert_allclose(plan.collision.world["wall"].T_world_obstacle[:, 3], [9, 0, 0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("world: world.yaml\n", "", "track.yaml:14 → moving: what moves is an obstacle of a `world`: name one"),
        ("  wall:", "  wal:", "track.yaml:16 → moving.wal: no obstacle that counts is called 'wal' (did you mean"),
        ("[0, 1, 2]", "[0, 2, 1]", "track.yaml:17 → moving.wall.times_s[2]: expected a later time than 2 s, got 1"),
        (
            "[0, 1, 2]",
            "[0, 1, 1.5]",
            "track.yaml:17 → moving.wall.times_s: wall is known from 0 to 1.5 s, the path lasts",
        ),
        ("[0, 1, 2]", "[0.5, 1, 2]", "track.yaml:17 → moving.wall.times_s: wall is known from 0.5 to 2 s, the path"),
        (
            "[0, 1, 2]",
            "[0, 2]",
            "track.yaml:17 → moving.wall.times_s: expected a pose a time, two at least, got 2 and 3",
        ),
        ("[0, 1, 2]", "[0]", "track.yaml:17 → moving.wall.times_s: expected"),
        ("rpy: [0, 0, 90]", "axis: [0, 0, 1]", "track.yaml:18 → moving.wall.poses[1].axis: expected rpy or quat_wxyz"),
        (
            "rpy: [0, 0, 90]",
            "rpy: [0, 0, 180]",
            "track.yaml:18 → moving.wall.poses[1]: half a turn from the orientation",
        ),
        ("quat_wxyz: [1, 0, 0, 0]", "quat_wxyz: [0, 0, 0, 0]", "track.yaml:18 → moving.wall.poses[2].quat_wxyz: "),
        ("    times_s: [0, 1, 2]\n", "", "track.yaml:16 → moving.wall.times_s: this key is missing"),
        (
            "moving:",
            "method: optimized\nmoving:",
            "track.yaml:16 → moving: obstacles that move need the method continuation",
        ),
    ],
)
def test_a_motion_of_an_obstacle_that_is_wrong_is_one_line(tmp_path, old, new, message):
    (tmp_path / "world.yaml").write_text(WALL)
    assert old in MOVING
    assert complaint(GOOD + MOVING.replace(old, new), tmp_path).startswith(message)


def test_a_mapping_is_the_same_track(tmp_path):
    (tmp_path / "track.yaml").write_text(GOOD)
    a, b = load_track(tmp_path / "track.yaml"), load_track(yaml.safe_load(GOOD))
    np.testing.assert_array_equal(a.path.p_world_tool, b.path.p_world_tool)
    assert (a.file, b.file) == (str(tmp_path / "track.yaml"), None)


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        (Y, "y: 200*sinn(k)", ":8 → path.expressions.y:", "no function is called 'sinn' (did you mean 'sin'?)"),
        (Y, "y: k.real", ":8 → path.expressions.y:", "'k.real' is not allowed here"),
        (Y, "y: [1]", ":8 → path.expressions.y:", "expected a number, got [1]"),
        (Y, "", ":6 → path.expressions.y:", "this key is missing"),
        (Y, f"{Y}\n    w: 1", ":9 → path.expressions.w:", "unknown key"),
        ("expressions:", "expression:", ":6 → path.expression:", "unknown key (did you mean 'expressions'?)"),
        ("samples: 100", "samples: 1.5", ":4 → samples:", "expected a whole number"),
        ("samples: 100", "", ":1 → samples:", "formulas need to know how many samples there are"),
        ("dt_s: 0.02", "dt_s: 0", ":3 → dt_s:", "expected more than 0"),
        ("dt_s: 0.02", "dt: 0.02", ":3 → dt:", "unknown key (did you mean 'dt_s'?)"),
        ("{axis: [0, 0, 1]}", "{axis: [0, 0, 0]}", ":10 → orientation.axis:", "a length of 0 has no direction"),
        ("{axis: [0, 0, 1]}", "{axs: [0, 0, 1]}", ":10 → orientation.axs:", "unknown key (did you mean 'axis'?)"),
        ("{axis: [0, 0, 1]}", "{axis: [0, 1]}", ":10 → orientation.axis:", "expected 3 values, got 2"),
        ("{axis: [0, 0, 1]}", "fre", ":10 → orientation:", "expected 'free', got 'fre'"),
        ("drive: diff", "drive: d", ":11 → drive:", "expected 'differential', 'omnidirectional' or 'mecanum'"),
        ("robot: qiao", r'name: "a\e[2J"' + "\nrobot: qiao", ":1 → name:", "expected a name of printable characters"),
        ("robot: qiao", f"detector: {'x' * 101}\nrobot: qiao", ":1 → detector:", "1 to 100 characters, got 101"),
        ("prismatic: 500", "prismatic: -5", ":13 → limits.speed.prismatic:", "expected at least 0, got -5"),
        ("prismatic: 500", "q9: 5", ":13 → limits.speed.q9:", "qiao2021 has no joint 'q9'"),
        ("robot: qiao2021", "robot: qiao", ":1 → robot:", "no robot is called 'qiao'"),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(tmp_path, old, new, place, words):
    assert old in GOOD
    message = complaint(GOOD.replace(old, new), tmp_path)
    assert message.startswith(f"track.yaml{place}")
    assert words in message


@pytest.mark.parametrize("bad", [None, 3, ["robot"]])
def test_what_is_neither_path_nor_mapping_is_refused(bad):
    with pytest.raises(InputError, match="expected the path of a track file or a mapping"):
        load_track(bad)


FULL = {
    "robot": "qiao2021",
    "units": {"length": "mm", "angle": "deg"},
    "dt_s": 0.1,
    "path": {
        "curve": {
            "from": [800, 0, 900],
            "segments": [
                {"duration_s": 1, "pace": "smooth", "line": {"to": [800, 100, 900]}},
                {"duration_s": 1, "arc": {"center": [800, 0, 900], "normal": [0, 0, 1], "angle": 90}},
                {"duration_s": 1, "arc_through": {"via": [700, 50, 900], "to": [800, 100, 900]}},
                {"duration_s": 1, "spline": {"through": [[800, 0, 900], [800, 0, 1000]]}},
            ],
        }
    },
    "orientation": {"keyframes": [{"at": 0, "rpy": [0, 0, 0]}, {"at": 1, "quat_wxyz": [1, 0, 0, 1]}]},
    "limits": {"speed": {"q1": 90}, "max_distance": 1400, "center": "Oc"},
    "detector": "improved",
    "ranges": {"d_x": [-1000, 1000]},
    "start": {"q1": 0},
}


def places(data, where=()):
    """Paths of every value in nested data."""
    children = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, child in children:
        yield (*where, key)
        yield from places(child, (*where, key))


scalars = st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats() | st.text(max_size=8)
anything = scalars | st.lists(scalars, max_size=4) | st.dictionaries(st.text(max_size=5), scalars, max_size=2)


@settings(max_examples=300)
@given(whole=st.sampled_from([FULL, yaml.safe_load(GOOD)]), data=st.data(), value=anything)
def test_nothing_that_is_written_ends_in_a_traceback(whole, data, value):
    changed = copy.deepcopy(whole)
    *path, last = data.draw(st.sampled_from(list(places(whole))))
    inner = changed
    for key in path:
        inner = inner[key]
    inner[last] = value
    try:
        load_track(changed)
    except InputError as error:
        assert "\n" not in str(error)


def test_waypoints_may_be_positions_alone(tmp_path):
    head = "robot: qiao2021\nunits: {length: mm}\ndt_s: 0.02\nsamples: 4\npath:\n  waypoints:\n"
    paths = []
    for name, rows in {
        "plain": ("[900, 0, 920]", "[900, 100, 920]"),
        "named": ("{position: [900, 0, 920]}", "{position: [900, 100, 920]}"),
    }.items():
        file = tmp_path / f"{name}.yaml"
        file.write_text(head + "".join(f"    - {row}\n" for row in rows))
        paths.append(load_track(file).path.p_world_tool)
    np.testing.assert_array_equal(*paths)
    bad = complaint(f"{head}    - [900, 0, 920]\n    - [900, x, 920]\n", tmp_path)
    assert bad == "track.yaml:8 → path.waypoints[1][1]: expected a number, got 'x'"
