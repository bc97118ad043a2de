"""Goals with freedom on the command line: they are those of Python, and what makes none is one line and code 2."""

import numpy as np
import pytest

import ikde
from ikde.cli.goal_options import NAMES, read_goal
from ikde.cli.options import AngleUnit, LengthUnit
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target

POSITION = (400.0, 200.0, 300.0)
POSE = Target.from_rpy((0.4, 0.2, 0.3), (np.pi, 0.0, 0.0))
AXIS = Target((0.4, 0.2, 0.3), axis_world_tool=(0, 0, -1))
ROOM = [(0, 0), (2, 0), (2, 2)]


def read(**given):
    options = {name: False if name == "free_turn" else None for name in NAMES} | given
    return read_goal(options, LengthUnit.mm, AngleUnit.deg)


@pytest.mark.parametrize(
    ("given", "goal"),
    [
        ({"position": POSITION}, Target((0.4, 0.2, 0.3))),
        ({"position": POSITION, "tolerance_box": "10 20 0"}, Region.box((0.4, 0.2, 0.3), (0.01, 0.02, 0.0))),
        ({"position": POSITION, "rpy": (180, 0, 0), "rotation_box": "0,0,90"}, Region.box(POSE, 0, (0, 0, np.pi / 2))),
        ({"position": POSITION, "rpy": (180, 0, 0), "free_turn": True}, Region.turn(POSE)),
        (
            {"position": POSITION, "axis": (0, 0, -1), "cone": 90.0, "tolerance_box": "10"},
            Region.cone(AXIS, np.pi / 2, 0.01),
        ),
        ({"look_at": POSITION, "distance": (300, 600)}, Region.look_at((0.4, 0.2, 0.3), (0.3, 0.6))),
        (
            {"look_at": POSITION, "distance": (300, 600), "axis": (1, 0, 0), "cone": 90.0},
            Region.look_at((0.4, 0.2, 0.3), (0.3, 0.6), (1, 0, 0), np.pi / 2),
        ),
        ({"position": POSITION, "base_region": "0,0 2000,0 2000,2000"}, Region.of((0.4, 0.2, 0.3)).with_base(ROOM)),
    ],
)
def test_options_make_the_goals_of_python(given, goal):
    assert read(**given) == goal


def test_a_base_region_may_be_a_file(tmp_path):
    path = tmp_path / "room.yaml"
    holes = "holes: [[[900, 100], [1100, 100], [1100, 200]]]"
    path.write_text(f"units: {{length: mm}}\ncorners: [[0, 0], [2000, 0], [2000, 2000]]\n{holes}\n")
    expected = BaseRegion(ROOM, [[(0.9, 0.1), (1.1, 0.1), (1.1, 0.2)]])
    assert read(position=POSITION, base_region=str(path)).base == expected


def test_a_command_solves_one(cli, tmp_path):
    goal = ("--position", 0.4, 0.2, 0.3, "--axis", 0, 0, -1, "--tolerance-box", 0.01, 0.01, 0, "--cone", 0.1)
    outcome = cli("solve", "--robot", "ur5", *goal, "--json")
    assert outcome.code == 0
    assert outcome.data["verified"]
    assert (outcome.data["goal"]["alternative"], outcome.data["goal"]["poses"]) == (0, 1)
    assert outcome.data["goal"]["target"]["kind"] == "axis"
    picture = tmp_path / "goal.png"
    text = cli("solve", "--robot", "ur5", *goal, "--count", 2, "--plot", picture)
    assert "errors are from the one at 0." in text.out
    assert picture.stat().st_size > 10_000


def test_a_no_says_what_was_tried(cli):
    outcome = cli("solve", "--robot", "ur5", "--position", 3, 0, 0, "--tolerance-box", "0.5")
    assert outcome.code == 1
    assert "out of reach: every pose of the region is at least 1.281 m too far" in " ".join(outcome.out.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("", "expected one of --position, --look-at, --goal, got none"),
        ("--position 1 2 3 --look-at 1 2 3", "got --position and --look-at"),
        ("--position 1 2 3 --tolerance-box 0", "a region of zero size"),
        ("--position 1 2 3 --tolerance-box -0.1", "--tolerance-box: inside out"),
        ("--position 1 2 3 --tolerance-box nan", "--tolerance-box: expected finite numbers"),
        ("--position 1 2 3 --tolerance-box 1,2", "--tolerance-box: expected a number, or three, got '1,2'"),
        ("--position 1 2 3 --free-turn", "--free-turn: a turn is about an axis of a full pose"),
        ("--position 1 2 3 --cone 0.1", "--cone: a cone needs a direction"),
        (
            "--position 1 2 3 --axis 0 0 1 --cone 190 --angles deg",
            "--cone: expected an angle from 0 to pi (180",
        ),
        ("--position 1 2 3 --axis 0 0 1 --rotation-box 0.1", "--rotation-box: only a full pose has rotations"),
        ("--position 1 2 3 --rpy 0 0 0 --cone 1 --free-turn", "--free-turn and --cone both say which orientations"),
        ("--position 1 2 3 --distance 0 1", "--distance: a --distance is from the point of --look-at"),
        ("--look-at 1 2 3", "--look-at needs a --distance"),
        ("--look-at 1 2 3 --distance 0.6 0.3", "--distance: inside out"),
        ("--look-at 1 2 3 --distance 0.3 0.6 --cone 1", "give an --axis"),
        ("--look-at 1 2 3 --distance 0.3 0.6 --tolerance-box 1", "leave out --tolerance-box"),
        ("--goal none.yaml --axis 0 0 1", "leave out --axis"),
        ("--goal none.yaml", "none.yaml"),
        ("--position 1 2 3 --base-region 0,0 1,1", "--base-region: expected at least 3 corners"),
        ("--position 1 2 3 --base-region 0,0 1,1 1,0 0,1", "--base-region: the polygon crosses or touches itself"),
        ("--position 1 2 3 --base-region here", "--base-region: expected corners as x,y"),
        ("--position 1 2 3 --base-region 0,0 1,0 1,1 --robot ur5", "base: ur5 has no planar base"),
    ],
)
def test_what_makes_no_goal_is_refused(refuse, words, said):
    assert said in refuse("solve", *words.split())


def test_a_goal_of_a_file_is_solved(cli, tmp_path):
    path = tmp_path / "goal.yaml"
    path.write_text("units: {length: mm, angle: deg}\ngoal: {position: [400, 200, 300], rpy: [180, 0, 0], turn: {}}\n")
    outcome = cli("solve", "--robot", "ur5", "--goal", path, "--json")
    assert outcome.code == 0
    tool = ikde.forward("ur5", [outcome.data["q"][name] for name in ikde.load_robot("ur5").joint_names])["tool"]
    assert tool[:3, 3] == pytest.approx((0.4, 0.2, 0.3), abs=1e-5)
