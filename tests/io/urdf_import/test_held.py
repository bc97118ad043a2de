"""Which joints stay where they are, at which value, and why."""

import pytest

from ikde.errors import FileError, InputError
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.held import find_held
from ikde.io.urdf_import.options import ImportOptions
from tests.urdf_texts import ARM, FINGERS, change, extend, joint, write


def hold(folder, text, state=(), tool="tip", **options):
    found = read_description(write(folder, text))
    held = find_held(found, find_tree(found), [tool], ImportOptions(**options), dict(state))
    return {name: (pytest.approx(one.value, abs=1e-15), one.reason) for name, one in held.items()}


OFF = "off the chain to the tool"


def test_joints_off_the_chain_stay_at_0_or_the_limit_next_to_it(tmp_path):
    assert hold(tmp_path, ARM) == {}
    assert hold(tmp_path, ARM, tool="upper") == {"slide": (0.1, f"{OFF}, the limit next to 0")}
    wheel = extend('<link name="wheel"/>' + joint("axle", "continuous", "base_link", "wheel"))
    assert hold(tmp_path, wheel) == {"axle": (0.0, OFF)}


def test_a_state_comes_before_0_and_what_is_asked_for_before_both(tmp_path):
    state = {"grip": 0.02, "shoulder": 1.0}
    text = extend(FINGERS)
    assert hold(tmp_path, text, state)["grip"] == (0.02, f"{OFF}, SRDF state")
    assert hold(tmp_path, text, state, hold={"grip": 0.03})["grip"] == (0.03, "asked for, --hold")
    assert hold(tmp_path, text, {"grip": 9.0})["grip"] == (0.05, f"{OFF}, SRDF state")
    assert hold(tmp_path, text, hold={"shoulder": 0.5})["shoulder"] == (0.5, "asked for, --hold")


def test_a_mimic_off_the_chain_follows_its_master_within_its_own_limits(tmp_path):
    text = extend(FINGERS)
    assert hold(tmp_path, text)["grip_mimic"] == (-2 * 0.01 + 0.003, f"{OFF}, mimics grip")
    assert hold(tmp_path, text, hold={"grip": 0.05})["grip_mimic"] == (-0.097, f"{OFF}, mimics grip")
    assert hold(tmp_path, text.replace('lower="-0.1"', 'lower="-0.01"'))["grip_mimic"][0] == -0.01
    assert hold(tmp_path, text, hold={"grip_mimic": 0.1})["grip_mimic"] == (0.1, "asked for, --hold")


def test_a_mimic_of_a_mimic_follows_both(tmp_path):
    third = '<link name="third"/>' + joint(
        "third", "continuous", "fore", "third", '<mimic joint="grip_mimic" multiplier="3" offset="1"/>'
    )
    held = hold(tmp_path, extend(FINGERS + third), hold={"grip": 0.02})
    assert held["third"] == (3 * (-2 * 0.02 + 0.003) + 1, f"{OFF}, mimics grip")


@pytest.mark.parametrize("master", ["grip_mimic", "nobody", "shoulder"])
def test_a_mimic_of_itself_of_nobody_or_of_a_joint_that_moves_stays_somewhere(tmp_path, master):
    text = extend(FINGERS.replace('mimic joint="grip"', f'mimic joint="{master}"'))
    assert hold(tmp_path, text)["grip_mimic"][0] == (0.003 if master == "shoulder" else pytest.approx(0, abs=0.1))


def test_a_mimic_that_moves_the_tool_is_refused_by_name_unless_it_is_held(tmp_path):
    text = change('velocity="0"/>', 'velocity="0"/><mimic joint="shoulder"/>')
    with pytest.raises(
        FileError, match=r"joint\.slide: it mimics 'shoulder' and moves the tool; hold it \(--hold slide="
    ):
        hold(tmp_path, text)
    assert hold(tmp_path, text, hold={"slide": 0.2}) == {"slide": (0.2, "asked for, --hold")}


def test_a_floating_joint_moves_no_tool_but_may_be_the_base(tmp_path):
    text = extend('<link name="ground"/>' + joint("root", "floating", "ground", "base_link"))
    with pytest.raises(FileError, match=r"joint\.root: a floating joint moves the tool, and a body in the air"):
        hold(tmp_path, text)
    for base in ("fixed", "omni", "differential"):
        assert hold(tmp_path, text, base=base) == {"root": (0.0, "the base is another one")}
    planar = text.replace("floating", "planar")
    assert hold(tmp_path, planar) == {}
    assert hold(tmp_path, planar, base="fixed") == {"root": (0.0, "the base is another one")}
    assert hold(tmp_path, ARM.replace('"prismatic"', '"planar"'), base="fixed") == {}  # not of the root


@pytest.mark.parametrize(
    ("held", "message"),
    [
        ({"shouldr": 1.0}, "hold.shouldr: no joint is called 'shouldr' (did you mean 'shoulder'?)"),
        ({"flange": 1.0}, "hold.flange: a fixed joint, none that moves, is called 'flange'"),
        ({"shoulder": 2.5}, "hold.shoulder: expected a value from -1.5 to 2, got 2.5"),
        ({"shoulder": float("nan")}, "expected a value from -1.5 to 2, got nan"),
        ({"root": 0.5}, "hold.root: a planar joint has no single value; it is held at 0"),
    ],
)
def test_what_cannot_be_held_is_refused(tmp_path, held, message):
    text = extend('<link name="ground"/>' + joint("root", "planar", "ground", "base_link"))
    with pytest.raises(InputError) as caught:
        hold(tmp_path, text, hold=held)
    assert message in str(caught.value)


def test_a_mimic_that_goes_out_of_all_bounds_is_refused(tmp_path):
    text = extend(FINGERS.replace('type="prismatic"', 'type="continuous"').replace('"-2"', '"1e300"'))
    with pytest.raises(FileError, match=r"joint\.grip_mimic: it cannot be held at 1e\+299"):
        hold(tmp_path, text, hold={"grip": 0.1})


@pytest.mark.parametrize("value", [2e5, float("inf"), float("nan")])
def test_no_joint_is_held_farther_away_than_can_be_computed_with(tmp_path, value):
    wheel = extend('<link name="wheel"/>' + joint("axle", "continuous", "base_link", "wheel"))
    with pytest.raises(InputError, match=r"hold\.axle: expected a value from -inf to inf, got"):
        hold(tmp_path, wheel, hold={"axle": value})
