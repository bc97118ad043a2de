"""Sets of scenes and requests: which belong together, what is asked, and what is wrong with one."""

import pytest

from ikde.errors import FileError
from ikde.io.scene_pairs import find_pairs, read_request
from tests.scene_set import REQUEST, write_set


def test_a_scene_has_its_request_beside_it(tmp_path):
    families = find_pairs(write_set(tmp_path))
    assert {name: [pair.name for pair in pairs] for name, pairs in families.items()} == {
        "shelf": ["shelf/scene0001", "shelf/scene0002"],
        "table": ["table/scene0001"],
    }
    first, second = families["shelf"]
    assert first.request.name == "request0001.yaml"
    assert first.digest != second.digest
    before = first.digest
    first.request.write_text(REQUEST + "\n", encoding="utf-8")
    assert first.digest != before


def test_a_folder_of_one_family_is_called_like_it(tmp_path):
    write_set(tmp_path)
    assert list(find_pairs(tmp_path / "problems" / "table")) == ["table"]


def test_a_scene_without_its_request_is_named(tmp_path):
    (write_set(tmp_path) / "problems" / "table" / "request0001.yaml").unlink()
    with pytest.raises(FileError, match=r"table/scene0001.yaml: has no request0001.yaml beside it"):
        find_pairs(tmp_path)


def test_a_folder_without_scenes_is_refused(tmp_path):
    with pytest.raises(FileError, match=r"holds no scene"):
        find_pairs(tmp_path)
    with pytest.raises(FileError, match=r"expected a folder"):
        find_pairs(tmp_path / "none")


def test_a_request_is_read_by_name(tmp_path):
    path = tmp_path / "request.yaml"
    path.write_text(REQUEST, encoding="utf-8")
    request = read_request(path)
    assert request.start == {"reach": 0.1, "turn": 0.0, "shoulder": 0.0, "finger": 0.4}
    assert request.goal == {"reach": 0.25, "turn": 1.5, "shoulder": 0.7}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "position: 0.25",
            "position: much",
            r":5 → .*joint_constraints\[0\].position: expected a finite",
        ),
        ("joint_name: turn", "joint_name: reach", r":6 → .*\[1\].joint_name: 'reach' is asked twice"),
        ("[0.1, 0, 0, 0.4]", "[0.1, 0, 0]", r":2 → start_state.joint_state: 4 names, but 3 positions"),
        ("  - joint_constraints:", "  - position_constraints:", r":4 → .*joint_constraints: expected the goal's joint"),
    ],
)
def test_what_is_wrong_has_its_line(tmp_path, old, new, message):
    path = tmp_path / "request.yaml"
    path.write_text(REQUEST.replace(old, new), encoding="utf-8")
    with pytest.raises(FileError, match=message):
        read_request(path)
