"""What stands in the columns of a part."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import ikde
from ikde.batch.columns import make_solutions, make_timing
from ikde.batch.parts import serialize
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import rotation_from_quat_wxyz
from ikde.solver.columns import GROUPS, WORDS
from ikde.solver.results import solve_rows
from ikde.solver.settings import BulkOptions
from tests.batch.small import FAR, ROBOT, make_arm
from tests.problems import problem_of
from tests.scara import make_scara

NUMBERS = np.arange(5, 9)  # targets 2, 3, 3, 4 of two repeats each
POSE = rotation_from_quat_wxyz(np.array([0.5, 0.5, -0.5, 0.5]))
ALWAYS = ["arm", "target", "target_name", "repeat", "reached", "collision", "verified", "stop_reason"]


@pytest.fixture(scope="module")
def rows():
    near = ikde.Target((0.6, 0.3, 0.9), axis_world_tool=(0, 0, -2))
    targets = [ikde.Target((0.5, 0.2, 0.8)), near, ikde.Target((0.6, 0.3, 0.9), POSE), ikde.Target(FAR)]
    return solve_rows(make_arm().problem, targets, seed=3, first_stream=5)


def tabulate(rows, **changes):
    facts = {"numbers": NUMBERS, "repeats": 2, "names": list("wxyz"), "groups": tuple(GROUPS), "graders": ()}
    return make_solutions("a", rows, **(facts | changes))


def test_a_solve_is_known_by_arm_target_and_repeat(rows):
    table = tabulate(rows).to_pydict()
    assert table["arm"] == ["a"] * 4
    assert table["target"] == [2, 3, 3, 4]
    assert table["target_name"] == list("wxyz")
    assert table["repeat"] == [1, 0, 1, 0]


def test_the_verdict_is_that_of_the_rows(rows):
    table = tabulate(rows).to_pydict()
    assert table["reached"] == [True, True, True, False]
    assert table["collision"] == [False] * 3 + [rows.row(3).collision]
    assert table["verified"] == [True] * 4
    assert table["stop_reason"] == ["reached"] * 3 + ["out_of_reach"]
    assert set(table["stop_reason"]) <= set(WORDS)


def test_figures_are_those_of_the_rows_to_the_last_bit(rows):
    table = tabulate(rows)
    q = np.column_stack([table[f"q_{name}"].to_numpy() for name in ROBOT.joint_names])
    assert np.array_equal(q, rows.q)
    for k in range(4):
        row, result = table.slice(k, 1).to_pylist()[0], rows.row(k)
        assert row["position_error_m"] == pytest.approx(result.position_error_m, abs=1e-11)
        assert row["orientation_error_rad"] == pytest.approx(result.orientation_error_rad, abs=1e-11)
        assert row["clearance_m"] == pytest.approx(result.clearance_m, abs=1e-11)
        assert (row["pair_a"], row["pair_b"]) == result.closest_pair
        assert (row["attempts"], row["evaluations"]) == (result.attempts, result.evaluations)
        assert row["rejected"] == result.rejected


def test_reasons_are_those_of_failures(rows):
    table = tabulate(rows).to_pydict()
    assert table["reason"] == [None] * 3 + [rows.row(3).reason]
    assert table["hint"] == [None] * 3 + [rows.row(3).hint]


def test_targets_are_given_back(rows):
    table = tabulate(rows).to_pydict()
    assert table["target_kind"] == ["position", "axis", "pose", "position"]
    assert (table["target_x_m"][3], table["target_z_m"][0]) == (9.0, 0.8)
    quats = list(zip(*(table[f"target_q{k}"] for k in "wxyz"), strict=True))
    assert quats[0] == quats[3] == (None,) * 4
    assert quats[2] == pytest.approx((0.5, 0.5, -0.5, 0.5))
    assert rotation_from_quat_wxyz(np.array(quats[1]))[:, 2] == pytest.approx([0, 0, -1])


def test_each_grader_adds_its_columns(rows):
    table = tabulate(rows, graders=(ROBOT.detectors["typical"],))
    for k, row in enumerate(table.to_pylist()):
        seen = ikde.check(ROBOT, rows.q[k], "typical")
        assert row["typical_clearance_m"] == pytest.approx(seen.clearance_m, abs=1e-11)
        assert row["typical_collides"] == seen.collision
        nearest = [pair for pair in seen.pairs if pair.clearance_m <= seen.pairs[0].clearance_m + 1e-11]  # may be two
        assert (row["typical_pair_a"], row["typical_pair_b"]) in [(pair.a, pair.b) for pair in nearest]


def test_reasons_that_are_not_looked_into_tell_angles_apart():
    """What is off by another angle has another reason, also where all that was counted is the same."""
    problem = problem_of(make_scara(), ikde.SolveSettings(restarts=1))
    targets = [ikde.Target((0.74, 0.1, 0.0), axis_world_tool=(np.sin(a), 0.0, -np.cos(a))) for a in (0.2, 0.3, 0.2)]
    rows = solve_rows(problem, targets, BulkOptions(explain=False), seed=1)
    table = tabulate(rows, numbers=np.arange(3), repeats=1, names=None).to_pydict()
    told = [f"out of reach: at least 0.{off} rad off in orientation, whatever the joints do" for off in (199, 299, 199)]
    assert table["reason"] == [row.reason for row in rows] == told


def read_back(table):
    """A table as its Parquet file holds it."""
    return pq.read_table(pa.BufferReader(serialize(table))).to_pydict()


def test_without_a_detector_clearance_and_collision_are_null():
    rows = solve_rows(make_arm(detector="none").problem, [ikde.Target((0.5, 0.2, 0.8))], seed=1)
    table = read_back(tabulate(rows, numbers=NUMBERS[:1], names=None))
    assert [table[name] for name in ("clearance_m", "pair_a", "pair_b", "collision")] == [[None]] * 4
    assert table["reached"] == [True]


def test_what_plain_numpy_did_not_grade_is_null():
    targets = [ikde.Target((0.5, 0.2, 0.8))] * 3
    rows = solve_rows(make_arm().problem, targets, seed=1, first_stream=4094, bulk=BulkOptions())
    table = read_back(tabulate(rows, numbers=np.arange(4094, 4097), names=None))
    assert table["verified"] == [True, True, None]
    assert table["collision"] == [False] * 3


def test_a_grader_that_compares_nothing_gives_nulls(rows):
    robot = replace(ROBOT, pair_lists={**ROBOT.pair_lists, "nothing": ()})
    nothing = ikde.Detector(name="it", spheres="typical", pairs="nothing")
    blind = replace(rows, problem=replace(rows.problem, collision=CollisionModel.of(robot)))
    table = tabulate(blind, graders=(nothing,)).to_pydict()
    assert table["it_collides"] == table["it_clearance_m"] == [None] * 4


def test_only_the_groups_asked_for_are_there(rows):
    assert tabulate(rows, groups=()).column_names == ALWAYS
    assert tabulate(rows, groups=("cost",)).column_names == [*ALWAYS, "attempts", "evaluations", "rejected"]
    assert "target_name" not in tabulate(rows, names=None).column_names


def test_the_order_of_groups_does_not_matter(rows):
    assert tabulate(rows, groups=("cost", "q")).equals(tabulate(rows, groups=("q", "cost")))


def test_timing_holds_what_hangs_on_the_machine(rows):
    table = make_timing("a", rows, numbers=NUMBERS, repeats=2)
    assert table.column_names == ["arm", "target", "repeat", "solve_seconds", "host"]
    assert np.array_equal(table["solve_seconds"].to_numpy(), rows.found.seconds)
