"""The graders' distances from solids, against those of the search and of plain numpy: three texts, one number."""

import numpy as np
import pytest

from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.obstacles import solid_gap
from ikde.kernels.world_grades import grade_solid
from ikde.model.pack_world import pack_world
from ikde.model.robot import WORLD
from ikde.model.solids import KINDS
from ikde.model.world import make_obstacle, make_world
from ikde.solver.plain_world import measure_obstacle
from tests.solids import random_pose, random_solid


@pytest.mark.parametrize("kind", KINDS)
def test_three_texts_give_one_distance(kind, rng):
    for _ in range(4):
        obstacle = make_obstacle("it", [random_solid(kind, rng, random_pose(rng, 0.2))], random_pose(rng))
        arrays = unpack_world.plain(pack_world(make_world([obstacle]), ["hand"], {WORLD: np.eye(4)}, 0.5, np.zeros(1)))
        P = obstacle.T_world_obstacle[:, 3] + rng.uniform(-0.6, 0.6, (40, 3))
        for p, exact in zip(P, measure_obstacle(obstacle, P), strict=True):
            with np.errstate(all="ignore"):
                found = grade_solid.plain(arrays, 0, *p.tolist(), np.inf)
                assert abs(found - solid_gap.plain(arrays, 0, *p.tolist(), np.inf, -np.inf)) < 1e-12
                assert abs(found - exact) < 1e-12
                assert abs(grade_solid.plain(arrays, 0, *p.tolist(), exact + 1e-9) - exact) < 1e-12
                assert grade_solid.plain(arrays, 0, *p.tolist(), exact - 1e-9) > exact - 1e-9
