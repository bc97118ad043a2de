"""First answers come from plain Python, to the bit; a child compiles meanwhile, and ends with what started it."""

import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numba
import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.io.robots import robot_path
from ikde.kernels.answer import size_of
from ikde.kernels.jit import COMPILE
from ikde.kernels.least_motion import reduce_motions
from ikde.kernels.lm import answer_target
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS
from ikde.solver import background
from ikde.solver.asker import find_asker
from ikde.solver.background import LATER, WAIT, Child, Question, answers_plainly, choose_way, compile_way
from ikde.solver.engines.lm import pack_answer
from ikde.solver.engines.stay_near import pack_walk
from ikde.solver.quick import find_quick
from tests.problems import problem_of
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
    find_asker.cache_clear()
    yield monkeypatch
    find_quick.cache_clear()
    find_asker.cache_clear()


def answer(robot, kind, way, written):
    """Bits of some answers."""
    written.setenv(COMPILE, way)
    find_quick.cache_clear()
    find_asker.cache_clear()
    rng, lines = np.random.default_rng(7), []
    for stream in range(25):
        target = make_target(robot, free_q(robot, rng), kind)
        near = robot.home if stream % 5 == 0 else None  # by another kernel
        result = ikde.solve(robot, target, seed=2**64 - 1, stream=stream, method="lm", near=near)
        lines.append([np.asarray(getattr(result, word)).tobytes().hex() for word in WORDS])
    return lines


PAIRS = [(name, kind) for name in ("qiao2021", "ur5", "panda") for kind in KINDS]
SLOW = [pytest.param(*pair, marks=[] if pair == PAIRS[0] else pytest.mark.slow) for pair in PAIRS]


@needs_compiler
@pytest.mark.parametrize(("name", "kind"), SLOW)
def test_plain_python_and_machine_code_give_the_same_bits(name, kind, written):
    robot = ikde.load_robot(name)
    assert answer(robot, kind, "never", written) == answer(robot, kind, "wait", written)


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize(("name", "kind"), PAIRS)
def test_kernels_of_tables_give_the_same_bits_both_ways(name, kind):
    """Of all robots, compiled once: it is the same Python about other kinematics. Then the descent to `near`."""
    robot, rng = ikde.load_robot(name), np.random.default_rng(3)
    problem = problem_of(robot, ikde.SolveSettings.for_method("lm"))
    near = replace(problem, near=robot.home)
    answer = answer_target.bind(*pack_answer(problem, kind))
    for stream in range(3):
        q = free_q(robot, rng)
        target = make_target(robot, q, kind)
        descend = reduce_motions.bind(*pack_walk(near, kind), *pack_targets([target]), np.array([0]))
        rows, moved = np.zeros((2, size_of(len(q), len(problem.collision.pairs)))), np.array([[q], [q]])
        for row, Q, way in zip(rows, moved, ("plain", "compiled"), strict=True):
            getattr(answer, way)(target.T_world_tool, np.int64(-1), stream, 0, 16, row)
            getattr(descend, way)(Q)
        assert rows[0].tobytes() == rows[1].tobytes()
        assert moved[0].tobytes() == moved[1].tobytes()
        assert (moved[0] != q).any()


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
    first.code = 0  # it could not keep what it made: the first question compiles, the second gets a child of its own
    assert not answers_plainly(lost, Question(collision, "pose"))
    assert answers_plainly(lost, Question(collision, "axis"))
    assert child._process is not first


@pytest.mark.parametrize("between", [False, True])
def test_a_child_that_was_killed_is_started_once_more(qiao, child, between):
    """Also if another question had its turn before the first is asked again."""
    collision, lost = CollisionModel.of(qiao), Answer(is_kept=False)
    pose, axis = (Question(collision, kind) for kind in ("pose", "axis"))
    assert answers_plainly(lost, pose)
    first, first.code = child._process, -9
    if between:
        assert answers_plainly(lost, axis)
        child._process.code = 0
    assert answers_plainly(lost, pose)
    assert child.works_on(pose)
    assert child._process is not first
    child._process.code = -9
    assert not answers_plainly(lost, pose)
    assert answers_plainly(lost, axis) is not between


def test_what_was_asked_while_the_child_was_at_work_has_its_turn_when_it_is_asked_again(qiao, child):
    collision, lost = CollisionModel.of(qiao), Answer(is_kept=False)
    questions = [Question(collision, "pose", call) for call in ("one", "near", "many of")]
    for question in questions:
        assert answers_plainly(lost, question)
    for done, question in pairwise(questions):
        assert child.works_on(done)
        child._process.code = 0
        assert answers_plainly(lost, question)
        assert child.works_on(question)


def test_what_is_kept_is_made_use_of_while_the_child_works_on_something_else(qiao, child):
    collision = CollisionModel.of(qiao)
    assert answers_plainly(Answer(is_kept=False), Question(collision, "pose", "near"))
    assert not answers_plainly(Answer(is_kept=True), Question(collision, "pose"))
    assert child.is_at_work


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


@pytest.mark.parametrize("told", ["", "background"])
def test_a_process_of_one_answer_starts_no_child(qiao, child, monkeypatch, told):
    monkeypatch.setenv(COMPILE, told)
    with compile_way(LATER):
        assert answers_plainly(Answer(is_kept=True), Question(CollisionModel.of(qiao), "pose"))
    assert not child.is_at_work


def test_another_word_is_an_error(monkeypatch):
    monkeypatch.setenv(COMPILE, "sometimes")
    with pytest.raises(InputError, match=r"\$IKDE_COMPILE.*background, wait, never"):
        choose_way()
    with pytest.raises(InputError, match=r"\$IKDE_COMPILE"):
        ikde.solve_many(ikde.load_robot("qiao2021"), [ikde.Target((0.8, 0.5, 1.0))])


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


MANY = """
import sys
import ikde
robot, places = ikde.load_robot("ur5"), [[0.3, 0.1 + 0.005 * k, 0.4] for k in range(40)]
rows = ikde.solve_many(robot, [ikde.Target(p) for p in [*places, [9.0, 0.0, 0.0]]], seed=7, method="lm")
from ikde.solver import background
process = background.CHILD._process
print(int(rows.reached.sum()), rows.reason(40)[:21], "numba" in sys.modules, process.pid, sep=",")
"""


def test_some_targets_one_of_them_out_of_reach_are_answered_without_numba(tmp_path):
    done = run_first(tmp_path, MANY)
    reached, reason, numba_is_there, pid = done.stdout.split(",")
    assert (reached, reason, numba_is_there, done.stderr) == ("40", "out of reach: at leas", "False", "")
    assert ends(pid)


COMMAND = """
import sys
from ikde.__main__ import main
sys.argv = ["ikde", "solve", "--json", *{words}]
try:
    main()
except SystemExit as end:
    code = end.code
print(code, "numba" in sys.modules, file=sys.stderr)
"""
DOWN = ["--quat-wxyz", "0", "1", "0", "0"]
BENT = "0,-1.5,1.5,-1.5,-1.5,0"


@pytest.mark.parametrize(
    "words",
    [
        ["--near", BENT],
        [*DOWN],
        [*DOWN, "--near", BENT],
        ["--freeze", "wrist_1_joint=-1"],
        ["--near", BENT, "--weights", "elbow_joint=3"],
        ["--axis", "0", "0", "-1", "--robot", "own"],
    ],
    ids=" ".join,
)
def test_the_command_answers_one_target_without_numba(tmp_path, words):
    """Also of a robot that does not come with ikde, whose seeds are drawn."""
    text = robot_path("ur5").read_text().replace("425]", "435]")
    (tmp_path / "own.yaml").write_text(text)
    given = [word.replace("own", str(tmp_path / "own.yaml")) for word in words]
    asked = ["--robot", "ur5", "--position", "0.3", "0.2", "0.4", *given]
    done = run_first(tmp_path / "cache", COMMAND.format(words=asked))
    assert done.stderr.strip() == "0 False"
    assert json.loads(done.stdout)["reached"]


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
