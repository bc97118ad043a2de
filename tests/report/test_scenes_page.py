"""The page of a set of planning problems."""

from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.batch.scenes import Margins, ask, make_question, refuse
from ikde.errors import InputError
from ikde.io.world_file import load_world
from ikde.model.collision_model import CollisionModel
from ikde.report.page import Code, Details, Gallery, Table
from ikde.report.scenes_page import ScenesRun, make_scenes_page, scenes_json
from tests.three_joints import ROBOT

GOAL = {"reach": 0.25, "turn": 1.5, "shoulder": 0.7}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The run and its rows: one solved, one blocked by a ball, one that could not be asked."""
    folder = tmp_path_factory.mktemp("scenes")
    question, own = make_question(ROBOT, {}, GOAL), CollisionModel.of(ROBOT)
    place = question.target.p_world_tool
    texts = {"a/free": place + np.array([1.0, 0.0, 0.0]), "a/blocked": place, "b/gone": place}
    rows, scenes = {}, {}
    for name, p in texts.items():
        path = folder / f"{name.replace('/', '-')}.yaml"
        world = {"obstacles": {"ball": {"sphere": {"radius": 0.1}, "position": p.tolist()}}}
        ikde.write_world(load_world(world), path)
        scenes[name] = (name[0], path)
        rows[name] = ask(question, own, load_world(path), Margins())
    rows["b/gone"] = refuse(InputError("no such frame"))
    known = {"own": own, "robot": "three.yaml", "has_tool": False, "margins": Margins()}
    return ScenesRun(folder=Path("set"), scenes=scenes, command="again", **known), rows


def test_families_blockers_and_the_hardest_are_there(made):
    run, rows = made
    page = make_scenes_page(run, rows)
    assert page.lead[0].items[0].value == "1 of 3"
    sections = {section.title: section.blocks for section in page.sections}
    assert list(sections) == ["By family", "What stood in the way", "The hardest", "Not solved", "What ran"]
    table = sections["By family"][0]
    assert isinstance(table, Table)
    assert [row[:3] for row in table.rows] == [("a", "2", "1"), ("b", "1", "0"), ("all", "3", "1")]
    assert sections["What stood in the way"][0].rows[0] == ("ball", "1", "1")
    gallery, first, second = sections["The hardest"]
    assert isinstance(gallery, Gallery)
    assert [figure.alt for figure in gallery.figures] == ["the robot in a/blocked", "the robot in a/free"]
    assert isinstance(first, Details)
    assert first.summary.startswith("a/blocked: not solved, world")
    assert second.summary.startswith("a/free: took ")
    (command,) = [block.text for block in first.blocks if isinstance(block, Code)]
    assert command.startswith("ikde solve --robot three.yaml --world ")
    assert [row[0] for row in sections["Not solved"][0].rows] == ["a/blocked", "b/gone"]


def test_data_of_a_part_is_not_finished(made):
    run, rows = made
    assert scenes_json(run, rows)["finished"]
    some = scenes_json(run, {"a/free": rows["a/free"]})
    assert not some["finished"]
    assert some["all"]["reached"] == some["families"][0]["reached"] == 1
