"""The cache follows the kernels' source, and code is run from a folder only if nobody else can have put it there."""

import grp
import os
import shutil
import stat
import tempfile
import warnings
from pathlib import Path

import pytest

from ikde.errors import CacheWarning
from ikde.kernels import cache_folder as module

STRANGER, GROUP = 4321, 4321
needs_owners = pytest.mark.skipif(not module.HAS_OWNERS, reason="needs owners of files")
needs_root = pytest.mark.skipif(module.USER != 0, reason="only root gives files away")


@pytest.fixture
def copied_kernels(tmp_path, monkeypatch):
    """A copy of the kernels that `cache_folder` takes for its own."""
    folder = tmp_path / "kernels"
    shutil.copytree(Path(module.__file__).parent, folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(module, "__file__", str(folder / "cache_folder.py"))
    return folder


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, of the test's own."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
def wanted(tmp_path):
    """A cache folder with all that belongs to it."""
    folder = tmp_path / "above" / "cache" / "abc"
    assert module.prepare(folder) is None
    return folder


def find(wanted):
    """(folder, whether it can be used, warnings) of a search for a folder."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        folder, usable = module.find_usable(wanted)
    return folder, usable, [str(warning.message) for warning in caught if warning.category is CacheWarning]


def give_away(path, group=-1):
    os.chown(path, STRANGER if group == -1 else -1, group, follow_symlinks=False)


# ---- which folder


def test_the_cache_folder_follows_the_source_and_nothing_else(copied_kernels):
    before = module.cache_folder()
    assert before == module.CACHE_FOLDER
    (copied_kernels / "trig.py").write_text((copied_kernels / "trig.py").read_text() + "\n# changed\n")
    assert module.cache_folder() != before
    assert module.cache_folder().parent == before.parent


def test_a_new_kernel_file_changes_the_cache_folder(copied_kernels):
    before = module.cache_folder()
    (copied_kernels / "zeta.py").write_text("ONE = 1\n")
    assert module.cache_folder() != before


def test_the_cache_folder_can_be_chosen(monkeypatch, tmp_path):
    monkeypatch.setenv("IKDE_CACHE_DIR", str(tmp_path))
    assert module.cache_folder().parent == tmp_path
    monkeypatch.setenv("IKDE_CACHE_DIR", "here")
    assert module.cache_folder().parent == Path("here").absolute()
    monkeypatch.delenv("IKDE_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert module.cache_folder().parent == tmp_path / "ikde"


# ---- what is taken


def test_a_folder_of_ones_own_is_taken_without_a_word(wanted, temporary):
    assert find(wanted) == (wanted, True, [])
    assert not list(temporary.iterdir())


@needs_owners
def test_every_level_is_made_for_this_user_alone(tmp_path):
    before = os.umask(0)
    try:
        assert module.prepare(tmp_path / "a" / "b" / "cache" / "abc") is None
    finally:
        os.umask(before)
    made = list(tmp_path.rglob("*"))
    assert [path.name for path in made if path.parent.name == "abc"] == unordered(module.MACHINE_CODE, module.ROBOTS)
    assert {stat.S_IMODE(path.stat().st_mode) for path in made} == {0o700}


class unordered(list):  # noqa: N801 - reads as a word
    """A list that equals any other order of itself."""

    def __init__(self, *items):
        super().__init__(items)

    def __eq__(self, other):
        return sorted(self) == sorted(other)

    __hash__ = None


def test_a_file_in_place_of_a_folder_of_the_cache_is_removed(wanted):
    for folder in (wanted / module.ROBOTS, wanted):
        shutil.rmtree(folder)
        folder.write_text("in the way")
        with pytest.warns(CacheWarning, match=f"^{folder} is removed: it was a file, expected a folder$"):
            assert module.prepare(wanted) is None
        assert (wanted / module.ROBOTS).is_dir()


def test_a_link_of_ones_own_to_a_place_of_ones_own_may_lead_to_the_cache(wanted, tmp_path):
    (tmp_path / "link").symlink_to("above")
    assert find(tmp_path / "link" / "cache" / "abc") == (tmp_path / "link" / "cache" / "abc", True, [])


@needs_owners
def test_a_shared_folder_above_is_taken_if_only_owners_can_rename_in_it(wanted):
    wanted.parent.parent.chmod(0o1777)
    assert find(wanted) == (wanted, True, [])


# ---- what is refused


@needs_owners
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o707, 0o720, 0o1777])
@pytest.mark.parametrize("level", ["cache", "abc", "robots", "machine_code"])
def test_a_level_that_others_can_write_is_refused(wanted, temporary, level, mode):
    path = {"cache": wanted.parent, "abc": wanted}.get(level, wanted / level)
    path.chmod(mode)
    folder, usable, (message,) = find(wanted)
    assert (folder.parent.parent, folder.name, usable) == (temporary, "abc", True)
    assert f"the cache folder {wanted.parent} is not used: {path} can be written by others (mode {mode:o})" in message
    assert "IKDE_CACHE_DIR" in message
    assert message.endswith(f"{folder.parent} is used instead")


@needs_owners
@needs_root
@pytest.mark.parametrize("level", ["above", "cache", "abc", "robots", "machine_code"])
def test_a_level_of_another_user_is_refused(wanted, temporary, level):
    path = {"above": wanted.parent.parent, "cache": wanted.parent, "abc": wanted}.get(level, wanted / level)
    give_away(path)
    _, _, (message,) = find(wanted)
    assert f"{path} belongs to user {STRANGER}" in message


@needs_owners
def test_a_folder_above_in_which_others_can_rename_is_refused(wanted, temporary):
    above = wanted.parent.parent
    above.chmod(0o777)
    _, _, (message,) = find(wanted)
    assert f"{above} can be written by others (mode 777)" in message
    assert not module.prepare(temporary / "cache" / "abc")


@needs_owners
@needs_root
def test_a_folder_above_that_a_group_can_write_is_refused_unless_it_is_ones_own_group(wanted, temporary):
    above = wanted.parent.parent
    above.chmod(0o770)
    assert find(wanted)[1:] == (True, [])  # a group called like its only member
    other = next(group.gr_gid for group in grp.getgrall() if group.gr_gid and not group.gr_mem)
    for group in (GROUP, other):  # one that nobody has given a name, and one of another name
        give_away(above, group)
        assert f"{above} can be written by others (mode 770)" in find(wanted)[2][0]


@pytest.mark.parametrize("level", ["abc", "robots", "machine_code"])
def test_no_level_of_the_cache_is_a_link(wanted, temporary, level, tmp_path):
    path = wanted if level == "abc" else wanted / level
    shutil.rmtree(path)
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    path.symlink_to(tmp_path / "elsewhere")
    _, _, (message,) = find(wanted)
    assert f"{path} is no folder" in message
    assert list((tmp_path / "elsewhere").iterdir()) == []


@needs_owners
@needs_root
def test_a_link_of_another_user_is_refused(wanted, temporary, tmp_path):
    link = tmp_path / "link"
    link.symlink_to("above")
    give_away(link)
    assert f"{link} belongs to user {STRANGER}" in find(link / "cache" / "abc")[2][0]


@needs_owners
def test_where_a_link_leads_is_checked_from_the_root(wanted, temporary, tmp_path):
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o777)
    (tmp_path / "link").symlink_to(f"temporary/../{shared.name}")
    assert f"{shared} can be written by others" in find(tmp_path / "link" / "cache" / "abc")[2][0]
    assert list(shared.iterdir()) == []


def test_links_that_lead_in_a_circle_are_refused(temporary, tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    assert "too many symbolic links" in find(tmp_path / "a" / "cache" / "abc")[2][0].lower()


def test_a_file_on_the_way_is_refused_and_left_alone(temporary, tmp_path):
    (tmp_path / "file").write_text("mine")
    for path in (tmp_path / "file" / "abc", tmp_path / "file" / "cache" / "abc"):
        assert f"{tmp_path / 'file'}" in find(path)[2][0]
    assert (tmp_path / "file").read_text() == "mine"


def test_a_read_only_folder_is_told_once_with_what_is_used_instead(wanted, temporary, monkeypatch):
    allowed = os.access  # root may write anywhere, so the system is asked in vain

    def access(path, mode):
        return wanted.parent not in (Path(path), *Path(path).parents) and allowed(path, mode)

    monkeypatch.setattr(os, "access", access)
    folder, usable, (message,) = find(wanted)
    assert usable
    assert folder == temporary / f"ikde-{module.USER}" / "abc"
    assert f"{wanted.parent} cannot be written" in message
    assert f"{folder.parent} is used instead" in message


@needs_owners
@pytest.mark.parametrize("spoil", ["folder", "abc"])
def test_a_spare_folder_that_others_can_write_is_refused_as_well(wanted, temporary, spoil):
    wanted.chmod(0o777)
    spare = temporary / f"ikde-{module.USER}"
    assert module.prepare(spare / "abc") is None
    spoilt = spare if spoil == "folder" else spare / "abc"
    spoilt.chmod(0o777)
    _, usable, (message,) = find(wanted)
    assert not usable
    assert f"{spoilt} can be written by others (mode 777)" in message
    assert "every process compiles for itself" in message


@needs_owners
def test_a_foreign_hand_on_a_file_is_named(tmp_path):
    file = tmp_path / "file"
    file.touch(0o600)
    assert module.find_fault(file.stat()) is None
    file.chmod(0o620)
    assert module.find_fault(file.stat()) == "can be written by others (mode 620)"


@needs_owners
def test_another_user_trusts_none_of_ours(wanted, temporary, monkeypatch):
    monkeypatch.setattr(module, "USER", module.USER + 1)
    assert not find(wanted)[1]
