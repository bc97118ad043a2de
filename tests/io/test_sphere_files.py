"""Spheres out of cuRobo's robot files, XRDF and SRDF; what is no sphere is one line."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ikde.errors import FileError
from ikde.io import sphere_files
from ikde.io.sphere_files import read_spheres

BALLS = "{upper: [{center: [0, 0, 0.1], radius: 0.05}, {center: [1, 2, 3], radius: 1e-1}], tip: []}"
FOUND = {"upper": ((0.0, 0.0, 0.1, 0.05), (1.0, 2.0, 3.0, 0.1)), "tip": ()}
SRDF = """<robot name="arm">
  <link_sphere_approximation link="upper">
    <sphere center="0 0 0.1" radius="0.05"/><sphere center="1 2 3" radius="0.1"/>
  </link_sphere_approximation>
  <link_sphere_approximation link="tip"><sphere center="0 0 0" radius="0"/></link_sphere_approximation>
</robot>"""


def read(folder: Path, text: str, name: str = "spheres.yml"):
    (folder / name).write_text(text, encoding="utf-8")
    return read_spheres(folder / name)


@pytest.mark.parametrize(
    "text",
    [
        f"collision_spheres: {BALLS}",
        f"robot_cfg: {{kinematics: {{collision_spheres: {BALLS}}}}}",
        f"kinematics: {{collision_spheres: {BALLS}}}",
    ],
)
def test_spheres_of_curobo_are_found_wherever_they_stand(tmp_path, text):
    file = read(tmp_path, text)
    assert (file.kind, file.spheres, file.notes) == ("cuRobo", FOUND, ())


def test_a_file_of_spheres_is_followed_within_the_folder_only(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "balls.yml").write_text(f"collision_spheres: {BALLS}", encoding="utf-8")
    assert read(tmp_path, "robot_cfg: {kinematics: {collision_spheres: deep/balls.yml}}").spheres == FOUND
    for name in ("../balls.yml", "missing.yml", "/etc/passwd", "deep"):
        with pytest.raises(FileError, match=r"spheres\.yml:1 → .*is not in its folder; name that file"):
            read(tmp_path, f"collision_spheres: {name}")
    for text in ("collision_spheres: round.yml", "robot_cfg: {kinematics: {collision_spheres: round.yml}}"):
        (tmp_path / "round.yml").write_text(text, encoding="utf-8")
        with pytest.raises(FileError, match=r"round\.yml:1 → .*expected links with their spheres"):
            read(tmp_path, text)


def test_xrdf_has_one_geometry_or_names_it(tmp_path):
    file = read(tmp_path, f"format: xrdf\ngeometry: {{all: {{spheres: {BALLS}}}}}", "arm.xrdf")
    assert (file.kind, file.spheres) == ("XRDF", FOUND)
    two = f"geometry: {{a: {{spheres: {{}}}}, b: {{spheres: {BALLS}}}, c: {{clone: b}}}}\n"
    for chosen in ("b", "c"):
        assert read(tmp_path, f"{two}collision: {{geometry: {chosen}}}").spheres == FOUND
    with pytest.raises(FileError, match=r"expected collision\.geometry, which names one of them"):
        read(tmp_path, two)
    with pytest.raises(FileError, match="no geometry is called 'd'"):
        read(tmp_path, f"{two}collision: {{geometry: d}}")


def test_srdf(tmp_path):
    file = read(tmp_path, SRDF, "arm.srdf")
    assert (file.kind, file.spheres) == ("SRDF", FOUND)
    assert file.notes == ("1 sphere without a radius above 0",)


def test_what_is_not_taken_over_is_listed(tmp_path):
    text = "collision_spheres: {a: [{center: [0, 0, 0], radius: -10}, {center: [0, 0, 0], radius: 1}]}\n"
    assert read(tmp_path, text + "collision_sphere_buffer: 0.005\nself_collision_buffer: {a: 0}").notes == (
        "collision_sphere_buffer is not added to radii",
        "1 sphere without a radius above 0",
    )
    (tmp_path / "balls.yml").write_text(f"self_collision_buffer: 1\ncollision_spheres: {BALLS}", encoding="utf-8")
    assert read(tmp_path, "collision_spheres: balls.yml\ncollision_sphere_buffer: 0.005").notes == (
        "collision_sphere_buffer is not added to radii",
        "self_collision_buffer is not added to radii",
    )
    xrdf = f"geometry: {{g: {{spheres: {BALLS}}}}}\nself_collision: {{geometry: g, buffer_distance: {{upper: 0.01}}}}\n"
    assert read(tmp_path, xrdf + "modifiers: [{set_base_frame: a}]").notes == (
        "self_collision.buffer_distance is not added to radii",
        "modifiers, such as frames that are added, are not made",
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("joints: {}", "expected cuRobo's collision_spheres, XRDF's geometry, or an SRDF"),
        ("- 1", "expected cuRobo's collision_spheres"),
        ("collision_spheres: {a: 3}", r"collision_spheres\.a: expected a list of spheres"),
        ("collision_spheres: [a]", "expected links with their spheres"),
        ("collision_spheres: {a: [{center: [0, 0], radius: 1}]}", r"expected {center: \[x, y, z\], radius: r}, in m"),
        ("collision_spheres: {a: [{center: [0, 0, .nan], radius: 1}]}", "expected {center"),
        ("collision_spheres: {a: [{center: [0, 0, true], radius: 1}]}", "expected {center"),
        ("collision_spheres: {a: [{center: [0, 0, 1e9], radius: 1}]}", "expected {center"),
        ("collision_spheres: {a: [{radius: 1}]}", "expected {center"),
        (f"collision_spheres: {{a: [{{center: [0, 0, {'9' * 400}], radius: 1}}]}}", "expected {center"),
        ("geometry: {a: {clone: [1]}}", "expected spheres by link"),
        ("geometry: {a: {clone: a}}", "expected spheres by link"),
        (
            "collision_spheres: {a: [{center: [0, 0, 0], radius: 0}]}",
            "expected spheres with a radius above 0, got none",
        ),
        ("format: xrdf", "expected a geometry with spheres"),
        ("geometry: {a: 3}", "expected spheres by link"),
        ("<robot/>", "expected an SRDF with <link_sphere_approximation>"),
        (SRDF.replace("0 0 0.1", "0 0"), r"upper\.center: expected 3 finite numbers"),
        (SRDF.replace('radius="0.05"', ""), r"upper\.radius: expected a number"),
        (SRDF.replace('"0.05"', '"inf"'), "expected a sphere within 100000 m"),
        ("", "the file is empty"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path, text, message):
    with pytest.raises(FileError, match=message) as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_a_link_has_not_too_many(tmp_path, monkeypatch):
    monkeypatch.setattr(sphere_files, "MAX_SPHERES", 1)
    with pytest.raises(FileError, match="expected at most 1 spheres of a link, got 2"):
        read(tmp_path, f"collision_spheres: {BALLS}")


SOUND = {
    "curobo.yml": """{robot_cfg: {kinematics: {collision_sphere_buffer: 0.01, self_collision_ignore: {a: [b]},
        cspace: {joint_names: [j], retract_config: [0.1]},
        collision_spheres: {a: [{center: [0, 0, 1], radius: 0.1}], b: [{center: [0, 0, 1], radius: 0.2}]}}}}""",
    "arm.xrdf": """{format: xrdf, collision: {geometry: g},
        self_collision: {buffer_distance: {a: 0.1}, ignore: {a: [b]}}, default_joint_positions: {j: 0.1},
        modifiers: [{add_frame: x}],
        geometry: {g: {clone: h}, h: {spheres: {a: [{center: [0, 0, 1], radius: 0.1}], b: []}}}}""",
}
VALUES = [0, -1, 0.5, float("nan"), float("inf"), 1e308, 10**400, True, None, ""]
VALUES += ["g", "a", "spheres.yml", [], {}, [[]]]


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from([*SOUND]), st.lists(st.tuples(st.integers(0, 60), st.sampled_from(VALUES)), max_size=2))
def test_a_file_with_a_few_flaws_gives_spheres_or_one_line(tmp_path, name, flaws):
    data = yaml.safe_load(SOUND[name])
    for number, value in flaws:
        places = list(list_places(data))
        inside, key = places[number % len(places)]
        inside[key] = value
    try:
        balls = [ball for own in read(tmp_path, yaml.safe_dump(data), name).spheres.values() for ball in own]
    except FileError as error:
        assert str(error).isprintable()
        return
    assert all(radius > 0.0 for *_, radius in balls)
    assert np.abs(balls).max() <= 1e5


def list_places(data):
    """Every value of plain data, as what it is in and its key."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield data, key
        if isinstance(value, dict | list):
            yield from list_places(value)
