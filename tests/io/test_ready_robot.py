"""What stands ready of a shipped robot is what its file says, and is read without the parsers of files."""

import json
import subprocess
import sys
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from ikde.io.ready_robot import FOLDER as READY
from ikde.io.ready_robot import format_ready, read_ready
from ikde.io.robots import FOLDER, parse_file, robot_names

ROOT = Path(__file__).parents[2]


def assert_same(a, b):
    """To the bit, but for what numpy's sine makes of an angle: that hangs on the machine."""
    assert type(a) is type(b)
    if is_dataclass(a):
        for field in fields(a):
            assert_same(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, np.ndarray):
        assert (a.shape, a.dtype, a.flags.writeable) == (b.shape, b.dtype, b.flags.writeable)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=4e-16)
    elif isinstance(a, dict):
        assert_same(tuple(a.items()), tuple(b.items()))
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for x, y in zip(a, b, strict=True):
            assert_same(x, y)
    else:
        assert a == b


@pytest.mark.parametrize("name", robot_names())
def test_every_shipped_robot_stands_ready_as_its_file_says(name):
    ready = read_ready(FOLDER / f"{name}.yaml")
    assert ready is not None, "run benchmarks/ship_robots.py"
    assert_same(ready, parse_file(FOLDER / f"{name}.yaml"))


def test_numbers_are_read_to_the_bit(tmp_path):
    robot = parse_file(FOLDER / "ur5.yaml")
    joint = replace(robot.joints[0], lower=-np.inf, upper=0.1 + 0.2, home=-0.0)
    robot = replace(robot, joints=(joint, *robot.joints[1:]))
    path = write(tmp_path, robot, b"text")
    first = read_ready(path).joints[0]
    assert (first.lower, first.upper, str(first.home)) == (-np.inf, 0.1 + 0.2, "-0.0")


def test_an_edited_file_is_read_itself(tmp_path):
    path = write(tmp_path, parse_file(FOLDER / "ur5.yaml"), b"text")
    assert read_ready(path).name == "ur5"
    path.write_bytes(b"text ")
    assert read_ready(path) is None


def test_a_file_without_anything_ready_is_read_itself(tmp_path):
    (tmp_path / "robot.yaml").write_bytes(b"text")
    assert read_ready(tmp_path / "robot.yaml") is None


def test_a_shipped_robot_is_loaded_without_the_parsers():
    script = "import ikde, sys; ikde.load_robot('qiao2021'); print({'yaml', 'pydantic'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def write(folder, robot, source):
    path = folder / "robot.yaml"
    path.write_bytes(source)
    (folder / READY).mkdir()
    (folder / READY / "robot.json").write_text(format_ready(robot, source), encoding="utf-8")
    assert json.loads((folder / READY / "robot.json").read_text(encoding="utf-8"))["robot"]["name"] == robot.name
    return path
