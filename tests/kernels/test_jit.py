"""The cache follows the kernels' source, the clock counts compilation only, and nothing compiles twice."""

import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import ikde
from ikde.kernels import jit

ROOT = Path(__file__).parents[2]
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


@pytest.fixture
def copied_kernels(tmp_path, monkeypatch):
    """A copy of the kernels that `cache_folder` takes for its own."""
    folder = tmp_path / "kernels"
    shutil.copytree(Path(jit.__file__).parent, folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(jit, "__file__", str(folder / "jit.py"))
    return folder


def test_the_cache_folder_follows_the_source_and_nothing_else(copied_kernels):
    before = jit.cache_folder()
    assert before == jit.CACHE_FOLDER
    (copied_kernels / "trig.py").write_text((copied_kernels / "trig.py").read_text() + "\n# changed\n")
    assert jit.cache_folder() != before
    assert jit.cache_folder().parent == before.parent


def test_a_new_kernel_file_changes_the_cache_folder(copied_kernels):
    before = jit.cache_folder()
    (copied_kernels / "zeta.py").write_text("ONE = 1\n")
    assert jit.cache_folder() != before


def test_the_cache_folder_can_be_chosen(monkeypatch, tmp_path):
    monkeypatch.setenv("IKDE_CACHE_DIR", str(tmp_path))
    assert jit.cache_folder().parent == tmp_path
    monkeypatch.delenv("IKDE_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert jit.cache_folder().parent == tmp_path / "ikde"


def test_a_folder_that_cannot_be_made_is_not_writable(tmp_path):
    (tmp_path / "file").write_text("in the way")
    assert not jit._is_writable(tmp_path / "file" / "cache")
    assert jit._is_writable(tmp_path / "new" / "cache")


def test_decorating_leaves_numbas_own_cache_folder_alone():
    before = numba.config.CACHE_DIR
    jit.kernel(lambda x: x)
    jit.inline_kernel(lambda x: x)
    assert before == numba.config.CACHE_DIR


@needs_compiler
def test_the_clock_counts_and_announces_a_compilation_once():
    announced = []
    with jit.compile_clock(lambda: announced.append("compiling")) as clock:
        double, triple = (numba.njit(lambda x, n=n: n * x) for n in (2.0, 3.0))
        assert (double(1.0), triple(1.0)) == (2.0, 3.0)
    assert clock.seconds > 0.0
    assert announced == ["compiling"]


@needs_compiler
def test_the_clock_stands_still_when_nothing_compiles(qiao):
    target, settings = ikde.Target([0.8, 0.5, 1.0]), ikde.SolveSettings(population=8, generations=2, restarts=1)
    ikde.solve(qiao, target, settings)
    announced = []
    with jit.compile_clock(lambda: announced.append("compiling")) as clock:
        result = ikde.solve(qiao, target, settings)
    assert clock.seconds == 0.0
    assert result.compile_seconds == 0.0
    assert announced == []


ONE_SIGNATURE = """
import ikde
from ikde.kernels.figures import compute_figures
from ikde.kernels.lanes import solve_lanes
from tests.random_robots import random_robot

settings = ikde.SolveSettings(population=8, generations=5, restarts=2)
for robot in (ikde.load_robot("qiao2021"), random_robot(1), random_robot(2)):
    p = ikde.forward(robot, robot.home)[robot.tool][:3, 3]
    pose = ikde.Target(p, R_world_tool=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for target in (ikde.Target(p), ikde.Target(p, axis_world_tool=[0, 0, 1]), pose):
        for detector in (None, "none"):
            for collision in ("reject", "feasibility"):
                changed = settings.with_changes(collision=collision)
                ikde.solve(robot, target, changed, detector=detector, near=robot.home)
                ikde.solve(robot, target, settings, detector=detector, freeze=robot.joint_names[:1])
    ikde.solve_many(robot, [pose, pose], settings, threads=2)
print(len(solve_lanes.signatures), len(compute_figures.signatures))
"""


@needs_compiler
def test_kernels_called_from_the_host_have_one_signature():
    command = [sys.executable, "-W", "error", "-c", ONE_SIGNATURE]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout.split() == ["1", "1"], done.stderr
