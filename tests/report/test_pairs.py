"""Pairs as text and as JSON: each of them once, worst first, and why the others are left out."""

import json
from dataclasses import replace
from itertools import combinations

import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import list_tests
from ikde.model.generate.proofs import drop_proved, proof_margin
from ikde.model.pack import pack_robot
from ikde.report.numbers import Units
from ikde.report.pairs import format_pairs, pairs_json
from tests.bare_robot import BARE
from tests.robot_files import load_text

MM = Units("mm", "deg")
ALWAYS = BARE.replace("radius: 0.35", "radius: 0.9")


def show(robot, detector, units=MM, width=100):
    return format_pairs(CollisionModel(robot=robot, detector=detector), units, width=width)


def test_json_accounts_for_every_pair(any_robot):
    for detector in any_robot.detectors.values():
        data = json.loads(json.dumps(pairs_json(CollisionModel(robot=any_robot, detector=detector)), allow_nan=False))
        told = [frozenset((pair["a"], pair["b"])) for pair in (*data["compared"], *data["left_out"])]
        assert len(told) == len(set(told))
        assert set(told) == {frozenset(pair) for pair in combinations(any_robot.components(detector.spheres), 2)}


def test_json_has_the_clearance_at_home_worst_first_and_the_reasons(qiao):
    data = pairs_json(CollisionModel.of(qiao, "typical"))
    checked = ikde.check(qiao, qiao.home, "typical").pairs
    assert [(p["a"], p["b"], p["clearance_at_home_m"]) for p in data["compared"]] == [
        (p.a, p.b, p.clearance_m) for p in checked
    ]
    reasons = {(pair["a"], pair["b"]): pair["reason"] for pair in data["left_out"]}
    assert reasons["M", "G"] == "one body"
    assert reasons["M", "J1"] == "joined by joint q1"
    assert reasons["M", "J2"].startswith("adjacent: motor 2 stands over the mount")
    assert reasons["G", "J2"] == "not in the pair list formula_22"
    assert (data["detector"], data["always_touching"], data["to_add"]) == ("typical", [], [])


def test_pairs_that_are_proved_apart_count_as_compared(qiao):
    detector = CollisionModel.of(qiao).detector
    tests, arrays = list_tests(CollisionModel(robot=qiao, detector=detector).arrays), pack_robot(qiao)
    kept = drop_proved(
        arrays, tests, proof_margin(CollisionModel(robot=qiao, detector=detector)), qiao.lower, qiao.upper
    )
    proved = {CollisionModel(robot=qiao, detector=detector).pairs[test.pair] for test in tests} - {
        CollisionModel(robot=qiao, detector=detector).pairs[test.pair] for test in kept
    }
    assert proved
    assert proved <= {
        (pair["a"], pair["b"]) for pair in pairs_json(CollisionModel(robot=qiao, detector=detector))["compared"]
    }


def test_text_has_a_line_a_pair(any_robot):
    for detector in any_robot.detectors.values():
        lines = show(any_robot, detector, width=200).splitlines()
        compared, left_out = lines.index("pairs compared"), lines.index("pairs left out")
        rows = [line for line in lines if " - " in line]
        pairs = ikde.check(any_robot, any_robot.home, detector).pairs
        assert [line.split()[:4] for line in rows if compared < lines.index(line) < left_out] == [
            [pair.a, "-", pair.b, f"{1e3 * pair.clearance_m:.2f}"] for pair in pairs
        ]
        assert [" ".join(line.split()) for line in rows if left_out < lines.index(line)] == [
            f"{pair.a} - {pair.b} {pair.reason}"
            for pair in CollisionModel(robot=any_robot, detector=detector).left_out_pairs
        ]


def test_text_counts_pairs_first(qiao):
    assert show(qiao, CollisionModel.of(qiao).detector).startswith(
        "collision: detector improved compares 35 pairs, 20 left out\n"
    )
    robot = load_text(
        BARE.replace("{spheres: s,", "{spheres: s, pairs: one,") + "pairs: {one: {pairs: {platform: [forearm]}}}"
    )
    assert show(robot, CollisionModel.of(robot).detector).startswith(
        "collision: detector d compares 1 pair, 2 left out\n"
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("qiao2021", "no detector: self-collision is not checked"),
        ("qiao2021_dh", "not checked (qiao2021_dh has no spheres)"),
    ],
)
def test_no_detector_is_said(name, words):
    robot = ikde.load_robot(name)
    assert show(robot, None).endswith(words)
    assert pairs_json(CollisionModel.of(robot, "none")) is None


@pytest.mark.parametrize("width", [40, 100])
def test_pairs_that_always_touch_are_named_with_the_line_to_add_in_one_piece(width):
    robot = load_text(ALWAYS)
    line = 'adjacent: {pairs: {platform: {upper_arm: "why they may touch"}}}'
    assert line in show(robot, CollisionModel.of(robot).detector, width=width).splitlines()
    assert "platform - upper_arm touches in each of" in show(robot, CollisionModel.of(robot).detector)
    data = pairs_json(CollisionModel.of(robot))
    assert (data["always_touching"], data["to_add"]) == ([["platform", "upper_arm"]], [line])
    assert ["platform", "upper_arm"] in [[pair["a"], pair["b"]] for pair in data["compared"]]


def test_names_and_reasons_in_brackets_are_shown_as_they_are():
    robot = load_text(BARE.replace("upper_arm, from", "'[red]arm', from"))
    assert "platform - [red]arm" in show(robot, CollisionModel.of(robot).detector)
    assert "[red]arm - forearm" in show(robot, replace(CollisionModel.of(robot).detector))
