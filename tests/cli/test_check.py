"""`ikde check`."""

import pytest

import ikde
from tests.cli.paper_row import ROW, ROW_OPTIONS

FOLDED = "q1=90 q2=150 q3=150"  # deg: the arm lies on the platform


def test_json_has_the_promised_keys_and_pairs_worst_first(cli, qiao):
    outcome = cli("check", "--json")
    assert outcome.code == 0
    data = outcome.data
    assert set(data) == {
        "convention",
        "robot",
        "detector",
        "safe_distance_m",
        "collision",
        "clearance_m",
        "closest_pair",
        "pairs",
        "obstacles",
        "q",
        "outside_limits",
    }
    assert all(set(pair) == {"a", "b", "clearance_m", "collides"} for pair in data["pairs"])
    clearances = [pair["clearance_m"] for pair in data["pairs"]]
    assert clearances == sorted(clearances)
    assert data["clearance_m"] == clearances[0] == ikde.check(qiao, qiao.home).clearance_m
    assert len(clearances) == len(qiao.pair_lists["formula_22"])


def test_a_row_of_the_paper_is_free(cli):
    outcome = cli("check", "--q", ROW, *ROW_OPTIONS)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("free of self-collision: robot qiao2021, clearance")
    assert "[mm]" in outcome.out


def test_a_collision_exits_with_1_and_names_the_pairs(cli):
    outcome = cli("check", "--q", FOLDED, "--angles", "deg", "--json")
    assert outcome.code == 1
    assert outcome.data["collision"] is True
    assert outcome.data["pairs"][0]["collides"] is True
    text = cli("check", "--q", FOLDED, "--angles", "deg")
    assert text.code == 1
    assert text.out.startswith("self-collision: robot qiao2021, clearance -")
    assert "collides" in text.out


def test_without_a_detector_the_output_says_not_checked(cli):
    outcome = cli("check", "--q", FOLDED, "--angles", "deg", "--detector", "none", "--json")
    assert outcome.code == 0
    assert (outcome.data["collision"], outcome.data["clearance_m"], outcome.data["pairs"]) == (None, None, [])
    text = cli("check", "--detector", "none")
    assert (text.code, text.out) == (0, "self-collision not checked: robot qiao2021, detector none\n")


def test_a_robot_without_spheres_is_not_called_free(cli):
    outcome = cli("check", "--robot", "qiao2021_dh")
    assert outcome.code == 0
    assert "free" not in outcome.out
    assert outcome.err == "ikde: self-collision is not checked: qiao2021_dh has no spheres\n"


def test_a_detector_that_is_switched_off_is_not_missed(cli):
    assert cli("check", "--detector", "none").err == ""
    assert cli("check", "--robot", "qiao2021_dh", "--detector", "none").err == ""


def test_the_safe_distance_is_in_the_unit_asked_for(cli):
    clearance_mm = 1e3 * cli("check", "--json").data["clearance_m"]
    near, far = clearance_mm - 0.01, clearance_mm + 0.01
    assert cli("check", "--unit", "mm", "--safe-distance", near).code == 0
    outcome = cli("check", "--unit", "mm", "--safe-distance", far, "--json")
    assert outcome.code == 1
    assert outcome.data["safe_distance_m"] == pytest.approx(far / 1e3)


def test_another_pair_list_is_looked_at(cli, qiao):
    data = cli("check", "--pairs", "load_arm", "--json").data
    assert {(pair["a"], pair["b"]) for pair in data["pairs"]} == set(qiao.pair_lists["load_arm"])
    assert "load_arm" in data["detector"]


def test_values_outside_the_limits_are_named_and_judged(cli):
    outcome = cli("check", "--q", "q2=3.1", "--json")
    assert outcome.data["outside_limits"] == ["q2"]
    assert "outside the limits: q2" in cli("check", "--q", "q2=3.1").out


def test_a_figure_is_written(cli, tmp_path):
    outcome = cli("check", "--plot", tmp_path / "pose.png")
    assert (outcome.code, outcome.err) == (0, "")
    assert (tmp_path / "pose.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("value", ["1e308", "1e200"])
def test_an_absurd_value_is_never_called_free(cli, value):
    outcome = cli("check", "--q", f"d_x={value}", "--json")
    assert outcome.code in (1, 2)
