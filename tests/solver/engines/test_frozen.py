"""Frozen pools: the rows of the whole one, moved to the frozen values."""

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import TargetArrays
from ikde.kernels.seeds import find_cell
from ikde.model.base_motion import NO_BASE
from ikde.model.pack import pack_robot
from ikde.model.target import KINDS
from ikde.solver.engines import frozen
from ikde.solver.engines.frozen import freeze_pool, set_frozen
from ikde.solver.engines.pool import GRIDS, KEPT, sort_pool
from tests.conftest import random_q
from tests.random_robots import random_robot
from tests.uncompiled import plain

ROBOTS = [*map(ikde.load_robot, ("qiao2021", "panda")), *map(random_robot, range(8))]
each_robot = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def make_pools(robot, rng, joints, kind="pose", count=300):
    """Frozen pools of random configurations."""
    seeds = sort_pool(robot, random_q(robot, rng, count), NO_BASE, np.array(GRIDS[kind]), kind=kind)
    return freeze_pool(pack_robot(robot), seeds.q, joints, seeds, KEPT[kind]), seeds


@each_robot
@pytest.mark.parametrize(("size", "kind"), [(1, "pose"), (2, "axis"), (3, "position"), (3, "pose")])
def test_the_tool_stands_where_the_configuration_puts_it(robot, size, kind, rng):
    joints = tuple(sorted(rng.choice(len(robot.joints), min(size, len(robot.joints)), replace=False).tolist()))
    pools, whole = make_pools(robot, rng, joints, kind)
    for values in random_q(robot, rng, 3)[:, list(joints)]:
        seeds = set_frozen(pools, values)
        assert (seeds.q[:, joints] == values).all()
        T_world_tool = ikde.forward(robot, seeds.q)[robot.tool][:, :3].reshape(-1, 12)
        np.testing.assert_allclose(seeds.T_world_tool, T_world_tool[:, KEPT[kind]], rtol=0, atol=1e-13)
        others = np.setdiff1d(np.arange(len(robot.joints)), joints)
        assert {row.tobytes() for row in seeds.q[:, others]} == {row.tobytes() for row in whole.q[:, others]}


@pytest.mark.parametrize("kind", KINDS)
def test_rows_lie_in_the_cells_that_they_are_sorted_into(qiao, kind, rng):
    pools, _ = make_pools(qiao, rng, (4,), kind)
    seeds = set_frozen(pools, np.array([0.3]))
    assert seeds.cell_start[0] == 0
    assert seeds.cell_start[-1] == len(seeds.q)
    assert len(seeds.cell_start) == np.prod(seeds.grid[:, 1]) + 1
    T = ikde.forward(qiao, seeds.q)[qiao.tool][:, :3]
    targets = TargetArrays(np.zeros(len(T), dtype=np.int64), T)
    cells = [plain(find_cell)(seeds, targets, row) for row in range(len(T))]
    assert all(seeds.cell_start[cell] <= row < seeds.cell_start[cell + 1] for row, cell in enumerate(cells))
    assert len(set(cells)) > 5


def test_the_rows_are_those_that_had_nearly_the_value(qiao, rng, monkeypatch):
    monkeypatch.setattr(frozen, "ROWS", 40)
    pools, whole = make_pools(qiao, rng, (5, 4))
    for value in (qiao.lower[5], -0.4, qiao.upper[5]):
        seeds = set_frozen(pools, np.array([value, 0.1]))
        arms = {row[6:].tobytes(): row[5] for row in whole.q}
        taken = np.array([arms[row[6:].tobytes()] for row in seeds.q])
        assert len(taken) == 40
        assert np.sort(np.abs(whole.q[:, 5] - value))[50] >= np.abs(taken - value).max() or value == -0.4
        assert np.abs(taken - value).max() < 2.0


def test_a_large_pool_is_thinned_out_evenly(qiao, rng, monkeypatch):
    monkeypatch.setattr(frozen, "MAX_ROWS", 100)
    pools, whole = make_pools(qiao, rng, (4,))
    assert {row.tobytes() for row in pools.q} == {row.tobytes() for row in whole.q[::4]}


def test_a_value_gives_the_same_bits_whatever_came_before(qiao, rng):
    pools, _ = make_pools(qiao, rng, (3, 6))
    first = set_frozen(pools, np.array([0.1, 0.2]))
    set_frozen(pools, np.array([-1.0, 2.0]))
    again = set_frozen(pools, np.array([0.1, 0.2]))
    assert all(np.asarray(a).tobytes() == np.asarray(b).tobytes() for a, b in zip(first, again, strict=True))
