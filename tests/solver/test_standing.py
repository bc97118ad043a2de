"""What touches an obstacle whatever the joints do is refused, with the line that allows it."""

import re

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
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
