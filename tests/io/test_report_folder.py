"""A report's folder: found out before the work, and whole files."""

import pytest

from ikde.errors import FileError
from ikde.io.report_folder import open_folder, prepare_folder, write_report


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
