"""The child compiles what it is told, one at a time in a cache folder, and leaves no half of a file."""

import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import ikde
from ikde.kernels import cache_files
from ikde.model.plain_data import encode
from ikde.solver import compiler_process, warmup
from ikde.solver.compiler_process import compile_answer

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("kind", ["position", "pose"])
def test_it_compiles_one_kind_of_target_for_the_robot_that_it_is_told(substitute, kind):
    robot, done = ikde.load_robot("ur5"), []
    substitute(warmup.warm_up, done.extend)
    detector = robot.detectors[robot.default_detector]
    compile_answer({"robot": encode(robot), "detector": encode(detector), "what": [kind, "one", "lm"]})
    (stage,) = done
    assert stage.name == f"lm, one {kind}"
    asked, target, *_ = stage.run.args
    assert (asked.name, target.kind) == ("ur5", kind)
    assert stage.run.keywords["collision"].detector == detector


def test_with_near_and_without_a_detector_it_compiles_for_that(substitute):
    robot, done = ikde.load_robot("ur5"), []
    substitute(warmup.warm_up, done.extend)
    compile_answer({"robot": encode(robot), "detector": None, "what": ["axis", "near", "lm"]})
    asked = done[0].run.keywords
    assert asked["collision"].detector is None
    assert asked["near"].tolist() == robot.home.tolist()


def test_it_does_not_end_in_the_middle_of_a_file(monkeypatch):
    ended = []
    monkeypatch.setattr(compiler_process.os, "_exit", ended.append)
    with cache_files.WRITING:
        thread = threading.Thread(target=compiler_process.leave)
        thread.start()
        time.sleep(0.1)
        assert ended == []
    thread.join(20.0)
    cache_files.WRITING.release()
    assert ended == [1]


def test_while_it_waits_nothing_is_imported():
    script = "import sys; from ikde.solver import compiler_process; print({'numpy', 'numba'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


@pytest.mark.parametrize(("call", "engine"), [("many of", "lm"), ("one", "analytic"), ("near", "analytic")])
def test_what_is_asked_is_one_stage(substitute, call, engine):
    robot, done = ikde.load_robot("ur5"), []
    substitute(warmup.warm_up, done.extend)
    compile_answer({"robot": encode(robot), "detector": None, "what": ("pose", call, engine)})
    assert [stage.name for stage in done] == [f"{engine}, {call} pose"]
