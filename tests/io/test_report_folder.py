"""A report's folder: found out before the work, whole files, and a record that is one."""

import json
from dataclasses import asdict

import pytest

from ikde.bench.budget import QUICK
from ikde.errors import FileError
from ikde.io.report_folder import RESULTS, format_results, open_folder, prepare_folder, read_results, write_report

RECORD = {"made": {"budget": asdict(QUICK), "only": []}, "sections": {}}


def test_a_folder_is_made_with_its_parents(tmp_path):
    prepare_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()
    assert list((tmp_path / "a" / "b").iterdir()) == []


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "report").write_text("mine")
    with pytest.raises(FileError, match="this is a file; expected a folder"):
        prepare_folder(tmp_path / "report")
    assert (tmp_path / "report").read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_found_out_at_once(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="cannot be written"):
        prepare_folder(tmp_path / "file" / "report")


def test_a_new_folder_goes_again_if_nothing_comes_of_it(tmp_path):
    with pytest.raises(KeyError), open_folder(tmp_path / "new"):
        raise KeyError
    assert sorted(path.name for path in tmp_path.iterdir()) == []
    (tmp_path / "old").mkdir()
    with pytest.raises(KeyError), open_folder(tmp_path / "old"):
        raise KeyError
    assert sorted(path.name for path in tmp_path.iterdir()) == ["old"]


def test_a_file_is_not_opened(tmp_path):
    (tmp_path / "here").write_text("mine")
    with pytest.raises(FileError, match="this is a file"), open_folder(tmp_path / "here"):
        pass


def test_only_its_own_files_are_replaced(tmp_path):
    (tmp_path / "report.html").write_text("old")
    (tmp_path / "notes.txt").write_text("mine")
    write_report(tmp_path, {"report.html": "new", "report.md": "# ü"})
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == {
        "report.html": "new",
        "report.md": "# ü",
        "notes.txt": "mine",
    }


def test_what_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(FileError, match=r"report\.html: cannot be written") as error:
        write_report(tmp_path / "gone", {"report.html": ""})
    assert "\n" not in str(error.value)


def test_a_record_comes_back(tmp_path):
    write_report(tmp_path, {RESULTS: format_results(RECORD)})
    assert read_results(tmp_path) == RECORD


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not JSON"),
        ("[]", "not a record"),
        ("{}", "not a record"),
        (json.dumps({"made": {"budget": {"solves": 1}}, "sections": {}}), "not a record"),
        (json.dumps({**RECORD, "made": 3}), "not a record"),
        (json.dumps({**RECORD, "sections": None}), "→ sections: expected a mapping, got None"),
        (
            json.dumps({**RECORD, "sections": {"a": {}, "kinematics": 3}}),
            r"→ sections\.kinematics: expected a mapping, got 3",
        ),
    ],
)
def test_something_else_is_no_record(tmp_path, text, words):
    (tmp_path / RESULTS).write_text(text)
    with pytest.raises(FileError, match=words):
        read_results(tmp_path)


@pytest.mark.parametrize("size", [0, -1, 1.0, True, "300", None])
def test_a_sample_size_is_a_whole_number(tmp_path, size):
    budget = asdict(QUICK) | {"solves": size}
    (tmp_path / RESULTS).write_text(json.dumps({**RECORD, "made": {"budget": budget, "only": []}}))
    with pytest.raises(FileError, match=r"→ made\.budget\.solves: expected a whole number of at least 1, got"):
        read_results(tmp_path)


def test_no_record_is_one_line(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        read_results(tmp_path)
