"""Who was not reached, and why."""

from dataclasses import replace

from ikde.report.batch_page import missed
from ikde.report.batch_page.missed import make_missed
from tests.report.batch_page.blocks import column, tables


def make_table(run):
    (table,) = tables(make_missed(run))
    return table


def test_a_target_that_was_not_reached_is_there_with_its_reason_and_what_would_help(answers):
    table = make_table(answers)
    mine = [row for row in table.rows if row[0] == "1"]
    assert [(row[1], row[2], row[3], row[4]) for row in mine] == [
        ("<far|away>", "9.000, 9.000, 9.000", "all", "8 of 8")
    ]
    assert all(row[5].startswith("out of reach: at least") for row in mine)
    assert all(row[6] for row in mine)
    assert table.caption == "Targets that were not reached"
    assert "the first repeat that missed" in table.note


def test_misses_are_counted(answers, rows):
    for target, _, _, arm, count, *_ in make_table(answers).rows:
        for own in [arm] if arm != "all" else ["free", "careful"]:
            mine = [row for row in rows if (str(row["target"]), row["arm"]) == (target, own)]
            assert count == f"{sum(not row['reached'] for row in mine)} of 8"


def test_a_run_without_reasons_shows_where_it_stopped_and_claims_nothing(bare):
    table = make_table(bare)
    assert [column.title for column in table.columns] == ["target", "why"]
    assert column(table, "why") == ["budget"] * 12
    assert "keeps no reasons" in table.note
    assert "Nothing was found" not in table.note


def test_a_run_that_was_not_asked_why_says_so(answers):
    silent = replace(answers, manifest=replace(answers.manifest, recipe={"explain": False}))
    assert "`explain: false`" in make_table(silent).note


def test_the_first_of_many_are_shown(answers, monkeypatch):
    monkeypatch.setattr(missed, "MAX_MISSED", 1)
    table = make_table(answers)
    total = len({target for arm in answers.arms for target in arm.missed})
    assert len(table.rows) == 1
    assert table.caption == f"The first 1 of {total} targets that were not reached"


def test_a_run_that_reached_everything_has_no_such_section(answers):
    assert make_missed(replace(answers, arms=tuple(replace(arm, missed={}) for arm in answers.arms))) is None
