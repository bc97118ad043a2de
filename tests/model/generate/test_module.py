"""Modules: the same text for the same robot under a name of its own, whole in the cache, whoever writes it first."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numba
import numpy as np
import pytest

import ikde
from ikde.kernels import jit
from ikde.model.generate import assemble, module
from ikde.model.robot import Detector
from ikde.model.target import KINDS
from tests.collision_robots import find_gaps
from tests.random_robots import make_frame, make_robot, random_robot

ROOT = Path(__file__).parents[3]
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


def tiny_robot():
    """One joint, whose tool can touch a post."""
    points = [make_frame("post", "world", (0.5, 0.0, 0.2)), make_frame("tool", "arm", (0.5, 0, 0))]
    frames = [make_frame("arm", "world", (0, 0, 0.2), joint="turn", axis=(0, 0, 1)), *points]
    row = ikde.model.robot.SphereRow
    rows = tuple(row(component=name, start=name, end=name, radius_m=0.1) for name in ("post", "tool"))
    return make_robot(
        {"turn": "revolute"},
        frames,
        lower=-2.0,
        upper=2.0,
        approximations={"spheres": rows},
        pair_lists={"some": (("post", "tool"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
    )


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    """Modules and their machine code go into a folder of the test's own."""
    monkeypatch.setattr(jit, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(jit, "CACHE_IS_WRITABLE", True)
    module.load_module.cache_clear()
    yield tmp_path
    module.load_module.cache_clear()


# ---- the name


def variants(robot):
    """Robots that differ in one thing, and detectors that see other things."""
    detector = robot.detector(None)
    first, joint, frame = robot.approximations[detector.spheres][0], robot.joints[0], robot.frames[-1]
    larger = (replace(first, radius_m=first.radius_m + 1e-12), *robot.approximations[detector.spheres][1:])
    moved = replace(frame, p_parent_frame=frame.p_parent_frame + np.array([0, 0, 1e-12]))
    fewer = {**robot.pair_lists, detector.pairs: robot.pair_lists[detector.pairs][1:]}
    yield robot, detector
    yield replace(robot, joints=(replace(joint, upper=joint.upper - 1e-9), *robot.joints[1:])), detector
    yield replace(robot, frames=(*robot.frames[:-1], moved)), detector
    approximations = {**robot.approximations, detector.spheres: larger}
    yield replace(robot, approximations=MappingProxyType(approximations)), detector
    yield replace(robot, pair_lists=MappingProxyType(fewer)), detector
    yield replace(robot, name="another"), detector
    yield robot, replace(detector, safe_distance_m=0.05)
    yield robot, replace(detector, safe_distance_m=0.5)
    yield robot, replace(detector, safe_distance_m=5.0)
    yield robot, None


def test_wheels_are_no_part_of_it(qiao, unwheeled):
    detector = qiao.detector(None)
    for kind in KINDS:
        assert module.module_name(unwheeled, detector, kind) == module.module_name(qiao, detector, kind)
        assert assemble.format_module(unwheeled, detector, kind) == assemble.format_module(qiao, detector, kind)


@pytest.mark.parametrize("robot", [ikde.load_robot("qiao2021"), random_robot(3)], ids=lambda robot: robot.name)
def test_what_differs_has_a_name_of_its_own(robot):
    names = [module.module_name(*case, kind) for case in variants(robot) for kind in KINDS]
    assert len(set(names)) == len(names)
    assert all(name.isidentifier() for name in names)


def test_a_safe_distance_within_the_margin_changes_nothing(qiao):
    detectors = [replace(qiao.detector(None), safe_distance_m=d) for d in (0.0, 0.003, 0.00999)]
    assert len({module.module_name(qiao, detector, "pose") for detector in detectors}) == 1
    assert len({assemble.format_module(qiao, detector, "pose") for detector in detectors}) == 1


def test_beyond_the_last_margin_nothing_is_proved(qiao):
    far = replace(qiao.detector(None), safe_distance_m=3.0)
    head = assemble.format_module(qiao, far, "position").split('"""')[1]
    assert "\n0 proved never to fail" in head


def test_a_name_can_be_read(qiao):
    assert module.module_name(qiao, qiao.detector(None), "axis").startswith("qiao2021_improved_axis_")
    assert module.module_name(qiao, None, "axis").startswith("qiao2021_none_axis_")
    odd = replace(qiao, name="my robot/2.0 (new)")
    assert "/" not in module.module_name(odd, None, "pose")


# ---- the cache


def test_a_module_is_written_once_and_imported_from_the_cache(empty_cache):
    robot = tiny_robot()
    made = module.load_module(robot, robot.detector(None), "position")
    path = Path(made.__file__)
    assert path.parent == empty_cache / "robots"
    assert path.read_text(encoding="utf-8") == assemble.format_module(robot, robot.detector(None), "position")
    before = path.stat()
    assert module.load_module(robot, robot.detector(None), "position") is made
    again = tiny_robot()
    module.load_module(again, again.detector(None), "position")
    assert (path.stat().st_ino, path.stat().st_mtime) == (before.st_ino, before.st_mtime)
    assert [file.suffix for file in path.parent.iterdir() if file.is_file()] == [".py"]


def test_a_file_that_is_written_again_is_as_old_as_before(empty_cache):
    path = empty_cache / "robots" / "some.py"
    stamps = []
    for _ in range(2):
        module.write_whole(path, b"ONE = 1\n")
        stamps.append((path.stat().st_mtime, path.stat().st_size))
    assert stamps[0] == stamps[1]


def test_where_nothing_can_be_written_a_module_has_no_file(empty_cache, monkeypatch):
    monkeypatch.setattr(jit, "CACHE_IS_WRITABLE", False)
    robot = tiny_robot()
    name = module.module_name(robot, robot.detector(None), "position")
    folder = empty_cache / "robots"
    folder.mkdir()
    (folder / f"{name}.py").write_text("raise RuntimeError('run by mistake')\n")  # whose it is, nobody knows
    made = module.load_module(robot, robot.detector(None), "position")
    find = getattr(made.find_collision, "py_func", made.find_collision)
    assert callable(find)
    assert len(list(folder.iterdir())) == 1


SCRIPT = """
import json, pathlib, sys, time
from ikde.kernels.jit import compile_clock
from ikde.model.generate.module import load_module
from tests.model.generate.test_module import tiny_robot
import numpy as np
robot = tiny_robot()
while not pathlib.Path(sys.argv[1]).exists():
    time.sleep(0.01)
with compile_clock() as clock:
    module = load_module(robot, robot.detector(None), "position")
    q = np.linspace(-2.0, 2.0, 9)
    found = [int(module.find_collision(0, 0.0, q[k : k + 1], 0)) for k in range(9)]
print(json.dumps({"found": found, "seconds": clock.seconds, "file": module.__file__}))
"""


@needs_compiler
def test_two_processes_may_start_at_once_and_a_third_compiles_nothing(tmp_path):
    cache, go = tmp_path / "cache", tmp_path / "go"
    environment = {**os.environ, "IKDE_CACHE_DIR": str(cache)}
    options = {"cwd": ROOT, "env": environment, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [sys.executable, "-W", "error", "-c", SCRIPT, str(go)]
    both = [subprocess.Popen(command, **options) for _ in range(2)]
    go.write_text("go")
    outputs = [process.communicate(timeout=300) for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    third = subprocess.run(command, **options, timeout=300, check=False)
    assert third.returncode == 0, third.stderr
    answers = [json.loads(out) for out in (*(out for out, _ in outputs), third.stdout)]
    robot = tiny_robot()
    gaps = find_gaps(robot, robot.detector(None), np.linspace(-2.0, 2.0, 9)[:, None])
    expected = np.where(gaps[:, 0] <= 0.0, 0, -1).tolist()
    assert [answer["found"] for answer in answers] == [expected] * 3
    assert {0, -1} == set(expected)
    assert len({answer["file"] for answer in answers}) == 1
    assert answers[2]["seconds"] == 0.0
