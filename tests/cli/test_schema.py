"""`ikde schema` prints JSON schemas that editors can use."""

import pytest


def test_the_schema_of_a_run_file_explains_its_keys(cli):
    outcome = cli("schema", "batch")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.data["additionalProperties"] is False
    assert outcome.data["required"] == ["robot", "targets"]
    assert outcome.data["properties"]["repeats"]["description"].startswith("How often each target is solved")
    targets = outcome.data["$defs"]["TargetsEntry"]
    assert (targets["minProperties"], targets["maxProperties"]) == (1, 1)
    assert outcome.data["$defs"]["GridEntry"]["required"] == ["from", "to", "counts"]


def test_the_schema_of_a_track_file_explains_its_keys(cli):
    data = cli("schema", "track").data
    assert data["required"] == ["robot", "dt_s", "path"]
    assert data["properties"]["samples"]["description"].startswith("N, samples after the start")
    assert data["$defs"]["CurveEntry"]["required"] == ["from", "segments"]


def test_the_schema_of_a_robot_file_is_there_too(cli):
    data = cli("schema", "robot").data
    assert {"joints", "frames"} <= set(data["required"])
    assert data["anyOf"] == [{"required": ["tool"]}, {"required": ["tools"]}]
    joint = data["$defs"]["JointEntry"]
    assert joint["properties"]["kind"]["enum"] == ["revolute", "prismatic", "continuous"]
    assert joint["if"]["properties"]["kind"] == {"const": "continuous"}
    assert (joint["then"]["properties"], joint["else"]["required"]) == (
        {"lower": False, "upper": False},
        ["lower", "upper"],
    )


def test_the_schema_of_a_world_file_is_there_too(cli):
    data = cli("schema", "world").data
    assert data["required"] == ["obstacles"]
    obstacle = data["$defs"]["ObstacleEntry"]["properties"]
    assert {"box", "sphere", "hull", "cloud", "parts", "margin", "ignore", "group"} <= set(obstacle)
    assert obstacle["box"]["description"] == "Whole edges along its own x, y, z."
    assert data["$defs"]["RoundEntry"]["required"] == ["radius", "height"]


def test_the_schema_of_a_goal_file_is_there_too(cli):
    data = cli("schema", "goal").data
    assert set(data["properties"]) == {"units", "goal", "any_of", "take", "base"}
    goal = data["$defs"]["GoalEntry"]["properties"]
    assert {"position", "box", "rotation", "turn", "cone", "look_at", "frame"} <= set(goal)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "of batch, track, robot, goal, world, got nothing"),
        (("bacth",), "robot, goal, world, got bacth (did you mean 'batch'?)"),
    ],
)
def test_other_names_are_refused(refuse, arguments, words):
    assert words in refuse("schema", *arguments)
