"""What is compared: resolved once from a name, a detector or a model; what a detector may compare, and with whom."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector
from ikde.model.validate import NON_ADJACENT, check_robot
from tests.model.drafts import make_detector, make_draft


def test_a_choice_is_a_name_a_detector_a_model_or_the_default(qiao):
    typical = qiao.detectors["typical"]
    model = CollisionModel.of(qiao, "typical")
    assert model == CollisionModel.of(qiao, typical) == CollisionModel.of(qiao, model)
    assert (model.name, model.limit_m) == ("typical", typical.safe_distance_m)
    assert model.pairs == qiao.pair_lists[typical.pairs]
    assert CollisionModel.of(qiao).name == qiao.default_detector


def test_no_detector_compares_nothing(qiao):
    model = CollisionModel.of(qiao, "none")
    assert (model.name, model.detector, model.limit_m) == ("none", None, 0.0)
    assert model.pairs == model.left_out_pairs == model.rows == ()
    assert (len(model.arrays.pairs), len(model.arrays.radius)) == (0, 0)


def test_an_unknown_name_is_refused_with_those_known(qiao):
    with pytest.raises(InputError, match="qiao2021 has no detector 'imporved'; it has single, typical, improved, none"):
        CollisionModel.of(qiao, "imporved")


def test_a_model_of_another_robot_is_refused(qiao):
    narrow = replace(qiao, joints=(replace(qiao.joints[0], upper=1.0), *qiao.joints[1:]))
    with pytest.raises(InputError, match=r"^collision: this is a model of another Robot object \(qiao2021\)"):
        CollisionModel.of(narrow, CollisionModel.of(qiao))
    with pytest.raises(InputError, match="another Robot object"):
        ikde.check(narrow, narrow.home, CollisionModel.of(qiao))


def test_a_model_made_by_hand_is_checked_when_it_is_used(qiao):
    improved = qiao.detectors["improved"]
    for detector, message in (
        (replace(improved, safe_distance_m=-1.0), r"^collision\.detector\.safe_distance: expected a distance"),
        (replace(improved, spheres="imporved"), r"^collision\.detector\.spheres: no approximation"),
        ("improved", r"^collision\.detector: expected a Detector, got 'improved'"),
    ):
        with pytest.raises(InputError, match=message):
            ikde.check(qiao, qiao.home, CollisionModel(robot=qiao, detector=detector))


def test_what_is_no_choice_is_refused_in_a_line(qiao):
    with pytest.raises(
        InputError, match=r"^collision: expected a name, a Detector, a World or a CollisionModel, got <Robot qiao"
    ):
        ikde.check(qiao, qiao.home, qiao)


def test_the_public_calls_take_a_model(qiao):
    model, target = CollisionModel.of(qiao, "typical"), ikde.Target((0.8, 0.5, 1.0))
    named, given = ikde.solve(qiao, target, collision="typical"), ikde.solve(qiao, target, collision=model)
    assert (given.detector, given.q.tobytes()) == ("typical", named.q.tobytes())
    assert ikde.verify(qiao, target, given.q, collision=model) == ikde.verify(
        qiao, target, given.q, collision="typical"
    )


def test_it_is_sent_to_other_processes_without_its_arrays(qiao):
    model = CollisionModel.of(qiao)
    assert len(model.arrays.pairs) == len(model.pairs)
    again = pickle.loads(pickle.dumps(model))
    assert set(vars(again)) == {"robot", "detector"}
    assert not any(np.asarray(array).flags.writeable for array in again.arrays[1:])


def test_a_detector_of_pythons_own_is_called_what_can_be_printed():
    robot = check_robot(make_draft())
    with pytest.raises(InputError, match=r"^detector\.name: expected a name of printable characters"):
        CollisionModel.of(robot, Detector(name="a\nb", spheres="fine", pairs="some"))


def test_no_detector_of_pythons_own_is_called_as_none_at_all(qiao):
    own = replace(CollisionModel.of(qiao).detector, name="none")
    with pytest.raises(InputError, match="'none' is taken: it stands for no detector at all"):
        CollisionModel.of(qiao, own)


def test_a_detector_made_by_hand_is_checked_when_it_is_used():
    robot = check_robot(make_draft(pair_lists={**make_draft().pair_lists, "none": ()}))
    good = Detector(name="mine", spheres="fine", pairs=NON_ADJACENT)
    assert CollisionModel.of(robot, good).detector is good
    wrong = ({"spheres": "fin"}, {"pairs": "all"}, {"pairs": "none"}, {"safe_distance_m": -1.0})
    for bad in (*wrong, {"safe_distance_m": np.nan}):
        with pytest.raises(InputError, match="detector"):
            CollisionModel.of(robot, replace(good, **bad))


def test_a_detector_may_use_the_pairs_that_ikde_makes():
    robot = check_robot(make_draft(detectors=make_detector(pairs=NON_ADJACENT)))
    assert robot.detectors["d"].pairs == NON_ADJACENT


def test_no_detector_may_be_the_default():
    assert CollisionModel.of(check_robot(make_draft(default_detector="none"))).detector is None


@pytest.mark.parametrize("given", [[1], 3, "x"])
def test_distances_of_components_come_as_a_mapping(given):
    world = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 1.0}, "position": [5, 0, 0]}}})
    with pytest.raises(InputError, match=r"^margins_m: expected distances by component, got "):
        CollisionModel.of("ur5").in_world(world, 0.0, given)


def test_models_in_equal_worlds_are_equal_also_pickled():
    obstacles = {"obstacles": {"ball": {"sphere": {"radius": 1.0}, "position": [5, 0, 0]}}}
    model, again = (CollisionModel.of("ur5").in_world(ikde.load_world(obstacles), 0.1) for _ in range(2))
    assert model == again == pickle.loads(pickle.dumps(model))
    assert hash(model) == hash(again)
