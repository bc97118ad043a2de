"""What came of a run, compared with the table of its answers."""

import numpy as np
import pytest

import ikde
from ikde.batch.sources import ListSource
from ikde.batch.statistics import Rate
from ikde.batch.summary import LISTED, summarise
from ikde.errors import FileError
from tests.batch.small import BLINK, FAR, ROBOT, make_arm, make_batch

LOOSE = {"position_tolerance_m": 0.02, "restarts": 3, "generations": 60, "population": 20}
ARMS = (make_arm("free", detector="none", **LOOSE), make_arm("careful", method="de", **LOOSE))
POINTS = [(0.5, 0.2, 0.8), FAR, (0.3, 0.0, 0.5), (0.6, -0.3, 1.0)]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Folder, summary and table of a run."""
    folder = tmp_path_factory.mktemp("run")
    source = ListSource(targets=[ikde.Target(point) for point in POINTS], names=tuple("abcd"))
    graders = (ROBOT.detectors["typical"], ROBOT.detectors["improved"])
    summary = ikde.run_batch(make_batch(arms=ARMS, source=source, repeats=8, chunk=6, graders=graders), folder)
    return folder, summary, ikde.read_batch(folder).to_pylist()


def of_arm(rows, name):
    return [row for row in rows if row["arm"] == name]


def test_a_summary_can_be_had_again(run):
    folder, summary, _ = run
    assert summarise(folder) == summary
    assert (summary.parts_done, summary.parts, summary.finished) == (12, 12, True)
    assert (summary.name, summary.robot, summary.seed) == ("small", "qiao2021", 7)


def test_each_arm_is_counted(run):
    _, summary, rows = run
    assert [(arm.name, arm.method, arm.detector) for arm in summary.arms] == [
        ("free", "auto", "none"),
        ("careful", "de", "improved"),
    ]
    for arm in summary.arms:
        mine = of_arm(rows, arm.name)
        reached = [row for row in mine if row["reached"]]
        assert arm.reached == Rate(len(reached), 32)
        assert 0 < len(reached) < 32
        assert arm.stop_reasons == {
            reason: sum(row["stop_reason"] == reason for row in mine) for reason in arm.stop_reasons
        }
        assert sum(arm.stop_reasons.values()) == 32
        for grader in ("typical", "improved"):
            assert arm.collisions[grader] == Rate(sum(row[f"{grader}_collides"] for row in reached), len(reached))
    assert summary.arms[1].collisions["improved"].count == 0  # what the search looked at is free


def test_cost_is_spread_over_all_solves(run):
    folder, summary, rows = run
    seconds = ikde.read_batch(folder, timing=True)["solve_seconds"].to_numpy()
    for k, arm in enumerate(summary.arms):
        attempts = [row["attempts"] for row in of_arm(rows, arm.name)]
        assert arm.attempts.median == np.median(attempts)
        assert arm.attempts.max == max(attempts)
        assert arm.milliseconds.p95 == pytest.approx(1e3 * np.percentile(seconds[32 * k : 32 * k + 32], 95))


def test_the_first_unreached_are_listed(run):
    _, summary, rows = run
    failures = [row for row in rows if not row["reached"]]
    assert summary.unreached == len(failures)
    assert [(row.arm, row.target, row.name, row.repeat, row.stop_reason, row.reason) for row in summary.listed] == [
        tuple(row[key] for key in ("arm", "target", "target_name", "repeat", "stop_reason", "reason"))
        for row in failures[:LISTED]
    ]
    assert {row.name for row in summary.listed} >= {"b"}


def test_columns_that_are_not_kept_are_missed_by_nobody(tmp_path):
    summary = ikde.run_batch(make_batch(columns=()), tmp_path)
    assert summary.arms[0].attempts is None
    assert summary.arms[0].milliseconds is not None
    assert (summary.unreached, len(summary.listed)) == (24, LISTED)
    assert summary.listed[0].reason is summary.listed[0].name is None
    assert summary.listed[0].stop_reason == "budget"


def test_an_unfinished_run_is_summarised_as_far_as_it_goes(tmp_path):
    ikde.run_batch(make_batch(arms=(make_arm("a", **BLINK), make_arm("b", **BLINK))), tmp_path)
    for path in (tmp_path / "solutions").glob("b-*"):
        path.unlink()
    summary = summarise(tmp_path)
    assert (summary.parts_done, summary.parts, summary.finished) == (5, 10, False)
    assert [arm.reached.total for arm in summary.arms] == [24, 0]
    assert summary.arms[1].attempts is summary.arms[1].milliseconds is None


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    with pytest.raises(FileError, match="holds no run of ikde"):
        summarise(tmp_path)
