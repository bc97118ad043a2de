"""The rows that are worth a look."""

from dataclasses import replace

from ikde.batch.one_row import Row
from ikde.report.batch_page.worst import _list_facts, make_worst, repeat_command
from ikde.report.page import Code, Details, Facts


def details(run):
    return [block for block in make_worst(run).blocks if isinstance(block, Details)]


def test_the_least_clear_and_the_farthest_off_are_there(answers, rows):
    lines = [block.summary for block in details(answers)]
    clear = [row for row in rows if row["reached"] and row["clearance_m"] is not None]
    worst = min(clear, key=lambda row: row["clearance_m"])
    (line,) = [line for line in lines if line.startswith("least clearance")]
    assert f"target {worst['target']}" in line
    assert f"repeat {worst['repeat']}, arm {worst['arm']}" in line
    far = max((row for row in rows if row["reached"]), key=lambda row: row["position_error_m"])
    (line,) = [line for line in lines if line.startswith("largest position error")]
    assert f"target {far['target']}" in line
    assert "(<far|away>)" in next(line for line in lines if line.startswith("not reached: out of reach"))


def test_no_row_is_shown_twice(answers):
    shown = [block.summary.split(": target ")[1] for block in details(answers)]
    assert len(shown) == len(set(shown))


def test_each_has_its_numbers_and_its_command(answers):
    file = replace(answers, manifest=replace(answers.manifest, file="my runs/a.yaml"))
    for block in details(file):
        assert isinstance(block.blocks[0], Facts)
        (command,) = [part.text for part in block.blocks if isinstance(part, Code)]
        assert command.startswith("ikde batch 'my runs/a.yaml' --out ")
        assert " --row " in command
    assert repeat_command(file, Row("a b", 1, 2)).endswith("--row 'a b/1/2'")


def test_without_a_file_there_is_no_command(answers):
    assert not [part for block in details(answers) for part in block.blocks if isinstance(part, Code)]


def test_a_run_without_answers_has_no_worst(bare):
    assert make_worst(replace(bare, arms=())) is None


def test_of_a_goal_with_freedom_it_says_which_alternative_and_how_many_poses():
    facts = dict(_list_facts({"poses": 1200, "alternative": 0, "target_x_m": 1, "target_y_m": 2, "target_z_m": 3}))
    assert facts["poses of the goal tried"] == "1,200"
    assert facts["alternative of the goal, from 0"] == "0"
    assert "poses of the goal tried" not in dict(_list_facts({"poses": None, "alternative": None}))
