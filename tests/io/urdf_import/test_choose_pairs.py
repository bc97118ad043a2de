"""Pairs of an import: what is compared, what is left out and why, in the robot and in its file."""

import pytest

import ikde
from ikde.errors import FileError
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.model.collision_model import CollisionModel
from ikde.solver import pair_verdicts
from tests.urdf_texts import joint, write


def ball(name, at, radius=0.05):
    """A link with one sphere."""
    return (
        f'<link name="{name}"><collision><origin xyz="{at}"/><geometry><sphere radius="{radius}"/></geometry>'
        "</collision></link>"
    )


def turning(name, parent, child, at="0 0 0.3", axis="0 0 1"):
    inside = f'<origin xyz="{at}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" velocity="1" effort="1"/>'
    return joint(name, "revolute", parent, child, inside)


WRIST = "".join(
    [
        '<robot name="wrist">',
        ball("wrist_2", "0 0 0"),
        ball("wrist_3", "0 0 0"),
        ball("sensor", "0 0 -0.2125"),  # it stands 12.5 mm deep in wrist_2, on the axis of the joint
        ball("finger", "0.2 0 0"),
        ball("hook", "0.2 0 -0.3"),  # comes to where the post is
        ball("post", "0.2 0 0"),
        '<link name="tip"/>',
        turning("roll", "wrist_2", "wrist_3"),
        joint("plate", "fixed", "wrist_3", "sensor"),
        joint("grip", "fixed", "wrist_3", "finger"),
        joint("bend", "fixed", "wrist_3", "hook"),
        joint("stand", "fixed", "wrist_2", "post"),
        turning("lift", "wrist_3", "tip", "0 0 0.1", "0 1 0"),
        "</robot>",
    ]
)
SRDF = (
    '<robot name="wrist"><disable_collisions link1="wrist_2" link2="wrist_3" reason="Adjacent"/>'
    '<disable_collisions link1="wrist_2" link2="finger" reason="Never"/>'
    '<disable_collisions link1="nobody" link2="finger" reason="Never"/></robot>'
)
ALWAYS = "always touching: 12.5 mm deep at least, proved for all values of roll"


def choose(folder, srdf=None, **options):
    given = {"srdf": write(folder, srdf, "wrist.srdf")} if srdf else {}
    return read_urdf(write(folder, WRIST), ImportOptions(tool="tip", **given, **options))


def compared(robot):
    return {frozenset(pair) for pair in CollisionModel.of(robot).pairs}


def left_out(robot):
    return {frozenset((pair.a, pair.b)): pair.reason for pair in CollisionModel.of(robot).left_out_pairs}


ACROSS = {frozenset(pair) for pair in (("wrist_2", "finger"), ("wrist_2", "hook"), ("wrist_3", "post"))}
ACROSS |= {frozenset((name, "post")) for name in ("sensor", "finger", "hook")}


def test_links_with_nothing_between_are_adjacent_and_others_are_decided(tmp_path):
    imported = choose(tmp_path)
    reasons = left_out(imported.robot)
    assert compared(imported.robot) == ACROSS
    assert reasons[frozenset(("wrist_2", "wrist_3"))] == "joined by joint roll"
    assert reasons[frozenset(("sensor", "finger"))] == "one body"
    assert reasons[frozenset(("wrist_2", "sensor"))] == f"adjacent: {ALWAYS}"
    never = ACROSS - {frozenset(("hook", "post"))}
    assert {frozenset(pair) for pair in imported.never_touching} == never
    assert imported.warnings == ("1 of 7 pairs always touch and are left out",)


def test_the_file_holds_what_was_decided_and_takes_it_back(tmp_path):
    robot, path = choose(tmp_path).robot, tmp_path / "wrist.yaml"
    robot.save(path)
    assert ikde.load_robot(path) == robot
    text = path.read_text(encoding="utf-8")
    assert f'    wrist_2: {{sensor: "{ALWAYS}"}}' in text.splitlines()
    path.write_text(text.replace("  wrist_2: [finger, hook]\n", "  wrist_2: [finger]\n"), encoding="utf-8")
    assert compared(ikde.load_robot(path)) == ACROSS - {frozenset(("wrist_2", "hook"))}
    path.write_text(text.replace("adjacent:", "compare: {wrist_2: [sensor]}\nadjacent:", 1), encoding="utf-8")
    with pytest.raises(FileError):  # a key is given twice
        ikde.load_robot(path)


def test_what_the_srdf_disables_is_left_out_with_its_reason(tmp_path):
    imported = choose(tmp_path, SRDF)
    assert compared(imported.robot) == ACROSS - {frozenset(("wrist_2", "finger"))}
    assert left_out(imported.robot)[frozenset(("wrist_2", "finger"))] == "adjacent: SRDF: Never"
    assert left_out(imported.robot)[frozenset(("wrist_2", "sensor"))] == f"adjacent: {ALWAYS}"
    assert imported.warnings[0] == "the SRDF names links that there are not: nobody"


@pytest.mark.parametrize(
    "pair", [("finger", "wrist_2"), ("wrist_2", "sensor"), ("wrist_3", "wrist_2"), ("sensor", "hook")]
)
def test_whatever_was_left_out_is_compared_if_that_is_asked_for(tmp_path, pair):
    imported = choose(tmp_path, SRDF, compare=(pair,))
    assert frozenset(pair) in compared(imported.robot)
    said = [warning for warning in imported.warnings if "compared as asked for" in warning]
    assert bool(said) == (pair == ("wrist_2", "sensor"))


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        (("wrist_2", "fingr"), "no link with spheres is called 'fingr' (did you mean 'finger'?)"),
        (("tip", "finger"), "no link with spheres is called 'tip'"),
        (("finger", "finger"), "expected two links"),
    ],
)
def test_a_pair_that_there_is_not_is_named(tmp_path, pair, message):
    with pytest.raises(FileError) as caught:
        choose(tmp_path, compare=(pair,))
    assert f"compare.{pair[0]}:{pair[1]}: {message}" in str(caught.value)


def test_pairs_that_touch_often_are_said_with_what_may_help(tmp_path):
    assert not [note for note in choose(tmp_path).warnings if "random configurations" in note]
    path = write(tmp_path, WRIST.replace(ball("post", "0.2 0 0"), ball("post", "0.2 0 0", 0.12)))
    imported = read_urdf(path, ImportOptions(tool="tip"))
    said = next(note for note in imported.warnings if "random configurations" in note)
    assert "of 200 random configurations are free of self-collision; most often these touch: hook - post (" in said
    assert said.endswith("spheres that stand out less (--protrusion) may keep them apart")
    share = float(said.split("hook - post (")[1].split("%")[0])
    # Circles of 0.2 m: they touch where 2 * 0.2 * sin(turn / 2) <= 0.17, at most 0.878 rad of 3 either way.
    assert abs(share - 100 * 0.878 / 3.0) < 10.0


def test_what_was_never_seen_to_touch_is_not_called_proved(tmp_path, monkeypatch):
    monkeypatch.setattr(pair_verdicts, "BOXES", 0)
    judged = pair_verdicts._judge
    judged.cache_clear()
    try:
        assert choose(tmp_path).never_touching == ()
    finally:
        judged.cache_clear()
