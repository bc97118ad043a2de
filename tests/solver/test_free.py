"""`is_free` says what `check` says, one by one and in bulk, by plain numpy and by its kernel."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.flat_arguments import flatten_models
from ikde.kernels.free_rows import judge_rows
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver import free as module
from tests.conftest import ROBOTS, random_q
from tests.solids import random_world
from tests.three_joints import ROBOT

OWN = CollisionModel.of(ROBOT)


@pytest.fixture
def plainly(monkeypatch):
    """No machine code, and nothing begins to make it."""
    monkeypatch.setattr(module, "find_machine_code", lambda question: None)


def near_contact(model, free, hit):
    """Between free configurations and others, both sides of where the verdict changes, 1e-9 of the way apart."""
    for _ in range(30):
        middle = 0.5 * (free + hit)
        collides = ikde.check_many(model.robot, middle, model).collision.data[:, None]
        free, hit = np.where(collides, free, middle), np.where(collides, middle, hit)
    return np.concatenate([free, hit])


def judge(model, rows):
    """By the kernel as plain Python."""
    found = np.empty(len(rows), dtype=bool)
    with np.errstate(all="ignore"):
        judge_rows.plain(*flatten_models(pack_robot(model.robot), model.arrays), rows, found)
    return found


def test_the_kernel_says_what_check_says_also_near_contact(rng):
    kinds = ("box", "cylinder", "sphere", "hull")
    model = OWN.in_world(random_world(rng, 5, kinds=kinds, far=0.9, margin_m=0.01), 0.005, {"post": 0.0})
    rows = rng.uniform(ROBOT.lower, ROBOT.upper, (200, 3))
    collides = ikde.check_many(ROBOT, rows, model).collision.data
    ends = rows[~collides][:6], rows[collides][:6]
    assert min(map(len, ends)) == 6
    rows = np.concatenate([rows[:20], near_contact(model, *ends)])
    assert judge(model, rows).tolist() == (~ikde.check_many(ROBOT, rows, model).collision.data).tolist()


@pytest.mark.parametrize("name", ROBOTS)
def test_without_a_world_too(name, rng):
    robot = ikde.load_robot(name)
    rows = random_q(robot, rng, 4)
    expected = ~ikde.check_many(robot, rows).collision.data
    assert judge(CollisionModel.of(robot), rows).tolist() == expected.tolist()


def test_one_is_a_bool_and_many_are_an_array(plainly, rng):
    world = random_world(rng, 3, kinds=("box",), far=0.9, ignore=("floor",))
    rows = rng.uniform(ROBOT.lower, ROBOT.upper, (9, 3))
    found = ikde.is_free(ROBOT, rows, world)
    assert found.dtype == bool
    assert found.tolist() == [ikde.is_free(ROBOT, q, world) for q in rows]
    assert found.tolist() == (~ikde.check_many(ROBOT, rows, world).collision.data).tolist()
    assert ikde.is_free(ROBOT, dict(zip(ROBOT.joint_names, rows[0], strict=True)), world) is found.tolist()[0]
    assert ikde.is_free(ROBOT, np.empty((0, 3)), world).shape == (0,)


def test_joint_limits_are_not_part_of_it(plainly):
    q = ROBOT.home + 2 * np.pi
    assert ikde.is_free(ROBOT, q) == (not ikde.check(ROBOT, q).collision)


def test_without_a_detector_nothing_is_called_free(plainly):
    with pytest.raises(InputError, match=r"^collision: nothing is compared without a detector"):
        ikde.is_free(ROBOT, ROBOT.home, "none")


@pytest.mark.parametrize("q", [[0.0, 0.0], np.zeros((2, 2, 3)), [0.0, np.nan, 0.0]])
def test_what_is_no_configuration_is_refused(plainly, q):
    with pytest.raises(InputError, match=r"^q: "):
        ikde.is_free(ROBOT, q)


def test_machine_code_is_taken_once_it_is_there(monkeypatch):
    asked = []
    monkeypatch.setattr(
        module.ROWS, "machine", lambda numbers, whole, rows, out: asked.append(len(rows)) or out.fill(True)
    )
    assert ikde.is_free(ROBOT, [ROBOT.home] * 3).all()
    assert ikde.is_free(ROBOT, ROBOT.home) is True
    assert asked == [3, 1]


def test_until_then_a_child_is_asked_for_it(monkeypatch):
    questions = []
    monkeypatch.setattr(module.ROWS, "machine", None)
    monkeypatch.setattr(module, "answers_plainly", lambda rows, question: questions.append(question) or True)
    assert ikde.is_free(ROBOT, ROBOT.home) == (not ikde.check(ROBOT, ROBOT.home).collision)
    assert [question[1:] for question in questions] == [("configurations", "a yes or no of", "check")]
