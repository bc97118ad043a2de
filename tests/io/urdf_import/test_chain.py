"""The tree of links, and which of its ends is the tool."""

import pytest

from ikde.errors import FileError
from ikde.io.urdf_import.chain import choose_tool, find_tree, list_names
from ikde.io.urdf_import.description import read_description
from tests.urdf_texts import ARM, FINGERS, change, extend, joint, write


def read(folder, text):
    found = read_description(write(folder, text))
    return found, find_tree(found)


def test_links_come_parents_first_and_paths_from_the_root(tmp_path):
    text = extend('<link name="camera"/>' + joint("mount", "fixed", "base_link", "camera"))
    _, tree = read(tmp_path, text)
    assert tree.order == ("base_link", "upper", "fore", "tip", "camera")
    assert [one.name for one in tree.path("tip")] == ["shoulder", "slide", "flange"]
    assert tree.path("base_link") == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (extend('<link name="loose"/>'), "link.loose: 2 links have no parent, base_link, loose; expected one"),
        (
            extend(joint("again", "fixed", "base_link", "tip")),
            "joint.again: its child 'tip' is that of joint 'flange' as well",
        ),
        (
            change('<parent link="base_link"/>', '<parent link="tip"/>'),
            "a cycle: following the parents never reaches a root",
        ),
        (
            extend(
                '<link name="a"/><link name="b"/>' + joint("ab", "fixed", "a", "b") + joint("ba", "fixed", "b", "a")
            ),
            "joint.ba: a cycle",
        ),
        (extend('<link name="a"/>' + joint("aa", "fixed", "a", "a")), "joint.aa: a cycle"),
    ],
)
def test_what_is_no_tree_is_refused(tmp_path, text, message):
    with pytest.raises(FileError) as caught:
        read(tmp_path, text)
    assert message in str(caught.value)


def test_without_a_word_the_tool_is_the_only_leaf_that_a_joint_moves(tmp_path):
    assert choose_tool(*read(tmp_path, ARM), None) == "tip"
    still = extend('<link name="camera"/>' + joint("mount", "fixed", "base_link", "camera"))
    assert choose_tool(*read(tmp_path, still), None) == "tip"


def test_of_several_ends_one_must_be_named_and_all_are_listed(tmp_path):
    found = read(tmp_path, extend(FINGERS))
    with pytest.raises(FileError) as caught:
        choose_tool(*found, None)
    assert (
        "tool: which link is the tool? it has 3 ends: tip, left, right; "
        "name one, or a link that carries them: ikde robots import --tool NAME" in str(caught.value)
    )
    assert choose_tool(*found, "left") == "left"
    assert choose_tool(*found, "upper") == "upper"


def test_a_robot_in_which_nothing_moves_has_no_tool(tmp_path):
    with pytest.raises(FileError, match="which link is the tool\\? no joint of it moves"):
        choose_tool(*read(tmp_path, '<robot name="r"><link name="a"/></robot>'), None)
    assert choose_tool(*read(tmp_path, '<robot name="r"><link name="a"/></robot>'), None, True) == "a"
    assert choose_tool(*read(tmp_path, ARM), None, True) == "tip"


def test_a_tool_that_is_not_there_is_answered_with_the_nearest(tmp_path):
    with pytest.raises(FileError, match="no link is called 'tipp' \\(did you mean 'tip'\\?\\)"):
        choose_tool(*read(tmp_path, ARM), "tipp")
    with pytest.raises(FileError, match=r"no link is called 'zzz'; its ends are tip$"):
        choose_tool(*read(tmp_path, ARM), "zzz")


def test_a_long_list_of_names_is_cut():
    assert list_names([str(k) for k in range(10)]) == "0, 1, 2, 3, 4, 5, 6, 7 and 2 more"
    assert list_names(["x" * 50]) == "x" * 37 + "..."
