"""What came of a run, compared with the table of its answers."""

import numpy as np
import pyarrow as pa
import pytest

import ikde
from ikde.batch.manifest import read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part, read_table, seal_part, write_parts
from ikde.batch.sources import ListSource
from ikde.batch.statistics import Rate
from ikde.batch.summary import RunTally, summarise
from ikde.errors import FileError
from ikde.formats.reading import read_bytes
from tests.batch.small import BLINK, FAR, ROBOT, make_arm, make_batch
from tests.substitutes import never

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
        ("free", "de", "none"),
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


def test_only_what_was_checked_is_counted(run):
    _, summary, rows = run
    for arm, checked in zip(summary.arms, (0, 32), strict=True):
        verdicts = [row["verified"] for row in of_arm(rows, arm.name) if row["verified"] is not None]
        assert arm.verified == Rate(len(verdicts), len(verdicts))
        assert len(verdicts) < 32
        assert arm.collision_checked == checked == sum(row["collision"] is not None for row in of_arm(rows, arm.name))


def test_cost_is_spread_over_all_solves(run):
    folder, summary, rows = run
    seconds = ikde.read_batch(folder, timing=True)["solve_seconds"].to_numpy()
    for k, arm in enumerate(summary.arms):
        attempts = [row["attempts"] for row in of_arm(rows, arm.name)]
        assert arm.attempts.median == np.median(attempts)
        assert arm.attempts.max == max(attempts)
        assert arm.milliseconds.p95 == pytest.approx(1e3 * np.percentile(seconds[32 * k : 32 * k + 32], 95))


def test_an_unreached_target_is_listed_once_an_arm(run):
    _, summary, rows = run
    assert summary.unreached == sum(not row["reached"] for row in rows)
    assert summary.repeats == 8
    for arm in summary.arms:
        failures = [row for row in of_arm(rows, arm.name) if not row["reached"]]
        targets = sorted({row["target"] for row in failures})
        assert [row.target for row in arm.listed] == targets
        assert arm.unreached_targets == len(targets)
        for listed in arm.listed:
            mine = [row for row in failures if row["target"] == listed.target]
            assert listed.missed == len(mine)
            names = ("arm", "target_name", "repeat", "stop_reason", "reason")
            facts = (listed.arm, listed.name, listed.repeat, listed.stop_reason, listed.reason)
            assert facts == tuple(mine[0][key] for key in names)
        assert next(row.missed for row in arm.listed if row.name == "b") == 8  # of two parts


def test_an_unfinished_run_is_summarised_as_far_as_it_goes(tmp_path):
    ikde.run_batch(make_batch(arms=(make_arm("a", **BLINK), make_arm("b", **BLINK))), tmp_path)
    for path in (tmp_path / "solutions").glob("b-*"):
        path.unlink()
    summary = summarise(tmp_path)
    assert (summary.parts_done, summary.parts, summary.finished) == (5, 10, False)
    assert [arm.reached.total for arm in summary.arms] == [24, 0]
    assert summary.arms[1].attempts is summary.arms[1].milliseconds is None


def interrupt(parts):
    def tell(now):
        if now.parts_done >= parts:
            raise KeyboardInterrupt

    return tell


@pytest.fixture(scope="module")
def batch():
    source = ListSource(targets=[ikde.Target(point) for point in POINTS], names=tuple("abcd"))
    return make_batch(arms=ARMS, source=source, repeats=8, chunk=6, graders=(ROBOT.detectors["typical"],))


def test_what_is_solved_now_is_not_read(batch, tmp_path, substitute):
    substitute(read_table, never)
    summary = ikde.run_batch(batch, tmp_path)
    assert summary.finished


@pytest.mark.parametrize("threads", [1, 2])
def test_a_resumed_run_reads_once_what_was_there_and_counts_all(batch, tmp_path, substitute, threads):
    with pytest.raises(KeyboardInterrupt):
        ikde.run_batch(batch, tmp_path, threads=threads, progress=interrupt(5))
    there = sorted((tmp_path / "solutions").iterdir())
    hole = there.pop(2)  # what is there need not come first
    hole.unlink()
    assert len(there) >= 4
    seen, honest = [], read_bytes

    def watch(path, *arguments, **options):
        seen.append(path)
        return honest(path, *arguments, **options)

    substitute(read_bytes, watch)
    summary = ikde.run_batch(batch, tmp_path, threads=threads)
    assert sorted(path for path in seen if path in there) == there
    assert summary.finished
    assert summary == summarise(tmp_path)


def test_parts_may_be_counted_in_any_order(run):
    folder, summary, _ = run
    tally = RunTally(folder)
    parts = list(read_manifest(folder).list_parts())
    assert all(tally.find(part) for part in reversed(parts))
    assert tally.summary() == summary


def test_a_part_that_holds_something_else_is_done_again(batch, tmp_path):
    """With the right seal: whoever can write files can seal them."""
    first = ikde.run_batch(batch, tmp_path)
    part = Part("careful", 2, 12, 18)
    true, timing = (read_table(part.path(tmp_path, kind)) for kind in (SOLUTIONS, TIMING))
    for column, other in (("target", pa.array([0] * 6)), ("reached", pa.array(["yes"] * 6))):
        forged = true.set_column(true.column_names.index(column), column, other)
        write_parts(tmp_path, [seal_part(part, forged, timing, recipe=batch.hash)])
        with pytest.raises(FileError, match="is no part of this run"):
            summarise(tmp_path)
        told = []
        assert ikde.run_batch(batch, tmp_path, progress=told.append).arms[0] == first.arms[0]
        assert told[0].parts_found == 11
        assert read_table(part.path(tmp_path, SOLUTIONS)).equals(true)


def test_timing_that_holds_something_else_is_done_again(batch, tmp_path):
    ikde.run_batch(batch, tmp_path)
    part = Part("free", 0, 0, 6)
    true, timing = (read_table(part.path(tmp_path, kind)) for kind in (SOLUTIONS, TIMING))
    forged = timing.set_column(timing.column_names.index("solve_seconds"), "solve_seconds", pa.array([1e300] * 6))
    write_parts(tmp_path, [seal_part(part, true, forged, recipe=batch.hash)])
    told = []
    assert ikde.run_batch(batch, tmp_path, progress=told.append).arms[0].milliseconds.max < 1e6
    assert told[0].parts_found == 11


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    with pytest.raises(FileError, match="holds no run of ikde"):
        summarise(tmp_path)
