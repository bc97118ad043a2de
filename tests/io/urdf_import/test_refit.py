"""Spheres of links exchanged in a robot: pairs and home follow, all else stays."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import FileError, InputError
from ikde.io.urdf_import.cover_links import LinkSpheres
from ikde.io.urdf_import.imported import CoveredLink
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.refit import UrdfShapes, exchange_spheres, list_link_spheres, read_comments
from tests.urdf_texts import ARM, change, write


def make(link, *balls):
    rows = np.array(balls)
    report = CoveredLink(link=link, shapes="", spheres=len(rows), covered=None, protrusion_m=None, how="")
    return {link: LinkSpheres(centres=rows[:, :3], radii=rows[:, 3], report=report)}


@pytest.fixture
def arm(tmp_path):
    return ikde.import_urdf(write(tmp_path, ARM))


def test_one_link_changes_and_the_others_stay(arm):
    robot, notes = exchange_spheres(arm, make("upper", (0, 0, 0.3, 0.04), (0, 0, 0.2, 0.04)))
    before, after = list_link_spheres(arm), list_link_spheres(robot)
    assert list(before) == list(after) == ["base_link", "upper", "fore"]
    np.testing.assert_array_equal(after["upper"], [[0, 0, 0.3, 0.04], [0, 0, 0.2, 0.04]])
    np.testing.assert_array_equal(after["fore"], before["fore"])
    assert notes == []
    assert (robot.pair_lists, robot.joints) == (arm.pair_lists, arm.joints)
    assert replace(robot, approximations=arm.approximations) == arm


def test_a_link_may_get_its_first_spheres(arm):
    robot, _ = exchange_spheres(arm, make("tip", (0, 0, 0.1, 0.01)))
    assert list(list_link_spheres(robot)) == ["base_link", "upper", "fore", "tip"]
    assert ("base_link", "tip") in robot.pair_lists["non_adjacent"]


def test_pairs_that_always_touch_are_found_anew(arm):
    large, notes = exchange_spheres(arm, make("fore", (0, 0, 0, 2.0)))
    assert [(pair.a, pair.b) for pair in large.adjacent] == [("base_link", "fore")]
    assert large.adjacent[0].reason.startswith("always touching: ")
    assert any("always touch" in note for note in notes)
    small, notes = exchange_spheres(large, make("fore", (0, 0, 0, 0.04)))
    assert (small.adjacent, notes) == ((), [])
    assert small.pair_lists == arm.pair_lists


def test_a_pair_that_a_joint_joins_is_compared_again(tmp_path):
    balls = "{upper: [{center: [0, 0, 0.3], radius: 0.05}], fore: [{center: [0, 0, 0], radius: 2}]}"
    text = f"robot_cfg: {{kinematics: {{collision_spheres: {balls}, self_collision_ignore: {{}}}}}}"
    robot = ikde.import_urdf(write(tmp_path, ARM), spheres=write(tmp_path, text, "spheres.yml"))
    assert [(pair.a, pair.b) for pair in robot.adjacent] == [("upper", "fore")]
    robot, _ = exchange_spheres(robot, make("fore", (0, 0, 0, 0.04)))
    assert robot.adjacent == ()
    assert ikde.CollisionModel.of(robot).pairs == (("upper", "fore"),)


def test_a_home_that_collides_now_is_a_warning(arm):
    home = ikde.check(arm, arm.home).clearance_m
    _, notes = exchange_spheres(arm, make("fore", (0, 0, 0, 0.04 + home + 0.01)))
    assert notes[-1] == "home collides with these spheres"
    wide = replace(arm.detectors["spheres"], safe_distance_m=home)
    _, notes = exchange_spheres(replace(arm, detectors={"spheres": wide}), make("fore", (0, 0, 0, 0.041)))
    assert notes[-1] == "home collides with these spheres"


def test_the_safe_distance_is_kept(arm):
    wide = replace(arm.detectors["spheres"], safe_distance_m=0.01)
    robot, _ = exchange_spheres(replace(arm, detectors={"spheres": wide}), make("fore", (0, 0, 0, 0.03)))
    assert robot.detectors == {"spheres": wide}


def test_a_frame_that_there_is_not_and_rows_are_refused(arm):
    with pytest.raises(InputError, match=r"no frame of the robot is called 'uper' \(did you mean 'upper'\?\)"):
        exchange_spheres(arm, make("uper", (0, 0, 0, 1)))
    ur5 = ikde.load_robot("ur5")
    name = next(row.component for row in ur5.approximations[ur5.detectors[ur5.default_detector].spheres])
    if name in [frame.name for frame in ur5.frames]:
        with pytest.raises(InputError, match="do not stand in the frame of its name"):
            exchange_spheres(ur5, make(name, (0, 0, 0, 1)))
    assert list_link_spheres(ur5) == {}


def test_shapes_are_covered_compared_and_drawn(tmp_path):
    text = change('<sphere radius="0.05"/>', '<box size="0.1 0.1 0.4"/>')
    shapes = UrdfShapes.read(write(tmp_path, text), ImportOptions())
    made = shapes.cover("upper", 0.02)
    assert len(made.radii) > len(shapes.cover("upper", 0.05).radii)
    spheres = np.column_stack([made.centres, made.radii])
    known = shapes.describe("upper", spheres)
    assert (known.shapes, known.covered, known.how) == ("1 box", 1.0, "as in the robot's file")
    assert known.protrusion_m == pytest.approx(made.report.protrusion_m)
    assert shapes.describe("upper", spheres[1:], made.report).how.startswith(made.report.how)
    assert shapes.describe("tip", spheres).covered is None
    assert [len(shapes.list_triangles(name)) for name in ("upper", "tip")] == [12, 0]


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ("uper", r"arm\.urdf → link: no link is called 'uper' \(did you mean 'upper'\?\)"),
        ("tip", "the link 'tip' has no collision shapes to cover"),
    ],
)
def test_a_link_without_shapes_is_refused(tmp_path, link, message):
    shapes = UrdfShapes.read(write(tmp_path, ARM), ImportOptions())
    with pytest.raises(FileError, match=message):
        shapes.cover(link, 0.02)


def test_comments_on_top_of_a_file_are_kept(tmp_path):
    path = write(tmp_path, "# one\n#two\nname: a\n# three\n", "a.yaml")
    assert read_comments(path) == ["one", "two"]
