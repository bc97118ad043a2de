"""Every error that a robot can have is found, and named by the path of the offending value."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.robot import AdjacentPair, Inertia, Wheels
from ikde.model.validate import NON_ADJACENT, check_robot
from tests.model.drafts import make_draft, make_joint, make_row, reject
from tests.random_robots import make_frame


@pytest.mark.parametrize("hidden", ["\n", "\x1b", "\u202e", "x" * 100])
def test_whatever_bears_a_name_may_be_called_what_can_be_printed(hidden):
    """Of robots that Python makes, as of those from files."""
    told = "expected a name of"
    reject(told, "name", name=f"draft{hidden}")
    reject(told, "convention", convention=f"own{hidden}")
    for key, section in (
        ("approximations", "spheres"),
        ("pair_lists", "pairs"),
        ("detectors", "detectors"),
        ("conventions", "conventions"),
    ):
        reject(told, section, f"new{hidden}", **{key: {**getattr(make_draft(), key), f"new{hidden}": ()}})
    reject(told, "joints", f"turn{hidden}", joints=(make_joint(f"turn{hidden}"),))
    reject(told, "frames", f"b{hidden}", frames=(make_frame(f"b{hidden}", "world"),))
    rows = (make_row(), make_row(f"B{hidden}"))
    reject(told, "spheres", "fine", 1, "component", approximations={"fine": rows})


def replace_frame(name, **changes):
    return tuple(replace(f, **changes) if f.name == name else f for f in make_draft().frames)


def replace_rows(**changes):
    rows = make_draft().approximations["fine"]
    return {"fine": (*rows[:2], replace(rows[2], **changes))}


def test_a_sound_draft_passes_with_parents_first():
    robot = check_robot(make_draft())
    assert [frame.name for frame in robot.frames] == ["a", "b", "tool"]
    assert robot.joint_names == ("slide", "turn")


def test_non_adjacent_pairs_are_added():
    robot = check_robot(make_draft())
    assert robot.pair_lists[NON_ADJACENT] == (("G", "B"),)
    assert robot.pair_lists["some"] == (("G", "B"),)


def test_checking_leaves_the_draft_alone():
    draft = make_draft()
    check_robot(draft)
    assert draft.frames[0].name == "b"
    assert NON_ADJACENT not in draft.pair_lists


def test_branches_are_sorted_depth_first():
    frames = (
        make_frame("left", "a"),
        make_frame("right", "a"),
        make_frame("tool", "right"),
        make_frame("left_tip", "left"),
        *make_draft(
            frames=(
                make_frame("a", "world", joint="slide", axis=(1, 0, 0)),
                make_frame("b", "a", joint="turn", axis=(0, 0, 1)),
            )
        ).frames,
    )
    plain = {"approximations": {}, "pair_lists": {}, "detectors": {}, "default_detector": "none"}
    robot = check_robot(make_draft(frames=frames, **plain))
    assert [f.name for f in robot.frames] == ["a", "left", "left_tip", "right", "tool", "b"]


def test_names_are_unique():
    draft = make_draft()
    reject("given twice", "joints", draft.joints[0].name, joints=(*draft.joints, draft.joints[0]))
    reject("given twice", "frames", draft.frames[0].name, frames=(*draft.frames, draft.frames[0]))


# ---- joints

ENDS = {"lower": -np.inf, "upper": np.inf}  # of a joint without limits


def test_no_joints():
    reject("expected at least one joint", "joints", joints=())


@pytest.mark.parametrize("key", ["lower", "upper", "home"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_limits_and_home_are_finite(key, value):
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", **{key: value}))
    reject("expected a finite number", "joints", "turn", key, joints=joints)


@pytest.mark.parametrize("key", ["lower", "upper", "home"])
@pytest.mark.parametrize(("kind", "unit"), [("prismatic", "m"), ("revolute", "rad")])
def test_limits_and_home_lie_where_joint_values_may(key, kind, unit):
    ends = {"lower": -1e5, "upper": 1e5, "home": 0.0}
    check_robot(make_draft(joints=(make_joint("slide", kind="prismatic"), make_joint("turn", **ends))))
    beyond = {**ends, key: np.nextafter(-1e5 if key == "lower" else 1e5, np.inf if key != "lower" else -np.inf)}
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", **{"kind": kind, **beyond}))
    reject(f"expected a finite number, at most 100000 {unit} from 0, got", "joints", "turn", key, joints=joints)


@pytest.mark.parametrize("key", ["lower", "upper"])
@pytest.mark.parametrize("value", [0.0, 1e6, np.nan])
def test_a_continuous_joint_has_no_limits(key, value):
    slide = make_joint("slide", kind="prismatic")
    endless = make_joint("turn", kind="continuous", **ENDS, home=50.0)
    robot = check_robot(make_draft(joints=(slide, endless), conventions={"other": {"turn": 1.0}}))
    assert (robot.lower[1], robot.upper[1]) == (-np.inf, np.inf)
    limited = make_joint("turn", kind="continuous", **{**ENDS, key: value})
    reject(
        "a continuous joint has no limits; one with limits is revolute", "joints", "turn", key, joints=(slide, limited)
    )


@pytest.mark.parametrize("home", [np.nan, np.inf, 1.01e5])
def test_the_home_of_a_continuous_joint_is_finite(home):
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", kind="continuous", **ENDS, home=home))
    reject("expected a finite number, at most 100000 rad from 0", "joints", "turn", "home", joints=joints)


def test_limits_upside_down():
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", lower=1.0, upper=-1.0))
    reject("the upper limit is below the lower one", "joints", "turn", "upper", joints=joints)


def test_home_outside_the_limits():
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", home=1.5))
    reject("home is outside the limits", "joints", "turn", "home", joints=joints)


@pytest.mark.parametrize("key", ["max_speed", "max_acceleration", "max_effort"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.inf, np.nan])
def test_a_joint_that_may_not_move_at_all_or_at_any_pace(key, value):
    joints = (make_joint("slide", kind="prismatic"), make_joint("turn", **{key: value}))
    reject("expected a finite number above 0", "joints", "turn", key, joints=joints)


def test_home_on_a_limit_is_inside():
    check_robot(make_draft(joints=(make_joint("slide", kind="prismatic"), make_joint("turn", home=1.0))))


def test_a_joint_that_moves_no_frame():
    joints = (*make_draft().joints, make_joint("idle"))
    reject("expected one frame that this joint moves, found 0", "joints", "idle", joints=joints)


def test_a_joint_that_moves_two_frames():
    frames = (*make_draft().frames, make_frame("c", "a", joint="turn", axis=(0, 0, 1)))
    reject("expected one frame that this joint moves, found 2", "joints", "turn", frames=frames)


# ---- frames


def test_the_world_cannot_be_defined():
    reject(
        "is the root and cannot be defined", "frames", "world", frames=(*make_draft().frames, make_frame("world", "a"))
    )


def test_an_unknown_parent_names_the_nearest_frame():
    frames = replace_frame("tool", parent="tol")
    reject("no frame is called 'tol' (did you mean 'tool'?)", "frames", "tool", "parent", frames=frames)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1.01e5, -1.01e5])
def test_a_place_is_within_100_km(value):
    check_robot(make_draft(frames=replace_frame("tool", p_parent_frame=np.array([1e5, -1e5, 0.0]))))
    frames = replace_frame("tool", p_parent_frame=np.array([0.0, value, 0.0]))
    reject("expected finite numbers, at most 100000 m from 0", "frames", "tool", "xyz", frames=frames)


def test_an_axis_needs_a_joint():
    frames = replace_frame("tool", axis=np.array([0.0, 0.0, 1.0]))
    reject("an axis needs a joint", "frames", "tool", "axis", frames=frames)


def test_an_unknown_joint_names_the_nearest():
    frames = replace_frame("b", joint="trn")
    reject("no joint is called 'trn' (did you mean 'turn'?)", "frames", "b", "joint", frames=frames)


def test_a_joint_needs_an_axis():
    reject("a frame with a joint needs an axis", "frames", "b", frames=replace_frame("b", axis=None))


@pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (np.nan, 0.0, 1.0)])
def test_an_axis_has_length_one(axis):
    reject("expected an axis that is not zero", "frames", "b", "axis", frames=replace_frame("b", axis=np.array(axis)))


def test_a_cycle_of_parents():
    reject("a cycle: following the parents never reaches the world", "frames", "b", "parent", frames=(
        make_frame("a", "world", joint="slide", axis=(1, 0, 0)),
        make_frame("b", "tool", joint="turn", axis=(0, 0, 1)),
        make_frame("tool", "b"),
    ))  # fmt: skip


def test_a_frame_that_is_its_own_parent():
    reject("a cycle", "frames", "tool", "parent", frames=replace_frame("tool", parent="tool"))


def test_an_unknown_tool():
    reject("no frame is called 'tip'", "tool", tool="tip")


def test_a_frame_called_tool_is_the_tool():
    assert check_robot(make_draft()).tool == "tool"
    message = "this name stands for the tool, which is 'b'; name this frame otherwise, or let it be the tool"
    reject(message, "frames", "tool", tool="b")


def test_a_frame_that_is_no_rotation_is_refused():
    draft = make_draft()
    bent = replace(draft.frames[0], R_parent_frame=np.full((3, 3), np.nan))
    with pytest.raises(InputError, match="rotation matrix"):
        check_robot(replace(draft, frames=(bent, *draft.frames[1:])))


# ---- spheres


@pytest.mark.parametrize(("key", "name"), [("start", "from"), ("end", "to")])
def test_a_row_between_unknown_frames(key, name):
    reject("no frame is called 'tol'", "spheres", "fine", 2, name, approximations=replace_rows(**{key: "tol"}))


@pytest.mark.parametrize("radius", [0.0, -0.1, np.nan, np.inf, 1.01e5])
def test_a_radius_is_above_zero_and_within_100_km(radius):
    approximations = replace_rows(radius_m=radius)
    reject("expected a radius above 0, up to 100000 m", "spheres", "fine", 2, "radius", approximations=approximations)


@pytest.mark.parametrize("count", [0, -1])
def test_a_count_is_at_least_one(count):
    reject("expected a count of at least 1", "spheres", "fine", 2, "count", approximations=replace_rows(count=count))


def test_a_row_across_a_joint():
    message = "these two frames are on different bodies; add a fixed frame on one of the two"
    reject(message, "spheres", "fine", 2, "to", approximations=replace_rows(end="a"))


def test_a_component_on_two_bodies():
    message = "the rows of 'A' lie on different bodies; a component is rigid"
    reject(message, "spheres", "fine", 2, "component", approximations=replace_rows(component="A"))


def test_every_approximation_describes_the_same_components():
    approximations = {**make_draft().approximations, "coarse": (make_row("G", "world", "world"),)}
    reject("the other approximations also describe A, B", "spheres", "coarse", approximations=approximations)


def test_several_spheres_need_a_line():
    row = replace(make_row("G", "world", "world"), count=2)
    reject("several spheres need two key points", "spheres", "fine", 0, "to", approximations={"fine": (row,)})


# ---- pairs


def test_non_adjacent_cannot_be_defined():
    lists = {**make_draft().pair_lists, NON_ADJACENT: ()}
    reject("this list is made by ikde and cannot be defined", "pairs", NON_ADJACENT, pair_lists=lists)


@pytest.mark.parametrize("pair", [("G", "X"), ("X", "G")])
def test_an_unknown_component_in_a_pair(pair):
    lists = {"some": (pair,)}
    reject("no component is called 'X'", "pairs", "some", "pairs", pair[0], pair_lists=lists)


def test_an_unknown_component_among_adjacent_pairs():
    reject(
        "no component is called 'X'", "adjacent", "pairs", "X", adjacent=(AdjacentPair(a="X", b="G", reason="glued"),)
    )


@pytest.mark.parametrize("reason", ["", "  ", "two\nlines", "red \x1b[31m", "\u202eback"])
def test_an_adjacent_pair_without_a_reason(reason):
    reject(
        "expected a reason, in one line",
        "adjacent",
        "pairs",
        "G",
        "B",
        adjacent=(AdjacentPair(a="G", b="B", reason=reason),),
    )


@pytest.mark.parametrize("again", [("G", "B"), ("B", "G")])
def test_a_pair_that_is_given_twice(again):
    reject("are paired twice", "pairs", "some", "pairs", again[0], pair_lists={"some": (("G", "B"), again)})


def test_a_component_paired_with_itself():
    reject("'G' is paired with itself", "pairs", "some", "pairs", "G", pair_lists={"some": (("G", "G"),)})


# ---- conventions


def test_a_convention_called_like_the_robots_own():
    message = "this is the convention the file is written in"
    reject(message, "conventions", "own", conventions={"own": {"turn": 1.0}})


def test_a_convention_with_an_unknown_joint():
    message = "no joint is called 'tun' (did you mean 'turn'?)"
    reject(message, "conventions", "other", "tun", conventions={"other": {"tun": 1.0}})


def test_a_slide_cannot_be_shifted():
    message = "only a revolute joint can have an offset"
    reject(message, "conventions", "other", "slide", conventions={"other": {"slide": 1.0}})


@pytest.mark.parametrize("offset", [np.nan, np.inf, 1.01e5])
def test_a_shift_keeps_the_digits_of_an_angle(offset):
    message = "expected at most 100000 rad either way"
    reject(message, "conventions", "other", "turn", conventions={"other": {"turn": offset}})


# ---- wheels


def test_wheels_need_a_base():
    message = (
        "wheels need a planar base, prismatic along x and y and revolute about z, that carries all that can collide"
    )
    reject(message, "wheels", wheels=Wheels(radius_m=0.1, half_track_m=0.2))


@pytest.mark.parametrize("value", [0.0, -0.1, np.nan, np.inf, 1.01e5])
def test_wheels_have_a_size(qiao, value):
    for key, what in (("radius", "radius"), ("half_track", "distance")):
        message = f"expected a {what} above 0, up to 100000 m"
        wheels = Wheels(**{"radius_m": 0.1, "half_track_m": 0.2, f"{key}_m": value})
        with pytest.raises(InputError) as caught:
            check_robot(unchecked(replace(qiao, wheels=wheels)))
        assert (caught.value.message, caught.value.where) == (message, ("wheels", key))
    with pytest.raises(InputError, match=r"wheels\.half_wheelbase: expected a distance above 0"):
        check_robot(unchecked(replace(qiao, wheels=Wheels(radius_m=0.1, half_track_m=0.2, half_wheelbase_m=value))))


def unchecked(robot):
    """As it was before ikde made its list of pairs."""
    return replace(robot, pair_lists={name: pairs for name, pairs in robot.pair_lists.items() if name != NON_ADJACENT})


def test_a_base_may_have_wheels_or_not(qiao, unwheeled):
    assert check_robot(unchecked(qiao)).wheels == Wheels(radius_m=0.1, half_track_m=0.259)
    assert check_robot(unchecked(unwheeled)).wheels is None


def test_a_drive_has_wheels_of_its_own(qiao):
    four = Wheels(radius_m=0.1, half_track_m=0.2, half_wheelbase_m=0.3)
    assert check_robot(unchecked(replace(qiao, wheels=four))).drive is None
    for wheels, drive in ((four, "differential"), (replace(four, half_wheelbase_m=None), "mecanum")):
        with pytest.raises(InputError, match=r"drive: .*mecanum wheels"):
            check_robot(unchecked(replace(qiao, wheels=wheels, drive=drive)))


def test_a_drive_needs_a_base_and_is_one_of_those_known(qiao):
    reject("a drive needs a planar base, prismatic along x", "drive", drive="omnidirectional")
    with pytest.raises(InputError, match="drive: expected one of differential, omnidirectional"):
        check_robot(unchecked(replace(qiao, drive="legs")))
    assert check_robot(unchecked(replace(qiao, drive="omnidirectional"))).drive == "omnidirectional"


@pytest.mark.parametrize(
    ("changes", "where", "message"),
    [
        ({"mass_kg": -1.0}, "mass", "expected a finite mass of at least 0 kg"),
        ({"mass_kg": np.nan}, "mass", "expected a finite mass of at least 0 kg"),
        ({"p_frame_com": np.array([0.0, np.nan, 0.0])}, "com", "expected finite numbers, at most 100000 m from 0"),
        ({"I_com_frame": np.full((3, 3), np.inf)}, "inertia", "expected finite numbers"),
    ],
)
def test_masses_are_finite(changes, where, message):
    good = {"mass_kg": 1.0, "p_frame_com": np.zeros(3), "I_com_frame": np.eye(3)}
    assert check_robot(make_draft(inertias={"a": Inertia(**good)})).inertias["a"].mass_kg == 1.0
    reject(message, "inertias", "a", where, inertias={"a": Inertia(**{**good, **changes})})


def test_masses_stand_at_frames():
    inertia = Inertia(mass_kg=1.0, p_frame_com=np.zeros(3), I_com_frame=np.eye(3))
    reject("no frame is called 'toool' (did you mean 'tool'?)", "inertias", "toool", inertias={"toool": inertia})
