"""Kernels compile once, with a cache or without one, and the clock counts compilation only."""

import inspect
import os
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba
import numpy as np
import pytest

import ikde
from ikde.kernels import jit
from tests.flat_settings import flat_settings

ROOT = Path(__file__).parents[2]
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


def multiply_by(n):
    """A kernel that no cache keeps, since it is a closure."""
    return jit.kernel(lambda x: n * x)


@jit.inline_kernel
def half(x):
    """Half of x."""
    return 0.5 * x


@jit.kernel
def count_halvings(x, least):
    """How often x can be halved; it calls another kernel, and itself."""
    if x <= least:
        return 0
    return 1 + count_halvings(half(x), least)


def test_a_kernel_looks_like_its_function():
    assert (half.__name__, half.__doc__) == ("half", "Half of x.")
    assert list(inspect.signature(count_halvings).parameters) == ["x", "least"]


def test_both_ways_give_the_same_and_call_their_own_kind():
    assert count_halvings(10.0, 1.0) == count_halvings.plain(10.0, 1.0) == 4
    assert count_halvings.plain.__globals__["half"] is half.plain
    assert not [value for value in count_halvings.plain.__globals__.values() if isinstance(value, jit.Kernel)]


def test_a_kernel_that_is_defined_later_is_plain_as_well():
    space = {"kernel": jit.kernel}
    exec("@kernel\ndef one():\n    return 1\n", space)
    assert space["one"].plain() == 1
    exec("@kernel\ndef two():\n    return 2\n\n@kernel\ndef three():\n    return one() + two()\n", space)
    assert space["three"].plain() == 3
    assert space["three"].plain.__globals__["two"] is space["two"].plain


def test_a_kernel_with_its_first_arguments_has_both_ways():
    bound = count_halvings.bind(10.0)
    assert bound.plain(1.0) == bound.compiled(1.0) == 4


def test_plain_python_goes_on_with_infinite_numbers_as_machine_code_does():
    divide = jit.kernel(lambda x: x / x).bind(np.float64(0.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isnan(divide.plain())


def test_where_nothing_is_to_be_compiled_a_kernel_is_plain(monkeypatch):
    monkeypatch.setenv(jit.COMPILE, "never")
    triple = multiply_by(3.0)
    assert triple(2.0) == 6.0
    assert triple.compiled is triple.plain


WITHOUT_NUMBA = """
import sys
from importlib import import_module
from pathlib import Path
import numpy as np
from ikde.kernels import jit

for file in sorted(Path(jit.__file__).parent.glob("*.py")):
    if file.stem != "machine_code":
        import_module(f"ikde.kernels.{file.stem}")

@jit.kernel
def double(x):
    return 2.0 * x

with jit.compile_clock() as clock:
    print(double.plain(2.0), "numba" in sys.modules)
    print(double(2.0), "numba" in sys.modules, clock.seconds > 0.0)
"""


@needs_compiler
def test_numba_is_imported_for_machine_code_alone_and_then_tells_clocks_that_run_already():
    done = subprocess.run([sys.executable, "-c", WITHOUT_NUMBA], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout.splitlines() == ["4.0 False", "4.0 True True"], done.stderr


UNCACHED = """
import warnings
import numpy as np
from ikde.kernels import cache_folder, jit

@jit.kernel
def double(x):
    return 2.0 * x

print(cache_folder.CACHE_IS_WRITABLE, double(2.0))
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


@needs_compiler
def test_the_clock_counts_and_announces_a_compilation_once():
    announced = []
    with jit.compile_clock(lambda: announced.append("compiling")) as clock:
        double, triple = (multiply_by(n) for n in (2.0, 3.0))
        assert (double(1.0), triple(1.0)) == (2.0, 3.0)
    assert clock.seconds > 0.0
    assert announced == ["compiling"]


@needs_compiler
def test_a_compilation_on_another_thread_is_announced_and_none_after_the_block():
    announced, (double, triple) = [], (multiply_by(n) for n in (2.0, 3.0))
    with jit.compile_clock(lambda: announced.append("compiling")), ThreadPoolExecutor(1) as pool:
        assert pool.submit(double, 1.0).result() == 2.0
    assert triple(1.0) == 3.0
    assert announced == ["compiling"]


@needs_compiler
def test_the_clock_stands_still_when_nothing_compiles(qiao):
    target, settings = ikde.Target([0.8, 0.5, 1.0]), flat_settings(population=8, generations=2, restarts=1)
    ikde.solve(qiao, target, settings)
    announced = []
    with jit.compile_clock(lambda: announced.append("compiling")) as clock:
        result = ikde.solve(qiao, target, settings)
    assert clock.seconds == 0.0
    assert result.compile_seconds == 0.0
    assert announced == []


ONE_SIGNATURE = """
import sys

import ikde
from ikde.solver.settings import BulkOptions
from ikde.kernels.grade_many import grade_many
from ikde.kernels.evolution import solve_lanes
from tests.flat_settings import flat_settings
from tests.random_robots import random_robot

NEAR = "--near" in sys.argv
settings = flat_settings(population=8, generations=5, restarts=2)
for robot in (ikde.load_robot("qiao2021"), random_robot(1), random_robot(2)):
    p = ikde.forward(robot, robot.home)[robot.tool][:3, 3]
    pose = ikde.Target(p, R_world_tool=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for target in (ikde.Target(p), ikde.Target(p, axis_world_tool=[0, 0, 1]), pose):
        for detector in (None, "none"):
            for collision in ("reject", "feasibility"):
                changed = settings.with_changes(de={"collision": collision})
                ikde.solve(robot, target, changed, collision=detector, near=robot.home if NEAR else None)
                ikde.solve(robot, target, settings, collision=detector, freeze=robot.joint_names[:1])
    ikde.solve_many(robot, [pose, pose], settings, bulk=BulkOptions(threads=2))
print(len(solve_lanes.compiled.signatures), len(grade_many.compiled.signatures))
"""


@needs_compiler
@pytest.mark.parametrize("near", ["", pytest.param("--near", marks=pytest.mark.slow)])  # that compiles 30 s
def test_kernels_called_from_the_host_have_one_signature(near):
    command = [sys.executable, "-W", "error", "-c", ONE_SIGNATURE, near]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout.split() == ["1", "1"], done.stderr
