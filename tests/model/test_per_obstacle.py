"""What is made of an obstacle is made once, and anew only of what has changed."""

import numpy as np

from ikde.model.per_obstacle import FEW, PerObstacle, find_changed
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world

BALL = make_solid("sphere", [0.1])


def test_what_is_made_of_each_obstacle_is_made_once():
    made = []
    kept = PerObstacle(lambda obstacle: made.append(obstacle.name) or obstacle.name.upper())
    world = make_world([make_obstacle(name, [BALL]) for name in "abc"])
    moved = world.move("b", np.eye(4))
    for obstacles, new in (
        (world.active, ["a", "b", "c"]),
        (world.active, []),
        (moved.active, ["b"]),
        (moved.remove("a").active, []),
        (moved.remove("a").add(make_obstacle("d", [BALL])).active, ["d"]),
        ((), []),
        (moved.active, ["a", "b", "c"]),
    ):
        made.clear()
        assert kept.list(obstacles) == [obstacle.name.upper() for obstacle in obstacles]
        assert made == new


def test_what_is_made_stays_right_however_obstacles_are_moved_and_ordered():
    """Of a few that are others, of many, and of as many that stand elsewhere in the order."""
    first = [make_obstacle(f"o{k}", [BALL]) for k in range(2 * FEW)]
    kept = PerObstacle(lambda obstacle: obstacle.name)
    before, other = tuple(first), make_obstacle("other", [make_solid("box", [0.1, 0.2, 0.3])])
    for obstacles in (before, (other, *first[1:]), before[::-1], (*first[1:], first[0]), (other,)):
        assert kept.list(obstacles) == [obstacle.name for obstacle in obstacles]
    assert find_changed(before, (other, *first[1:])) == [0]
    assert find_changed(before, (other,)) is None
