"""Targets of a run file: every way to give them, and what is wrong named by its key."""

import numpy as np
import pytest

import ikde
from ikde.batch.arms import make_arm
from ikde.batch.recipe import digest
from ikde.batch.spec import BatchSpec, SolveEntry
from ikde.batch.targets import make_source
from ikde.errors import InputError
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text

UNITS = {"length": "mm", "angle": "deg"}
DOWN = {"axis": [0, 0, -1]}
GRID = {"from": [0, 0, 0], "to": [1000, 0, 500], "counts": [3, 1, 2]}
BOX = {"from": [0, 0, 0], "to": [1000, 1, 500], "count": 4}
BALL = {"center": [1000, 0, 0], "radius": 500, "count": 4}


@pytest.fixture
def make(qiao, tmp_path):
    def call(solve=None, units=UNITS, freedom=None, **targets):
        known = {"robot": "qiao2021", "units": units, "targets": targets, "solve": solve or {}}
        spec = BatchSpec.model_validate(known if freedom is None else {**known, "freedom": freedom})
        return make_source(spec, make_arm("a", qiao, spec.solve, spec.units).problem, tmp_path)

    return call


@pytest.fixture
def complaint(make):
    def call(**targets):
        with pytest.raises(InputError) as caught:
            make(**targets)
        return str(caught.value)

    return call


def test_inline_targets_may_differ_in_kind(make):
    entries = [{"position": [1, 2, 3]}, {"position": [0, 0, 1000], **DOWN}, {"position": [0, 0, 0], "rpy": [0, 0, 90]}]
    targets = make(inline=entries)[0].read(0, 3)
    assert [t.kind for t in targets] == ["position", "axis", "pose"]
    np.testing.assert_array_equal(targets[0].p_world_tool, [1e-3, 2e-3, 3e-3])
    np.testing.assert_array_equal(targets[2].R_world_tool, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_inline_targets_may_have_names(make):
    assert make(inline=[{"position": [1, 2, 3]}])[0].names is None
    source, _ = make(inline=[{"position": [1, 2, 3], "name": "a"}, {"position": [1, 2, 3]}])
    assert source.names == ("a", "target 1")


@pytest.mark.parametrize(("key", "entry", "count"), [("grid", GRID, 6), ("box", BOX, 4), ("sphere", BALL, 4)])
def test_points_are_in_metres_with_an_orientation(make, key, entry, count):
    source, _ = make(**{key: {**entry, "orientation": DOWN}})
    targets = source.read(0, 99)
    assert len(targets) == source.count == count
    assert {t.kind for t in targets} == {"axis"}
    assert max(np.abs(t.p_world_tool).max() for t in targets) <= 1.5


def test_reachable_targets_lie_in_the_ranges_of_solve(make):
    source, recipe = make(
        solve={"ranges": {"d_x": [-10, 10]}, "freeze": {"d_y": 100}}, reachable={"count": 5, "goal": "axis"}
    )
    ranges = recipe["reachable"]["ranges"]
    assert (ranges["d_x"], ranges["d_y"]) == ([-0.01, 0.01], [0.1, 0.1])
    assert (recipe["reachable"]["detector"]["name"], source.read(0, 1)[0].kind) == ("improved", "axis")


def test_reachable_targets_of_a_joint_without_limits_are_drawn_once_around_home(tmp_path):
    robot = load_text(ENDLESS)
    spec = BatchSpec.model_validate({"robot": "r", "units": UNITS, "targets": {"reachable": {"count": 5}}})
    problem = make_arm("a", robot, SolveEntry.model_validate({"near": {"pan": 9000}}), spec.units).problem
    recipe = make_source(spec, problem, tmp_path)[1]["reachable"]
    assert recipe["ranges"]["pan"] == [-np.pi, np.pi]
    assert recipe["ranges"]["spin"] == [-0.5 * np.pi, 1.5 * np.pi]
    digest(recipe)


def test_a_table_counts_by_its_numbers_and_not_by_its_name(make, tmp_path):
    for name, unit in (("a.csv", "m"), ("b.csv", "mm")):
        (tmp_path / name).write_text("x,y,z\n" + ("0.5,1,2\n" if unit == "m" else "500,1000,2000\n"))
    columns = {"position": ["x", "y", "z"]}
    recipes = [
        make(file={"path": name, "columns": columns, "units": {"length": unit}})[1]
        for name, unit in (("a.csv", "m"), ("b.csv", "mm"))
    ]
    assert recipes[0] == recipes[1]
    assert recipes[0]["file"]["count"] == 1


@pytest.mark.parametrize(
    ("targets", "expected"),
    [
        ({}, "targets: expected one of inline, goals, file, reachable, grid, box, sphere, got none"),
        ({"grid": GRID, "box": BOX}, "targets.box: expected one of inline, goals, file"),
        ({"goals": [{"position": [1, 2, 3]}, {"position": [1, 2, 3], "box": -1}]}, "targets.goals[1].box: inside out"),
        ({"goals": [{"position": [1, 2, 3]}], "freedom": {"box": 1}}, "freedom: `goals` say by themselves"),
        (
            {"inline": [{"position": [1, 2, 3], **DOWN}, {"position": [1, 2, 3]}], "freedom": {"cone": 1}},
            "freedom.cone",
        ),
        ({"grid": GRID, "freedom": {"turn": {}}}, "freedom.turn: a turn is about an axis of a full pose"),
        ({"inline": [{"position": [1, 2, 3], "axis": [0, 0, 0]}]}, "targets.inline[0].axis: an axis of length 0"),
        (
            {"inline": [{"position": [1, 2, 3], "rpy": [0, 0, 0], **DOWN}]},
            "targets.inline[0].rpy: axis and rpy both ask for an orientation; give one",
        ),
        (
            {"box": {**BOX, "orientation": {"quat_wxyz": [0, 0, 0, 0]}}},
            "targets.box.orientation.quat_wxyz: a quaternion of length 0",
        ),
        ({"reachable": {"count": 3, "detector": "typcal"}}, "targets.reachable.detector: qiao2021 has no detector"),
        (
            {"file": {"path": "none.csv", "columns": {"position": ["x", "y", "z"]}}},
            "targets.file.path: no such file: ",
        ),
    ],
)
def test_what_is_wrong_is_named(make, complaint, targets, expected):
    assert complaint(**targets).startswith(expected)


@pytest.mark.parametrize(
    ("targets", "key"),
    [
        ({"inline": [{"position": [1, 2, 1e9]}]}, "inline[0].position"),
        ({"grid": {**GRID, "from": [0, -1e8, 0]}}, "grid.from"),
        ({"box": {**BOX, "to": [1e7, 0, 0]}}, "box.to"),
        ({"sphere": {**BALL, "center": [2e6, 0, 0]}}, "sphere.center"),
        ({"sphere": {**BALL, "center": [-1e6, 0, 0]}}, "sphere.radius"),
    ],
)
def test_targets_beyond_a_thousand_kilometres_are_refused(complaint, targets, key):
    message = complaint(units={"length": "m"}, **targets)
    assert message.startswith(f"targets.{key}: expected finite numbers up to 1e+06")


CORNERS = [[0, 0], [1000, 0], [1000, 1000]]


def test_goals_with_freedom_may_have_names(make):
    entries = [{"position": [1, 2, 3], "box": 5, "name": "near"}, {"position": [1, 2, 3]}]
    source, recipe = make(goals=entries)
    first, second = source.read(0, 9)
    assert (source.count, source.names) == (2, ("near", "target 1"))
    assert first == Region.box((1e-3, 2e-3, 3e-3), 5e-3)
    assert second == Target((1e-3, 2e-3, 3e-3))
    assert digest(recipe) != digest(make(goals=entries[:1])[1])
    assert digest(recipe) != digest(make(goals=entries, units={"length": "m"})[1])


def test_freedom_makes_goals_of_the_targets_of_any_source(make):
    plain, exact = make(grid=GRID)
    source, recipe = make(grid=GRID, freedom={"box": 5, "base": {"corners": CORNERS}})
    goals, targets = source.read(1, 99), plain.read(1, 99)
    assert (source.count, source.names, len(goals)) == (6, None, 5)
    base = BaseRegion(np.array(CORNERS) / 1e3)
    assert goals == [Region.box(target, 5e-3).with_base(base) for target in targets]
    assert {key: recipe[key] for key in exact} == exact
    assert digest(recipe) != digest(make(grid=GRID, freedom={"box": 5})[1])


def test_a_base_that_may_stand_somewhere_needs_one(tmp_path):
    ways = {"goals": [{"position": [0, 0, 0], "base": {"corners": CORNERS}}]}, {"inline": [{"position": [0, 0, 0]}]}
    for targets, freedom in ((ways[0], None), (ways[1], {"base": {"corners": CORNERS}})):
        more = {"freedom": freedom} if freedom else {}
        spec = BatchSpec.model_validate({"robot": "ur5", "targets": targets, **more})
        problem = make_arm("a", ikde.load_robot("ur5"), spec.solve, spec.units).problem
        with pytest.raises(InputError, match=r"(goals\[0\]|freedom).base: ur5 has no planar base"):
            make_source(spec, problem, tmp_path)
