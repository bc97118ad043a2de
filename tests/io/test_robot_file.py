"""Robot files: what is wrong is said in one line with file, line and key; nothing ever ends in a traceback."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import FileError, InputError
from ikde.io import robot_file
from ikde.io.robot_file import parse_robot
from ikde.io.robots import FOLDER, load_robot
from ikde.io.yaml_file import Document
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import AdjacentPair
from tests.hostile_names import HIDDEN, PRINTABLE, rename_in_file
from tests.robot_files import GOOD, NAMES

DRIVEN = """\
name: cart
units: {length: mm, angle: deg}
sources:
  maker: {kind: published, text: "the maker's drawing"}
  ours: {kind: calibrated, text: "measured on the floor"}
joints:
  x: {kind: prismatic, lower: -5000, upper: 5000}
  y: {kind: prismatic, lower: -5000, upper: 5000}
  turn: {kind: revolute, lower: -180, upper: 180}
frames:
  along:    {parent: world, joint: x, axis: [1, 0, 0]}
  across:   {parent: along, joint: y, axis: [0, 1, 0]}
  platform: {parent: across, xyz: [0, 0, 75], joint: turn, axis: [0, 0, 1]}
  mast:     {parent: platform, xyz: [0, 0, 900]}
tool: mast
wheels: {radius: 75, half_track: 210.5, source: {radius: maker, half_track: ours}}
"""


def parse(text, tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    return load_robot(path)


def complaint(old, new, tmp_path):
    assert old in GOOD
    with pytest.raises(FileError) as caught:
        parse(GOOD.replace(old, new, 1), tmp_path)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("template", PRINTABLE.values(), ids=PRINTABLE)
def test_any_printable_name_is_one(tmp_path, template):
    robot = parse(rename_in_file(GOOD, template.format, NAMES), tmp_path)
    plain = parse(GOOD, tmp_path)
    assert robot.joint_names == tuple(map(template.format, plain.joint_names))
    detector = CollisionModel.of(robot).detector
    assert (detector.name, detector.pairs) == (template.format("coarse"), template.format("all"))
    assert robot.upper.tolist() == plain.upper.tolist()


@pytest.mark.parametrize("hidden", HIDDEN, ids=ascii)
def test_a_name_with_what_cannot_be_seen_is_refused(hidden):
    document = Document(Path("robot.yaml"), GOOD)
    document.data["joints"][f"slide{hidden}"] = document.data["joints"].pop("slide")
    with pytest.raises(FileError, match="expected a name of printable characters") as caught:
        parse_robot(document)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("name: two", 'name: "two{}"', "robot.yaml:1 → name"),
        ("  slide:", '  "slide{}":', "robot.yaml:6 → joints.slide{}"),
        ("  rail:", '  "rail{}":', "robot.yaml:9 → frames.rail{}"),
        ("component: bar", 'component: "bar{}"', "robot.yaml:16 → spheres.coarse[1].component"),
        ("  coarse:\n", '  "coarse{}":\n', "robot.yaml:14 → spheres.coarse{}"),
        ("  all:", '  "all{}":', "robot.yaml:18 → pairs.all{}"),
        ("  coarse: {", '  "coarse{}": {{', "robot.yaml:20 → detectors.coarse{}"),
    ],
)
@pytest.mark.parametrize(("hidden", "shown"), [(r"\e[2J", r"\x1b[2J"), (r"\u202e", r"\u202e"), (r"\n", r"\n")])
def test_a_name_is_refused_at_its_place_and_shown_harmless(tmp_path, old, new, place, hidden, shown):
    message = complaint(old, new.format(hidden), tmp_path)
    assert message.startswith(f"{tmp_path}/{place.format(shown)}: expected a name of printable characters")
    assert message.isprintable()


def test_a_name_that_is_too_long_is_refused(tmp_path):
    message = complaint("name: two", f"name: {'x' * 101}", tmp_path)
    assert message.endswith("robot.yaml:1 → name: expected a name of 1 to 100 characters, got 101")


def test_units_become_metres_and_radians(tmp_path):
    robot = parse(GOOD, tmp_path)
    assert robot.upper == pytest.approx([1.0, np.pi / 2])
    assert robot.home == pytest.approx([0.0, np.pi / 18])
    assert robot.frames[1].p_parent_frame == pytest.approx([0, 0, 0.5])
    assert robot.detectors["coarse"].safe_distance_m == pytest.approx(0.005)
    assert robot.approximations["coarse"][1].radius_m == pytest.approx(0.02)


def test_a_continuous_joint_has_a_home_and_no_limits(tmp_path):
    turn = parse(GOOD.replace("revolute, lower: -90, upper: 90, home: 10", "continuous, home: 370"), tmp_path).joints[1]
    assert (turn.kind, turn.lower, turn.upper) == ("continuous", -np.inf, np.inf)
    assert turn.home == np.radians(370.0)
    assert parse(GOOD.replace("revolute, lower: -90, upper: 90, home: 10", "continuous"), tmp_path).home[1] == 0.0


def test_provenance_is_kept_by_entry_and_by_key(tmp_path):
    provenance = parse(GOOD, tmp_path).provenance
    assert provenance[("joints", "slide")].kind == "calibrated"
    assert provenance[("frames", "rail", "axis")].text == "made up"


def test_wheels_are_in_metres_with_their_sources(tmp_path):
    robot = parse(DRIVEN, tmp_path)
    assert (robot.wheels.radius_m, robot.wheels.half_track_m) == pytest.approx((0.075, 0.2105))
    kinds = {place: source.kind for place, source in robot.provenance.items()}
    assert kinds == {("wheels", "radius"): "published", ("wheels", "half_track"): "calibrated"}
    whole = parse(DRIVEN.replace("{radius: maker, half_track: ours}", "ours"), tmp_path)
    assert whole.provenance[("wheels",)].kind == "calibrated"


def test_wheels_may_be_left_out(tmp_path):
    assert parse(GOOD, tmp_path).wheels is None
    assert parse("\n".join(DRIVEN.splitlines()[:-1]), tmp_path).wheels is None


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("radius: 75", "radius: 0", "robot.yaml:16 → wheels.radius", "expected a radius above 0"),
        ("radius: 75", "radius: .inf", "robot.yaml:16 → wheels.radius", "finite"),
        ("radius: 75", "radius: .nan", "robot.yaml:16 → wheels.radius", "finite"),
        ("radius: 75", "radius: '75'", "robot.yaml:16 → wheels.radius", "expected a number, got '75'"),
        ("half_track: 210.5", "half_track: -1", "robot.yaml:16 → wheels.half_track", "expected a distance above 0"),
        ("half_track: 210.5, ", "", "robot.yaml:16 → wheels.half_track", "missing"),
        ("half_track: 210.5", "halftrack: 210.5", "wheels.halftrack", "did you mean 'half_track'?"),
        ("half_track: ours", "half_track: our", "wheels.source", "did you mean 'ours'?"),
        ("half_track: ours", "track: ours", "wheels.source.track", "this entry has no key 'track'"),
        ("{radius: 75", "[{radius: 75", "robot.yaml", ""),
        ("axis: [0, 0, 1]", "axis: [0, 1, 0]", "robot.yaml:16 → wheels", "revolute about z, that carries all"),
    ],
)
def test_what_is_wrong_with_wheels_is_said_with_its_place(old, new, place, words, tmp_path):
    assert old in DRIVEN
    with pytest.raises(FileError) as caught:
        parse(DRIVEN.replace(old, new, 1), tmp_path)
    assert "\n" not in str(caught.value)
    assert place in str(caught.value)
    assert words in str(caught.value)


def test_frames_may_stand_in_any_order(tmp_path):
    lines = GOOD.splitlines()
    swapped = "\n".join([*lines[:8], lines[10], lines[9], lines[8], *lines[11:]])
    names = [frame.name for frame in parse(swapped, tmp_path).frames]
    assert names == ["rail", "arm", "tip"]


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("tool: tip", "tol: tip", "robot.yaml:12 → tol", "did you mean 'tool'?"),
        ("radius: 200", "radios: 200", "spheres.coarse[0].radios", "did you mean 'radius'?"),
        ("radius: 200", "radius: -200", "robot.yaml:15 → spheres.coarse[0].radius", "above 0"),
        ("radius: 200", "radius: big", "spheres.coarse[0].radius", "expected a number, got 'big'"),
        ("radius: 200", "radius: .nan", "spheres.coarse[0].radius", "finite"),
        ("radius: 200", "radius: .inf", "spheres.coarse[0].radius", "finite"),
        ("xyz: [0, 0, 500]", "xyz: [0, 0]", "robot.yaml:10 → frames.arm.xyz", "expected 3 values, got 2"),
        ("xyz: [0, 0, 500]", "xyz: [0, 0, 1, 2]", "frames.arm.xyz", "expected 3 values, got 4"),
        ("xyz: [0, 0, 500]", "xyz: [0, 0, .nan]", "frames.arm.xyz", "finite"),
        ("lower: -90, upper: 90", "lower: 90, upper: -90", "robot.yaml:7 → joints.turn.upper", "upper limit is below"),
        ("home: 10", "home: 100", "joints.turn.home", "outside the limits"),
        ("upper: 1e3", "upper: 1.1e8", "robot.yaml:6 → joints.slide.upper", "at most 100000 m from 0, got 110000.0"),
        ("lower: -90", "lower: -6e6", "robot.yaml:7 → joints.turn.lower", "at most 100000 rad from 0"),
        ("xyz: [0, 0, 500]", "xyz: [0, 0, 2e8]", "robot.yaml:10 → frames.arm.xyz", "at most 100000 m from 0"),
        ("parent: rail", "parent: tip", "frames.arm.parent", "cycle"),
        ("parent: rail", "parent: rial", "robot.yaml:10 → frames.arm.parent", "did you mean 'rail'?"),
        ("axis: [0, 1, 0]", "axis: [0, 0, 0]", "frames.arm.axis", "not zero"),
        ("joint: turn,", "joint: trun,", "frames.arm.joint", "did you mean 'turn'?"),
        ("joint: turn, axis: [0, 1, 0]", "joint: slide, axis: [0, 1, 0]", "joints.slide", "found 2"),
        ("joint: turn, axis: [0, 1, 0]", "rpy: [0, 0, 0]", "joints.turn", "found 0"),
        ("box: [bar]", "box: [bra]", "robot.yaml:18 → pairs.all.pairs.box", "no component is called 'bra'"),
        ("box: [bar]", "box: [box]", "pairs.all.pairs.box", "paired with itself"),
        ("pairs: all,", "pairs: al,", "detectors.coarse.pairs", "did you mean 'all'?"),
        ("spheres: coarse,", "spheres: fine,", "detectors.coarse.spheres", "no approximation is called 'fine'"),
        ("safe_distance: 5", "safe_distance: -5", "detectors.coarse.safe_distance", "at least 0"),
        ("to: tip,", "to: rail,", "spheres.coarse[1].to", "these two frames are on different bodies"),
        ("count: 4", "count: 0", "spheres.coarse[1].count", "expected at least 1, got 0"),
        ("count: 4", "count: 2.5", "spheres.coarse[1].count", "whole number"),
        ("kind: prismatic", "kind: sliding", "joints.slide.kind", "'revolute', 'prismatic' or 'continuous'"),
        ("lower: -90, upper: 90, ", "", "robot.yaml:7 → joints.turn.lower", "this key is missing"),
        ("upper: 90, ", "", "robot.yaml:7 → joints.turn.upper", "this key is missing"),
        ("upper: 90, ", "upper: null, ", "robot.yaml:7 → joints.turn.upper", "this key is missing"),
        ("kind: revolute", "kind: continuous", "robot.yaml:7 → joints.turn.lower", "joint has no limits; one with"),
        ("kind: revolute, lower: -90", "kind: continuous", "robot.yaml:7 → joints.turn.upper", "has no limits"),
        ("length: mm", "length: cm", "robot.yaml:2 → units.length", "'m' or 'mm'"),
        ("source: ours}\n  turn", "source: theirs}\n  turn", "joints.slide.source", "no source is called 'theirs'"),
        ("tool: tip\n", "", "robot.yaml:1 → tool", "missing"),
        ("default_detector: coarse", "default_detector: corse", "default_detector", "did you mean 'coarse'?"),
        (
            "pairs: {box: [bar]}",
            "pairs: {}",
            "robot.yaml:20 → detectors.coarse.pairs",
            "the only pair is left out: box",
        ),
        ("pairs: all, ", "", "robot.yaml:20 → detectors.coarse.pairs", "box - bar (joined by joint turn)"),
        (
            "  tip: ",
            "  tool: {parent: arm}\n  tip: ",
            "robot.yaml:11 → frames.tool",
            "stands for the tool, which is 'tip'",
        ),
        ("name: two", "name: ''", "robot.yaml:1 → name", "not empty"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(old, new, place, words, tmp_path):
    message = complaint(old, new, tmp_path)
    assert place in message
    assert words in message


def test_a_list_that_includes_itself_is_refused(tmp_path):
    assert "includes itself" in complaint("all: {pairs: {box: [bar]}}", "all: {include: [all]}", tmp_path)


THREE = GOOD.replace(
    "{component: bar, from: arm, to: tip,",
    "{component: lid, from: rail, radius: 1}\n    - {component: bar, from: arm, to: tip,",
)


def test_adjacent_pairs_carry_their_reason(tmp_path):
    robot = parse(f"{THREE}adjacent:\n  source: ours\n  pairs:\n    lid: {{bar: a cable runs along}}\n", tmp_path)
    assert robot.adjacent == (AdjacentPair(a="lid", b="bar", reason="a cable runs along"),)
    assert robot.provenance[("adjacent",)].text == "made up"


@pytest.mark.parametrize(
    "pairs", ["[bar]", "bar", "{bar: }", "{bar: ''}", "{bar: ' '}", "{bar: 3}", "{bar: [why]}", "[{bar: why}]", "null"]
)
def test_an_adjacent_pair_without_a_reason_is_refused_with_the_form(pairs, tmp_path):
    with pytest.raises(FileError) as caught:
        parse(f"{THREE}adjacent: {{pairs: {{lid: {pairs}}}}}\n", tmp_path)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'robot.yaml'}:23 → adjacent.pairs.lid: expected a reason for each pair")
    assert message.endswith('{A: {B: "why A and B may touch"}}')


def test_the_same_pair_the_other_way_round_counts_once(tmp_path):
    robot = parse(GOOD.replace("{box: [bar]}", "{box: [bar], bar: [box, box]}"), tmp_path)
    assert robot.pair_lists["all"] == (("box", "bar"),)


def test_the_only_detector_is_the_default(tmp_path):
    assert parse(GOOD.replace("default_detector: coarse\n", ""), tmp_path).default_detector == "coarse"


TWO_DETECTORS = GOOD.replace("default_detector: coarse\n", "  tight: {spheres: coarse, pairs: all}\n")


def test_of_several_detectors_the_default_is_named(tmp_path):
    with pytest.raises(
        FileError, match=r"default_detector: there are several detectors: name one of coarse, tight, none$"
    ):
        parse(TWO_DETECTORS, tmp_path)
    assert parse(f"{TWO_DETECTORS}default_detector: tight\n", tmp_path).default_detector == "tight"


def test_no_detector_may_be_the_default_and_none_need_be_there(tmp_path):
    assert parse(f"{TWO_DETECTORS}default_detector: none\n", tmp_path).default_detector == "none"
    bare = GOOD[: GOOD.index("detectors:")]
    assert parse(bare, tmp_path).default_detector == "none"
    assert parse(bare[: bare.index("spheres:")], tmp_path).default_detector == "none"


@pytest.mark.parametrize("text", ["", "[]", "3", "name: x", "null", "{name: x, joints: [], frames: {}, tool: t}"])
def test_a_file_that_is_no_robot_is_refused(text, tmp_path):
    with pytest.raises(FileError) as caught:
        parse(text, tmp_path)
    assert "\n" not in str(caught.value)


def test_an_unknown_name_lists_the_robots():
    with pytest.raises(InputError, match="did you mean 'qiao2021'"):
        load_robot("qiao2012")


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-10, 10),
    st.floats(),
    st.text(max_size=6),
    st.lists(st.integers(-2, 2), max_size=4),
    st.dictionaries(st.text(max_size=4), st.integers(), max_size=2),
)


def paths_of(data, path=()):
    yield path
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield from paths_of(value, (*path, key))


def put(data, path, value):
    if not path:
        return value
    data = copy.deepcopy(data)
    place = data
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return data


UR5 = yaml.safe_load(Path(FOLDER / "ur5.yaml").read_text())
Dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)  # libyaml's is several times faster


@given(path=st.sampled_from(list(paths_of(UR5))), junk=JUNK)
@settings(max_examples=150)
def test_junk_anywhere_is_a_robot_or_one_line(path, junk):
    text = yaml.dump(put(UR5, path, junk), Dumper=Dumper, sort_keys=False)
    try:
        robot = ikde.io.robot_file.parse_robot(Document(Path("fuzz.yaml"), text))  # type: ignore[attr-defined]
    except FileError as error:
        assert "\n" not in str(error)
        assert str(error).startswith("fuzz.yaml")
    else:
        assert np.all(np.isfinite(robot.home))


def test_lists_that_include_lists_again_and_again_are_put_together_once(tmp_path, monkeypatch):
    asked, put_together = [], robot_file._to_pairs
    monkeypatch.setattr(robot_file, "_to_pairs", lambda *given: asked.append(1) or put_together(*given))
    lists = [f"l{k}: {{include: [{', '.join([f'l{k - 1}' if k else 'all', 'all'] * 3)}]}}" for k in range(8)]
    robot = parse(GOOD.replace("  all: {pairs", "  " + "\n  ".join(lists) + "\n  all: {pairs"), tmp_path)
    assert robot.pair_lists["l7"] == robot.pair_lists["all"]
    assert len(asked) == 9 + 2 * 8 - 1  # each list of the file, and for each of eight the two that it includes


BARS = "    - {component: bar, from: arm, radius: 1, count: 10000}\n"
MANY = {
    "frames": ("  tip:  {", "".join(f"  f{k}: {{parent: world}}\n" for k in range(2000)), "at most 2,000 values"),
    "spheres": ("    - {component: box", BARS * 10, "at most 100,000 spheres"),
    "pairs": ("  all: {", "".join(f"  l{k}: {{}}\n" for k in range(100)), "at most 100 values"),
}


@pytest.mark.parametrize("section", MANY)
def test_a_robot_has_an_end(tmp_path, section):
    before, lines, words = MANY[section]
    assert words in complaint(before, lines + before, tmp_path)


def test_wrong_entries_side_by_side_are_told_together(tmp_path):
    for old, new, count in (
        ("lower: -180, ", "", 1),
        ("lower: -", "lower: 1", 3),
        ("parent: ", "parent: not_", 4),
        ("axis: [0, 0, 1]", "axis: [0, 0, 0]", 1),
        ("prismatic, lower: -5000, upper: 5000", "prismatic, upper: 5000", 2),
    ):
        with pytest.raises(FileError) as caught:
            parse(DRIVEN.replace(old, new), tmp_path)
        lines = [str(caught.value), *getattr(caught.value, "__notes__", ())]
        assert len(lines) == count, lines
        assert [int(line.split(":")[1].split()[0]) for line in lines] == sorted(
            number for number, line in enumerate(DRIVEN.splitlines(), 1) if old in line
        )


def test_at_most_ten_wrong_entries_are_listed(tmp_path):
    mast = "  mast:     {parent: platform, xyz: [0, 0, 900]}\n"
    more = "".join(f"  mast{k}: {{parent: nowhere}}\n" for k in range(13))
    with pytest.raises(FileError) as caught:
        parse(DRIVEN.replace(mast, mast + more), tmp_path)
    assert len(caught.value.__notes__) == 10
    assert caught.value.__notes__[-1] == "and 3 more"
