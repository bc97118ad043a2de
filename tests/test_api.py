"""The names that users import: they exist, are documented, are known to type checkers, and cost nothing to look at."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.track.certify import certify
from ikde.track.verify_track import verify_track

SOURCE = ast.parse(Path(ikde.__file__).read_text(encoding="utf-8"))
CONFIGS = Path(__file__).parent.parent / "configs"
FUNCTIONS = sorted(name for name in ikde._HOME if inspect.isfunction(getattr(ikde, name)))
every_name = pytest.mark.parametrize("name", sorted(ikde._HOME))


def names_for_type_checkers():
    """Name -> module of the imports under `if TYPE_CHECKING`."""
    block = next(node for node in SOURCE.body if isinstance(node, ast.If))
    assert block.test.id == "TYPE_CHECKING"
    return {alias.asname: node.module for node in block.body for alias in node.names if alias.asname == alias.name}


@every_name
def test_a_name_comes_from_its_home(name):
    assert getattr(ikde, name).__module__ == ikde._HOME[name]


@every_name
def test_a_name_is_listed_and_documented(name):
    assert name in dir(ikde)
    assert inspect.getdoc(getattr(ikde, name))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_call_stays_small(name):
    kinds = [parameter.kind for parameter in inspect.signature(getattr(ikde, name)).parameters.values()]
    assert kinds.count(inspect.Parameter.KEYWORD_ONLY) <= 8


def test_type_checkers_see_the_same_names():
    assert names_for_type_checkers() == ikde._HOME


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'ikde' has no attribute 'sovle'"):
        _ = ikde.sovle


def test_importing_ikde_imports_nothing_heavy():
    script = "import ikde, sys; dir(ikde); print(sorted({'numpy', 'numba', 'scipy', 'yaml'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_says_what_it_takes(name):
    function = getattr(ikde, name)
    text = inspect.getdoc(function)
    parameters = inspect.signature(function).parameters
    shared = "rguments as for `solve`" in " ".join(text.split())
    if not parameters:
        return
    assert "Args:" in text or shared or all(f"`{parameter}`" in text for parameter in parameters)
    if "Args:" in text:
        section = text.split("Args:")[1]
        assert [parameter for parameter in parameters if f"    {parameter}: " not in section] == []


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_is_typed(name):
    signature = inspect.signature(getattr(ikde, name))
    assert signature.return_annotation is not inspect.Signature.empty
    assert all(p.annotation is not inspect.Parameter.empty for p in signature.parameters.values())


def test_what_calls_give_is_shown_in_a_line(tmp_path):
    robot, world = ikde.load_robot("qiao2021"), ikde.load_world(CONFIGS / "worlds" / "kitchen.yaml")
    (tmp_path / "ur5.urdf").write_text(ikde.format_urdf(ikde.load_robot("ur5")))
    plan = ikde.load_track(CONFIGS / "tracks" / "qiao2022_task1.yaml")
    q = [robot.home] * 300
    grade = verify_track(plan.collision, plan.path, np.array(q), drive=plan.drive, limits=plan.limits)
    shown = [
        robot,
        world,
        *world.obstacles,
        *(solid for obstacle in world.obstacles for solid in obstacle.solids),
        ikde.CollisionModel.of(robot),
        ikde.check(robot, robot.home),
        ikde.check(robot, q),
        ikde.forward(robot, q),
        ikde.read_urdf(tmp_path / "ur5.urdf"),
        ikde.load_batch(CONFIGS / "runs" / "first_run.yaml"),
        plan,
        plan.path,
        grade,
        certify(plan.collision, np.array(q)),
        ikde.Target.from_rpy((1, 2, 3), (0.1, 0.2, 0.3)),
        ikde.Targets([(1, 2, 3)] * 300),
        ikde.SolveSettings.for_method("de"),
        ikde.ContinuationSettings(),
        ikde.ObjectMotion([0, 1], [[0, 0, 0], [1, 0, 0]]),
    ]
    assert {repr(each): len(repr(each)) for each in shown if len(repr(each)) > 400} == {}
    assert repr(world["shelf"]) == "<Obstacle shelf: 3 solids (box) at 0.899049, 0.0217889, 0.9 m in world>"
    assert repr(plan.path) == "<ToolPath Qiao 2022, task 1: 500 samples of 0.02 s, orientation free>"
