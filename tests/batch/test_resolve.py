"""A resolved run file: names, columns and graders, and a hash that changes exactly when an answer can."""

import json
import pickle
from pathlib import Path

import pytest

from ikde.batch.folder import claim_folder
from ikde.batch.resolve import make_batch
from ikde.batch.spec import BatchSpec
from ikde.errors import FileError, InputError

TARGETS = {"inline": [{"position": [0.8, 0.5, 1.0], "name": "task 1"}]}
HERE = Path()


def make(robot, file=None, **keys):
    spec = BatchSpec.model_validate({"robot": "qiao2021", "targets": TARGETS, **keys})
    return make_batch(spec, robot, folder=HERE, file=file)


@pytest.mark.parametrize(
    ("keys", "file", "expected"),
    [({}, None, "batch"), ({}, "runs/first.yaml", "first"), ({"name": "mine"}, "runs/first.yaml", "mine")],
)
def test_a_run_has_a_name(qiao, keys, file, expected):
    assert make(qiao, file, **keys).name == expected


def test_columns_stand_in_one_order(qiao):
    assert make(qiao, output={"columns": ["cost", "q", "cost"]}).columns == ("q", "cost")
    assert make(qiao, output={"columns": []}).columns == ()


def test_graders_are_names_or_the_users_own(qiao):
    own = {"name": "typical_all", "spheres": "typical", "pairs": "non_adjacent"}
    graders = make(qiao, grade=[own, "improved"]).graders
    assert [(g.name, g.pairs) for g in graders] == [("typical_all", "non_adjacent"), ("improved", "formula_22")]


def test_the_recipe_is_json_and_the_batch_can_travel(qiao):
    batch = make(qiao, grade=["typical"], seed=2**64 - 1)
    assert json.loads(json.dumps(batch.recipe)) == batch.recipe
    assert pickle.loads(pickle.dumps(batch.arms[0].problem)).settings == batch.arms[0].problem.settings


@pytest.mark.parametrize(
    "keys",
    [
        {"seed": 1},
        {"repeats": 2},
        {"chunk": 10},
        {"explain": False},
        {"output": {"columns": ["q"]}},
        {"grade": ["typical"]},
        {"solve": {"settings": {"restarts": 51}}},
        {"solve": {"near": {"q1": 0.1}}},
        {"solve": {"freeze": {"q1": 0.1}}},
        {"solve": {"ranges": {"q1": [0, 1]}}},
        {"solve": {"detector": "typical"}},
        {"arms": {"other": {}}},
        {"targets": {"inline": [{"position": [0.8, 0.5, 1.0]}]}},
        {"units": {"length": "mm"}},
        {"targets": {"reachable": {"count": 1}}},
    ],
    ids=str,
)
def test_what_changes_an_answer_changes_the_hash(qiao, keys):
    assert make(qiao, **keys).hash != make(qiao).hash


@pytest.mark.parametrize(
    "keys",
    [{"name": "x"}, {"arms": {"auto": {"method": "auto"}}}, {"solve": {"settings": {"position_tolerance": 1e-5}}}],
    ids=str,
)
def test_what_changes_nothing_keeps_the_hash(qiao, keys):
    assert make(qiao, **keys).hash == make(qiao).hash


def test_a_default_that_is_written_keeps_the_hash(qiao):
    written, changed = ({"settings": {"de": {"population": count}}} for count in (50, 51))
    de = {"method": "de"}
    assert make(qiao, solve=de | written).hash == make(qiao, solve=de).hash
    assert make(qiao, solve=de | changed).hash != make(qiao, solve=de).hash


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"grade": ["typical", "typicl"]}, "grade[1]: qiao2021 has no detector 'typicl'"),
        ({"grade": ["typical", "typical"]}, "grade[1]: two detectors are called 'typical'"),
        ({"grade": ["none"]}, "grade[0]: expected a detector; 'none' grades nothing"),
        ({"grade": [{"name": "a b", "spheres": "typical"}]}, "grade[0]: expected a name of up to 100 letters"),
        ({"grade": [{"name": "a", "spheres": "typical", "pairs": "all"}]}, "grade[0].pairs: no pair list is called"),
        ({"repeats": 10**9, "targets": {"inline": TARGETS["inline"] * 2}}, "repeats: 2 targets make more than"),
        ({"repeats": 10**7, "chunk": 1}, "chunk: this makes"),
        ({"solve": {"freeze": {"q1": 9}}}, "solve.freeze.q1: 9 is outside the limits"),
    ],
)
def test_what_is_wrong_is_named(qiao, keys, expected):
    with pytest.raises(InputError) as caught:
        make(qiao, **keys)
    assert str(caught.value).startswith(expected)


@pytest.mark.parametrize(
    ("count", "repeats", "asked", "chunk"),
    [
        (1, 1, None, 1000),
        (100_000, 1, None, 1000),
        (100_000, 3, None, 3000),
        (10**6, 1, None, 10_000),
        (10**6, 50, None, 10_000),
        (10**6, 1, 77, 77),
    ],
)
def test_a_part_is_a_hundredth_of_an_arm_within_reason(qiao, count, repeats, asked, chunk):
    box = {"box": {"from": [0, 0, 0], "to": [1, 1, 1], "count": count}}
    assert make(qiao, targets=box, repeats=repeats, chunk=asked).chunk == chunk


def test_a_part_of_goals_with_freedom_is_smaller(qiao):
    goals = {"goals": [{"position": [0.8, 0, 1], "box": 0.1}]}
    chunks = [make(qiao, targets=goals, repeats=repeats).chunk for repeats in (1, 5000, 10**6)]
    assert chunks == [20, 50, 1000]
    grid = {"grid": {"from": [0, 0, 0], "to": [1, 1, 1], "counts": [10, 10, 10]}}
    assert make(qiao, targets=grid, freedom={"box": 0.1}).chunk == 20
    assert make(qiao, targets=grid, freedom={"box": 0.1}).hash != make(qiao, targets=grid).hash


def test_the_two_kinds_of_kernels_are_never_mixed_in_a_run(qiao, monkeypatch, tmp_path):
    with claim_folder(tmp_path, make(qiao), overwrite=False):
        pass
    monkeypatch.delenv("IKDE_KERNELS")
    with (
        pytest.raises(
            FileError, match=r"holds another run \(--overwrite replaces it\): kernels.kind: 'tables' there, 'w"
        ),
        claim_folder(tmp_path, make(qiao), overwrite=False),
    ):
        pass
