"""The whole page of a run, as HTML and as Markdown."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from ikde.batch.statistics import Rate
from ikde.report.batch_page.answers import gather_answers
from ikde.report.batch_page.page import MAX_NUMBERS, format_share, make_batch_page, say_how_to_go_on
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown
from ikde.report.page import Notice, Numbers


def labels(page):
    return [item.label for block in page.lead if isinstance(block, Numbers) for item in block.items]


def numbers_of(page):
    return next(block.items for block in page.lead if isinstance(block, Numbers))


def notices(page):
    return [block.markup for block in page.lead if isinstance(block, Notice)]


@pytest.fixture(scope="module")
def page(answers):
    return make_batch_page(answers)


def test_a_run_has_all_its_sections(page):
    assert page.anchors() == [
        "reached",
        "targets",
        "worst",
        "cost",
        "clearance",
        "graded",
        "not-reached",
        "recipe",
        "again",
    ]
    assert page.subtitle.startswith("A batch of inverse kinematics: robot qiao2021, 2 arms, 4 targets, 8 solves each")
    assert notices(page) == []
    assert labels(page) == ["reached by free", "reached by careful"]


def test_html_is_whole_and_holds_what_others_wrote_as_text(page):
    text = render_html(page)
    assert "&lt;far|away&gt;" in text
    assert "<far" not in text
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    assert re.findall(r"(?:src|href)=\"(?!#|data:)", text) == []
    assert render_html(page) == text


def test_markdown_has_tables_of_one_shape(page):
    text = render_markdown(page)
    assert "&lt;far\\|away>" in text
    for table in re.findall(r"(?:^\|.*\n)+", text, flags=re.MULTILINE):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()}) == 1
    assert "out of reach: at least" in text


def test_the_same_run_gives_the_same_page(folder, page):
    assert render_html(make_batch_page(gather_answers(folder))) == render_html(page)


def test_one_arm_is_shown_with_its_cost(answers, bare):
    careful = make_batch_page(replace(answers, arms=answers.arms[1:]))
    assert labels(careful) == ["reached", "a solve, median", "attempts, median", "smallest clearance"]
    assert labels(make_batch_page(bare)) == ["reached", "a solve, median"]


def test_an_arm_without_a_detector_is_said_not_to_be_checked(answers):
    first, second = (item.note for item in numbers_of(make_batch_page(answers)))
    assert first.endswith("of 32 solves, self-collision not checked")
    assert second.endswith("of 32 solves")
    many = replace(answers, arms=(*answers.arms[:1], *answers.arms[1:] * MAX_NUMBERS))
    assert numbers_of(make_batch_page(many))[0].note.endswith("solves, self-collision not checked in 1 of 5 arms")


def test_a_run_without_graders_and_reasons_has_fewer_sections(bare):
    page = make_batch_page(bare)
    assert page.anchors() == ["reached", "worst", "cost", "not-reached", "recipe", "again"]
    assert "12 targets, seed 7" in page.subtitle
    assert "</html>" in render_html(page)


def test_many_arms_share_one_large_figure(bare):
    many = replace(bare, arms=bare.arms * (MAX_NUMBERS + 1))
    assert labels(make_batch_page(many)) == ["reached, over all arms"]


def test_an_unfinished_run_says_so_and_shows_what_is_there(unfinished):
    page = make_batch_page(unfinished)
    (notice,) = notices(page)
    assert "not finished" in notice
    assert "6 of 12 parts are there, 32 of 64 solves" in notice
    assert page.anchors()[0] == "reached"
    assert "**This run is not finished**" in render_markdown(page)
    assert 'class="notice"' in render_html(page)


def test_a_run_that_has_just_begun_has_a_page(folder, tmp_path):
    for name in ("solutions", "timing"):
        (tmp_path / name).mkdir()
    shutil.copy(folder / "manifest.json", tmp_path)
    page = make_batch_page(gather_answers(tmp_path))
    assert page.anchors() == ["recipe", "again"]
    assert "0 of 12 parts" in notices(page)[0]
    assert "</html>" in render_html(page)


def test_a_run_goes_on_by_its_command(bare):
    assert say_how_to_go_on(bare) == "The same call of `run_batch` goes on."
    file = replace(bare, folder=Path("runs/[a]"), manifest=replace(bare.manifest, file="a b.yaml"))
    assert say_how_to_go_on(file) == "`ikde batch 'a b.yaml' --out 'runs/[a]'` goes on."
    assert make_batch_page(file).footer.endswith("from the answers in `runs/[a]`.")


@pytest.mark.parametrize(
    ("count", "total", "text"),
    [
        (0, 0, "–"),
        (0, 10, "0.0 %"),
        (10, 10, "100.0 %"),
        (9_999, 10_000, "> 99.9 %"),
        (1, 10_000, "< 0.1 %"),
        (994, 1000, "99.4 %"),
    ],
)
def test_a_share_is_all_or_nothing_only_if_it_is(count, total, text):
    assert format_share(Rate(count, total)) == text
