"""Seeds: free, the same for everybody, drawn where the joints may be."""

import os
from dataclasses import replace

import numba
import numpy as np
import pytest

import ikde
from ikde.errors import CacheWarning
from ikde.kernels import analytic, cache_files, cache_folder, lm
from ikde.kernels.seeds import find_cell
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS, Targets
from ikde.solver.engines import pool as module
from ikde.solver.engines.pool import (
    DRAWN,
    PER_CELL,
    digest_pool,
    find_base,
    load_kernels,
    load_pool,
    rotation_length_m,
    save_pool,
)
from tests.hostile_names import rename
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


def test_frozen_joints_stay_and_the_base_then_helps_no_more(qiao):
    seeds = make_pool(qiao, freeze={"d_x": 0.3, "q2": 0.1})
    assert (seeds.q[:, 0] == 0.3).all()
    assert (seeds.q[:, 4] == 0.1).all()
    assert seeds.base.tolist() == [-1, -1, -1]


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


def test_pools_of_other_detectors_are_others(qiao):
    detector = CollisionModel.of(qiao).detector
    wider = replace(detector, safe_distance_m=detector.safe_distance_m + 1e-3)
    names = {
        digest_pool(CollisionModel(robot=qiao, detector=each), kind)
        for each in (None, detector, wider)
        for kind in KINDS
    }
    assert len(names) == 9


def test_wheels_leave_the_pool_alone(qiao, unwheeled):
    detector = CollisionModel.of(qiao).detector
    assert digest_pool(CollisionModel(robot=unwheeled, detector=detector), "axis") == digest_pool(
        CollisionModel(robot=qiao, detector=detector), "axis"
    )


def test_no_name_is_part_of_a_pool(qiao):
    other = rename(qiao, "other {}".format)
    assert len({digest_pool(CollisionModel.of(robot), "axis") for robot in (qiao, other)}) == 1


def test_a_robot_has_one_pool_with_a_cache_and_without(monkeypatch, tmp_path):
    """Drawn and kept, loaded, and drawn where nothing is kept."""
    monkeypatch.delenv("IKDE_KERNELS")
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path)
    load_kernels = "ikde.solver.engines.pool.load_kernels"  # those of tables are compiled already
    robot = ikde.load_robot("ur5")
    with monkeypatch.context() as tables:
        tables.setenv("IKDE_KERNELS", "tables")
        ready = module.load_kernels(CollisionModel.of(robot), "position")
    monkeypatch.setattr(load_kernels, lambda *_: ready)
    bits = []
    for usable in (True, True, False):
        monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", usable)
        for path in () if usable else tmp_path.rglob("*.pool"):
            path.write_text("somebody else's")
        module._find_pool.cache_clear()
        bits.append([np.asarray(field).tobytes() for field in make_pool(robot, "position")])
    module._find_pool.cache_clear()
    assert bits[0] == bits[1] == bits[2]
    assert [path.suffix for path in (tmp_path / cache_folder.ROBOTS).iterdir()] == [".pool"]


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


# ---- on disk: what was saved comes back bit for bit, and what is damaged is drawn again


def test_kernels_take_all_seeds_alike(qiao, tmp_path):
    """Drawn, loaded, near something or frozen: one type, one compilation."""
    save_pool(tmp_path / "pool.npz", make_pool(qiao))
    every = [
        make_pool(qiao),
        load_pool(tmp_path / "pool.npz"),
        make_pool(qiao, near=qiao.home),
        make_pool(qiao, freeze={"q1": 0.1}),
    ]
    assert len({numba.typeof(seeds) for seeds in every}) == 1


def test_what_was_saved_comes_back(qiao, tmp_path):
    seeds = make_pool(qiao)
    save_pool(tmp_path / "pool.npz", seeds)
    loaded = load_pool(tmp_path / "pool.npz")
    for ours, theirs in zip(seeds, loaded, strict=True):
        assert type(ours) is type(theirs)
        assert np.asarray(ours).tobytes() == np.asarray(theirs).tobytes()
        assert not isinstance(theirs, np.ndarray) or not theirs.flags.writeable


@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
def test_a_file_that_was_cut_is_none(qiao, tmp_path, share, monkeypatch):
    monkeypatch.setattr(cache_files, "WARNED", set())
    path = tmp_path / "pool.npz"
    save_pool(path, make_pool(qiao))
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.warns(CacheWarning, match="is damaged"):
        assert load_pool(path) is None


def test_a_full_disk_is_no_error(qiao, tmp_path, monkeypatch):
    def fail(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cache_files, "WARNED", set())
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.warns(CacheWarning, match="No space left on device"):
        save_pool(tmp_path / "pool.npz", make_pool(qiao))
    assert list(tmp_path.iterdir()) == []


def test_no_file_is_none(tmp_path):
    assert load_pool(tmp_path / "pool.npz") is None
