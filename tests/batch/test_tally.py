"""What one part amounts to, against counts row by row."""

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.batch import tally as module
from ikde.batch.parts import Part
from ikde.batch.statistics import Rate
from ikde.batch.tally import Counting, Counts

REASONS = ("out of reach", "too few attempts")
verdicts = st.sampled_from([True, False, None])
rows = st.lists(
    st.fixed_dictionaries(
        {
            "reached": st.booleans(),
            "collision": verdicts,
            "verified": verdicts,
            "typical_collides": verdicts,
            "stop_reason": st.sampled_from(["reached", "budget", "unreachable"]),
            "reason": st.sampled_from([*REASONS, None]),
            "attempts": st.integers(1, 300),
        }
    ),
    min_size=1,
    max_size=30,
)


def as_table(rows, repeats, without=()):
    """The columns of a part of arm `a` whose first solve is number 0."""
    columns = {name: [row[name] for row in rows] for name in rows[0] if name not in without}
    bools = {name: pa.array(columns[name], pa.bool_()) for name in ("reached", "collision", "verified")}
    bools["typical_collides"] = pa.array(columns["typical_collides"], pa.bool_())
    words = {name: pa.array(columns[name], pa.string()).dictionary_encode() for name in ("stop_reason",)}
    if "reason" in columns:
        words["reason"] = pa.array(columns["reason"], pa.string()).dictionary_encode()
    place = np.arange(len(rows))
    identity = {
        "arm": pa.array(["a"] * len(rows)).dictionary_encode(),
        "target": pa.array(place // repeats),
        "target_name": pa.array([f"t{k}" for k in place // repeats]).dictionary_encode(),
        "repeat": pa.array((place % repeats).astype(np.int32)),
    }
    cost = {"attempts": pa.array(columns["attempts"], pa.int32())} if "attempts" in columns else {}
    return pa.table(identity | bools | words | cost)


def count(rows, repeats=3, targets=5, graders=("typical",), without=()):
    table = as_table(rows, repeats, without)
    seconds = np.arange(len(rows)) / 7.0
    return Counting.of(graders, repeats, targets).count(Part("a", 0, 0, len(rows)), table, seconds)


def rate(rows, name):
    checked = [row[name] for row in rows if row[name] is not None]
    return Rate(sum(checked), len(checked))


@given(rows)
def test_every_count_is_that_of_the_rows(rows):
    tally, reached = count(rows), [row for row in rows if row["reached"]]
    assert tally.part == Part("a", 0, 0, len(rows))
    assert tally.all == Counts(
        reached=Rate(len(reached), len(rows)), collisions={"typical": rate(reached, "typical_collides")}
    )
    assert tally.collision_checked == rate(rows, "collision").total
    assert tally.verified == rate(rows, "verified")
    stops = [row["stop_reason"] for row in rows]
    assert tally.stop_reasons == {stop: stops.count(stop) for stop in set(stops)}
    assert tally.attempts.tolist() == [row["attempts"] for row in rows]
    assert tally.seconds.tolist() == [k / 7.0 for k in range(len(rows))]


@given(rows, st.integers(2, 4))
def test_each_of_a_few_targets_is_counted_by_itself(rows, repeats):
    tally = count(rows, repeats)
    assert list(tally.of_target) == list(range(-(-len(rows) // repeats)))
    for target, counts in tally.of_target.items():
        mine = rows[target * repeats : (target + 1) * repeats]
        reached = [row for row in mine if row["reached"]]
        collisions = {"typical": rate(reached, "typical_collides")}
        assert counts == Counts(name=f"t{target}", reached=Rate(len(reached), len(mine)), collisions=collisions)


@given(rows, st.integers(1, 4))
def test_a_target_that_was_missed_is_told_once_with_its_first_miss(rows, repeats):
    tally = count(rows, repeats)
    missed = [k for k, row in enumerate(rows) if not row["reached"]]
    targets = sorted({k // repeats for k in missed})
    assert tally.missed.tolist() == targets
    assert tally.misses.tolist() == [sum(k // repeats == target for k in missed) for target in targets]
    first = [next(k for k in missed if k // repeats == target) for target in targets]
    assert tally.first_missed.to_pylist() == [
        {
            "arm": "a",
            "target": k // repeats,
            "target_name": f"t{k // repeats}",
            "repeat": k % repeats,
            "stop_reason": rows[k]["stop_reason"],
            "reason": rows[k]["reason"],
        }
        for k in first
    ]


ROW = {"collision": None, "verified": None, "typical_collides": None, "reason": None, "attempts": 1}
MISSES = [ROW | {"reached": False, "stop_reason": "budget"}] * 9


def test_of_very_many_missed_targets_the_first_are_told(monkeypatch):
    monkeypatch.setattr(module, "MAX_LISTED", 2)
    tally = count(MISSES, repeats=1)
    assert tally.first_missed["target"].to_pylist() == [0, 1]
    assert len(tally.missed) == len(tally.misses) == 9


def test_columns_that_are_not_kept_are_missed_by_nobody():
    tally = count(MISSES, graders=(), without=("reason", "attempts"))
    assert tally.attempts is None
    assert tally.all.collisions == {}
    assert "reason" not in tally.first_missed.column_names


@pytest.mark.parametrize(
    ("repeats", "targets", "one_by_one"), [(2, 2, True), (2, 10, True), (1, 5, False), (9, 1, False), (2, 11, False)]
)
def test_a_few_targets_that_are_solved_repeatedly_are_counted_one_by_one(repeats, targets, one_by_one):
    counting = Counting.of(["a", "b"], repeats, targets)
    assert counting == Counting(graders=("a", "b"), one_by_one=one_by_one)
    if not one_by_one:
        assert count(MISSES, repeats, targets).of_target == {}


def test_counts_add_up():
    one = Counts(name="t", reached=Rate(1, 2), collisions={"a": Rate(0, 1)})
    assert Counts() + one == one
    assert one + one == Counts(name="t", reached=Rate(2, 4), collisions={"a": Rate(0, 2)})
