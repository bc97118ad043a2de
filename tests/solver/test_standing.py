"""What touches an obstacle whatever the joints do is refused, with the line that allows it."""

import re

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver.plain import compute_components
from ikde.solver.standing import find_standing_obstacles
from tests.three_joints import ROBOT

OWN, TARGET = CollisionModel.of(ROBOT), ikde.Target((0.3, 0.2, 0.4))


def shifted(z_m):
    T = np.eye(4)
    T[2, 3] = z_m
    return T


def test_what_always_touches_is_refused_with_the_line_to_write():
    sea = make_obstacle("sea", [make_solid("half_space")], shifted(5.0))
    model = OWN.in_world(make_world([sea]))
    touching = [pair.component for pair in find_standing_obstacles(model) if pair.touches]
    assert {"floor", "post"} <= set(touching)
    line = re.escape(f"`ignore: [{', '.join(touching)}]`")
    for ask in (lambda: ikde.solve(ROBOT, TARGET, collision=model), lambda: ikde.check(ROBOT, ROBOT.home, model)):
        with pytest.raises(InputError, match=rf"^world\.sea: .* mm from sea in every configuration.* {line} there$"):
            ask()
    free = OWN.in_world(make_world([make_obstacle("sea", sea.solids, shifted(5.0), ignore=touching)]))
    assert not any(pair.touches for pair in find_standing_obstacles(free))


def test_what_no_joint_moves_is_left_to_that_and_not_compared():
    model = OWN.in_world(make_world([make_obstacle("ball", [make_solid("sphere", (0.1,))], shifted(2.0))]))
    assert "floor" in model.fixed_components
    checked = ikde.check_many(ROBOT, ROBOT.home[None], model)
    assert np.isinf(checked.gaps_m[0, checked.pairs.index(("floor", "ball"))])


def test_what_stands_near_is_found_among_solids_and_clouds(rng):
    post = "post"
    centres, radii = compute_components(OWN, ROBOT.home)[post]
    beside = centres[0] + (radii[0] + 0.012, 0.0, 0.0)
    far = rng.uniform(3.0, 4.0, (500, 3))
    cloud = make_solid("cloud", (0.002,), points=[*far, beside])
    for solid in (make_solid("sphere", (0.002,), np.c_[np.eye(3), beside]), cloud):
        world = make_world([make_obstacle("near", [make_solid("sphere", (0.1,), np.c_[np.eye(3), far[0]]), solid])])
        found = {pair.component: pair for pair in find_standing_obstacles(OWN.in_world(world))}
        assert found[post].clearance_m == pytest.approx(0.01, abs=1e-9)
        assert not found[post].touches
        near = find_standing_obstacles(OWN.in_world(world, margins_m={post: 0.011}))
        assert post in [pair.component for pair in near if pair.touches]
        away = world.move("near", shifted(1.0))
        assert post not in {pair.component for pair in find_standing_obstacles(OWN.in_world(away))}


BLOCK = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
TALL = {  # solids that reach up to z = 1
    "sphere": ((1.0,), None),
    "box": ((2.0, 2.0, 2.0), None),
    "cylinder": ((1.0, 2.0), None),
    "capsule": ((0.5, 1.0), None),
    "cone": ((1.0, 2.0), None),
    "hull": ((), BLOCK),
    "cloud": ((0.5,), [[0.0, 0.0, 0.5], [0.0, 0.0, -9.0]]),
}


@pytest.mark.parametrize("kind", TALL)
def test_what_stands_on_a_large_solid_is_found(kind):
    size, points = TALL[kind]
    world = make_world([make_obstacle("block", [make_solid(kind, size, points=points)], shifted(-1.21))])
    found = {pair.component: pair.clearance_m for pair in find_standing_obstacles(OWN.in_world(world))}
    assert found["floor"] == pytest.approx(0.01, abs=1e-9)


def test_an_obstacle_that_keeps_off_farther_than_it_ever_is_is_refused_by_its_own_line():
    ball = make_solid("sphere", (0.1,))
    wide = make_obstacle("wide", [ball], shifted(-0.35), margin_m=0.051)
    model = OWN.in_world(make_world([wide, make_obstacle("sea", [make_solid("half_space")], shifted(5.0))]))
    assert ("floor", "wide") in [(p.component, p.obstacle) for p in find_standing_obstacles(model) if p.touches]
    with pytest.raises(InputError, match=r"^world\.wide: floor is 50 mm from wide .* `ignore: \[floor\]` there"):
        ikde.check(ROBOT, ROBOT.home, model)
    kept = OWN.in_world(make_world([make_obstacle("wide", [ball], shifted(-0.35), margin_m=0.049)]))
    assert not any(pair.touches for pair in find_standing_obstacles(kept))
