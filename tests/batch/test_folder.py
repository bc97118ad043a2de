"""Whose a folder is, and who may write to it."""

import os
import subprocess
import sys

import pytest

from ikde.batch import folder as module
from ikde.batch.folder import LOCK, check_folder, claim_folder, keep_names
from ikde.batch.manifest import MANIFEST, read_manifest, write_manifest
from ikde.errors import FileError
from ikde.formats.atomic import sync_folder, temporary_path
from tests.batch.small import make_batch

HOLD = """
import fcntl, sys, time
file = open(sys.argv[1], "a+")
fcntl.flock(file, fcntl.LOCK_EX)
print("held", flush=True)
time.sleep(60)
"""


def claim(folder, overwrite=False, **changes):
    with claim_folder(folder, make_batch(**changes), overwrite=overwrite):
        pass


def claims_and_checks(folder, overwrite=False, **changes):
    """What claiming a folder says, which checking must have said before, leaving everything as it is."""
    before = snapshot(folder)
    said = []
    for look in (check_folder, None):
        try:
            if look:
                look(folder, make_batch(**changes), overwrite=overwrite)
                assert snapshot(folder) == before
            else:
                claim(folder, overwrite, **changes)
            said.append(None)
        except FileError as error:
            said.append(str(error))
    assert said[0] == said[1]
    return said[0]


def snapshot(folder):
    """All that lies there, and next to it."""
    return {path: path.read_bytes() if path.is_file() else None for path in folder.parent.rglob("*")}


@pytest.fixture
def run(tmp_path):
    """A folder with a manifest, a finished part and something of the user's."""
    claim(tmp_path)
    for kind in ("solutions", "timing"):
        (tmp_path / kind / "auto-00000.parquet").write_text("a part")
    (tmp_path / "report").mkdir()
    (tmp_path / "solutions" / "notes.txt").write_text("mine")
    return tmp_path


def test_a_new_folder_is_made_with_its_parents(tmp_path):
    folder = tmp_path / "runs" / "a"
    claim(folder)
    assert read_manifest(folder).hash == make_batch().hash
    assert {path.name for path in folder.iterdir()} == {MANIFEST, LOCK, "solutions", "timing"}


def test_a_run_of_the_same_recipe_is_kept_as_it_is(run):
    before = (run / MANIFEST).read_bytes()
    leftover = temporary_path(run / "solutions" / "auto-00001.parquet")
    leftover.touch()
    claim(run)
    assert (run / MANIFEST).read_bytes() == before
    assert (run / "solutions" / "auto-00000.parquet").exists()
    assert not leftover.exists()


@pytest.mark.parametrize("overwrite", [False, True])
def test_parts_whose_columns_mean_something_else_are_not_mixed_in(run, overwrite):
    manifest = run / MANIFEST
    manifest.write_text(manifest.read_text().replace("ikde batch 3", "ikde batch 2"))
    before = {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
    with pytest.raises(FileError, match="holds a run of an earlier ikde"):
        claim(run, overwrite=overwrite)
    assert {path: path.read_bytes() for path in run.rglob("*") if path.is_file()} == before


def test_a_run_of_another_recipe_is_refused_with_the_difference(run):
    with pytest.raises(FileError, match=r"holds another run \(--overwrite replaces it\): seed: 7 there, 8 now$"):
        claim(run, seed=8)
    assert (run / "solutions" / "auto-00000.parquet").exists()


def test_checking_a_folder_says_what_claiming_it_says_and_changes_nothing(run, tmp_path):
    assert claims_and_checks(run) is None
    assert "holds another run" in claims_and_checks(run, seed=8)
    assert claims_and_checks(tmp_path / "new" / "deeper") is None
    (tmp_path / "file").touch()
    for place in ("file", "file/below", "file/below/deeper"):
        assert "is a file or lies below one" in claims_and_checks(tmp_path / place)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").write_text("mine")
    assert "is not empty and holds no run of ikde" in claims_and_checks(tmp_path / "other")
    linked = run / "report"
    linked.rmdir()
    linked.symlink_to(tmp_path / "other")
    assert "is a symbolic link" in claims_and_checks(run)
    linked.unlink()
    manifest = run / MANIFEST
    manifest.write_text(manifest.read_text().replace("ikde batch 3", "ikde batch 2"))
    for overwrite in (False, True):
        assert "holds a run of an earlier ikde" in claims_and_checks(run, overwrite=overwrite)


def test_a_run_that_would_be_replaced_is_no_error_and_still_there_after_a_check(run):
    check_folder(run, make_batch(seed=8), overwrite=True)
    assert (run / "solutions" / "auto-00000.parquet").exists()
    assert read_manifest(run).seed == 7


@pytest.mark.parametrize("seed", [7, 8])
def test_overwriting_deletes_parts_and_nothing_else(run, seed):
    claim(run, overwrite=True, seed=seed)
    assert read_manifest(run).seed == seed
    assert [path.name for path in (run / "solutions").iterdir()] == ["notes.txt"]
    assert list((run / "timing").iterdir()) == []


@pytest.mark.parametrize("notes", [False, True])
def test_overwriting_deletes_the_page_of_the_run_and_nothing_else(run, notes):
    for name in ("report.html", "report.md", *(["notes.txt"] if notes else [])):
        (run / "report" / name).touch()
    claim(run)
    assert (run / "report" / "report.html").exists()
    claim(run, overwrite=True)
    assert (run / "report").exists() == notes
    assert [path.name for path in (run / "report").glob("*")] == ["notes.txt"] * notes


def test_old_parts_are_gone_from_the_disk_before_the_new_manifest_is_there(run, substitute):
    done = []
    substitute(sync_folder, lambda folder: done.append(folder.name))
    substitute(write_manifest, lambda folder, manifest: done.append(MANIFEST))
    claim(run, overwrite=True, seed=8)
    assert done == ["solutions", "timing", MANIFEST, run.name]


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize(("name", "text"), [("thesis.tex", "precious"), (MANIFEST, "{}"), (".git", "")])
def test_a_folder_of_somebody_else_is_refused_untouched(tmp_path, overwrite, name, text):
    (tmp_path / name).write_text(text)
    with pytest.raises(FileError, match="no run of ikde"):
        claim(tmp_path, overwrite)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, text)]


def test_a_run_that_was_killed_before_its_manifest_was_whole_goes_on(tmp_path):
    (tmp_path / LOCK).touch()
    temporary_path(tmp_path / MANIFEST).write_text('{"for')
    claim(tmp_path)
    assert read_manifest(tmp_path)


@pytest.mark.parametrize("name", [MANIFEST, LOCK, "solutions", "timing", "report"])
@pytest.mark.parametrize("overwrite", [False, True])
def test_a_link_in_a_run_is_refused_and_not_followed(run, tmp_path_factory, name, overwrite):
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "precious"
    (run / name).rename(elsewhere)
    inside = {path: path.read_bytes() for path in [elsewhere, *elsewhere.rglob("*")] if path.is_file()}
    (run / name).symlink_to(elsewhere)
    with pytest.raises(FileError, match=r"is a symbolic link; a run holds none|cannot be used: .* symbolic links"):
        claim(run, overwrite)
    assert {path: path.read_bytes() for path in inside} == inside


def test_a_link_that_was_left_alone_in_a_folder_is_not_followed(tmp_path):
    (tmp_path / "precious").write_text("text")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / LOCK).symlink_to(tmp_path / "precious")
    with pytest.raises(FileError, match=r"cannot be used: .* symbolic links"):
        claim(tmp_path / "run")
    assert (tmp_path / "precious").read_text() == "text"


@pytest.mark.parametrize("place", ["a", "a/b"])
def test_a_file_is_no_folder(tmp_path, place):
    (tmp_path / "a").touch()
    with pytest.raises(FileError, match="is a file or lies below one"):
        claim(tmp_path / place)


def test_a_folder_that_cannot_be_written_is_an_error_in_one_line(tmp_path, monkeypatch):
    def refuse(*arguments, **options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.iterdir", refuse)  # the tests may run as root, whom no mode stops
    with pytest.raises(FileError, match=f"^{tmp_path}: cannot be used: Permission denied$"):
        claim(tmp_path)


def test_a_lock_that_is_none_is_left_alone(tmp_path):
    (tmp_path / LOCK).write_text("mine")
    with pytest.raises(FileError, match="was not written by ikde"):
        claim(tmp_path)
    assert (tmp_path / LOCK).read_text() == "mine"


def test_two_cannot_write_one_run(tmp_path):
    with claim_folder(tmp_path, make_batch(), overwrite=False), pytest.raises(FileError) as caught:
        claim(tmp_path, overwrite=True)
    assert f"process {os.getpid()} is writing this run" in str(caught.value)
    claim(tmp_path)


def test_a_lock_dies_with_its_holder(tmp_path):
    claim(tmp_path)
    with subprocess.Popen([sys.executable, "-c", HOLD, tmp_path / LOCK], stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(FileError, match="is writing this run"):
            claim(tmp_path)
        holder.kill()
    claim(tmp_path)


def count_syncs(substitute):
    calls = []
    substitute(sync_folder, calls.append)
    return calls


@pytest.mark.parametrize(("seconds", "syncs"), [(0.0, 4), (1e9, 1)])
def test_names_are_synced_now_and_then_and_at_the_end(tmp_path, monkeypatch, substitute, seconds, syncs):
    monkeypatch.setattr(module, "SYNC_SECONDS", seconds)
    calls = count_syncs(substitute)
    with keep_names(tmp_path) as keep:
        for _ in range(3):
            keep()
    assert calls == [tmp_path / "timing", tmp_path / "solutions"] * syncs


def test_names_are_synced_even_if_a_run_is_stopped(tmp_path, substitute):
    calls = count_syncs(substitute)
    with pytest.raises(KeyboardInterrupt), keep_names(tmp_path):
        raise KeyboardInterrupt
    assert len(calls) == 2


def keep_nothing(folder):
    with keep_names(folder):
        pass


def test_names_that_cannot_be_synced_are_one_line(tmp_path):
    with pytest.raises(FileError, match=r"timing: cannot be written: No such file.*run the same command"):
        keep_nothing(tmp_path)
    with pytest.raises(ZeroDivisionError), keep_names(tmp_path):  # what went wrong first is what is told
        raise ZeroDivisionError
