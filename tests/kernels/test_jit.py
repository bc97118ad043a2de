"""The cache follows the kernels' source, the clock counts compilation only, and nothing compiles twice."""

import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numba
import numpy as np
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
    assert not jit._is_ours(tmp_path / "file" / "cache")
    assert jit._is_ours(tmp_path / "new" / "cache")


def is_root():
    return hasattr(os, "getuid") and os.getuid() == 0


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, of the test's own."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def find(wanted):
    """(folder, whether it can be written, warnings) of a search for a writable folder."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        folder, usable = jit.find_writable(wanted)
    return folder, usable, caught


def block(folder, monkeypatch):
    """Nothing can be written below a folder; root may write anywhere, so the system is asked in vain."""
    folder.mkdir(exist_ok=True)
    allowed = os.access

    def access(path, mode):
        return folder not in (Path(path), *Path(path).parents) and allowed(path, mode)

    monkeypatch.setattr(os, "access", access)


def test_a_folder_that_can_be_written_is_taken_without_a_word(tmp_path, temporary):
    wanted = tmp_path / "cache" / "abc"
    assert find(wanted) == (wanted, True, [])
    assert wanted.is_dir()
    assert not list(temporary.iterdir())


def test_a_read_only_folder_is_told_once_with_what_is_used_instead(tmp_path, temporary, monkeypatch):
    wanted = tmp_path / "cache" / "abc"
    block(wanted.parent, monkeypatch)
    folder, usable, caught = find(wanted)
    assert usable
    assert folder.parent.parent == temporary
    assert folder.name == wanted.name
    assert folder.is_dir()
    (warning,) = caught
    assert warning.category is RuntimeWarning
    assert f"{wanted.parent} cannot be written" in str(warning.message)
    assert f"{folder.parent} is used instead" in str(warning.message)


@pytest.mark.skipif(is_root(), reason="root may write anywhere")
def test_a_folder_without_the_right_to_write_is_read_only(tmp_path, temporary):
    wanted = tmp_path / "cache" / "abc"
    wanted.mkdir(parents=True)
    wanted.chmod(0o555)
    folder, usable, caught = find(wanted)
    assert (folder.parent.parent, usable, len(caught)) == (temporary, True, 1)


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs owners of files")
def test_what_others_can_write_is_refused(tmp_path, temporary):
    wanted = tmp_path / "cache" / "abc"
    wanted.mkdir(parents=True)
    wanted.chmod(0o777)
    folder, usable, caught = find(wanted)
    assert (folder.parent.parent, usable, len(caught)) == (temporary, True, 1)
    assert list(wanted.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs owners of files")
@pytest.mark.parametrize("mode", [0o700, 0o755])
def test_what_belongs_to_another_user_is_refused(tmp_path, temporary, monkeypatch, mode):
    wanted = tmp_path / "cache" / "abc"
    wanted.mkdir(parents=True)
    wanted.chmod(mode)
    mine = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: mine + 1)
    _, usable, caught = find(wanted)
    assert not usable  # the folder for temporary files is made by the same user
    assert len(caught) == 1


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs owners of files")
@pytest.mark.parametrize("spoil", ["parent", "folder"])
def test_a_spare_folder_that_others_can_write_is_refused_as_well(tmp_path, temporary, monkeypatch, spoil):
    wanted = tmp_path / "cache" / "abc"
    block(wanted.parent, monkeypatch)
    spare = temporary / f"ikde-{os.getuid()}"
    (spare / "abc").mkdir(parents=True)
    (spare if spoil == "parent" else spare / "abc").chmod(0o777)
    _, usable, caught = find(wanted)
    assert not usable
    (warning,) = caught
    assert "every process compiles for itself" in str(warning.message)


UNCACHED = """
import warnings
import numpy as np
from ikde.kernels import jit

@jit.kernel
def double(x):
    return 2.0 * x

print(jit.CACHE_IS_WRITABLE, double(2.0))
"""


def test_where_nothing_can_be_written_every_process_compiles_for_itself(tmp_path):
    """A file stands where the folders would be."""
    for name in ("cache", "temporary"):
        (tmp_path / name).mkdir()
    (tmp_path / "cache" / "in the way").write_text("")
    user = os.getuid() if hasattr(os, "getuid") else "user"
    (tmp_path / "temporary" / f"ikde-{user}").write_text("in the way")
    environment = {
        **os.environ,
        "IKDE_CACHE_DIR": str(tmp_path / "cache" / "in the way"),
        "TMPDIR": str(tmp_path / "temporary"),
    }
    script = tmp_path / "script.py"
    script.write_text(UNCACHED)
    command = [sys.executable, "-W", "always::RuntimeWarning", str(script)]
    environment["PYTHONPATH"] = str(ROOT)
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.stdout.split() == ["False", "4.0"], done.stderr
    assert done.stderr.count("every process compiles for itself") == 1


def test_a_leaf_kernel_computes_like_any_other():
    """It allocates nothing itself; it may write into what it is given."""

    def add(a, b, out):
        for k in range(a.size):
            out[k] = a[k] + b[k]
        return out[0]

    results = []
    for decorate in (lambda function: function, jit.leaf_kernel):
        out = np.zeros(4)
        results.append((decorate(add)(np.arange(4.0), np.ones(4), out), out.tobytes()))
    assert results[0] == results[1]


def test_decorating_leaves_numbas_own_cache_folder_alone():
    before = numba.config.CACHE_DIR
    jit.kernel(lambda x: x)
    jit.inline_kernel(lambda x: x)
    jit.leaf_kernel(lambda x: x)
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
