"""Many results as arrays: slices, masks, tables; and what a notebook shows of them."""

import pickle
from copy import copy, deepcopy

import numpy as np
import pyarrow as pa
import pytest

import ikde
from ikde.solver.results import SolveResults, read_rows
from tests.problems import problem_of
from tests.three_joints import ROBOT, free_q, meet

TARGETS = [meet(ROBOT, q, "position") for q in free_q(7)] + [ikde.Target((50.0, 0.0, 0.0))]


KNOWN = ("seed", "stream", "reason", "hint", "blocking_pairs", "verified", "attempts", "method", "clearance_m")


@pytest.fixture(scope="module")
def rows():
    return ikde.solve_many(ROBOT, TARGETS, seed=5)


@pytest.mark.parametrize(
    "index",
    [slice(2, 5), slice(None, None, -2), slice(7, 3), [3, 1, -1], np.array([6, 6]), [], "reached", "missed"],
    ids=str,
)
def test_what_is_chosen_keeps_all_that_is_known_of_it(rows, index):
    chosen = index
    if isinstance(index, str):
        chosen = rows.reached if index == "reached" else ~rows.reached
    some, places = rows[chosen], read_rows(chosen, len(rows))
    assert len(some) == len(places)
    assert some.q.tobytes() == rows.q[places].tobytes()
    assert some.reached.tolist() == rows.reached[places].tolist()
    assert some.stop_reasons.tolist() == rows.stop_reasons[places].tolist()
    for ours, place in zip(some, places.tolist(), strict=True):
        theirs = rows[place]
        for name in KNOWN:
            assert getattr(ours, name) == getattr(theirs, name), name
        again = ikde.solve(ROBOT, ours.target, seed=ours.seed, stream=ours.stream)
        assert again.q.tobytes() == ours.q.tobytes()


COLUMNS = [name for name, known in vars(SolveResults).items() if isinstance(known, property)]
MEASURED_ANEW = {"motion"}


@pytest.mark.parametrize("name", [name for name in COLUMNS if name not in MEASURED_ANEW])
@pytest.mark.parametrize("chosen", [slice(None), slice(1, 5, 2), [0, 0, 7]], ids=str)
def test_no_column_of_what_was_graded_can_be_written_to(rows, name, chosen):
    some = rows if chosen == slice(None) else rows[chosen]
    column = getattr(some, name)
    before = column.tolist()
    with pytest.raises(ValueError, match="read-only"):
        column[0] = column[-1]
    if isinstance(column, np.ma.MaskedArray):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = np.ma.masked
    assert getattr(some, name).tolist() == before


@pytest.mark.parametrize("travel", [lambda rows: pickle.loads(pickle.dumps(rows)), deepcopy, copy])
def test_rows_that_travelled_are_the_same_and_cannot_be_written_to(rows, travel):
    there = travel(rows)
    assert there[1].q.tobytes() == rows[1].q.tobytes()
    assert [row.reason for row in there] == [row.reason for row in rows]
    for name in set(COLUMNS) - MEASURED_ANEW:
        column = getattr(there, name)
        with pytest.raises(ValueError, match="read-only"):
            column[0] = column[-1]


def test_a_choice_of_a_choice(rows):
    assert [row.stream for row in rows[2:][::2][1:]] == [4, 6]
    assert rows[rows.reached][-1].stream == 6


@pytest.mark.parametrize(
    ("index", "words"),
    [
        ([True, False], "expected a mask of 8 rows"),
        ([8], "out of bounds"),
        ([[1]], "expected a place"),
        ([[0], [1, 2]], "expected a place"),
        (np.ma.masked_array([0, 1], mask=[False, True]), "some are masked"),
        ([0.5], "expected a place"),
        ("a", "expected a place"),
        (True, "expected a mask of 8 rows"),
        (None, "expected a place"),
    ],
)
def test_what_chooses_nothing_is_refused(rows, index, words):
    with pytest.raises(IndexError, match=words):
        rows[index]


@pytest.mark.parametrize(
    ("index", "places"),
    [
        (np.ma.masked_array([True, True, True, False], mask=[False, True, False, False]), [0, 2]),
        ([], []),
        (slice(1, 3), [1, 2]),
        ([True, False, False, True], [0, 3]),
        ([-1, 0], [3, 0]),
    ],
)
def test_places_are_those_of_an_array(index, places):
    assert read_rows(index, 4).tolist() == places


def test_a_table_has_a_row_a_target(rows):
    table = rows.to_arrow()
    assert isinstance(table, pa.Table)
    assert table.num_rows == len(rows)
    assert table["reached"].to_pylist() == rows.reached.tolist()
    assert table["stop_reason"].to_pylist()[-1] == "out_of_reach"
    for k, name in enumerate(ROBOT.joint_names):
        assert table[f"q_{name}"].to_pylist() == rows.q[:, k].tolist()
    assert table["clearance_m"].to_pylist() == rows.clearance_m.tolist()
    unchecked = ikde.solve_many(ROBOT, TARGETS[:2], collision="none").to_arrow()
    assert unchecked["collision"].to_pylist() == unchecked["clearance_m"].to_pylist() == [None, None]


def test_pandas_has_the_same(rows):
    pandas = pytest.importorskip("pandas")
    frame = rows.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert frame["position_error_m"].tolist() == rows.position_error_m.tolist()


def test_a_notebook_shows_a_line_of_each(rows):
    robot, targets = ikde.load_robot("qiao2021"), ikde.Targets.of(TARGETS)
    shown = [robot, targets, targets[0], rows, rows[0], ikde.CollisionModel.of(robot), problem_of(robot)]
    q = robot.home
    shown += [ikde.check(robot, q), ikde.check_many(robot, [q]), ikde.forward(robot, q), rows.found, rows.outcomes]
    shown += [ikde.solve_distinct(ROBOT, TARGETS[0], 5, {"timeout_s": 5.0}), ikde.verify(robot, (0.8, 0.5, 1.0), q)]
    for thing in (*shown, ikde.SolveSettings(), rows[0].target, ikde.BulkOptions()):
        assert len(repr(thing)) <= 400, type(thing)
    assert repr(robot) == "<Robot qiao2021: 9 joints, tool O6, detector improved>".replace("O6", robot.tool)
    assert repr(targets) == "<Targets: 8 position>"
    assert repr(ikde.check(robot, q, "none")) == "<CheckResult: self-collision not checked>"
    closest = ikde.check(robot, q).pairs[0]
    assert f"{closest.a} - {closest.b}" in repr(ikde.check(robot, q))
    assert repr(rows) == f"<SolveResults: 8 rows, {rows.reached.sum()} reached by three_joints>"
