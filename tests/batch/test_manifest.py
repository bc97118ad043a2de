"""The manifest: what it holds, whose it is, and how two recipes differ."""

import json
from dataclasses import replace

import pytest

from ikde.batch.manifest import MANIFEST, describe_difference, make_manifest, read_manifest, write_manifest
from ikde.errors import FileError
from tests.batch.small import BLINK, ROBOT, make_arm, make_batch


@pytest.fixture
def manifest():
    arms = (make_arm("a", **BLINK), make_arm("b", detector="none", method="de", **BLINK))
    return make_manifest(make_batch(arms=arms, graders=(ROBOT.detectors["typical"],)))


def test_it_comes_back_as_it_was_written(tmp_path, manifest):
    write_manifest(tmp_path, manifest)
    assert read_manifest(tmp_path) == manifest


def test_it_says_what_runs(manifest):
    assert (manifest.targets, manifest.repeats, manifest.solves, manifest.chunk) == (12, 2, 24, 5)
    assert manifest.parts == len(list(manifest.list_parts())) == 10
    assert [(arm.name, arm.method, arm.detector) for arm in manifest.arms] == [
        ("a", "de", "improved"),
        ("b", "de", "none"),
    ]
    assert manifest.arms[0].settings["de"]["population"] == 6
    assert manifest.graders == ("typical",)
    assert manifest.hash == make_batch().hash
    assert manifest.started.endswith("+00:00")


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "other"}', '{"format": 1}', '{"format": "ikde batch 3"}', "\x00", "[" * 10**5]
)
def test_a_file_of_somebody_else_is_refused(tmp_path, text):
    (tmp_path / MANIFEST).write_text(text)
    with pytest.raises(
        FileError, match=r"holds no run of ikde: (its manifest.json was not written by ikde|manifest.json: n)"
    ):
        read_manifest(tmp_path)


@pytest.mark.parametrize("earlier", ["ikde batch 1", "ikde batch 2"])
def test_a_run_whose_columns_mean_something_else_is_refused(tmp_path, manifest, earlier):
    write_manifest(tmp_path, replace(manifest, format=earlier))
    with pytest.raises(FileError, match=rf"earlier ikde \('{earlier}', expected 'ikde batch 3'\); name another"):
        read_manifest(tmp_path)


def test_an_unknown_key_is_refused(tmp_path, manifest):
    write_manifest(tmp_path, manifest)
    path = tmp_path / MANIFEST
    path.write_text(json.dumps(json.loads(path.read_text()) | {"more": 1}))
    with pytest.raises(FileError, match="was not written by ikde"):
        read_manifest(tmp_path)


@pytest.mark.parametrize(
    "changes",
    [
        {"arms": []},
        {"arms": [{"name": "../../etc/x", "method": "de", "detector": "none", "settings": {}}]},
        {"arms": [{"name": "a/b", "method": "de", "detector": "none", "settings": {}}]},
        {"arms": [{"name": "a", "method": "de", "detector": "none", "settings": {}}] * 2},
        {"graders": ["a\nb"]},
        {"chunk": 1, "targets": 10**9, "repeats": 1, "solves": 10**9, "parts": 2 * 10**9},
        {"parts": 9},
        {"solves": 23},
        {"targets": -12, "repeats": -2},
        {"targets": "many"},
        {"recipe": []},
        {"recipe": {"arms": [1]}},
        {"recipe": {"arms": {"a": 1}}},
        {"recipe": {"targets": "x"}},
        {"versions": None},
        {"name": ["x"]},
    ],
)
def test_one_that_could_not_be_ours_is_refused(tmp_path, manifest, changes):
    write_manifest(tmp_path, manifest)
    path = tmp_path / MANIFEST
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    with pytest.raises(FileError, match="was not written by ikde"):
        read_manifest(tmp_path)


def test_deep_ones_and_links_are_refused(tmp_path, manifest):
    (tmp_path / MANIFEST).write_text('{"recipe":' * 50_000)
    with pytest.raises(FileError, match=r"manifest\.json: nested too deeply"):
        read_manifest(tmp_path)
    (tmp_path / "elsewhere").mkdir()
    write_manifest(tmp_path / "elsewhere", manifest)
    (tmp_path / MANIFEST).unlink()
    (tmp_path / MANIFEST).symlink_to(tmp_path / "elsewhere" / MANIFEST)
    with pytest.raises(FileError, match=r"manifest\.json: is a symbolic link"):
        read_manifest(tmp_path)


@pytest.mark.parametrize("name", ["solutions", "timing"])
def test_a_run_whose_folders_are_links_is_refused(tmp_path, manifest, name):
    run = tmp_path / "run"
    run.mkdir()
    write_manifest(run, manifest)
    (tmp_path / "elsewhere").mkdir()
    (run / name).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(FileError, match=f"{name}: is a symbolic link; a run holds none"):
        read_manifest(run)


def test_a_folder_without_one_is_refused(tmp_path):
    with pytest.raises(FileError, match=r"holds no run of ikde: manifest.json: no such file"):
        read_manifest(tmp_path)


def test_one_that_cannot_be_written_is_an_error_in_one_line(tmp_path, manifest):
    with pytest.raises(FileError, match=r"manifest.json: cannot be written: No such file or directory$"):
        write_manifest(tmp_path / "gone", manifest)


@pytest.mark.parametrize(
    ("there", "now", "words"),
    [
        ({"s": {"strategy": "rand/1"}}, {"s": {"strategy": "best/1"}}, "s.strategy: 'rand/1' there, 'best/1' now"),
        ({"a": [1, 2]}, {"a": [1, 3]}, "a[1]: 2 there, 3 now"),
        ({"a": 1}, {"b": 1}, "a: 1 there, nothing now; b: nothing there, 1 now"),
        ({"a": {}}, {"a": {"b": None}}, "a: {} there, nothing now; a.b: nothing there, None now"),
        ({}, {"a": "x" * 99}, f"a: nothing there, '{'x' * 56}... now"),
    ],
)
def test_a_difference_is_told_by_key(there, now, words):
    assert words in describe_difference(there, now)


def test_of_many_differences_the_first_are_told():
    words = describe_difference(dict.fromkeys("abcde", 1), dict.fromkeys("abcde", 2))
    assert words == "a: 1 there, 2 now; b: 1 there, 2 now; c: 1 there, 2 now; and 2 more"
