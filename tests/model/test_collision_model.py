"""What is compared: resolved once from a name, a detector or a model; what a detector may compare, and with whom."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model import collision_model
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import AdjacentPair, Detector
from ikde.model.validate import NON_ADJACENT, check_robot
from tests.model.drafts import make_detector, make_draft, make_row, reject


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


def test_a_detector_whose_pairs_are_all_left_out():
    message = (
        "this detector compares nothing: all 3 pairs are left out: "
        "G - A (joined by joint slide), G - B (adjacent: glued), A - B (joined by joint turn)"
    )
    glued = (AdjacentPair(a="B", b="G", reason="glued"),)
    reject(message, "detectors", "d", "pairs", adjacent=glued, detectors=make_detector(pairs=NON_ADJACENT))


def test_a_detector_with_an_empty_list():
    message = "all 3 pairs are left out: G - A (joined by joint slide), G - B (not in the pair list some), A - B"
    reject(message, "detectors", "d", "pairs", pair_lists={"some": ()})


def test_a_detector_with_one_component():
    one = {"approximations": {"fine": (make_row("G", "world", "world"),)}, "pair_lists": {}}
    reject("'G' is the only component", "detectors", "d", "pairs", detectors=make_detector(pairs=NON_ADJACENT), **one)


def test_a_detector_without_spheres():
    none = {"approximations": {"fine": ()}, "pair_lists": {"some": ()}}
    reject("this detector compares nothing: 'fine' has no spheres", "detectors", "d", "spheres", **none)


def test_pairs_left_out_are_named_as_long_as_they_are_few():
    rows = tuple(make_row(name, "world", "world") for name in "ABCDE")
    changes = {"approximations": {"fine": rows}, "pair_lists": {}, "detectors": make_detector(pairs=NON_ADJACENT)}
    message = "all 10 pairs are left out: A - B (one body), A - C (one body), A - D (one body) and 7 more"
    reject(message, "detectors", "d", "pairs", **changes)


def test_a_detector_compares_so_many_spheres_at_most():
    rows = tuple(make_row(name, "b", "tool", count=1500) for name in "GA")
    message = "expected at most 2,000,000 pairs of spheres to compare, got 2,250,000"
    changes = {"approximations": {"fine": rows}, "pair_lists": {"some": (("G", "A"),)}, "detectors": make_detector()}
    reject(message, "detectors", "d", "spheres", **changes)


def test_a_detector_compares_so_many_pairs_at_most(monkeypatch):
    monkeypatch.setattr(collision_model, "MAX_PAIRS", 1)
    message = "expected at most 1 pairs of components, got 2"
    pairs = {"some": (("G", "A"), ("G", "B"))}
    reject(message, "detectors", "d", "pairs", pair_lists=pairs, detectors=make_detector())
    monkeypatch.setattr(collision_model, "MAX_PAIRS", 2)
    assert len(CollisionModel.of(check_robot(make_draft(pair_lists=pairs, detectors=make_detector()))).pairs) == 2


@pytest.mark.parametrize("distance", ["1", None, True, np.nan, np.inf, -0.1, 1.01e5])
def test_a_safe_distance_is_a_number_of_at_least_zero_within_100_km(distance):
    detectors = make_detector(safe_distance_m=distance)
    reject("expected a distance of at least 0, up to 100000 m", "detectors", "d", "safe_distance", detectors=detectors)


def test_no_detector_of_pythons_own_is_called_as_none_at_all(qiao):
    own = replace(CollisionModel.of(qiao).detector, name="none")
    with pytest.raises(InputError, match="'none' is taken: it stands for no detector at all"):
        CollisionModel.of(qiao, own)


def test_a_detector_called_none():
    detectors = {**make_detector(), "none": Detector(name="none", spheres="fine", pairs="some")}
    reject("is taken: it stands for no detector at all", "detectors", "none", detectors=detectors)


def test_a_detector_with_unknown_spheres():
    detectors = make_detector(spheres="fin")
    reject("no approximation is called 'fin' (did you mean 'fine'?)", "detectors", "d", "spheres", detectors=detectors)


def test_a_detector_with_unknown_pairs():
    reject("no pair list is called 'all'", "detectors", "d", "pairs", detectors=make_detector(pairs="all"))


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


def test_an_unknown_default_detector():
    reject("no detector is called 'e'", "default_detector", default_detector="e")


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
