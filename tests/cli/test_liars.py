"""Kernels that lie: nothing public calls a target reached, or a path followed, because they say so.

They claim a configuration that collides, leaves its limits, or misses the target. Where they are alone, nothing is
reached; another engine may find an honest answer, which the naive twins of `tests/reference.py` then accept.
"""

import re

import numpy as np
import pytest
import yaml

import ikde
from ikde.kernels.tracking import track_span
from ikde.model.collision_model import CollisionModel
from ikde.solver.settings import BulkOptions
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from tests import reference
from tests.three_joints import FILE, ROBOT, free_q, is_met, meet
from tests.written import Liar, written_kernels

ALONE = ikde.SolveSettings(method="lm", restarts=8)
HELPED = ikde.SolveSettings(restarts=2)
OFF_M = 2.0 * ALONE.position_tolerance_m


def find_touching():
    """A configuration inside the limits whose hand is in the post or the floor."""
    rng, detector = np.random.default_rng(5), CollisionModel.of(ROBOT).detector
    while True:
        q = rng.uniform(ROBOT.lower, ROBOT.upper)
        if reference.compute_clearance(ROBOT, detector, q)[0] < -0.02:
            return q


def find_outside():
    """A free configuration with a joint beyond its limit."""
    q = free_q(1)[0].copy()
    q[0] = ROBOT.upper[0] + 0.2
    return q


LIES = {"colliding": (find_touching(), 0.0), "outside": (find_outside(), 0.0), "off": (free_q(1)[0], OFF_M)}
each_kind = pytest.mark.parametrize("kind", ["position", "pose"])


@pytest.fixture(params=LIES)
def lie(request):
    """What the liars claim [3], and how far off its target the tool is there, in m."""
    return LIES[request.param]


@pytest.fixture
def liar(lie, monkeypatch):
    """Kernels written for robots are exchanged; in the end they must have been believed by somebody's search."""
    told = Liar(lie[0])
    with written_kernels(monkeypatch, told.change):
        yield told
    assert told.claims


def ask(lie, kind):
    """The target that the lie is about."""
    q, off_m = lie
    return meet(ROBOT, q, kind, shift=(0.0, 0.0, off_m))


def assert_honest(target, result):
    """What is called reached is."""
    assert is_met(ROBOT, target, result.q, result.settings) or not result.reached
    assert is_met(ROBOT, target, result.q, result.settings) or not result.grade.accepted


@each_kind
def test_the_lies_are_lies(lie, kind):
    assert not is_met(ROBOT, ask(lie, kind), lie[0], ALONE)


@each_kind
def test_one_solve_does_not_believe_them(lie, liar, kind):
    target = ask(lie, kind)
    assert not ikde.solve(ROBOT, target, ALONE).reached
    assert_honest(target, ikde.solve(ROBOT, target, HELPED))
    for options in ({"near": lie[0]}, {"freeze": {"reach": float(lie[0][2])}}):
        assert not ikde.solve(ROBOT, target, ALONE, **options).reached


@pytest.mark.parametrize("verify", ["all", "sample", "none"])
@each_kind
def test_many_solves_do_not_believe_them(lie, liar, kind, verify):
    target = ask(lie, kind)
    for count in (1, 6):
        alone = ikde.solve_many(ROBOT, [target] * count, ALONE, bulk=BulkOptions(verify=verify))
        assert not alone.reached.any()
        assert not any(result.reached for result in alone)
        for result in ikde.solve_many(ROBOT, [target] * count, HELPED, bulk=BulkOptions(verify=verify, explain=False)):
            assert_honest(target, result)


@each_kind
def test_distinct_solutions_do_not_believe_them(lie, liar, kind):
    target = ask(lie, kind)
    assert not any(result.reached for result in ikde.solve_distinct(ROBOT, target, 3, ALONE))
    for result in ikde.solve_distinct(ROBOT, target, 3, HELPED):
        assert_honest(target, result)


def run_of(lie):
    """A run of both arms over the lie's targets."""
    target = ask(lie, "position")
    return {
        "name": "lies",
        "robot": str(FILE),
        "targets": {"inline": [{"position": target.p_world_tool.tolist()}]},
        "repeats": 6,
        "arms": {"alone": {"method": "lm", "settings": {"restarts": 8}}, "helped": {"settings": {"restarts": 2}}},
        "grade": ["balls"],
    }


def assert_honest_table(lie, table):
    target, rows = ask(lie, "position"), table.to_pylist()
    assert len(rows) == 12
    for row in rows:
        q = [row[f"q_{name}"] for name in ROBOT.joint_names]
        assert not row["reached"] or (row["arm"] == "helped" and is_met(ROBOT, target, q, HELPED))
        touches = reference.compute_clearance(ROBOT, CollisionModel.of(ROBOT).detector, np.array(q))[0] <= 0.005
        assert row["balls_collides"] == touches


def test_a_batch_does_not_believe_them(lie, liar, tmp_path):
    summary = ikde.run_batch(ikde.load_batch(run_of(lie)), tmp_path / "run")
    assert summary.arms[0].reached.count == 0
    assert_honest_table(lie, ikde.read_batch(tmp_path / "run"))


@pytest.mark.parametrize("count", [1, 3])
def test_the_command_solve_does_not_believe_them(lie, liar, cli, count):
    target = ask(lie, "position")
    command = ("solve", "--robot", FILE, "--position", *map(repr, target.p_world_tool.tolist()), "--count", count)
    for options in (("--method", "lm", "--restarts", 8), ("--restarts", 2)):
        outcome, told = cli(*command, *options), cli(*command, *options, "--json")
        assert outcome.code == told.code
        solutions = told.data.get("solutions", [told.data])
        for solution in solutions:
            met = is_met(ROBOT, target, list(solution["q"].values()), HELPED)
            assert not solution["reached"] or (met and "lm" not in options)
        reached = sum(solution["reached"] for solution in solutions)
        assert len(re.findall("^reached by three_joints: ", outcome.out, flags=re.MULTILINE)) == reached
        assert (told.code == 0) == (reached == count)


def test_the_command_batch_does_not_believe_them(lie, liar, cli, tmp_path):
    (tmp_path / "lies.yaml").write_text(yaml.safe_dump(run_of(lie)))
    assert cli("batch", tmp_path / "lies.yaml", "--out", tmp_path / "run").code == 1
    assert_honest_table(lie, ikde.read_batch(tmp_path / "run"))


# ---- paths


def stand_at(lie, samples=3):
    """A path that stays at the lie's target."""
    return ToolPath.through(np.tile(ask(lie, "position").p_world_tool, (samples + 1, 1)), dt_s=0.02)


def assert_honest_motion(path, motion):
    """A motion that is called followed meets its path, inside all limits and free of collision."""
    settings = ikde.SolveSettings(position_tolerance_m=2e-6)  # 1e-6 m along each axis
    met = [is_met(ROBOT, ikde.Target(p), q, settings) for p, q in zip(path.p_world_tool, motion.q, strict=False)]
    assert not motion.reached or (all(met) and len(met) == path.samples + 1)


def track_of(lie, folder):
    """The same as a file."""
    formulas = dict(zip("xyz", ask(lie, "position").p_world_tool.tolist(), strict=True))
    track = {"robot": str(FILE), "dt_s": 0.02, "samples": 3, "path": {"expressions": formulas}}
    (folder / "lies.yaml").write_text(yaml.safe_dump(track))
    return folder / "lies.yaml"


@pytest.mark.parametrize("method", ["continuation", "optimized", "typical"])
def test_starts_that_lie_are_no_starts(lie, liar, cli, tmp_path, method):
    path = stand_at(lie)
    motion = ikde.follow_path(ROBOT, path, method=method)
    assert_honest_motion(path, motion)
    outcome = cli("track", track_of(lie, tmp_path), "--method", method, "--json")
    assert (outcome.code, outcome.data["reached"]) == (0 if motion.reached else 1, motion.reached)


def test_steps_that_lie_are_no_motion(lie, substitute, cli, tmp_path):
    def boast(*arguments):
        first, last, q, least = arguments[5], arguments[6], arguments[8], arguments[12]
        q[first + 1 : last + 1], least[first + 1 : last + 1] = lie[0], np.inf
        return last, 0

    substitute(track_span, boast)
    fast = MotionLimits.of(ROBOT, speed=None)  # so that nothing but the lie is in the way
    assert not ikde.follow_path(ROBOT, stand_at(lie), limits=fast).reached
    outcome = cli("track", track_of(lie, tmp_path), "--json")
    assert (outcome.code, outcome.data["reached"]) == (1, False)
    assert not cli("track", track_of(lie, tmp_path)).out.startswith("followed:")
