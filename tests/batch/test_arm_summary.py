"""What came of an arm: by target, and what was not reached."""

import pytest

import ikde
from ikde.batch import arm_summary as module
from ikde.batch.sources import ListSource
from ikde.batch.statistics import Rate
from tests.batch.small import FAR, ROBOT, make_arm, make_batch, make_targets

LOOSE = {"position_tolerance_m": 0.05}


def test_a_few_targets_are_counted_one_by_one(tmp_path):
    source = ListSource(targets=[ikde.Target((0.5, 0.2, 0.8)), ikde.Target(FAR)], names=("near", "far"))
    arms = (make_arm("free", detector="none", **LOOSE),)
    grader = ROBOT.detectors["typical"]
    summary = ikde.run_batch(make_batch(arms=arms, source=source, repeats=7, graders=(grader,)), tmp_path)
    rows = [row for row in ikde.read_batch(tmp_path).to_pylist() if row["target"] == 0]
    near, far = summary.arms[0].by_target
    assert (near.target, near.name, near.reached) == (0, "near", Rate(7, 7))
    assert near.collisions == {"typical": Rate(sum(row["typical_collides"] for row in rows), 7)}
    assert (far.target, far.name, far.reached) == (1, "far", Rate(0, 7))
    assert far.collisions == {"typical": Rate(0, 0)}
    assert near.collisions == summary.arms[0].collisions


@pytest.mark.parametrize(("count", "repeats"), [(1, 3), (11, 2), (5, 1)])
def test_other_runs_are_not(tmp_path, count, repeats):
    batch = make_batch(source=ListSource(targets=make_targets(count)), repeats=repeats)
    assert ikde.run_batch(batch, tmp_path).arms[0].by_target == ()


def test_columns_that_are_not_kept_are_missed_by_nobody(tmp_path):
    arm = ikde.run_batch(make_batch(columns=()), tmp_path).arms[0]
    assert arm.attempts is None
    assert arm.milliseconds is not None
    assert (arm.reached.count, arm.unreached_targets, len(arm.listed)) == (0, 12, 12)
    first = arm.listed[0]
    assert (first.name, first.repeat, first.missed, first.stop_reason, first.reason) == (None, 0, 2, "budget", None)


def test_of_very_many_unreached_targets_the_first_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "MAX_LISTED", 4)
    arm = ikde.run_batch(make_batch(), tmp_path).arms[0]
    assert [(row.target, row.missed) for row in arm.listed] == [(k, 2) for k in range(4)]
    assert arm.unreached_targets == 12
