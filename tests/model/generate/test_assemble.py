"""The text of a module: Python of one robot, the engines as they stand, the same whoever writes it."""

import ast
import hashlib
import inspect
import os
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import ikde
from ikde.kernels import analytic, draws, lm
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import assemble, module
from ikde.model.generate.collision import count_sphere_pairs, count_tests
from ikde.model.target import KINDS
from tests.collision_robots import SHIPPED, name_case
from tests.conftest import ROBOTS
from tests.hostile_names import rename
from tests.three_joints import CROWDED, crowd

ROOT = Path(__file__).parents[3]
each_kind = pytest.mark.parametrize("kind", KINDS)
OWN = ["use_models", "unpack_used", "make_buffers", "take_step", "take_steps", "find_collision"]


@cache
def text_of(name, kind):
    """The module of a robot that ships."""
    robot = ikde.load_robot(name)
    return assemble.format_module(CollisionModel.of(robot), kind)


@cache
def table_text(robot, kind):
    """The module of a robot made for tests."""
    return assemble.format_module(CollisionModel.of(robot), kind)


def functions_of(text):
    return [node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)]


@each_kind
@pytest.mark.parametrize("name", ROBOTS)
def test_a_module_is_python_of_one_robot(name, kind):
    robot, text = ikde.load_robot(name), text_of(name, kind)
    names = [function.name for function in functions_of(text)]
    assert names[: len(OWN)] == OWN
    assert len(set(names)) == len(names)
    assert {"solve_target", "solve_targets"} <= set(names)
    assert ("solve_branches" in names) == (kind == "pose" and find_ur_arm(robot) is not None)
    assert all(ast.get_docstring(function) for function in functions_of(text))


@each_kind
def test_a_check_of_many_tests_is_written_as_tables(kind):
    text = table_text(CROWDED, kind)
    assert [function.name for function in functions_of(text)][:2] == ["take_step", "take_steps"]
    assert assemble.TABLE_IMPORT in text
    pairs = count_sphere_pairs(CollisionModel.of(CROWDED).arrays)
    assert ast.get_docstring(ast.parse(text)).endswith(f"\n{pairs} pairs of spheres, in tables.")


def test_the_number_of_tests_decides(monkeypatch):
    """At the most that is written straight-line, and beyond it."""
    robot = ikde.load_robot("ur5")
    count = count_tests(CollisionModel.of(robot).arrays)
    for most, in_tables in ((count, False), (count - 1, True)):
        monkeypatch.setattr(assemble, "MAX_TESTS", most)
        text = assemble.format_module(CollisionModel.of(robot), "position")
        assert (assemble.TABLE_IMPORT in text) == in_tables
        assert ("def find_collision" in text) != in_tables


def test_no_sphere_is_in_a_text_that_reads_tables():
    """More spheres: the same text but for its head, and so as much to compile."""
    few, many = (table_text(crowd(rows), "position") for rows in (8, 18))
    assert count_tests(CollisionModel.of(crowd(18)).arrays) > 4 * assemble.MAX_TESTS
    assert few.split("import math", 1)[1] == many.split("import math", 1)[1]


@each_kind
@pytest.mark.parametrize("name", ["qiao2021", "panda", "crowded"])
def test_every_name_is_known_where_it_is_used(name, kind):
    text = table_text(CROWDED, kind) if name == "crowded" else text_of(name, kind)
    rules = "E9,F821,F822,F823,F841,W291,W293"
    command = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", rules, "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("case", SHIPPED, ids=name_case)
def test_the_head_tells_what_the_module_is_for(case):
    robot, detector = case
    head = ast.get_docstring(ast.parse(assemble.format_module(CollisionModel(robot=robot, detector=detector), "axis")))
    (first, second, *_), last = head.split("\n"), len(robot.joints) - 1
    assert first == f"Kernels of one robot for axis targets, written by ikde: straight-line code, q0 to q{last}."
    assert not second
    assert re.search(r"^\d+ pairs of spheres; \d+ tests of rows and spheres", head, re.MULTILINE)


@each_kind
@pytest.mark.parametrize("name", ["qiao2021", "ur5"])
def test_no_name_is_in_it(name, kind):
    """Whatever things are called, also what would end the docstring, the text is the same."""
    robot = ikde.load_robot(name)
    hostile = rename(robot, lambda old: f'{old}"""\n{old}\\')
    assert assemble.format_module(CollisionModel.of(hostile), kind) == text_of(name, kind)


def test_no_name_is_in_tables():
    hostile = rename(CROWDED, lambda old: f'{old}"""\n{old}\\')
    assert assemble.format_module(CollisionModel.of(hostile), "axis") == table_text(CROWDED, "axis")


def test_the_engine_is_in_it_as_it_stands():
    text = text_of("qiao2021", "pose")
    for source in (lm, draws, analytic):
        body = (
            Path(source.__file__)
            .read_text(encoding="utf-8")
            .split("ikde.kernels.tables import", 1)[1]
            .split("\n", 1)[1]
        )
        assert body in text
    assert "kernels.tables" not in text


def test_straight_line_code_has_no_loop_but_the_lanes():
    for function in functions_of(text_of("qiao2021", "pose"))[: len(OWN)]:
        loops = [node for node in ast.walk(function) if isinstance(node, ast.For | ast.While)]
        assert len(loops) == (function.name == "take_steps")
        signature = [argument.arg for argument in function.args.args]
        twin = getattr(sys.modules["ikde.kernels.tables"], function.name, None)
        if twin is not None:
            assert signature == list(inspect.signature(getattr(twin, "py_func", twin)).parameters)


def test_the_same_robot_has_the_same_module():
    for name in ("qiao2021", "panda"):
        a = ikde.load_robot(name)
        b = replace(a)
        assert a is not b
        assert a == b
        assert module.digest_inputs(CollisionModel.of(a), "pose") == module.digest_inputs(CollisionModel.of(b), "pose")
        assert assemble.format_module(CollisionModel.of(b), "pose") == text_of(name, "pose")


def test_another_process_writes_the_same_text():
    script = (
        "import hashlib, ikde; from ikde.model.generate import assemble; r = ikde.load_robot('qiao2021');"
        "from ikde.model.collision_model import CollisionModel; "
        "t = assemble.format_module(CollisionModel.of(r), 'pose'); print(hashlib.sha256(t.encode()).hexdigest())"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "7", "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.strip() == hashlib.sha256(text_of("qiao2021", "pose").encode()).hexdigest()
