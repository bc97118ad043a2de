"""What would run, and for how long."""

from contextlib import contextmanager

import pytest

import ikde
from ikde.batch.preview import preview_batch
from ikde.batch.sources import GoalSource, ListSource
from ikde.batch.task import solve_task
from ikde.model.region import Region
from ikde.solver.engine_table import SEVERAL
from tests.batch.small import BLINK, ROBOT, make_arm, make_batch, make_targets, read_files

ROBOT_TOOL = ikde.Target((0.8, 0.1, 0.9))
ARMS = (make_arm("a", **BLINK), make_arm("b", detector="none", **BLINK))


@pytest.fixture
def batch():
    return make_batch(arms=ARMS, repeats=5, chunk=20, graders=(ROBOT.detectors["typical"],))


def test_it_says_what_would_run(batch):
    preview = preview_batch(batch, threads=1)
    assert (preview.targets, preview.repeats, preview.solves, preview.parts) == (12, 5, 120, 6)
    assert [(arm.name, arm.detector) for arm in preview.arms] == [("a", "improved"), ("b", "none")]
    assert preview.threads == 1
    assert {"arm", "q_q1", "typical_collides"} <= set(preview.columns)


def test_a_sample_of_goals_has_the_columns_of_the_run():
    source = GoalSource(goals=[ROBOT_TOOL, Region.box(ROBOT_TOOL, 0.1)], names=("a", "b"))
    preview = preview_batch(make_batch(source=source, repeats=1), threads=1)
    assert {"alternative", "poses", "target_name"} <= set(preview.columns)
    assert preview.targets == 2


def test_short_arms_are_sampled_whole(batch):
    preview = preview_batch(batch)
    assert [arm.sample for arm in preview.arms] == [60, 60]
    assert preview.seconds == sum(arm.seconds + arm.load_seconds for arm in preview.arms) > 0.0


def test_long_arms_are_sampled_for_their_share_of_the_time(batch, monkeypatch):
    monkeypatch.setattr("ikde.batch.preview.SAMPLE_SECONDS", 0.0)
    assert [arm.sample for arm in preview_batch(batch, threads=7).arms] == [7, 7]


class Bench:
    """A clock that stands still but for what `solve_task` is said to take."""

    def __init__(self, monkeypatch, takes):
        self.now, self.compiled, self.sizes = 0.0, 0.0, []

        def solve(task, threads):
            self.sizes.append(task.part.rows)
            compiling, solving = takes(task, self)
            self.now += compiling + solving
            self.compiled += compiling
            return solve_task(task, threads)

        monkeypatch.setattr("ikde.batch.preview.solve_task", solve)
        monkeypatch.setattr("ikde.batch.preview.compile_clock", self.measure)

    @contextmanager
    def measure(self):
        yield Reading(self, self.now, self.compiled)


class Reading:
    def __init__(self, bench, now, compiled):
        self.bench, self.now, self.compiled = bench, now, compiled

    @property
    def seconds(self):
        return self.bench.compiled - self.compiled

    @property
    def run_seconds(self):
        return self.bench.now - self.now - self.seconds


def test_compiling_and_loading_are_told_apart_from_solving(batch, monkeypatch):
    """Also what a harder target needs compiled, in a sample that is timed."""

    def takes(task, bench):
        count = bench.sizes.count(task.part.rows)
        if task.arm.name == "a" and len(bench.sizes) == 1:
            return 20.0, 1.5
        return (7.0 if task.part.rows == 20 and count == 1 else 0.0), 0.001 * task.part.rows

    bench = Bench(monkeypatch, takes)
    preview = preview_batch(batch, threads=1)
    assert bench.sizes == [5, 5, 20, 60, 5, 5, 20, 60]
    assert [arm.compile_seconds for arm in preview.arms] == pytest.approx([27.0, 0.0])
    assert [arm.load_seconds for arm in preview.arms] == pytest.approx([1.5, 0.005])
    assert [arm.seconds for arm in preview.arms] == pytest.approx([0.06, 0.06])
    assert preview.seconds == pytest.approx(0.12 + 1.505)
    assert preview.compile_seconds == pytest.approx(27.0)


def test_as_many_targets_as_are_solved_side_by_side_come_first(batch, monkeypatch):
    """So that what is timed is not compiled meanwhile, and samples are never smaller."""
    bench = Bench(monkeypatch, lambda task, bench: (0.0, 10.0))
    preview_batch(batch, threads=1)
    assert bench.sizes == [SEVERAL, SEVERAL] * 2
    few = make_batch(arms=ARMS, repeats=1, source=ListSource(targets=make_targets(2)))
    bench.sizes.clear()
    preview_batch(few, threads=1)
    assert bench.sizes == [2, 2] * 2


@pytest.mark.parametrize("writable", [True, False])
def test_without_a_cache_folder_the_run_compiles_again(batch, monkeypatch, writable):
    monkeypatch.setattr("ikde.batch.preview.CACHE_IS_WRITABLE", writable)
    assert preview_batch(batch).compiles_again is not writable


def test_it_knows_what_the_answers_will_weigh(batch, tmp_path):
    ikde.run_batch(batch, tmp_path)
    weight = sum(len(data) for kind in ("solutions", "timing") for data in read_files(tmp_path, kind).values())
    assert preview_batch(batch).bytes == pytest.approx(weight, rel=0.3)
