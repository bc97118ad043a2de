"""`ikde solve --prefer`."""

SOLVE = ("solve", "--position", "0.8", "0.5", "1")


def test_an_answer_is_moved_for_what_is_preferred(cli, qiao):
    data = cli(*SOLVE, "--prefer", "limits", "--json").data
    assert (data["reached"], data["verified"], data["preferred"]["what"]) == (True, True, "limits")
    assert data["preferred"]["after"] > data["preferred"]["before"]
    assert data["position_error_m"] < 1e-9
    assert list(data["q"]) == list(qiao.joint_names)
    outcome = cli(*SOLVE, "--prefer", "clearance")
    assert "preferred" in outcome.out
    assert "room beyond what is asked for" in outcome.out
    assert "preferred" not in cli(*SOLVE, "--json").data


def test_what_cannot_be_preferred_is_one_line(refuse):
    assert "prefer: expected one of manipulability, clearance, limits, motion" in refuse(*SOLVE, "--prefer", "speed")
    assert "without a detector no clearance" in refuse(*SOLVE, "--prefer", "clearance", "--detector", "none")
    assert "--prefer moves one answer" in refuse(*SOLVE, "--prefer", "limits", "--count", "2")
    assert "prefer: an answer is moved for an exact target" in refuse(
        *SOLVE, "--prefer", "limits", "--tolerance-box", "0.01,0.01,0.01"
    )
