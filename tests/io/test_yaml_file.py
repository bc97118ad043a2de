"""YAML: numbers as people write them, the line of every value, and never a traceback."""

import os

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.errors import FileError
from ikde.io.yaml_file import Document, read_yaml


def load(text, tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text(text)
    return read_yaml(path)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-6", 1e-6),
        ("1.5e8", 1.5e8),
        ("1E3", 1e3),
        ("+2.5e+3", 2.5e3),
        (".5", 0.5),
        ("5.", 5.0),
        ("-3", -3),
        ("1_000", 1000),
        ("1_000.5", 1000.5),
        ("010", 10),
    ],
)
def test_every_spelling_of_a_number_is_a_number(text, value, tmp_path):
    data = load(f"x: {text}", tmp_path).data
    assert data == {"x": value}
    assert not isinstance(data["x"], str)


@pytest.mark.parametrize("word", ["on", "off", "yes", "no", "y", "n", "1:30", "0x", "e5", "1e", "nanometre"])
def test_words_stay_words(word, tmp_path):
    assert load(f"x: {word}", tmp_path).data == {"x": word}


def test_true_false_and_null_are_read(tmp_path):
    assert load("[true, False, null, ~, '']", tmp_path).data == [True, False, None, None, ""]


def test_a_value_knows_its_line(tmp_path):
    document = load("a:\n  b:\n    - 1\n    - c: 2\n", tmp_path)
    assert document.line(("a", "b", 1, "c")) == 4
    assert document.line(("a", "b", 1, "missing")) == 4


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: [1, 2\nb: 3", 2, "not YAML"),
        ("a: 1\na: 2", 2, "given twice"),
        ("? [1, 2]\n: 3", 1, "a key must be a word"),
        ("a: !!python/object:os.system x", 1, "is not read here"),
        ("a: !!int x", 1, "does not fit its tag"),
        ("a: &x [*x]", 1, "alias"),
        ("a: [1, 2}", 1, "not YAML"),
        ("\tb: 1", 1, "a tab; YAML wants spaces"),
        ("a:\n\tb: 1", 2, "a tab; YAML wants spaces"),
        ("a: 1\nb:\n  c: 1\n\td: 2", 4, "a tab; YAML wants spaces"),
    ],
)
def test_bad_yaml_is_one_line_with_its_place(text, line, words, tmp_path):
    with pytest.raises(FileError) as caught:
        load(text, tmp_path)
    message = str(caught.value)
    assert f"a.yaml:{line}" in message
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "a.yaml: the file is empty"),
        (" \n\n", "a.yaml: the file is empty"),
        (
            '<?xml version="1.0"?>\n<robot name="a"/>',
            "a.yaml: this is a URDF; expected YAML (`ikde robots import FILE.urdf`",
        ),
        ('\n<robot xmlns:xacro="http://ros.org/wiki/xacro"/>', "a.yaml: this is xacro; expected YAML (`xacro FILE > "),
        (
            '<robot name="a"><group_state name="home"/></robot>',
            "a.yaml: this is an SRDF; expected YAML (`ikde robots import",
        ),
        ("<mujoco model='a'/>", "a.yaml: this is MJCF; expected YAML"),
        ("<html/>", "a.yaml: this is XML; expected YAML"),
    ],
)
def test_files_of_other_kinds_are_named(text, words, tmp_path):
    with pytest.raises(FileError) as caught:
        load(text, tmp_path)
    assert str(caught.value).removeprefix(f"{tmp_path}/").startswith(words)


def test_a_comment_alone_is_no_empty_file(tmp_path):
    assert load("# nothing yet", tmp_path).data is None


def test_deep_nesting_is_refused(tmp_path):
    with pytest.raises(FileError, match="nested too deeply"):
        load("[" * 300 + "]" * 300, tmp_path)


def make_bomb(levels):
    """Lists of ten aliases of lists of ten aliases ..., so many levels above ten words."""
    lines = ["a0: &a0 [" + ", ".join("x" * 10) + "]"]
    lines += [f"a{k}: &a{k} [" + ", ".join([f"*a{k - 1}"] * 10) + "]" for k in range(1, levels + 1)]
    return "\n".join(lines)


@pytest.mark.parametrize("levels", [5, 12, 30])
def test_aliases_of_aliases_are_refused_at_once(levels, tmp_path):
    with pytest.raises(FileError, match=r"a.yaml:6 → a5\[\d\]: too many values, aliases counted"):
        load(make_bomb(levels), tmp_path)


def test_aliases_in_reason_are_read(tmp_path):
    data = load("a: &a [1, 2]\nb: [*a, *a]\nc: {d: *a}\n", tmp_path).data
    assert data == {"a": [1, 2], "b": [[1, 2], [1, 2]], "c": {"d": [1, 2]}}
    assert len(load(make_bomb(2), tmp_path).data["a2"]) == 10


def test_an_error_behind_an_alias_is_where_it_was_written(tmp_path):
    document = load("a: &a\n  x: 1\nb:\n  c: *a\n", tmp_path)
    assert document.line(("b", "c", "x")) == 2
    assert document.line(("b", "c")) == 4


def test_aliases_that_pile_up_levels_are_refused(tmp_path):
    lines = ["a0: &a0 [1]", *(f"a{k}: &a{k} [*a{k - 1}]" for k in range(1, 100))]
    with pytest.raises(FileError, match=r"a.yaml:\d+ → a\d+\[0\]: nested too deeply; expected at most 40 levels"):
        load("\n".join(lines), tmp_path)


@pytest.mark.parametrize("text", ["*a", "a: *b", "a: &a {b: *a}", "{*a : 1}", "1\n---\n2"])
def test_aliases_of_nothing_and_second_documents_are_one_line(text, tmp_path):
    with pytest.raises(FileError, match=r"a\.yaml:\d"):
        load(text, tmp_path)


def test_values_are_counted_while_they_are_read(tmp_path, monkeypatch):
    monkeypatch.setattr("ikde.io.yaml_file.MAX_VALUES", 100)
    assert len(load("[" + "1," * 99 + "]", tmp_path).data) == 99
    with pytest.raises(FileError, match=r"too many values"):
        load("[" + "1," * 100 + "]" * 10_000, tmp_path)  # the end, which is no YAML, is not reached


def test_a_text_beyond_the_limit_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "1")
    with pytest.raises(FileError, match=r"a\.yaml: 0\.124 MB; expected at most 0\.1 MB"):
        load("#" * 124_000, tmp_path)


def test_a_pipe_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "a.yaml")
    with pytest.raises(FileError, match="this is a pipe"):
        read_yaml(tmp_path / "a.yaml")


def test_a_number_without_end_is_quoted_in_few_words(tmp_path):
    with pytest.raises(FileError) as caught:
        load("x: " + "9" * 10_000, tmp_path)
    assert "does not fit its tag" in str(caught.value)
    assert len(str(caught.value)) < 300


def test_missing_file_folder_and_binary_are_refused(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        read_yaml(tmp_path / "nope.yaml")
    with pytest.raises(FileError, match="a folder"):
        read_yaml(tmp_path)
    (tmp_path / "b.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="not a UTF-8"):
        read_yaml(tmp_path / "b.yaml")


@given(st.text(max_size=200))
@settings(max_examples=200)
def test_any_text_is_data_or_one_line(text):
    try:
        Document("fuzz.yaml", text)  # type: ignore[arg-type]
    except FileError as error:
        assert "\n" not in str(error)
