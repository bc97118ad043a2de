"""What is compared: resolved once from a name, a detector or a model, and nothing without one."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel


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
    with pytest.raises(InputError, match=r"^collision: this is a collision model of another qiao2021$"):
        CollisionModel.of(narrow, CollisionModel.of(qiao))
    with pytest.raises(InputError, match="another qiao2021"):
        ikde.check(narrow, narrow.home, CollisionModel.of(qiao))


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
