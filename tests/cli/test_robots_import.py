"""`ikde robots import`: a file that all commands take, or one line and nothing written."""

import ikde
from tests.urdf_texts import ARM, FINGERS, change, extend, write


def test_a_urdf_becomes_a_robot_file(cli, tmp_path):
    path, out = write(tmp_path, extend(FINGERS)), tmp_path / "arm.yaml"
    outcome = cli("robots", "import", path, "--tool", "tip", "--base", "omni", "--hold", "grip=0.02", "-o", out)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.endswith(f"wrote {out}\n")
    assert "joints that move the tool" in outcome.out
    robot = ikde.load_robot(out)
    same = ikde.import_urdf(path, tool="tip", base="omni", hold={"grip": 0.02})
    assert robot.joints == same.joints
    assert (robot.drive, robot.default_detector) == ("omnidirectional", "spheres")
    assert "# frozen: grip (prismatic) at 0.02: asked for, --hold" in out.read_text()
    assert cli("robots", "validate", out).code == 0


def test_without_a_file_nothing_is_written(cli, tmp_path):
    outcome = cli("robots", "import", write(tmp_path, ARM), "--json")
    assert outcome.err == "ikde: nothing is written without -o FILE\n"
    assert outcome.data["tool"] == "tip"
    assert [path.name for path in tmp_path.iterdir()] == ["arm.urdf"]


def test_all_that_is_asked_for_arrives(cli, tmp_path):
    mesh = change('<sphere radius="0.05"/>', '<mesh filename="package://arm/a.stl"/>')
    path = write(tmp_path, mesh)
    state = '<group_state name="home" group="g"><joint name="shoulder" value="0.5"/></group_state>'
    srdf = write(tmp_path, f'<robot name="arm">{state}</robot>', "arm.srdf")
    asked = ("--base", "differential", "--base-reach", "7", "--srdf", srdf, "--no-spheres", "--protrusion", "5")
    joints = cli("robots", "import", path, *asked, "--json").data["joints"]
    assert [joint["name"] for joint in joints] == ["base_x", "base_y", "base_yaw", "shoulder", "slide"]
    assert (joints[0]["upper"], joints[3]["home"]) == (7.0, 0.5)
    assert cli("robots", "import", path, "--base", "mecanum", "--no-spheres", "--json").data["drive"] == "mecanum"
    refused = cli("robots", "import", path, "--package-path", tmp_path)
    assert refused.code == 2
    assert "the mesh 'package://arm/a.stl' is not in this folder" in refused.err


def test_what_is_wrong_is_one_line_and_nothing_is_written(refuse, tmp_path):
    out = tmp_path / "out.yaml"
    for text, asked, message in (
        (extend(FINGERS), (), "which link is the tool? it has 3 ends: tip, left, right"),
        (ARM, ("--tool", "tipp"), "did you mean 'tip'?"),
        (ARM, ("--hold", "slide"), "hold: expected JOINT=VALUE"),
        (ARM, ("--base-reach", "-1"), "base_reach_m: expected a number above 0"),
        ("<!DOCTYPE r><robot/>", (), "a DOCTYPE is not read here"),
    ):
        said = refuse("robots", "import", write(tmp_path, text), "-o", out, *asked)
        assert message in said
    assert not out.exists()


def test_every_command_takes_a_urdf(cli, tmp_path):
    path = write(tmp_path, ARM)
    assert cli("robots", "show", path).code == 0
    assert cli("robots", "validate", path).code == 0
    assert cli("fk", "--robot", path, "--json").data
    solved = cli("solve", "--robot", path, "--position", "0.3", "0.1", "0.9", "--json")
    assert solved.code in (0, 1)
    assert "Traceback" not in solved.err


def test_a_name_is_looked_for_in_installed_packages(cli, tmp_path, monkeypatch):
    path = write(tmp_path, ARM)
    monkeypatch.setattr("ikde.io.urdf_import.installed.find_installed", lambda name: (path, (tmp_path,)))
    assert cli("robots", "import", "arm", "--json").data["file"] == str(path)


def test_spheres_come_from_a_file_and_go_to_one(cli, refuse, tmp_path):
    path, out, curobo = write(tmp_path, ARM), tmp_path / "arm.yaml", tmp_path / "curobo.yml"
    assert cli("robots", "import", path, "-o", out).code == 0
    written = cli("robots", "export", out, "--curobo", "--out", curobo)
    assert (written.code, written.out) == (0, f"wrote {curobo}\nwrote {tmp_path / 'curobo.urdf'}\n")
    assert written.err.startswith("ikde: cuRobo does not hold: joint limits")
    curobo.write_text(curobo.read_text().replace("upper:", "uper:"), encoding="utf-8")
    outcome = cli("robots", "import", path, "--spheres", curobo, "--json")
    assert [(own["link"], own["how"]) for own in outcome.data["spheres"]] == [
        ("base_link", "as in curobo.yml (cuRobo)"),
        ("fore", "as in curobo.yml (cuRobo)"),
    ]
    assert "curobo.yml has spheres for links that there are not: uper" in outcome.data["warnings"]
    assert "which are not checked: upper" in cli("robots", "import", path, "--spheres", curobo).out
    both = refuse("robots", "import", path, "--spheres", curobo, "--no-spheres")
    assert "expected one of --spheres and --no-spheres" in both


def test_what_is_read_is_not_written_over(refuse, tmp_path):
    path, srdf = write(tmp_path, ARM), write(tmp_path, '<robot name="arm"/>', "arm.srdf")
    for out in (path, srdf, tmp_path / ".." / tmp_path.name / path.name):
        before = out.read_bytes()
        said = refuse("robots", "import", path, "--srdf", srdf, "-o", out)
        assert "is what is read; expected another file to write" in said
        assert out.read_bytes() == before


def test_a_name_that_no_file_can_have_is_refused(refuse):
    assert "no robot 'xxx" in refuse("robots", "import", "x" * 5000)
