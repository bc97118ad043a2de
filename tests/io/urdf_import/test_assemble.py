"""The robot out of its parts: spheres, pairs that are left out, home."""

import re

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.urdf_import import assemble
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.model.collision_model import CollisionModel
from ikde.solver.check import check
from ikde.solver.plain import compute_components
from tests.urdf_texts import ARM, change, extend, joint, write


def load(folder, text, **options):
    return read_urdf(write(folder, text), ImportOptions(**options))


def test_spheres_stand_where_the_file_has_them(tmp_path):
    robot = load(tmp_path, ARM).robot
    centres, radii = compute_components(CollisionModel.of(robot), np.array([0.0, 0.2]))["upper"]
    placed = robot.frames[1].R_parent_frame @ [0, 0, 0.3] + [0, 0, 0.2]
    np.testing.assert_allclose(centres, [placed], atol=1e-15)
    assert radii.tolist() == [0.05]


def test_neighbours_are_left_out_and_all_other_pairs_compared(tmp_path):
    collision = CollisionModel.of(load(tmp_path, ARM).robot)
    assert collision.pairs == (("base_link", "fore"),)
    assert [(pair.a, pair.b, pair.reason) for pair in collision.left_out_pairs] == [
        ("base_link", "upper", "joined by joint shoulder"),
        ("upper", "fore", "joined by joint slide"),
    ]


def test_a_pair_that_always_touches_is_left_out_and_that_is_said(tmp_path):
    imported = load(tmp_path, change('<sphere radius="0.1"/>', '<sphere radius="3"/>'))
    (pair,) = imported.robot.adjacent
    assert (pair.a, pair.b) == ("base_link", "fore")
    assert re.fullmatch(r"always touching: .* mm deep at least, proved for all values of shoulder, slide", pair.reason)
    assert imported.warnings == (
        "1 of 1 pairs always touch and are left out",
        "no two links are left that could collide: self-collision is not checked",
    )
    assert imported.robot.detectors == {}
    assert imported.is_home_free is None


def test_others_stay_compared_beside_it(tmp_path):
    far = '<link name="far"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
    text = extend(far + joint("wall", "fixed", "base_link", "far", '<origin xyz="9 0 0"/>'))
    text = text.replace('<sphere radius="0.1"/>', '<sphere radius="3"/>', 1)
    robot = load(tmp_path, text, tool="tip").robot
    assert CollisionModel.of(robot).pairs == (("upper", "far"), ("fore", "far"))


def test_a_robot_without_shapes_is_not_checked_and_that_is_said(tmp_path):
    text = ARM.replace("collision", "visual")
    imported = load(tmp_path, text)
    assert imported.robot.default_detector == "none"
    assert imported.warnings == ("no link has spheres: self-collision is not checked",)
    assert load(tmp_path, ARM, spheres=False).robot.approximations == {}


def test_masses_stand_at_the_frames_of_their_links(tmp_path):
    robot = load(tmp_path, ARM.replace('"upper"', '"tool"')).robot
    assert {name: inertia.mass_kg for name, inertia in robot.inertias.items()} == {"tool_link": 2.0}
    heavy = ARM.replace('name="base_link">', 'name="world"><inertial><mass value="5"/></inertial>')
    assert list(load(tmp_path, heavy.replace("base_link", "world")).robot.inertias) == ["upper"]


def test_a_home_that_collides_is_moved_and_that_is_said(tmp_path):
    imported = load(tmp_path, change('<sphere radius="0.1"/>', '<sphere radius="0.75"/>'))
    assert imported.home == "0, or mid-range where 0 is outside the limits; moved to a free configuration near it"
    assert imported.is_home_free
    robot = imported.robot
    assert robot.home.tolist() != [0.0, 0.25]
    assert not check(robot, robot.home).collision
    assert check(robot, [0.0, 0.25]).collision
    assert np.all((robot.lower <= robot.home) & (robot.home <= robot.upper))


def test_a_home_that_cannot_be_moved_stays_and_that_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(assemble, "find_free_home", lambda *_: None)
    imported = load(tmp_path, ARM)
    assert imported.is_home_free is False
    assert (
        imported.home == "0, or mid-range where 0 is outside the limits; it collides, and no free one was found near it"
    )
    assert imported.robot.home.tolist() == [0.0, 0.25]


@pytest.mark.parametrize(("limit", "what", "number"), [("MAX_JOINTS", "joints", 2), ("MAX_ENTRIES", "frames", 4)])
def test_what_no_robot_file_could_hold_is_refused(tmp_path, monkeypatch, limit, what, number):
    monkeypatch.setattr(assemble, limit, number)
    assert load(tmp_path, ARM).robot
    monkeypatch.setattr(assemble, limit, number - 1)
    with pytest.raises(FileError, match=f"{what}: a robot has at most {number - 1} {what}, and this one {number}"):
        load(tmp_path, ARM)


def test_so_are_more_spheres(tmp_path, monkeypatch):
    monkeypatch.setattr(assemble, "MAX_ENTRIES", 6)
    more = '<collision><geometry><sphere radius="0.05"/></geometry></collision>' * 4
    with pytest.raises(FileError, match="spheres: a robot has at most 6 spheres, and this one 7"):
        load(tmp_path, change('<link name="fore">', f'<link name="fore">{more}'))


def test_a_link_is_one_entry_of_spheres_in_its_own_frame(tmp_path):
    more = '<link name="fore"><collision><geometry><box size="0.05 0.05 0.2"/></geometry></collision>'
    robot = load(tmp_path, change('<link name="fore">', more)).robot
    entries = robot.approximations[assemble.SPHERES]
    assert [(entry.component, entry.start, entry.end) for entry in entries] == [
        (name, name, name) for name in ("base_link", "upper", "fore")
    ]
    assert not [frame.name for frame in robot.frames if "sphere" in frame.name]
    assert CollisionModel.of(robot).pairs == (("base_link", "fore"),)
    assert entries[2].count > 1
