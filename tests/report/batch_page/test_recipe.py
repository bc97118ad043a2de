"""What ran, and how to do it again."""

import ast
from dataclasses import replace
from pathlib import Path

from ikde.report.batch_page.recipe import make_again, make_recipe
from ikde.report.page import Code, Facts
from tests.report.batch_page.blocks import column, tables


def facts(section):
    (block,) = [block for block in section.blocks if isinstance(block, Facts)]
    return dict(block.items)


def with_manifest(run, **changes):
    return replace(run, manifest=replace(run.manifest, **changes))


def codes(run):
    return [block.text for block in make_again(run).blocks if isinstance(block, Code)]


def test_what_ran_is_stated(answers):
    stated = facts(make_recipe(answers))
    assert stated["robot"] == "qiao2021"
    assert (stated["targets"], stated["solves of a target"], stated["seed"]) == ("4", "8", "7")
    assert stated["graded again by"].endswith(" of 64, detectors typical, improved: all reached")
    assert stated["graded again by"].startswith("plain numpy: ")
    assert stated["recipe"] == answers.manifest.hash
    assert "cores" in stated["machine"]
    for library in ("ikde", "numpy", "numba", "pyarrow"):
        assert library in stated["versions"]


def test_a_file_with_brackets_is_shown_as_it_is(answers):
    stated = facts(make_recipe(with_manifest(answers, file="runs/[a].yaml")))
    assert stated["run file"] == r"runs/\[a\].yaml"


def test_arms_are_compared_by_what_differs(answers):
    differing, common = tables(make_recipe(answers))
    assert [column.title for column in differing.columns] == ["setting", "free", "careful"]
    assert ("detector", "none", "improved") in differing.rows
    assert "position tolerance [m]" not in column(differing, "setting")
    settings = dict(common.rows)
    assert settings["position tolerance [m]"] == "0.02"
    assert settings["method"] == "de"
    assert "detector" not in settings


def test_arms_that_differ_in_nothing_say_so(answers):
    twins = tuple(replace(answers.manifest.arms[0], name=name) for name in "ab")
    table = tables(make_recipe(with_manifest(answers, arms=twins)))[0]
    assert [column.title for column in table.columns] == ["setting", "a", "b"]
    assert table.rows == ()
    assert "Nothing" in table.note


def test_one_arm_is_described_and_not_compared(bare):
    (table,) = tables(make_recipe(bare))
    assert table.caption == "How it was solved"
    assert dict(table.rows)["method"] == "de"


def test_the_recipe_knows_more_than_the_settings(bare):
    """A run that came from a file."""
    recipe = {
        "targets": {"grid": {}, "units": {}},
        "arms": {"auto": {"ranges": {"q_z": [0.0, 1 / 3]}, "near": None, "detector": {"name": "typical"}}},
    }
    section = make_recipe(with_manifest(bare, recipe=recipe))
    assert facts(section)["targets"] == "12 (grid)"
    assert dict(tables(section)[0].rows) == {
        "ranges: q_z": "0 to 0.333333",
        "near": "none",
        "detector: name": "typical",
    }


def test_commands_make_run_and_page_again(answers):
    run = replace(answers, folder=Path("my runs/a"), manifest=replace(answers.manifest, file="b.yaml"))
    assert codes(run)[0] == "ikde batch b.yaml --out 'my runs/a'\nikde report 'my runs/a'"
    assert codes(answers)[0] == f"ikde report {answers.folder}"  # made in Python, from no file


def test_a_file_whose_name_looks_like_an_option_is_a_file(answers):
    run = replace(answers, folder=Path("a"), manifest=replace(answers.manifest, file="--out=elsewhere"))
    assert codes(run)[0].splitlines()[0] == "ikde batch ./--out=elsewhere --out a"


def test_reading_on_is_python_whatever_the_folder_is_called(answers):
    for name in ("runs/a", "it's", 'a"b'):
        _, first, others = codes(replace(answers, folder=Path(name)))
        ast.parse(first)
        ast.parse(others)
        for library in ("pandas", "polars", "duckdb"):  # which need not be there
            assert library not in first
            assert library in others


def test_commands_repeat_what_was_picked_up(answers):
    held = with_manifest(answers, file="a.yaml", attach="mug=tool:left finger")
    assert codes(held)[0].startswith("ikde batch a.yaml '--attach=mug=tool:left finger' --out ")
