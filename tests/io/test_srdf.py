"""What an SRDF adds: states by group, and pairs with reasons."""

import pytest

from ikde.errors import FileError
from ikde.io.srdf import Srdf, read_srdf
from tests.urdf_texts import write

TEXT = """\
<robot name="arm">
  <group_state name="folded" group="arm"><joint name="a" value="1"/></group_state>
  <group_state name="Home" group="arm"><joint name="a" value="0.5"/><joint name="b" value="-1e-2"/></group_state>
  <group_state name="up" group="arm"><joint name="a" value="3"/></group_state>
  <group_state name="open" group="hand"><joint name="grip" value="0.04"/>
    <joint name="base" value="1 2 3"/></group_state>
  <disable_collisions link1="l" link2="r" reason="Never"/>
  <disable_collisions link1="l" link2="tip"/>
</robot>
"""


def test_states_and_pairs_are_read(tmp_path):
    srdf = read_srdf(write(tmp_path, TEXT))
    assert srdf.states[1] == ("arm", "Home", {"a": 0.5, "b": -0.01})
    assert srdf.states[3] == ("hand", "open", {"grip": 0.04})  # several values are those of a planar joint
    assert [(pair.a, pair.b, pair.reason) for pair in srdf.disabled] == [("l", "r", "Never"), ("l", "tip", "")]


def test_of_each_group_home_is_chosen_else_its_first_state(tmp_path):
    names, values = read_srdf(write(tmp_path, TEXT)).choose_states()
    assert names == ("Home of arm", "open of hand")
    assert values == {"a": 0.5, "b": -0.01, "grip": 0.04}
    others = read_srdf(write(tmp_path, TEXT.replace("Home", "so").replace('"up"', '"default"')))
    assert others.choose_states()[0] == ("default of arm", "open of hand")
    assert Srdf().choose_states() == ((), {})
    none = read_srdf(write(tmp_path, TEXT.replace("Home", "so")))
    assert none.choose_states()[0] == ("folded of arm", "open of hand")
    nameless = read_srdf(write(tmp_path, TEXT.replace(' group="hand"', "")))
    assert nameless.choose_states()[0] == ("Home of arm", "open")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("robot", "model", ":1: expected <robot>, got <model>"),
        ('value="0.5"', 'value="half"', ":3 → Home.value: expected a number, got 'half'"),
        ('link1="l" link2="r"', 'link1="l"', ":7 → disable_collisions: expected an attribute 'link2'"),
        (' name="open"', "", ":5 → group_state: expected an attribute 'name'"),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(tmp_path, old, new, message):
    path = write(tmp_path, TEXT.replace(old, new))
    with pytest.raises(FileError) as caught:
        read_srdf(path)
    assert str(caught.value).startswith(f"{path}{message}")


def test_reasons_are_one_short_printable_line(tmp_path):
    reason = read_srdf(write(tmp_path, TEXT.replace("Never", "x\u202ey" * 99))).disabled[0].reason
    assert reason.isprintable()
    assert len(reason) == 80


def test_a_value_without_end_is_no_state(tmp_path):
    text = '<robot><group_state name="home" group="g"><joint name="a" value="inf"/><joint name="b" value="1"/>'
    srdf = read_srdf(write(tmp_path, f"{text}</group_state></robot>", "arm.srdf"))
    assert srdf.choose_states()[1] == {"b": 1.0}
