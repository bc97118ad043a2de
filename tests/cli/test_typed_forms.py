"""Numbers as people type them: three words, one in quotes, or commas."""

import pytest

from ikde.cli.typed_forms import regroup


@pytest.mark.parametrize(
    ("typed", "taken"),
    [
        (["--position", "1", "2", "3"], ["--position", "1", "2", "3"]),
        (["--position", "1 2 3"], ["--position", "1", "2", "3"]),
        (["--position", "1,2,3", "--json"], ["--position", "1", "2", "3", "--json"]),
        (["--position=1,-2,3e-1"], ["--position", "1", "-2", "3e-1"]),
        (["--position", "1,", "2,", "3", "x"], ["--position", "1", "2", "3", "x"]),
        (["--quat-wxyz", "1,0,0", "0"], ["--quat-wxyz", "1", "0", "0", "0"]),
        (["--q", "1", "-2", "3", "--json"], ["--q", "1 -2 3", "--json"]),
        (["--q", "q1=1", "q2=2"], ["--q", "q1=1 q2=2"]),
        (["--q=q1=1,q2=2", "q3=-4"], ["--q", "q1=1,q2=2 q3=-4"]),
        (["--freeze", "d_x", "d_y", "--json"], ["--freeze", "d_x d_y", "--json"]),
        (["--weights", "q1=2", "file"], ["--weights", "q1=2", "file"]),
    ],
)
def test_all_forms_come_to_one(typed, taken):
    assert regroup(typed) == taken


@pytest.mark.parametrize(
    "typed",
    [
        ["--position", "1", "2"],
        ["--position", "1", "2", "x"],
        ["--position", "1,2,3,4"],
        ["--position"],
        ["--q"],
        ["--seed", "1", "2", "3"],
        ["--", "--position", "1,2,3"],
    ],
)
def test_what_does_not_fit_is_left_to_the_option(typed):
    assert regroup(typed) == typed
