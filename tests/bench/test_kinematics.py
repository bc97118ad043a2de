"""Formula 23 by both models."""

import numpy as np
import pytest

import ikde
from ikde.bench.kinematics import compute_kinematics
from tests.bench.conftest import is_plain


@pytest.fixture(scope="module")
def section(qiao, classical, published):
    return compute_kinematics({"key_point": qiao, "classical": classical}, published)


def test_all_but_one_coordinate_agree_to_the_rounding(section):
    rounding = section["settings"]["rounding_mm"]
    for point in section["exact"]["points"]:
        assert max(point["difference_to_meant_mm"].values()) < rounding
        assert (max(point["difference_mm"].values()) > rounding) == (point["misprint"] is not None)
    assert sum(point["misprint"] is not None for point in section["exact"]["points"]) == 1


def test_positions_of_the_first_points_follow_from_the_lengths(section):
    points = [point["ours_mm"]["key_point"] for point in section["exact"]["points"][:3]]
    np.testing.assert_allclose(points, [[540, 0, 480 + 89.2], [540, 0, 994.2], [540, 0, 1386.45]], atol=1e-9)


def test_both_models_are_one_arm(section):
    assert section["exact"]["models_differ_mm"] < 1e-9


def test_figures_name_frames_of_their_robot(section, qiao, classical):
    assert is_plain(section)
    for figure, robot in zip(section["exact"]["figures"], (qiao, classical), strict=True):
        assert figure["robot"] == robot.name
        assert set(figure["frames"]) <= set(ikde.forward(robot, figure["q"]))
        np.testing.assert_allclose(figure["q"], robot.home)
