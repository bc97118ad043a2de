"""Formula 23 by both models."""

import numpy as np
import pytest

import ikde
from ikde.paper.kinematics import show_kinematics
from ikde.report.page import Cell, Gallery, Table
from tests.paper.conftest import is_plain


@pytest.fixture(scope="module")
def section(results):
    return results.sections["kinematics"]


def test_all_but_one_coordinate_agree_to_the_rounding(section):
    rounding = section.settings["rounding_mm"]
    for point in section.points:
        assert max(point.difference_to_meant_mm.values()) < rounding
        assert (max(point.difference_mm.values()) > rounding) == (point.misprint is not None)
    assert sum(point.misprint is not None for point in section.points) == 1


def test_positions_of_the_first_points_follow_from_the_lengths(section):
    points = [point.ours_mm["key_point"] for point in section.points[:3]]
    np.testing.assert_allclose(points, [[540, 0, 480 + 89.2], [540, 0, 994.2], [540, 0, 1386.45]], atol=1e-9)


def test_both_models_are_one_arm(section):
    assert section.models_differ_mm < 1e-9


def test_figures_name_frames_of_their_robot(section, inputs):
    assert is_plain(section)
    for figure, robot in zip(section.figures, (inputs.robot, inputs.classical), strict=True):
        assert figure.robot == robot.name
        assert set(figure.frames) <= set(ikde.forward(robot, figure.q))
        np.testing.assert_allclose(figure.q, robot.home)


def test_every_point_stands_beside_both_models(section, inputs):
    table = next(block for block in show_kinematics(section, inputs).blocks if isinstance(block, Table))
    assert [row[1] for row in table.rows] == ["O1", "Oc23", "O3", "O4", "O5", "O6"]
    assert table.rows[0][2:5] == ("540.0, 0.0, 569.2", "540.00, 0.00, 569.20", "540.00, 0.00, 569.20")
    assert table.rows[5][5] == Cell("7.000", "off")
    assert "point 6 is printed 711.5, 0.0, 1,488.1, meant 711.5, 0.0, 1,481.1" in table.note


def test_both_models_are_drawn(section, inputs):
    gallery = next(block for block in show_kinematics(section, inputs).blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 2
    assert all(figure.image.startswith(b"\x89PNG") for figure in gallery.figures)
