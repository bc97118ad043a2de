"""Joint values as people type them."""

import json

import pytest

from ikde.errors import InputError
from ikde.io.joint_text import parse_freeze, parse_joints

ROW = "-0.0008 0.8659 1.6368 1.0156 0.9326 -0.0388 0.4905 2.8275 0.6857"


def test_a_row_of_the_paper_is_read_in_mm_and_rad(qiao):
    values = parse_joints(qiao, ROW, "mm", "rad")
    assert values[:3] == pytest.approx([-0.0000008, 0.0008659, 1.6368])


@pytest.mark.parametrize("text", [ROW.replace(" ", ", "), f"[{ROW}]", f"({ROW})", ROW.replace("-", "−"), f"  {ROW}\n"])
def test_brackets_commas_and_typographic_minus_do_not_matter(qiao, text):
    assert parse_joints(qiao, text, "m", "rad") == parse_joints(qiao, ROW, "m", "rad")


def test_pairs_are_read_in_any_order(qiao):
    assert parse_joints(qiao, "q1=90, d_x=-20", "mm", "deg") == pytest.approx({"q1": 1.5707963267948966, "d_x": -0.02})


@pytest.mark.parametrize("content", [{"q1": 1, "d_y": 2.5}, [1, 2, 3, 4, 5, 6, 7, 8, 9]])
def test_a_json_file_is_read(qiao, content, tmp_path):
    path = tmp_path / "q.json"
    path.write_text(json.dumps(content))
    values = parse_joints(qiao, str(path), "m", "rad")
    assert values == content


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 2 3", "expected 9 joint values"),
        ("1 2 3 4 5 6 7 8 x", "expected a number, got 'x'"),
        ("q1=1 2", "expected name=value, got '2'"),
        ("q1=1 q1=2", "given twice"),
        ("q7=1", "no joint is called 'q7'"),
        ("q1=", "expected a number"),
        ("nowhere.yaml", "no such file"),
        ("", "expected 9 joint values"),
    ],
)
def test_bad_words_are_one_line(qiao, text, words):
    with pytest.raises(InputError, match=words) as caught:
        parse_joints(qiao, text, "m", "rad")
    assert "\n" not in str(caught.value)


def test_a_file_with_text_in_it_names_its_line(qiao, tmp_path):
    path = tmp_path / "q.yaml"
    path.write_text("q1: 0.5\nq2: half\n")
    with pytest.raises(InputError, match=r"q.yaml:2 → q2: expected a number"):
        parse_joints(qiao, str(path), "m", "rad")


def test_freeze_takes_values_and_bare_names(qiao):
    assert parse_freeze(qiao, "d_x=200,q_z", "mm", "deg") == {"d_x": 0.2, "q_z": None}


def test_freeze_refuses_an_unknown_joint(qiao):
    with pytest.raises(InputError, match="did you mean 'q_z'"):
        parse_freeze(qiao, "q_zz", "m", "rad")
