"""An analysis as text and as plain data."""

import json

import numpy as np

import ikde
from ikde.report.analysis import analysis_json, format_analysis
from ikde.report.numbers import Units


def test_json_holds_no_infinities_and_every_number(any_robot):
    data = json.loads(json.dumps(analysis_json(ikde.analyze(any_robot, any_robot.home)), allow_nan=False))
    assert data["columns"] == [own["name"] for own in data["additions"]]
    for kind in ("scaled", "raw"):
        for rows in ("pose", "translation", "rotation"):
            own = data[kind]["whole"][rows]
            assert own["determinant"] == own["manipulability"] ** 2
            assert own["smallest_singular_value"] == own["singular_values"][-1]
    assert len(data["limits"]) == len(any_robot.joints)


def test_what_is_infinite_is_null():
    robot = ikde.load_robot("ur5e_mecanum")
    data = analysis_json(ikde.analyze(robot, robot.home))
    assert data["limits"][2] == {"joint": "heading", "below": None, "above": None, "share": 0.5}
    base = analysis_json(ikde.analyze("qiao2021", np.zeros(9)))["scaled"]["base"]["pose"]
    assert (base["condition"], base["smallest_singular_value"]) == (None, 0.0)


def test_text_names_what_it_counts_with(qiao):
    text = format_analysis(ikde.analyze(qiao, qiao.home, length_m=0.3), Units("mm", "deg"), width=140)
    assert text.startswith("robot qiao2021, tool tool, moved by its base's twist and joints")
    assert "a radian counted as 300 mm" in text
    assert "det(J J^T)" in text
    assert "base_forward" in text
    outside = qiao.home.copy()
    outside[4] = 9.0
    assert "outside the limits: q2" in format_analysis(ikde.analyze(qiao, outside), Units())
    stretched = ikde.analyze("ur5", [0.0, -1.2, 0.0, -1.0, 1.0, 0.0])
    text = format_analysis(stretched, Units())
    assert "singular" in text
    assert text.startswith("robot ur5, tool tool, moved by its joints")
