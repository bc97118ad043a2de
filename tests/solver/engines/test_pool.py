"""Seeds: free, the same for everybody, drawn where the joints may be."""

from contextlib import nullcontext
from dataclasses import replace

import numba
import numpy as np
import pytest

import ikde
from ikde.errors import CacheWarning
from ikde.kernels import analytic, cache_files, cache_folder, lm
from ikde.kernels.seeds import COMPARED, find_cell
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS, Targets
from ikde.solver.engines import pool as module
from ikde.solver.engines import pool_files
from ikde.solver.engines.frozen import ROWS
from ikde.solver.engines.pool import (
    DRAWN,
    MIN_DRAWN,
    PER_CELL,
    digest_pool,
    draw_kept,
    find_base,
    load_kernels,
    make_seeds,
    make_whole_pool,
    pack_pool,
    rotation_length_m,
)
from ikde.solver.problem import pack_searched
from tests.collision_robots import find_gaps
from tests.endless_robot import ENDLESS
from tests.hostile_names import rename
from tests.problems import problem_of
from tests.random_robots import with_ranges
from tests.robot_files import load_text
from tests.solver.engines.questions import make_pool


def test_the_pool_is_free_and_spread_over_tool_poses(qiao):
    seeds = make_pool(qiao)
    assert 10_000 < len(seeds.q) < DRAWN
    assert (seeds.q[:, :3] == 0.0).all()  # the base is set for each target
    assert not any(ikde.check(qiao, q).collision for q in seeds.q[::512])
    assert np.diff(seeds.cell_start).max() == PER_CELL
    assert seeds.cell_start[-1] == len(seeds.q)


@pytest.mark.parametrize(("kind", "asked"), [("position", 3), ("axis", 6), ("pose", 12)])
def test_a_pool_holds_what_its_kind_of_target_asks_of_the_tool_and_no_more(qiao, kind, asked):
    seeds = make_pool(qiao, kind=kind)
    x, y, z, position = np.moveaxis(ikde.forward(qiao, seeds.q)[qiao.tool][:, :3], 2, 0)
    assert seeds.T_world_tool.shape == (len(seeds.q), asked)
    assert np.abs(np.hstack([position, z, x, y])[:, :asked] - seeds.T_world_tool).max() < 1e-12


@pytest.mark.parametrize("name", ["qiao2021", "ur5"])
@pytest.mark.parametrize("kind", KINDS)
def test_every_configuration_lies_in_the_cell_that_it_is_sorted_into(name, kind):
    robot = ikde.load_robot(name)
    seeds = make_pool(robot, kind=kind, freeze={robot.joint_names[-1]: 0.1})
    T_world_tool = ikde.forward(robot, seeds.q)[robot.tool][:, :3].copy()
    targets = Targets.packed(np.zeros(len(seeds.q), dtype=np.int64), T_world_tool)
    for row in range(0, len(seeds.q), 251):
        cell = find_cell(seeds, pack_targets(targets), row)
        assert seeds.cell_start[cell] <= row < seeds.cell_start[cell + 1]


def test_a_frozen_base_has_the_pool_of_a_free_one(qiao):
    """Its joints are set for each target: there is nothing to be drawn for another value."""
    assert make_pool(qiao, freeze={"d_x": 0.3}) is make_pool(qiao)
    assert make_pool(qiao, freeze={"d_x": 0.3, "d_y": -1.0, "q_z": 0.0}) is make_pool(qiao)


def test_a_frozen_arm_has_rows_of_the_whole_pool(qiao):
    seeds = make_pool(qiao, freeze={"d_x": 0.3, "q2": 0.1, "q4": -0.2})
    assert (len(seeds.q), seeds.base.tolist()) == (ROWS, [0, 1, 2])
    assert (seeds.q[:, [4, 6]] == [0.1, -0.2]).all()
    assert (seeds.q[:, :3] == 0.0).all()
    arms = {row.tobytes() for row in make_pool(qiao).q[:, [3, 5, 7, 8]]}
    assert all(row.tobytes() in arms for row in seeds.q[:, [3, 5, 7, 8]])


@pytest.mark.parametrize("name", ["qiao2021", "ur5", "panda"])
def test_few_of_a_frozen_arms_rows_collide(name):
    """They were free at nearly the same value."""
    robot = ikde.load_robot(name)
    detector = CollisionModel.of(robot).detector
    arm = range(3, len(robot.joints)) if name == "qiao2021" else range(len(robot.joints))
    for k in arm:
        seeds = make_pool(robot, freeze={robot.joint_names[k]: robot.home[k] + 0.1})
        collides = (find_gaps(robot, detector, seeds.q) <= detector.safe_distance_m).any(axis=1)
        assert collides.mean() < 0.15


def test_a_joint_that_never_moves_is_not_frozen(qiao):
    robot = with_ranges(qiao, {"q2": (0.5, 0.5)})
    assert make_pool(robot) is make_pool(robot, freeze={"q2": 0.5})


def test_other_ranges_have_a_pool_of_their_own(qiao):
    problem = problem_of(qiao)
    lower, upper = problem.lower, problem.upper
    lower[4], upper[5] = -0.5, 0.25
    for wide in (lower, lower - [0, 0, 0, 0, 0, 0, 0, 0, 2.0]):
        seeds = make_seeds(problem.with_ranges(wide, upper), "pose")
        assert ((wide <= seeds.q) & (seeds.q <= upper)).all()
        assert seeds.q[:, 4].min() < -0.4
        assert seeds.q[:, 5].max() > 0.15
        assert (seeds.q[:, 8].min() < qiao.lower[8]) == (wide[8] < qiao.lower[8])


def test_fewer_are_drawn_of_a_robot_with_many_spheres(qiao, monkeypatch):
    collision = CollisionModel.of(qiao)  # 383 pairs of spheres
    assert make_whole_pool(collision, "pose").wanted == DRAWN
    monkeypatch.setattr(module, "MANY_PAIRS", 100)
    assert make_whole_pool(collision, "pose").wanted == int(DRAWN * 100 / 383)
    monkeypatch.setattr(module, "MANY_PAIRS", 1)
    assert make_whole_pool(collision, "pose").wanted == MIN_DRAWN
    assert make_whole_pool(CollisionModel.of(qiao, "none"), "pose").wanted == DRAWN


def test_a_joint_without_limits_is_drawn_once_around_home():
    robot = load_text(ENDLESS)
    drawn = make_pool(robot).q - robot.home
    for joint in (0, 5):
        assert np.abs(drawn[:, joint]).max() <= np.pi
        assert np.histogram(drawn[:, joint], bins=8, range=(-np.pi, np.pi))[0].min() > 0.08 * len(drawn)


def test_near_needs_no_pool(qiao):
    seeds = make_pool(qiao, near=qiao.home)
    assert len(seeds.q) == 0
    assert seeds.first_box < 1.0


def test_a_base_is_one_that_drives_turns_has_room_and_carries_all(qiao):
    lower, upper = qiao.lower, qiao.upper
    assert find_base(qiao, lower, upper).tolist() == [0, 1, 2]
    narrow = upper.copy()
    narrow[0] = lower[0] + 0.1
    assert find_base(qiao, lower, narrow).tolist() == [-1, -1, -1]
    half = upper.copy()
    half[2] = 0.0
    assert find_base(qiao, lower, half).tolist() == [-1, -1, -1]
    ur5 = ikde.load_robot("ur5")
    assert find_base(ur5, ur5.lower, ur5.upper).tolist() == [-1, -1, -1]


def test_a_radian_counts_as_a_part_of_the_arm(any_robot):
    assert 0.05 < rotation_length_m(any_robot) < 1.0


def digest(robot, kind, **changes):
    """Of the pool within the limits."""
    collision = CollisionModel.of(robot, **changes)
    return digest_pool(make_whole_pool(collision, kind), collision)


def test_pools_of_other_detectors_are_others(qiao):
    detector = CollisionModel.of(qiao).detector
    wider = replace(detector, safe_distance_m=detector.safe_distance_m + 1e-3)
    names = {digest(qiao, kind, choice=each) for each in ("none", detector, wider) for kind in KINDS}
    assert len(names) == 9


def test_pools_of_other_ranges_are_others(qiao):
    arm, base = (with_ranges(qiao, {name: (-1.0, 1.25)}) for name in ("q1", "d_x"))
    assert digest(arm, "pose") != digest(qiao, "pose")
    assert digest(base, "pose") == digest(qiao, "pose")  # the base is at zero in either


def test_kinds_that_share_a_grid_share_a_pool():
    ur5 = ikde.load_robot("ur5")
    assert digest(ur5, "axis") == digest(ur5, "pose") != digest(ur5, "position")


def test_wheels_leave_the_pool_alone(qiao, unwheeled):
    assert digest(unwheeled, "axis") == digest(qiao, "axis")


def test_no_name_is_part_of_a_pool(qiao):
    assert digest(rename(qiao, "other {}".format), "axis") == digest(qiao, "axis")


def test_the_last_digits_of_a_product_do_not_make_another_pool(qiao, monkeypatch):
    """Products of matrices differ from machine to machine."""
    collision = CollisionModel.of(qiao)
    pool = make_whole_pool(collision, "pose")
    names = set()
    for shift in (0.0, 1e-16, 1e-9):
        robot, searched = pack_searched(collision)
        moved = robot._replace(T_parent_body=robot.T_parent_body + shift), searched
        monkeypatch.setattr(module, "pack_searched", lambda _, moved=moved: moved)
        names.add(digest_pool(pool, collision))
        monkeypatch.undo()
    assert len(names) == 2


def test_other_code_draws_other_pools(qiao, monkeypatch):
    before = digest(qiao, "pose")
    monkeypatch.setattr(module, "_own_source", lambda: b"other code")
    assert digest(qiao, "pose") != before


def test_a_robot_has_one_pool_however_it_comes_by_it(monkeypatch, tmp_path):
    """With ikde; drawn and kept, loaded, drawn again for what was damaged; and drawn where nothing is kept."""
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(cache_files, "WARNED", set())
    robot, drawn = ikde.load_robot("ur5"), []
    monkeypatch.setattr(module, "draw_kept", lambda *pool: drawn.append(pool) or draw_kept(*pool))
    bits = [bits_of(robot)]
    assert not drawn
    monkeypatch.setattr(pool_files, "SHIPPED", tmp_path)
    for usable, damaged in ((True, False), (True, False), (True, True), (False, False)):
        monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", usable)
        for path in tmp_path.rglob("*.pool") if damaged else ():
            path.write_text("somebody else's")
        with pytest.warns(CacheWarning) if damaged else nullcontext():
            bits.append(bits_of(robot))
    assert len(set(bits)) == 1
    assert len(drawn) == 3
    assert [path.suffix for path in (tmp_path / cache_folder.ROBOTS).iterdir()] == [".pool"]


def test_kernels_of_tables_start_from_the_same_pool(monkeypatch):
    robot, bits = ikde.load_robot("ur5"), set()
    for kind in ("tables", "written"):
        monkeypatch.setenv("IKDE_KERNELS", kind)
        bits.add(bits_of(robot))
    assert len(bits) == 1


def bits_of(robot):
    """Of a pool that this process has not seen yet."""
    module.find_whole.cache_clear()
    seeds = make_pool(robot, "position")
    module.find_whole.cache_clear()
    return b"".join(np.asarray(field).tobytes() for field in seeds)


def test_a_robot_that_is_hardly_ever_free_has_no_pool(qiao, monkeypatch):
    monkeypatch.setattr(module, "_draw_free", lambda *_: np.arange(COMPARED - 1))
    pool = make_whole_pool(CollisionModel.of(qiao), "pose")
    kept = draw_kept(pool, CollisionModel.of(qiao))
    assert len(kept.numbers) == 0
    seeds = pack_pool(pool, kept)
    assert (len(seeds.q), seeds.base.tolist(), seeds.first_box) == (0, [-1, -1, -1], 1.0)


def test_without_a_cache_kernels_are_written_all_the_same(monkeypatch):
    monkeypatch.delenv("IKDE_KERNELS")
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", False)
    robot = ikde.load_robot("qiao2021_dh")
    kernels = load_kernels(CollisionModel.of(robot, "none"), "position")
    assert kernels.__name__.startswith("ikde_kernels_")


def test_tables_take_the_place_of_modules_if_asked(qiao, monkeypatch):
    monkeypatch.setenv("IKDE_KERNELS", "tables")
    kernels = load_kernels(CollisionModel.of(qiao), "pose")
    assert (kernels.solve_target, kernels.solve_branches) == (lm.solve_target, analytic.solve_branches)


# ---- as kernels take them


def test_kernels_take_all_seeds_alike(qiao):
    """Near something, frozen, or none of either: one type, one compilation."""
    every = [make_pool(qiao), make_pool(qiao, near=qiao.home), make_pool(qiao, freeze={"q1": 0.1})]
    assert len({numba.typeof(seeds) for seeds in every}) == 1
    for seeds in every:
        arrays = [field for field in seeds if isinstance(field, np.ndarray)]
        assert len(arrays) == 6
        assert not any(array.flags.writeable for array in arrays)
