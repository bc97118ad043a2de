"""Whether a world fits a robot: all that does not, with its line."""

import pytest

from ikde.errors import FileError
from ikde.io.world_file import read_world
from ikde.io.world_fit import check_fit
from ikde.model.collision_model import CollisionModel
from tests.three_joints import ROBOT

WRONG = """obstacles:
  a: {box: [1, 1, 1], frame: sleev, position: [5, 0, 0]}
  b: {box: [1, 1, 1], frame: tip, position: [5, 0, 0]}
  c: {box: [1, 1, 1], position: [5, 0, 0], ignore: [hand, arms]}
  d: {half_space: {}, position: [0, 0, -0.1]}
"""


@pytest.fixture
def read(tmp_path):
    def call(text):
        (tmp_path / "w.yaml").write_text(text, encoding="utf-8")
        return read_world(tmp_path / "w.yaml")

    return call


def test_all_that_does_not_fit_is_named(read):
    with pytest.raises(FileError) as caught:
        check_fit(read(WRONG), CollisionModel.of(ROBOT))
    lines = [str(caught.value), *caught.value.__notes__]
    assert [line.split("w.yaml:")[1] for line in lines] == [
        "2 → obstacles.a.frame: no frame that stays in its place is called 'sleev'",
        "3 → obstacles.b.frame: no frame that stays in its place is called 'tip': a joint moves it",
        "4 → obstacles.c.ignore[1]: no component is called 'arms' (did you mean 'arm'?)",
        "5 → obstacles.d: touched in every configuration: floor -100 mm; "
        "if that is meant, write `ignore: [floor]` there",
    ]


def test_what_fits_says_what_is_always_near(read):
    (pair,) = check_fit(read("obstacles: {d: {half_space: {}, position: [0, 0, -0.21]}}"), CollisionModel.of(ROBOT))
    assert (pair.component, pair.obstacle, round(pair.clearance_m, 6)) == ("floor", "d", 0.01)
