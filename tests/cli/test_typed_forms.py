"""Numbers as users type them: words, one quoted string, commas, brackets; all else stays as it is."""

import pytest

from ikde.cli.typed_forms import regroup

XYZ = ["--position", "0.8", "-0.5", "1"]


@pytest.mark.parametrize(
    "words",
    [
        ["--position", "0.8", "-0.5", "1"],
        ["--position", "0.8 -0.5 1"],
        ["--position", "0.8,-0.5,1"],
        ["--position", "0.8,", "-0.5,", "1"],
        ["--position", "[0.8,", "-0.5,", "1]"],
        ["--position=0.8,-0.5,1"],
        ["--position=0.8", "-0.5", "1"],
        ["--position", "0.8 −0.5 1"],
    ],
)
def test_three_numbers_are_three_words_however_they_are_typed(words):
    assert regroup(["solve", *words, "--json"]) == ["solve", *XYZ, "--json"]


@pytest.mark.parametrize("words", [["1", "2"], ["a", "b", "c"], ["1", "x", "3"], ["--json"], [], ["1 2 3 4"]])
def test_what_is_no_vector_is_left_to_the_option(words):
    assert regroup(["--axis", *words]) == ["--axis", *words]


def test_a_fourth_number_is_left_over():
    assert regroup(["--position", "1", "2", "3", "4"]) == ["--position", "1", "2", "3", "4"]
    assert regroup(["--quat-wxyz", "1,0,0,0"]) == ["--quat-wxyz", "1", "0", "0", "0"]


def test_goals_with_freedom_are_typed_alike():
    assert regroup(["--look-at", "1,2,3", "--distance", "0.3 0.6"]) == [
        "--look-at",
        "1",
        "2",
        "3",
        "--distance",
        "0.3",
        "0.6",
    ]
    assert regroup(["--tolerance-box", "0.1", "0", "0", "--json"]) == ["--tolerance-box", "0.1 0 0", "--json"]
    assert regroup(["--base-region", "-1,0", "1,0", "1,1", "--json"]) == ["--base-region", "-1,0 1,0 1,1", "--json"]


@pytest.mark.parametrize("option", ["--q", "--near", "--start"])
def test_joint_values_are_one_word(option):
    assert regroup([option, "0", "-1", ".5", "--json"]) == [option, "0 -1 .5", "--json"]
    assert regroup([option, "q1=1", "q2=-2", "--json"]) == [option, "q1=1 q2=-2", "--json"]
    assert regroup([f"{option}=q1=1", "q2=2"]) == [option, "q1=1 q2=2"]


def test_a_file_after_joint_values_is_an_argument():
    assert regroup(["track", "--start", "0", "1", "task.yaml"]) == ["track", "--start", "0 1", "task.yaml"]
    assert regroup(["--q", "a.yaml", "--json"]) == ["--q", "a.yaml", "--json"]


def test_frozen_joints_are_one_word():
    assert regroup(["--freeze", "d_x", "d_y=-1", "--seed", "1"]) == ["--freeze", "d_x d_y=-1", "--seed", "1"]


def test_other_words_and_what_follows_two_dashes_stay():
    words = ["check", "--unit=mm", "--seed", "1", "--", "--position", "1 2 3"]
    assert regroup(words) == words


def test_a_command_takes_them(cli):
    plain = cli("fk", "--q", "d_x=1 q2=0.5", "--json").data
    assert cli("fk", "--q", "d_x=1", "q2=0.5", "--json").data == plain
    assert cli("fk", "--q=d_x=1,q2=0.5", "--json").data == plain
