"""Parts that were solved as one, finished one by one."""

import numpy as np
import pyarrow as pa
import pytest

import ikde
from ikde.batch.finish import finish_parts
from ikde.batch.parts import Part, list_parts, read_table
from ikde.batch.sources import ListSource
from ikde.batch.task import make_task, solve_task
from tests.batch.small import FAR, ROBOT, make_arm, make_batch, make_targets


@pytest.fixture(scope="module")
def batch():
    points = [*make_targets(4), ikde.Target(FAR), *make_targets(3), ikde.Target((0.0, 0.0, 3.0))]
    return make_batch(
        arms=(make_arm("a", position_tolerance_m=0.05, restarts=2),),
        source=ListSource(targets=points, names=tuple(f"t{k // 2}" for k in range(9))),
        chunk=4,
        graders=(ROBOT.detectors["typical"],),
        explain=True,
    )


def finish(batch, parts):
    whole = Part("a", parts[0].number, parts[0].first, parts[-1].last)
    return finish_parts(batch, solve_task(make_task(batch, whole), 1), parts, "ab")


def test_parts_are_finished_as_if_each_had_been_solved_by_itself(batch, tmp_path):
    parts = list(list_parts(["a"], batch.solves, batch.chunk))[1:]
    together = finish(batch, parts)
    assert [one.part for one in together] == [one.tally.part for one in together] == parts
    for one in together:
        (alone,) = finish(batch, [one.part])
        assert one.sealed.solutions == alone.sealed.solutions
        same = [(a.all, a.of_target, a.collision_checked, a.verified, a.stop_reasons) for a in (one.tally, alone.tally)]
        assert same[0] == same[1]
        assert one.tally.first_missed.equals(alone.tally.first_missed)
        for name in ("attempts", "missed", "misses"):
            np.testing.assert_array_equal(getattr(one.tally, name), getattr(alone.tally, name))


def test_what_is_counted_is_what_is_written(batch, tmp_path):
    (one,) = finish(batch, [Part("a", 1, 4, 8)])
    tables = {}
    for kind in ("solutions", "timing"):
        (tmp_path / kind).write_bytes(getattr(one.sealed, kind))
        tables[kind] = read_table(tmp_path / kind)
    assert tables["solutions"]["attempts"].to_pylist() == one.tally.attempts.tolist()
    assert tables["timing"]["solve_seconds"].to_pylist() == one.tally.seconds.tolist()
    assert one.tally.all.reached.count == sum(tables["solutions"]["reached"].to_pylist())
    assert tables["solutions"].schema.metadata[b"ikde_recipe"] == b"ab"
    assert pa.types.is_dictionary(tables["solutions"].schema.field("reason").type)
