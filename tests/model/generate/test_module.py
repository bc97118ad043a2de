"""Modules: one text for one shape of robot, whatever it is called, run only if it is what its name says."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numba
import numpy as np
import pytest

import ikde
from ikde.errors import CacheWarning, InputError
from ikde.formats.entries import UnitsEntry
from ikde.formats.robot_entries import with_ranges
from ikde.kernels import cache_files, cache_folder
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import assemble, module
from ikde.model.robot import Detector
from ikde.model.target import KINDS
from ikde.solver.problem import pack_searched
from tests.collision_robots import find_gaps, make_row
from tests.hostile_names import payload, rename
from tests.random_robots import make_frame, make_robot, random_robot
from tests.tiny_robot import tiny_robot
from tests.uncompiled import run_text

ROOT = Path(__file__).parents[3]
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    """Modules and their machine code go into a folder of the test's own."""
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", True)
    monkeypatch.setattr(cache_files, "WARNED", set())
    forget()
    yield tmp_path
    forget()


def forget():
    """What a new process does not know."""
    module.load_module.cache_clear()
    module._run.cache_clear()


def load(robot):
    """The module for position targets, as a new process loads it."""
    forget()
    return module.load_module(CollisionModel.of(robot), "position")


def only(folder, suffix):
    (path,) = (path for path in (folder / cache_folder.ROBOTS).iterdir() if path.suffix == suffix)
    return path


# ---- the digest of what a text depends on


def elbow():
    """Two links and a ball at the foot, which the second link's end meets beyond 2.6 rad: never inside the limits."""
    rows = [make_row("foot", "foot", "foot", 0.1), make_row("end", "tool", "tool", 0.1)]
    frames = [
        make_frame("upper", "world", (0, 0, 0.1), joint="j0", axis=(0, 0, 1)),
        make_frame("foot", "upper", (0, 0, 0)),
        make_frame("lower", "upper", (0.5, 0, 0), joint="j1", axis=(0, 0, 1)),
        make_frame("tool", "lower", (0.5, 0, 0)),
    ]
    detector = Detector(name="own", spheres="balls", pairs="all")
    return make_robot(
        {"j0": "revolute", "j1": "revolute"},
        frames,
        lower=-1.5,
        upper=1.5,
        approximations={"balls": tuple(rows)},
        pair_lists={"all": (("foot", "end"),)},
        detectors={"own": detector},
        default_detector="own",
    )


def ranged(robot, **ranges):
    return with_ranges(robot, ranges, UnitsEntry())


def collides(robot, q):
    """What the module's own check says, run as plain Python."""
    collision = CollisionModel.of(robot)
    written = run_text(assemble.format_module(collision, "position"))
    pair = written.find_collision(*written.use_models(*pack_searched(collision)), np.array(q), 0)
    assert (find_gaps(robot, collision.detector, np.array([q])) <= 0.0).any() or pair < 0
    return pair >= 0


def test_ranges_inside_the_files_are_no_part_of_it(qiao):
    narrow = [ranged(qiao, q1=[-1.0, 1.0]), ranged(qiao, d_x=[0.0, 0.0], q4=[0.1, 0.2])]
    narrow.append(ranged(ranged(qiao, q2=[-0.5, 0.5]), q2=[-0.7, 0.7]))  # inside the file's, not inside the first
    for kind in KINDS:
        texts = {assemble.format_module(CollisionModel.of(robot), kind) for robot in (qiao, *narrow)}
        digests = {module.digest_inputs(CollisionModel.of(robot), kind) for robot in (qiao, *narrow)}
        assert len(texts) == len(digests) == 1


def test_wider_ranges_have_a_module_of_their_own():
    robot = elbow()
    wide = ranged(robot, j1=[-3.0, 1.0])
    digests = [module.digest_inputs(CollisionModel.of(each), "position") for each in (robot, wide)]
    assert digests[0] != digests[1]
    again = ranged(wide, j1=[-1.0, 1.0])
    assert module.digest_inputs(CollisionModel.of(again), "position") == digests[0]


def test_what_only_collides_beyond_the_files_limits_is_found_there():
    """Proved apart within them, and not tested there at all."""
    robot, beyond = elbow(), [0.3, -2.8]
    assert "1 proved never to fail" in assemble.format_module(CollisionModel.of(robot), "position")
    assert not collides(robot, beyond)
    for wide in (ranged(robot, j1=[-3.0, 1.5]), ranged(robot, j1=[-3.0, -2.0]), ranged(robot, j1=[-3.0, 0], j0=[0, 1])):
        assert collides(wide, beyond)
        assert not collides(wide, [0.3, -1.5])
    for narrow in (ranged(robot, j1=[-1.0, 1.5]), ranged(robot, j0=[-3.0, 3.0])):
        assert not collides(narrow, beyond)


def variants(robot):
    """Robots that differ in one thing, and detectors that see other things."""
    detector = CollisionModel.of(robot).detector
    first, joint, frame = robot.approximations[detector.spheres][0], robot.joints[0], robot.frames[-1]
    larger = (replace(first, radius_m=first.radius_m + 1e-12), *robot.approximations[detector.spheres][1:])
    moved = replace(frame, p_parent_frame=frame.p_parent_frame + np.array([0, 0, 1e-12]))
    fewer = {**robot.pair_lists, detector.pairs: robot.pair_lists[detector.pairs][1:]}
    yield robot, detector
    yield replace(robot, joints=(replace(joint, upper=joint.upper - 1e-9), *robot.joints[1:])), detector
    yield replace(robot, frames=(*robot.frames[:-1], moved)), detector
    approximations = {**robot.approximations, detector.spheres: larger}
    yield replace(robot, approximations=MappingProxyType(approximations)), detector
    yield replace(robot, pair_lists=MappingProxyType(fewer)), detector
    yield robot, replace(detector, safe_distance_m=0.05)
    yield robot, replace(detector, safe_distance_m=0.5)
    yield robot, replace(detector, safe_distance_m=5.0)
    yield robot, None


def test_wheels_are_no_part_of_it(qiao, unwheeled):
    detector = CollisionModel.of(qiao).detector
    for kind in KINDS:
        assert module.digest_inputs(CollisionModel(robot=unwheeled, detector=detector), kind) == module.digest_inputs(
            CollisionModel(robot=qiao, detector=detector), kind
        )
        assert assemble.format_module(
            CollisionModel(robot=unwheeled, detector=detector), kind
        ) == assemble.format_module(CollisionModel(robot=qiao, detector=detector), kind)


def test_no_name_is_part_of_it(qiao):
    other = rename(qiao, "other {}".format)
    for kind in KINDS:
        digests = {module.digest_inputs(CollisionModel.of(robot), kind) for robot in (qiao, other)}
        assert len(digests) == 1


@pytest.mark.parametrize("robot", [ikde.load_robot("qiao2021"), random_robot(3)], ids=lambda robot: robot.name)
def test_what_differs_has_a_digest_of_its_own(robot):
    digests = [
        module.digest_inputs(CollisionModel(robot=case[0], detector=case[1]), kind)
        for case in variants(robot)
        for kind in KINDS
    ]
    assert len(set(digests)) == len(digests)


@pytest.mark.parametrize("change", ["generator", "kernels"])
def test_other_code_has_other_digests(qiao, monkeypatch, change):
    before = module.digest_inputs(CollisionModel.of(qiao, "none"), "pose")
    if change == "generator":
        monkeypatch.setattr(module, "_own_digest", lambda: "another")
    else:
        monkeypatch.setattr(cache_folder, "CACHE_FOLDER", Path("another"))
    assert module.digest_inputs(CollisionModel.of(qiao, "none"), "pose") != before


def test_a_safe_distance_within_the_margin_changes_nothing(qiao):
    detectors = [replace(CollisionModel.of(qiao).detector, safe_distance_m=d) for d in (0.0, 0.003, 0.00999)]
    assert (
        len({module.digest_inputs(CollisionModel(robot=qiao, detector=detector), "pose") for detector in detectors})
        == 1
    )
    assert (
        len({assemble.format_module(CollisionModel(robot=qiao, detector=detector), "pose") for detector in detectors})
        == 1
    )


def test_beyond_the_last_margin_nothing_is_proved(qiao):
    far = replace(CollisionModel.of(qiao).detector, safe_distance_m=3.0)
    head = assemble.format_module(CollisionModel(robot=qiao, detector=far), "position").split('"""')[1]
    assert "\n0 proved never to fail" in head


# ---- the cache


def test_a_module_is_named_by_the_hash_of_its_text(empty_cache):
    robot = tiny_robot()
    path = Path(load(robot).__file__)
    text = assemble.format_module(CollisionModel.of(robot), "position").encode()
    assert path.parent == empty_cache / "robots"
    assert (path.read_bytes(), path.stem) == (text, hashlib.sha256(text).hexdigest())


def test_what_lies_in_the_cache_is_not_written_again(empty_cache, monkeypatch):
    before = load(tiny_robot())
    times = {path: path.stat().st_mtime_ns for path in (empty_cache / "robots").iterdir()}
    monkeypatch.setattr(module, "_format", lambda *_: pytest.fail("the text was written again"))
    after = load(tiny_robot())
    assert after is not before
    assert after.__file__ == before.__file__
    assert {path: path.stat().st_mtime_ns for path in (empty_cache / "robots").iterdir()} == times
    assert [path.suffix for path in sorted(times)].count(".py") == 1


def test_robots_that_differ_in_names_share_one_module(empty_cache):
    robot = tiny_robot()
    other = rename(robot, "other {}".format)
    assert load(robot) is module.load_module(CollisionModel.of(other), "position")


@pytest.mark.parametrize("line", ["; ", "\n"])
def test_no_name_is_ever_run(empty_cache, tmp_path, line):
    """Of a robot, a joint, a detector and all else; nor does it lie in wait for a robot of the same shape."""
    marker, robot = tmp_path / "marker", tiny_robot()
    hostile = rename(robot, lambda old: payload(marker, line) + old)
    assert load(hostile).__name__ == load(robot).__name__
    assert not marker.exists()


def test_a_text_that_is_not_what_its_name_says_is_never_run(empty_cache, tmp_path):
    robot, marker = tiny_robot(), tmp_path / "marker"
    path = Path(load(robot).__file__)
    text = path.read_bytes()
    path.write_bytes(text + f"open({str(marker)!r}, 'w')\n".encode())
    with pytest.warns(CacheWarning, match=f"^{path} is damaged: "):
        assert load(robot).__file__ == str(path)
    assert path.read_bytes() == text
    assert not marker.exists()


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path):
    path.write_bytes(b"")


def scribble(path):
    path.write_bytes(b"../../x" + path.read_bytes()[7:])


def put_folder(path):
    path.unlink()
    (path / "inside").mkdir(parents=True)


@pytest.mark.parametrize("damage", [cut, empty, scribble, put_folder])
@pytest.mark.parametrize("suffix", [".py", ".index", ".code"])
def test_a_damaged_file_heals(empty_cache, suffix, damage):
    robot = tiny_robot()
    load(robot)
    path = only(empty_cache, suffix)
    before = path.read_bytes()
    damage(path)
    with pytest.warns(CacheWarning) as caught:
        assert callable(load(robot).find_collision)
    assert len(caught) == 1
    assert load(robot)
    assert path.read_bytes() == before


def test_byte_code_that_another_python_wrote_is_made_again(empty_cache):
    load(tiny_robot())
    path = only(empty_cache, ".code")
    before = path.read_bytes()
    cache_files.write_sealed(path, b"?")
    assert callable(load(tiny_robot()).find_collision)
    assert path.read_bytes() == before


def test_a_cache_that_was_moved_runs_its_modules_where_they_are(empty_cache, monkeypatch):
    before = load(tiny_robot())
    moved = empty_cache.with_name("moved") / empty_cache.name
    shutil.copytree(empty_cache, moved)
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", moved)
    made = load(tiny_robot())
    assert made.__name__ == before.__name__
    assert getattr(made.find_collision, "py_func", made.find_collision).__code__.co_filename == made.__file__
    assert Path(made.__file__).parent == moved / "robots"


def test_without_a_cache_a_module_has_no_file_and_the_same_text(empty_cache, monkeypatch):
    with_file = load(tiny_robot())
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", False)
    for path in (empty_cache / "robots").iterdir():
        path.write_text("raise RuntimeError('run by mistake')\n")  # whose it is, nobody knows
    made = load(tiny_robot())
    assert made.__name__ == with_file.__name__
    assert not hasattr(made, "__file__")
    assert len(list((empty_cache / "robots").iterdir())) == 3


def test_on_a_disk_that_is_full_a_module_has_no_file(empty_cache, substitute):
    substitute(cache_files.write_file, lambda path, content: False)
    assert not hasattr(load(tiny_robot()), "__file__")


@pytest.mark.parametrize(("told", "kind"), [(None, "written"), ("tables", "tables"), ("written", "written")])
def test_the_kind_of_kernels_that_runs_is_told(monkeypatch, told, kind):
    monkeypatch.delenv("IKDE_KERNELS")
    if told:
        monkeypatch.setenv("IKDE_KERNELS", told)
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", False)  # they have no file then, and are the same
    assert module.describe_kernels()["kind"] == kind


def test_another_word_for_the_kind_of_kernels_is_refused(monkeypatch):
    monkeypatch.setenv("IKDE_KERNELS", "junk")
    with pytest.raises(InputError, match=r"^\$IKDE_KERNELS: expected written or tables, got 'junk'$"):
        module.kernel_kind()


SCRIPT = """
import json, pathlib, sys, time
from ikde.kernels.jit import compile_clock
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import load_module
from ikde.solver.problem import pack_searched
from tests.tiny_robot import tiny_robot
import numpy as np
robot = tiny_robot()
while not pathlib.Path(sys.argv[1]).exists():
    time.sleep(0.01)
with compile_clock() as clock:
    module = load_module(CollisionModel.of(robot), "position")
    q = np.linspace(-2.0, 2.0, 9)
    models = pack_searched(CollisionModel.of(robot))
    found = [int(module.find_collision(*models, q[k : k + 1], 0)) for k in range(9)]
print(json.dumps({"found": found, "seconds": clock.seconds, "file": module.__file__}))
"""


@needs_compiler
def test_two_processes_may_start_at_once_and_a_third_compiles_nothing(tmp_path):
    cache, go = tmp_path / "cache", tmp_path / "go"
    environment = {**os.environ, "IKDE_CACHE_DIR": str(cache)}
    options = {"cwd": ROOT, "env": environment, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [sys.executable, "-W", "error", "-c", SCRIPT, str(go)]
    both = [subprocess.Popen(command, **options) for _ in range(2)]
    go.write_text("go")
    outputs = [process.communicate(timeout=300) for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    third = subprocess.run(command, **options, timeout=300, check=False)
    assert third.returncode == 0, third.stderr
    answers = [json.loads(out) for out in (*(out for out, _ in outputs), third.stdout)]
    robot = tiny_robot()
    gaps = find_gaps(robot, CollisionModel.of(robot).detector, np.linspace(-2.0, 2.0, 9)[:, None])
    expected = np.where(gaps[:, 0] <= 0.0, 0, -1).tolist()
    assert [answer["found"] for answer in answers] == [expected] * 3
    assert {0, -1} == set(expected)
    assert len({answer["file"] for answer in answers}) == 1
    assert answers[2]["seconds"] == 0.0
