"""What a user waits for: every solve ends with a free solution, and each cell has its row."""

from dataclasses import replace

from ikde.paper.waiting import compute_waiting, show_waiting
from ikde.report.page import Table


def test_waiting_ends_with_a_free_solution(inputs):
    waiting = compute_waiting(replace(inputs, budget=replace(inputs.budget, waits=6)))
    assert len(waiting.rows) == len(waiting.measured["rows"]) == 8
    for row in waiting.rows:
        assert row.reached == row.solves == 6
        assert 1 <= row.attempts.median <= row.attempts.max


def test_waiting_has_a_row_a_detector_reading_and_target(results, inputs):
    blocks = show_waiting(results.sections["waiting"], inputs).blocks
    (table,) = [block for block in blocks if isinstance(block, Table)]
    assert len(table.rows) == 8
    assert all(row[3].endswith(f"of {inputs.budget.waits}") for row in table.rows)
