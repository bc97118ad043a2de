"""From a file to a robot: what was decided, and that whatever a file holds is answered with a robot or one line."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import IkdeError, InputError
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import import_urdf, read_urdf
from tests.urdf_texts import ARM, FINGERS, extend, joint, write

SEEDS = st.integers(0, 10**6)
WRONG = {
    "number": ["-0.5", "1e-7", "1e5", "1e300", "inf", "nan", "x", "", "0 0", "0", "9" * 400],
    "vector": ["1 2 3", "0 0 0", "1e5 0 0", "1e200 1 1", "nan 0 0", "1 2", "", "a b c"],
    "scale": ["0 1 1", "1e5 1 1", "nan 1 1", "1 1"],
    "link": ["base", "b", "nowhere", "world", ""],
    "joint": ["j0", "j1", "nothing", "base_x"],
    "kind": ["planar", "floating", "ball"],
    "shape": ["blob", "mesh", "sphere"],
    "mesh": ["a.stl", "package://arm/a.stl", "../a.stl", "file:///etc/passwd", "a.obj/"],
    "obj": ["1 2", "v 1 1", "0", "-1", "-9", "5", "1e9", "nan", "f", "1/1", "\\", "\n", "#", "surf"],
}
"""What stands, seldom, where something else is expected."""


class _Drawn:
    """Pieces of a URDF that are good but for a few."""

    def __init__(self, seed):
        self._rng = np.random.default_rng(seed)
        self.links = ["base", "a", "b", "c", "tool"][: int(self._rng.integers(2, 6))]

    def pick(self, *choices):
        return str(choices[int(self._rng.integers(len(choices)))])

    def of(self, kind, *good):
        """One of the good ones, or one time in 60 a wrong one."""
        return self.pick(*WRONG[kind]) if self._rng.random() < 1 / 60 else self.pick(*good)

    def vector(self):
        return self.of("vector", "0 0 1", "0.1 -0.2 0.3", "0 0 0.2")

    def link(self, name):
        inside = ""
        if self._rng.random() < 0.7:
            sizes = f'radius="{self.of("number", "0.05", 0.1)}" size="0.1 0.2 0.1" length="0.1"'
            scale = self.of("scale", "1 1 1", "1 -1 1", "0.5 2 1")
            shape = self.of("shape", "sphere", "box", "cylinder", "capsule", "mesh")
            shape = f'<{shape} {sizes} scale="{scale}" filename="{self.of("mesh", "b.obj")}"/>'
            inside += f'<collision><origin rpy="{self.vector()}"/><geometry>{shape}</geometry></collision>'
        if self._rng.random() < 0.3:
            inside += f'<inertial><mass value="{self.of("number", 1, 0)}"/><inertia ixx="1" iyy="1"/></inertial>'
        return f'<link name="{self.of("link", name)}">{inside}</link>'

    def joint(self, number):
        axis, limit = self.vector(), self.of("number", 1, 2)
        inside = f'<origin xyz="{self.vector()}" rpy="{self.vector()}"/><axis xyz="{axis}"/>'
        if self._rng.random() < 0.8:
            inside += f'<limit lower="{self.of("number", -1, 0)}" upper="{limit}" velocity="{self.of("number", 1)}"/>'
        if number and self._rng.random() < 0.15:
            inside += f'<mimic joint="{self.of("joint", "j0")}" multiplier="{self.of("number", 2)}"/>'
        kind = self.of("kind", "revolute", "revolute", "continuous", "prismatic", "fixed" if number else "revolute")
        parent = self.of("link", *self.links[max(0, number - 1) : number + 1])
        return joint(f"j{number}", kind, parent, self.links[number + 1], inside)

    def marks(self):
        last = len(self.links) - 2
        parts = [
            f'<coordinate joint="{self.of("joint", f"j{last}")}" acceleration="{self.of("number", 3)}"/>',
            f'<component link="{self.of("link", "glued")}" name="{self.of("link", "pad")}"/>',
            f'<placeholder joint="{self.of("joint", "j0")}" velocity="{self.of("number", 1)}"/>',
        ]
        inside = "".join(part for part in parts if self._rng.random() < 0.5)
        return f'<ikde tool="{self.of("link", self.links[-2])}">{inside}</ikde>' if self._rng.random() < 0.3 else ""

    def robot(self):
        parts = [*map(self.link, self.links), *(self.joint(k) for k in range(len(self.links) - 1)), self.marks()]
        parts += [self.link("glued"), joint("glue", "fixed", self.links[0], "glued")]
        return f"<robot>{''.join(parts)}</robot>"

    def obj(self):
        text = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        place = int(self._rng.integers(len(text)))
        flaw = self.pick(*WRONG["obj"]) if self._rng.random() < 0.2 else ""
        return text[:place] + flaw + text[place + len(flaw) :]

    def options(self):
        base = self.pick("urdf", "urdf", "fixed", "omni")
        return ImportOptions(base=base, tool=self.links[-1], protrusion_m=0.05)  # of a mesh: a tenth of the time


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(SEEDS)
def test_a_file_with_a_few_flaws_is_a_robot_or_one_line(tmp_path, seed):
    drawn = _Drawn(seed)
    write(tmp_path, drawn.obj(), "b.obj")
    answer_or_refuse(write(tmp_path, drawn.robot()), drawn.options())


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_good_file_with_a_hole_is_a_robot_or_one_line(tmp_path, data):
    text = extend(FINGERS)
    start = data.draw(st.integers(0, len(text)))
    piece = data.draw(st.sampled_from(["", '"', "<", "/>", "nan", "9" * 400, "\x00", "&a;", "<a>", "-"]))
    path = write(tmp_path, text[:start] + piece + text[start + data.draw(st.integers(0, 40)) :])
    answer_or_refuse(path, ImportOptions(tool="tip"))


def answer_or_refuse(path, options):
    try:
        robot = read_urdf(path, options).robot
    except IkdeError as error:
        assert len(str(error).splitlines()) == 1
        return
    saved = path.with_suffix(".yaml")
    robot.save(saved)
    again = ikde.load_robot(saved)
    assert again.joints == robot.joints
    q = robot.home
    for name, T in ikde.forward(robot, q).items():
        np.testing.assert_allclose(ikde.forward(again, q)[name], T, rtol=1e-12, atol=1e-12)


def test_the_account_says_what_was_decided(tmp_path):
    path = write(tmp_path, extend(FINGERS))
    imported = read_urdf(str(path), ImportOptions(tool="tip"))
    assert (imported.root, imported.robot.tool, imported.tool_was_chosen) == ("base_link", "tip", False)
    assert [held.name for held in imported.held] == ["grip", "grip_mimic"]
    assert [(link.link, link.spheres) for link in imported.links] == [("base_link", 1), ("upper", 1), ("fore", 1)]
    assert (imported.home, imported.is_home_free, imported.warnings) == (
        "0, or mid-range where 0 is outside the limits",
        True,
        (),
    )
    assert read_urdf(write(tmp_path, ARM)).tool_was_chosen


def test_a_frozen_joint_that_would_move_with_the_chain_is_a_warning(tmp_path):
    text = extend(FINGERS.replace('mimic joint="grip"', 'mimic joint="shoulder"'))
    assert read_urdf(write(tmp_path, text), ImportOptions(tool="tip")).warnings == (
        "grip_mimic mimics shoulder, which moves: what it carries is checked where it is frozen",
    )
    both = read_urdf(write(tmp_path, text), ImportOptions(tool="tip", hold={"shoulder": 0.1}))
    assert not [warning for warning in both.warnings if "mimics" in warning]


def test_the_short_call_gives_the_same_robot(tmp_path):
    path = write(tmp_path, extend(FINGERS))
    robot = import_urdf(path, tool="tip", base="omni", hold={"grip": 0.02}, protrusion_m=0.01)
    options = ImportOptions(tool="tip", base="omni", hold={"grip": 0.02}, protrusion_m=0.01)
    other = read_urdf(path, options).robot
    assert robot.joints == other.joints
    for frame, same in zip(robot.frames, other.frames, strict=True):
        assert frame.p_parent_frame.tolist() == same.p_parent_frame.tolist()
    assert ikde.import_urdf(path, tool="tip", spheres=False).detectors == {}


def test_states_and_pairs_come_from_the_srdf(tmp_path):
    srdf = write(
        tmp_path,
        '<robot name="arm"><group_state name="home" group="g"><joint name="shoulder" value="0.4"/></group_state>'
        '<disable_collisions link1="base_link" link2="fore" reason="Never"/>'
        '<disable_collisions link1="base_link" link2="hand"/></robot>',
        "arm.srdf",
    )
    text = srdf.read_text(encoding="utf-8")
    beyond = write(tmp_path, text.replace('"0.4"', '"9"'), "beyond.srdf")
    assert read_urdf(write(tmp_path, ARM), ImportOptions(srdf=beyond)).robot.home.tolist() == [2.0, 0.25]
    imported = read_urdf(write(tmp_path, ARM), ImportOptions(srdf=srdf))
    assert imported.robot.home.tolist() == [0.4, 0.25]
    assert imported.home == "SRDF state home of g"
    assert [(pair.a, pair.b, pair.reason) for pair in imported.robot.adjacent] == [("base_link", "fore", "SRDF: Never")]
    assert imported.warnings[0] == "the SRDF names links that there are not: hand"


def test_a_tool_that_nothing_moves_is_refused(tmp_path):
    with pytest.raises(IkdeError, match="no joint moves the tool 'base_link'; name another link or a base"):
        import_urdf(write(tmp_path, ARM), tool="base_link")
    assert import_urdf(write(tmp_path, ARM), tool="base_link", base="omni").joint_names[2] == "base_yaw"


def test_a_urdf_is_a_robot_wherever_one_is_named(tmp_path):
    path = write(tmp_path, ARM)
    assert ikde.load_robot(path).joint_names == ikde.load_robot(str(path)).joint_names == ("shoulder", "slide")
    assert ikde.load_robot(path.rename(tmp_path / "ARM.URDF")).joint_names == ("shoulder", "slide")
    path = write(tmp_path, ARM)
    with pytest.raises(IkdeError, match="no such file"):
        ikde.load_robot("nowhere.urdf")
    run = {"robot": str(path), "targets": {"inline": [{"position": [0.3, 0.1, 0.8]}]}}
    assert ikde.load_batch(run).robot.joint_names == ("shoulder", "slide")


def test_a_pair_that_is_asked_for_is_compared(tmp_path):
    path = write(tmp_path, ARM)
    assert ("upper", "fore") not in ikde.import_urdf(path).pair_lists["non_adjacent"]
    assert ("upper", "fore") in ikde.import_urdf(path, compare=[("upper", "fore")]).pair_lists["non_adjacent"]
    with pytest.raises(InputError, match="no link with spheres is called 'uper'"):
        ikde.import_urdf(path, compare=[("uper", "fore")])
    for wrong in ("upper:fore", ["upper:fore"], [("upper",)], [(1, 2)]):
        with pytest.raises(InputError, match="compare: expected pairs of links"):
            ikde.import_urdf(path, compare=wrong)
