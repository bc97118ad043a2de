"""Finished searches as a table: what repeats each row, then the columns of a batch."""

import numpy as np
import pytest

import ikde
from ikde.solver.results import solve_rows
from tests.flat_settings import flat_settings
from tests.problems import problem_of

QUICK = flat_settings(population=20, generations=200, restarts=3)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(4)]


@pytest.fixture
def rows(qiao):
    return solve_rows(problem_of(qiao, QUICK), TARGETS, seed=2**64 - 1, first_stream=40)


def test_a_table_says_what_repeats_each_row(rows):
    table = rows[[3, 1]].to_arrow().to_pydict()
    assert table["seed"] == [2**64 - 1] * 2
    assert table["stream"] == [43, 41]
    assert table["method"] == ["de"] * 2


def test_joint_values_and_figures_are_those_of_the_rows_to_the_bit(qiao, rows):
    table = rows.to_arrow()
    q = np.column_stack([table[f"q_{name}"].to_numpy() for name in qiao.joint_names])
    assert q.tobytes() == rows.q.tobytes()
    for name in ("reached", "position_error_m", "clearance_m", "attempts"):
        assert table[name].to_pylist() == getattr(rows, name).tolist()
    assert table["target_y_m"].to_pylist() == [target.p_world_tool[1] for target in TARGETS]


def test_what_was_not_checked_is_null(qiao):
    table = solve_rows(problem_of(qiao, QUICK, collision="none"), TARGETS[:1], seed=0).to_arrow().to_pydict()
    assert table["collision"] == table["clearance_m"] == [None]


def test_no_rows_are_an_empty_table(rows):
    assert rows[:0].to_arrow().num_rows == 0


def test_without_pandas_one_line_says_what_to_install(rows, monkeypatch):
    table = type("Table", (), {"to_pandas": lambda self: __import__("pandas_is_not_there")})()
    monkeypatch.setattr("ikde.solver.columns.tabulate", lambda rows: table)
    with pytest.raises(ikde.IkdeError, match="to_pandas needs pandas"):
        rows.to_pandas()
