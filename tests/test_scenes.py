"""`benchmarks/scenes.py` reads a scene and a request as they are meant, and its distances are those of `check`."""

import importlib
from pathlib import Path

import numpy as np
import pytest

import ikde

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
URDF = """<robot name="two">
  <link name="stand"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="arm">
    <collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.05"/></geometry></collision>
    <collision><origin xyz="0 0 0.3" rpy="1 0 0"/><geometry><sphere radius="0.04"/></geometry></collision>
  </link>
  <link name="hand"><collision><origin xyz="0.05 0 0"/><geometry><sphere radius="0.03"/></geometry></collision></link>
  <link name="tip"/>
  <joint name="turn" type="revolute">
    <parent link="stand"/><child link="arm"/><origin xyz="0 0.1 0.2" rpy="0.3 -0.2 0.1"/><axis xyz="0 1 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="arm"/><child link="hand"/><origin xyz="0 0 0.4" rpy="0 0.5 0"/><axis xyz="0 0 2"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/>
  </joint>
  <joint name="end" type="fixed"><parent link="hand"/><child link="tip"/><origin xyz="0 0 0.1"/></joint>
</robot>
"""
SCENE = """
world:
  collision_objects:
    - id: can
      header: {frame_id: stand}
      pose: {position: [0.1, 0.6, 0.2], orientation: [0.5, 0.5, 0.5, 0.5]}
      primitives: [{type: cylinder, dimensions: [0.3, 0.06]}]
      primitive_poses: [{position: [0, 0.1, 0], orientation: [0, 0.6, 0, 0.8]}]
    - id: board
      primitives: [{dimensions: [0.4, 0.1, 0.02], type: box}]
      primitive_poses: [{orientation: [0, 0, 0.6, 0.8], position: [-0.2, 0.1, 0.9]}]
"""
REQUEST = """
goal_constraints:
  - joint_constraints:
      - {position: 0.25, joint_name: slide}
      - {joint_name: turn, position: -1.5}
"""


@pytest.fixture
def problem(tmp_path, monkeypatch):
    """The script, a folder's robot and twin, and its only scene."""
    monkeypatch.syspath_prepend(BENCHMARKS.parent)
    module = importlib.import_module("benchmarks.scenes")
    (tmp_path / "two_spheres.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "two.srdf").write_text('<robot name="two"/>', encoding="utf-8")
    (tmp_path / "problems" / "shelf_two").mkdir(parents=True)
    for name, text in (("scene0001.yaml", SCENE), ("request0001.yaml", REQUEST)):
        (tmp_path / "problems" / "shelf_two" / name).write_text(text, encoding="utf-8")
    monkeypatch.setitem(module.TOOLS, "two", "tip")
    ((family, (pair,)),) = module.find_pairs(tmp_path).items()
    assert family == "shelf_two"
    return module, *module.read_robot(tmp_path)[1:], pair.scene


def test_a_goal_is_read_by_name(problem):
    module, robot, _, scene = problem
    goal = module.read_goal(module.read_request(scene.with_name("request0001.yaml")), robot)
    assert dict(zip(robot.joint_names, goal.tolist(), strict=True)) == {"turn": -1.5, "slide": 0.25}


def test_its_poses_and_distances_are_those_of_forward_and_check(problem):
    module, robot, twin, scene = problem
    model, entries = ikde.CollisionModel.of(robot).in_world(ikde.load_world(scene)), module.read_yaml(scene)
    named = set()
    for q in np.random.default_rng(0).uniform(robot.lower, robot.upper, (200, 2)):
        values = dict(zip(robot.joint_names, q.tolist(), strict=True))
        gap, link, name = twin.nearest(values, entries)
        worst = ikde.check(robot, q, collision=model).obstacles[0]
        assert gap == pytest.approx(worst.clearance_m, abs=1e-12)
        assert (link, name) == (worst.component, worst.obstacle)
        np.testing.assert_allclose(twin.place_links(values)["tip"], ikde.forward(robot, q)["tip"], atol=1e-12)
        named.add(name)
    assert named == {"can", "board"}


def test_what_touches_is_called_wrong(problem):
    module, _, twin, scene = problem
    tally = module.Tally()

    class Claimed:
        reached, stop_reason, joint_names = True, "reached", ("turn", "slide")
        q = np.array([-1.5, 0.25])

    module.judge(Claimed, Claimed.q, twin, scene, tally, 0.0)
    assert (tally.solved, tally.wrong) == (1, [])
    module.judge(Claimed, Claimed.q + 1e-3, twin, scene, tally, 10.0)
    assert tally.table()["wrong"] == tally.wrong
    assert [line.split(": ")[0] for line in tally.wrong] == ["shelf_two/scene0001"] * 2
