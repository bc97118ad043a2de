"""One process at a time compiles into a cache folder, and another can see what it is about."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

import ikde
from ikde.kernels import cache_folder
from ikde.kernels.jit import COMPILE
from ikde.model.collision_model import CollisionModel
from ikde.solver import background
from ikde.solver.background import Child, Question, answers_plainly
from ikde.solver.compile_turn import LOCK, is_taken_for, mark_work, take_turn

ROOT = Path(__file__).parents[2]
needs_locks = pytest.mark.skipif(sys.platform == "win32", reason="needs locks of files")


@needs_locks
def test_one_waits_for_another(tmp_path):
    script = f"import sys; sys.path[:] = {sys.path!r}\nfrom pathlib import Path\n" + (
        "from ikde.solver.compile_turn import take_turn\n"
        f"with take_turn(Path({str(tmp_path)!r})):\n    print('mine', flush=True)\n    input()\n"
    )
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", script], cwd=ROOT, **pipes) as other:
        assert other.stdout.readline() == "mine\n"
        mine = threading.Event()

        def wait():
            with take_turn(tmp_path):
                mine.set()

        thread = threading.Thread(target=wait)
        thread.start()
        assert not mine.wait(0.3)
        other.communicate("\n")
        thread.join(20.0)
        assert mine.is_set()


@needs_locks
def test_what_is_compiled_is_seen_while_it_is_and_by_its_mark_alone(tmp_path):
    assert not is_taken_for(tmp_path, b"work")
    for mark in (b"a longer one", b"work"):
        with take_turn(tmp_path, mark):
            assert is_taken_for(tmp_path, b"work") == (mark == b"work")
    assert not is_taken_for(tmp_path, b"work")
    assert (tmp_path / LOCK).read_bytes() == b"work"


def test_a_mark_tells_robots_kinds_and_detectors_apart_and_holds_no_name():
    robot = ikde.load_robot("ur5")
    collisions = [CollisionModel.of(robot), CollisionModel.of(robot, "none")]
    questions = [Question(c, kind, call) for c in collisions for kind in ("pose", "axis") for call in ("one", "near")]
    marks = {mark_work(question.encode()) for question in questions}
    assert len(marks) == len(questions)
    assert all(len(mark) == 64 and mark.isalnum() for mark in marks)
    assert mark_work({**questions[0].encode(), "parent": 1}) in marks


@needs_locks
def test_processes_that_are_killed_are_no_end_and_another_ones_is_waited_for(qiao, monkeypatch):
    child, lost, question = Child(), SimpleNamespace(is_kept=False), Question(CollisionModel.of(qiao), "pose")
    monkeypatch.setattr(background, "CHILD", child)
    monkeypatch.setenv(COMPILE, "background")
    folder, seen = cache_folder.CACHE_FOLDER, set()
    with take_turn(folder, b"something else"):  # so that they wait
        for _ in range(2):
            assert answers_plainly(lost, question)
            os.kill(child._process.pid, signal.SIGKILL)
            child._process.wait()
            child._process.stdin.close()
            seen.add(child._process.pid)
        assert not answers_plainly(lost, question)
    with take_turn(folder, mark_work(question.encode())):
        assert answers_plainly(lost, question)
    assert not answers_plainly(lost, question)
    assert len(seen) == 2
