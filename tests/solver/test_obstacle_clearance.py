"""The room to every obstacle, and the one with the least beyond what is asked for."""

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.report.numbers import Units
from ikde.report.solve import format_solve, solve_json
from ikde.solver.obstacle_clearance import find_nearest_obstacle, list_obstacles
from ikde.solver.plain import compute_gaps


@pytest.fixture
def among_walls(qiao):
    """The nearer wall asks for nothing; the farther for so much that less is left beyond it."""
    walls = {
        "near": {"box": [0.2, 8, 3], "position": [2.5, 0, 1]},
        "far": {"box": [0.2, 8, 3], "position": [-3.0, 0, 1], "margin": 1.5},
    }
    return CollisionModel.of(qiao).in_world(ikde.load_world({"obstacles": walls}))


def test_what_is_asked_for_decides_which_is_nearest(qiao, among_walls):
    gaps_m = compute_gaps(among_walls, np.array(qiao.home))
    first, second = list_obstacles(among_walls, gaps_m)
    assert (first.obstacle, second.obstacle) == ("far", "near")
    assert first.clearance_m > second.clearance_m
    assert first.clearance_m - first.margin_m < second.clearance_m - second.margin_m
    assert find_nearest_obstacle(among_walls, gaps_m) == first
    assert (first.margin_m, second.margin_m, first.collides) == (1.5, 0.0, False)


def test_without_a_world_there_is_none(qiao):
    model = CollisionModel.of(qiao)
    gaps_m = compute_gaps(model, np.array(qiao.home))
    assert find_nearest_obstacle(model, gaps_m) is None
    assert list_obstacles(model, gaps_m) == ()


def test_what_ignores_the_whole_robot_is_none(qiao):
    model = CollisionModel.of(qiao)
    ball = {"sphere": {"radius": 0.1}, "position": [3, 0, 1], "ignore": list(model.components)}
    model = model.in_world(ikde.load_world({"obstacles": {"ball": ball}}))
    gaps_m = compute_gaps(model, np.array(qiao.home))
    assert find_nearest_obstacle(model, gaps_m) is None
    assert list_obstacles(model, gaps_m) == ()


def test_a_result_names_it(qiao, among_walls):
    result = ikde.solve(qiao, (0.6, 0.2, 1.0), collision=among_walls)
    seen = ikde.check(qiao, result.q, among_walls).obstacles[0]
    assert result.grade.nearest_obstacle == seen
    assert solve_json(qiao, result)["nearest_obstacle"]["obstacle"] == seen.obstacle
    text = " ".join(format_solve(qiao, result, Units(), width=160).split())
    asked = f", {seen.margin_m:.6g} m asked for" if seen.margin_m else ""
    nearest = f"nearest {seen.component} - {seen.obstacle}: {seen.clearance_m:.6g} m{asked}"
    assert f"world free of 2 obstacles, {nearest}" in text
