"""Ignored pairs and homes in cuRobo's files and XRDF, and what is no such thing."""

import pytest

import ikde
from ikde.errors import FileError
from ikde.io.sphere_files import read_spheres
from ikde.io.srdf import DisabledPair
from tests.urdf_texts import ARM, write

BALLS = "{base_link: [{center: [0, 0, 0], radius: 0.1}], fore: [{center: [0, 0, 0], radius: 0.1}]}"
CUROBO = f"""\
robot_cfg:
  kinematics:
    collision_spheres: {BALLS}
    self_collision_ignore: {{base_link: [fore, nowhere]}}
    cspace: {{joint_names: [shoulder, slide], retract_config: [0.5, 0.2]}}
"""
XRDF = f"""\
format: xrdf
default_joint_positions: {{shoulder: 0.5, slide: 0.2}}
geometry: {{own: {{spheres: {BALLS}}}}}
self_collision: {{geometry: own, ignore: {{base_link: [fore, nowhere]}}}}
"""
FILES = pytest.mark.parametrize("text", [CUROBO, XRDF])


@FILES
def test_ignored_pairs_and_home_are_read(tmp_path, text):
    ignored = read_spheres(write(tmp_path, text, "spheres.yml")).ignored
    pairs = [("base_link", "fore"), ("base_link", "nowhere")]
    assert ignored.disabled == tuple(DisabledPair(a=a, b=b, reason="ignored") for a, b in pairs)
    assert ignored.choose_states()[1] == {"shoulder": 0.5, "slide": 0.2}
    assert ignored.is_whole


@FILES
def test_an_import_keeps_them(tmp_path, text):
    imported = ikde.read_urdf(write(tmp_path, ARM), ikde.ImportOptions(spheres=write(tmp_path, text, "spheres.yml")))
    assert imported.robot.home.tolist() == [0.5, 0.2]
    assert imported.home == "spheres.yml state home"
    (pair,) = imported.robot.adjacent
    assert (pair.a, pair.b, pair.reason) == ("base_link", "fore", "spheres.yml: ignored")
    assert "spheres.yml names links that there are not: nowhere" in imported.warnings


def test_a_file_of_any_name_leaves_pairs_out(tmp_path):
    spheres = write(tmp_path, CUROBO, "a\nb\x1b.yml")
    (pair,) = ikde.import_urdf(write(tmp_path, ARM), spheres=spheres).adjacent
    assert pair.reason == r"a\nb\x1b.yml: ignored"


def test_neighbours_are_compared_if_a_list_is_there_that_does_not_ignore_them(tmp_path):
    balls = "{upper: [{center: [0, 0, 0.3], radius: 0.05}], fore: [{center: [0, 0, 0], radius: 0.04}]}"
    path = write(tmp_path, ARM)
    for listed, count in (("    self_collision_ignore: {}\n", 1), ("", 0)):
        spheres = write(tmp_path, f"robot_cfg:\n  kinematics:\n    collision_spheres: {balls}\n{listed}", "s.yml")
        assert len(ikde.import_urdf(path, spheres=spheres).pair_lists.get("non_adjacent", ())) == count


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("{base_link: [fore, nowhere]}", "[base_link]", "self_collision_ignore: expected links with lists of links"),
        ("{base_link: [fore, nowhere]}", "5", r"yml:4 → robot_cfg.kinematics.self_collision_ignore: expected"),
        ("{base_link: [fore, nowhere]}", "{base_link: 5}", "expected links with lists of links"),
        ("{base_link: [fore, nowhere]}", "{base_link: [1]}", "expected links with lists of links"),
        ("[0.5, 0.2]", "[0.5]", "retract_config: expected 2 numbers within 100000 of 0, one a joint"),
        ("[0.5, 0.2]", "[0.5, .nan]", "retract_config: expected 2 numbers"),
        ("[0.5, 0.2]", f"[0.5, {'9' * 400}]", "retract_config: expected 2 numbers"),
        ("[0.5, 0.2]", "[0.5, much]", "expected 2 numbers"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, old, new, message):
    assert old in CUROBO
    with pytest.raises(FileError, match=message.replace("[", r"\[")) as caught:
        read_spheres(write(tmp_path, CUROBO.replace(old, new), "spheres.yml"))
    assert "\n" not in str(caught.value)
