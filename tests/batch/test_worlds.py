"""Runs in worlds: what a run file says of them, rows that say where they are, and a world that was changed."""

import pickle

import numpy as np
import pytest

import ikde
from ikde.errors import FileError, InputError
from tests.batch.small import read_files

KITCHEN = """units: {length: mm}
obstacles:
  wall: {box: [100, 2000, 2000], position: [4000, 0, 1000]}
  can: {cylinder: {radius: 150, height: 600}, position: [900, 400, 800], margin: 5}
"""
PAIR = ["kitchen.yaml", {"path": "kitchen.yaml", "name": "moved", "move": {"can": {"by": [300, 300, 0], "turn": 90}}}]
KEYS = {
    "robot": "qiao2021",
    "units": {"length": "mm", "angle": "deg"},
    "targets": {"inline": [{"position": [950, 400, 900]}, {"position": [600, -300, 1000]}, {"position": [9e4, 0, 0]}]},
    "solve": {"method": "de", "settings": {"restarts": 3, "position_tolerance": 100, "de": {"generations": 40}}},
    "repeats": 4,
    "chunk": 5,
    "grade": ["typical"],
}


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Loads a run whose world file lies beside it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kitchen.yaml").write_text(KITCHEN, encoding="utf-8")

    def call(**keys):
        return ikde.load_batch(KEYS | keys)

    return call


def names(batch):
    return [(arm.name, arm.world) for arm in batch.arms]


def test_one_world_is_where_every_arm_is(load):
    batch = load(world="kitchen.yaml", arms={"near": {}, "far": {"margin": "20,LT=0"}})
    assert names(batch) == [("near", "kitchen"), ("far", "kitchen")]
    near, far = (arm.problem.collision for arm in batch.arms)
    assert near.world.names == ("wall", "can")
    assert (near.margin_m, far.margin_m, far.margins_m) == (0.0, 0.02, (("LT", 0.0),))
    known = batch.recipe["arms"]["far"]["world"]
    assert known == {"name": "kitchen", "digest": far.world.digest, "margin_m": 0.02, "margins_m": {"LT": 0.0}}
    assert "world" not in load().recipe["arms"]["de"]


def test_several_worlds_make_an_arm_each(load):
    batch = load(worlds=["none", "kitchen.yaml", {**PAIR[1], "count": 2}])
    assert [name for name, _ in names(batch)] == ["de-none", "de-kitchen", "de-moved-0", "de-moved-1"]
    worlds = [arm.problem.collision.world for arm in batch.arms]
    assert [len(world) for world in worlds] == [0, 2, 2, 2]
    shifts = np.array([w["can"].T_world_obstacle[:, 3] - worlds[1]["can"].T_world_obstacle[:, 3] for w in worlds[2:]])
    assert (np.abs(shifts[:, :2]) <= 0.3).all()
    assert len(np.unique(shifts[:, 0])) == 2
    assert (shifts[:, 2] == 0.0).all()
    again = load(worlds=[{**PAIR[1], "count": 2}])
    assert [arm.problem.collision.world.digest for arm in again.arms] == [w.digest for w in worlds[2:]]
    assert load(worlds=[{**PAIR[1], "count": 1}], seed=1).arms[0].problem.collision.world.digest != worlds[2].digest


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"world": "kitchen.yaml", "worlds": ["kitchen.yaml"]}, r"^worlds: expected one of world, worlds, got both$"),
        ({"worlds": ["kitchen.yaml"] * 2}, r"^worlds\[1\]: two worlds are called 'kitchen'; give one a `name`"),
        ({"worlds": [{"path": "kitchen.yaml", "name": "a b"}]}, r"^worlds\[0\]: 'a b' cannot name files; expected"),
        ({"world": {"path": "kitchen.yaml", "count": 2}}, r"^world.count: several of one world differ by what moves"),
        ({"world": {"path": "kitchen.yaml", "move": {"cann": {}}}}, r"^world.move.*'cann' \(did you mean 'can'\?\)"),
        ({"solve": {"margin": 5}}, r"^solve.margin: a margin needs a world to be kept from$"),
        ({"world": "kitchen.yaml", "solve": {"margin": "5,LTT=0"}}, r"^solve.margin.LTT: no component is called"),
        ({"world": "kitchen.yaml", "solve": {"detector": "none"}}, r"^solve.world: a world needs a detector"),
        ({"worlds": []}, r"^worlds: expected at least 1"),
    ],
)
def test_what_is_wrong_is_named(load, keys, message):
    with pytest.raises(InputError, match=message):
        load(**keys)


def test_a_run_picks_up_what_stands_in_each_of_its_worlds(load):
    attached = {"can": {"frame": "tool", "may_touch": ["wall"]}}
    batch = load(worlds=PAIR, attached=attached, solve={**KEYS["solve"], "near": {"q1": 30}})
    near = KEYS["robot"], dict(zip(batch.robot.joint_names, batch.arms[0].problem.near, strict=True))
    for arm in batch.arms:
        (thing,) = arm.problem.collision.world.attached
        assert (thing.name, thing.frame, thing.may_touch) == ("can", "tool", ("wall",))
        stood = ikde.forward(*near)["tool"] @ np.vstack([thing.T_frame_object, [0, 0, 0, 1]])
        assert np.allclose(stood[:3], thing.obstacle.T_world_obstacle, atol=1e-12)
        assert arm.world_file is None
        known = batch.recipe["arms"][arm.name]["world"]
        assert (known["digest"], known["attached"]) == (arm.problem.collision.world.digest, {"can": "tool"})
    typed = ikde.load_batch({**KEYS, "world": "kitchen.yaml"}, attach="can=tool:wall")
    assert typed.attach == "can=tool:wall"
    assert typed.hash == load(world="kitchen.yaml", attached=attached).hash
    assert pickle.loads(pickle.dumps(batch.arms[0].problem)).collision.world == batch.arms[0].problem.collision.world


@pytest.mark.parametrize(
    ("keys", "attach", "message"),
    [
        (
            {"world": "kitchen.yaml", "attached": {"cam": "tool"}},
            None,
            "^attached.cam: no obstacle is called",
        ),
        ({"worlds": ["none", "kitchen.yaml"], "attached": {"can": "tool"}}, None, r"^attached.can: no .* \(in none\)$"),
        ({"attached": {"can": "tool"}}, None, r"^attached: what is picked up is an obstacle of a `world`: name one$"),
        ({}, "can=tool", r"^attach: what is picked up is an obstacle of a `world`"),
        ({"world": "kitchen.yaml"}, "can", r"^attach: expected OBJECT=FRAME"),
        ({"world": "kitchen.yaml", "attached": {"can": "tool"}}, "can=tool", r"^attach.can: 'can' is attached to tool"),
        ({"world": "kitchen.yaml", "attached": {"can": {}}}, None, r"^attached.can.frame: this key is missing$"),
    ],
)
def test_what_cannot_be_picked_up_is_named(load, tmp_path, keys, attach, message):
    with pytest.raises(InputError, match=message):
        ikde.load_batch({**KEYS, **keys}, attach)


def test_what_does_not_fit_the_robot_is_named_in_the_worlds_file(load, tmp_path):
    with pytest.raises(FileError, match=r"^nowhere.yaml: "):
        load(world="nowhere.yaml")
    (tmp_path / "kitchen.yaml").write_text(KITCHEN.replace("margin: 5", "ignore: [wheel]"), encoding="utf-8")
    with pytest.raises(FileError, match=r"^kitchen.yaml:4 → obstacles.can.ignore\[0\]: no component is called 'wheel'"):
        load(world="kitchen.yaml", arms={"a": {}})


def test_rows_say_where_they_are_and_what_blocked(load, tmp_path):
    batch = load(worlds=["none", *PAIR])
    batch = pickle.loads(pickle.dumps(batch))
    summary = ikde.run_batch(batch, tmp_path / "one", threads=1)
    ikde.run_batch(batch, tmp_path / "two", threads=2)
    assert read_files(tmp_path / "one") == read_files(tmp_path / "two")
    rows = ikde.read_batch(tmp_path / "one").to_pylist()
    assert {row["arm"]: row["world"] for row in rows} == {f"de-{n}": n for n in ("none", "kitchen", "moved-0")}
    stopped = [row for row in rows if row["stop_reason"] == "world"]
    assert {(row["arm"], row["target"], row["blocker_a"], row["blocker_b"]) for row in stopped} == {
        ("de-kitchen", 0, "qiao2021", "can")
    }
    assert all(row["blocked"] > 0 for row in stopped)
    assert {row["blocker_b"] for row in rows if row["reached"]} == {None}
    assert {row["typical_collides"] for row in stopped} == {True}  # a further detector knows the world, too
    kitchen = next(arm for arm in summary.arms if arm.world == "kitchen")
    assert kitchen.blockers["can"] == len(stopped)


def test_a_changed_world_is_another_run(load, tmp_path):
    ikde.run_batch(load(world="kitchen.yaml"), tmp_path / "run")
    ikde.run_batch(load(world="kitchen.yaml"), tmp_path / "run")
    (tmp_path / "kitchen.yaml").write_text(KITCHEN.replace("400, 800", "400, 801"), encoding="utf-8")
    with pytest.raises(FileError, match=r"holds another run.*arms.de.world.digest: '[0-9a-f]+"):
        ikde.run_batch(load(world="kitchen.yaml"), tmp_path / "run")
