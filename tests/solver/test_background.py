"""First answers come from plain Python, to the bit; a child compiles meanwhile, and ends with what started it."""

import os
import subprocess
import sys
import time
from pathlib import Path

import numba
import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.jit import COMPILE
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver import background
from ikde.solver.background import LATER, WAIT, Child, Question, answers_plainly, choose_way, compile_way
from ikde.solver.quick import find_quick
from ikde.solver.quick_near import find_quick_near
from tests.targets import free_q, make_target

ROOT = Path(__file__).parents[2]
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
PATIENCE_S = 300.0
WORDS = ("q", "attempts", "rejected", "evaluations", "position_error_m", "orientation_error_rad", "clearance_m")


@pytest.fixture
def written(monkeypatch):
    """As users run it: by kernels written for a robot."""
    monkeypatch.delenv("IKDE_KERNELS", raising=False)
    find_quick.cache_clear()
    find_quick_near.cache_clear()
    yield monkeypatch
    find_quick.cache_clear()
    find_quick_near.cache_clear()


def answer(robot, kind, way, written):
    """Bits of some answers."""
    written.setenv(COMPILE, way)
    find_quick.cache_clear()
    find_quick_near.cache_clear()
    rng, lines = np.random.default_rng(7), []
    for stream in range(25):
        target = make_target(robot, free_q(robot, rng), kind)
        near = robot.home if stream % 5 == 0 else None  # by another kernel
        result = ikde.solve(robot, target, seed=2**64 - 1, stream=stream, method="lm", near=near)
        lines.append([np.asarray(getattr(result, word)).tobytes().hex() for word in WORDS])
    return lines


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("ur5", "panda")]


@needs_compiler
@pytest.mark.parametrize("name", ["qiao2021", *SLOW])
@pytest.mark.parametrize("kind", KINDS)
def test_plain_python_and_machine_code_give_the_same_bits(name, kind, written):
    robot = ikde.load_robot(name)
    assert answer(robot, kind, "never", written) == answer(robot, kind, "wait", written)


class Answer:
    """One that was compiled before, or not."""

    def __init__(self, is_kept):
        self.is_kept = is_kept


@pytest.fixture
def child(monkeypatch):
    """A child that is only counted."""
    child = Child()
    monkeypatch.setattr(background, "CHILD", child)
    monkeypatch.setattr(background, "start", lambda question: Sleeper())
    monkeypatch.setenv(COMPILE, "background")
    return child


class Sleeper:
    """A process that runs until it is told that it has ended."""

    def __init__(self):
        self.code = None

    def poll(self):
        return self.code


def test_what_was_compiled_before_is_not_answered_in_plain_python(qiao, child):
    assert not answers_plainly(Answer(is_kept=True), Question(CollisionModel.of(qiao), "pose"))
    assert not child.is_at_work


def test_one_child_at_a_time_and_one_trial_a_question(qiao, child):
    collision, lost = CollisionModel.of(qiao), Answer(is_kept=False)
    assert answers_plainly(lost, Question(collision, "pose"))
    first = child._process
    assert answers_plainly(lost, Question(collision, "axis"))
    assert child._process is first
    first.code = -9  # somebody killed it: the first question compiles for itself, the second gets a child of its own
    assert not answers_plainly(lost, Question(collision, "pose"))
    assert answers_plainly(lost, Question(collision, "axis"))
    assert child._process is not first


def test_a_child_that_has_done_its_work_is_made_use_of(qiao, child):
    collision, made = CollisionModel.of(qiao), Answer(is_kept=False)
    assert answers_plainly(made, Question(collision, "pose"))
    made.is_kept = True
    assert answers_plainly(made, Question(collision, "pose"))  # it may be writing still
    child._process.code = 0
    assert not answers_plainly(made, Question(collision, "pose"))


@pytest.mark.parametrize(("way", "plain"), [("never", True), ("wait", False)])
def test_the_environment_decides(qiao, child, monkeypatch, way, plain):
    monkeypatch.setenv(COMPILE, way)
    with compile_way(LATER if way == "wait" else WAIT):
        assert answers_plainly(Answer(is_kept=False), Question(CollisionModel.of(qiao), "pose")) is plain
    assert not child.is_at_work


def test_a_process_of_one_answer_starts_no_child(qiao, child, monkeypatch):
    monkeypatch.delenv(COMPILE)
    with compile_way(LATER):
        assert answers_plainly(Answer(is_kept=True), Question(CollisionModel.of(qiao), "pose"))
    assert not child.is_at_work


def test_another_word_is_an_error(monkeypatch):
    monkeypatch.setenv(COMPILE, "sometimes")
    with pytest.raises(InputError, match=r"\$IKDE_COMPILE.*background, wait, never"):
        choose_way()


@pytest.mark.parametrize("hindrance", ["frozen", "no cache", "no python"])
def test_where_no_child_can_be_had_the_first_call_compiles(qiao, child, monkeypatch, hindrance):
    if hindrance == "frozen":
        monkeypatch.setattr(sys, "frozen", True, raising=False)
    elif hindrance == "no cache":
        monkeypatch.setattr(background.cache_folder, "CACHE_IS_WRITABLE", False)
    else:
        monkeypatch.setattr(sys, "executable", "")
    assert not answers_plainly(Answer(is_kept=False), Question(CollisionModel.of(qiao), "pose"))


FIRST = """
import sys
import ikde
robot = ikde.load_robot("ur5")
result = ikde.solve(robot, ikde.Target([0.3, 0.2, 0.4]), seed=7, method="lm")
from ikde.solver import background
process = background.CHILD._process
print(result.reached, "numba" in sys.modules, process and process.pid, flush=True)
"""


def surroundings(folder, **environment):
    """A cache of its own, and nothing that tests set."""
    free = {name: value for name, value in os.environ.items() if name not in (COMPILE, "IKDE_KERNELS")}
    return {"cwd": ROOT, "env": {**free, "IKDE_CACHE_DIR": str(folder), **environment}, "text": True}


def run_first(folder, script=FIRST, **environment):
    """A process of its own."""
    command = [sys.executable, "-c", script]
    return subprocess.run(
        command, **surroundings(folder, **environment), capture_output=True, timeout=PATIENCE_S, check=True
    )


def ends(pid):
    """True once there is no such process, or only what is left of it until somebody asks."""
    last = time.monotonic() + 20.0
    while time.monotonic() < last:
        state = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, check=False).stdout.strip()
        if not state or state.startswith(b"Z"):
            return True
        time.sleep(0.05)
    return False


def test_a_short_script_is_answered_without_numba_and_leaves_nothing(tmp_path):
    done = run_first(tmp_path)
    reached, numba_is_there, pid = done.stdout.split()
    assert (reached, numba_is_there, done.stderr) == ("True", "False", "")
    assert ends(pid)
    assert not list(tmp_path.rglob("*.tmp"))


def test_a_closed_standard_input_changes_nothing(tmp_path):
    done = run_first(tmp_path, "import os; os.close(0)\n" + FIRST)
    reached, numba_is_there, pid = done.stdout.split()
    assert (reached, numba_is_there, done.stderr) == ("True", "False", "")
    assert ends(pid)


def test_a_child_ends_with_a_parent_that_is_killed(tmp_path):
    script = FIRST + "input()\n"
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", script], **surroundings(tmp_path), **pipes) as parent:
        pid = parent.stdout.readline().split()[-1]
        assert not parent.poll()
        parent.kill()
    assert ends(pid)
    assert not list(tmp_path.rglob("*.tmp"))


SPAWNED = """
import multiprocessing
import sys
import ikde

def solve(x):
    result = ikde.solve(ikde.load_robot("ur5"), ikde.Target([x, 0.2, 0.4]), seed=7, method="lm")
    return result.reached, "numba" in sys.modules

if __name__ == "__main__":
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        print(pool.map(solve, [0.3, 0.35]))
"""


def test_workers_that_are_spawned_are_answered_as_well(tmp_path):
    (tmp_path / "script.py").write_text(SPAWNED)
    command = [sys.executable, str(tmp_path / "script.py")]
    place = {**surroundings(tmp_path / "cache"), "cwd": tmp_path}
    place["env"]["PYTHONPATH"] = str(ROOT)
    done = subprocess.run(command, **place, capture_output=True, timeout=PATIENCE_S, check=True)
    assert (done.stdout.strip(), done.stderr) == ("[(True, False), (True, False)]", "")


def test_a_fork_has_no_child():
    """Of a process that has one: it belongs to the process that started it."""
    child = Child()
    child._process = Sleeper()
    child.forget()
    assert not child.is_at_work


def test_never_imports_numba_and_starts_nothing(tmp_path):
    assert run_first(tmp_path, **{COMPILE: "never"}).stdout.split() == ["True", "False", "None"]


NEVER = """
import sys
import warnings
warnings.simplefilter("error")
import ikde
robot = ikde.load_robot("ur5")
targets = [ikde.Target([0.3, 0.2, 0.4]), ikde.Target([0.3, 0.1, 0.4])]
results = [ikde.solve_many(robot, targets), ikde.solve_many(robot, targets, near=robot.home)]
print([bool(rows.reached.all()) for rows in results], "numba" in sys.modules)
"""


def test_never_answers_many_without_a_warning(tmp_path):
    """Of words that wrap around, which machine code does without a word."""
    done = run_first(tmp_path, NEVER, **{COMPILE: "never"})
    assert (done.stdout.strip(), done.stderr) == ("[True, True] False", "")
