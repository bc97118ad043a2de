"""What a detector may compare, and with whom."""

import numpy as np
import pytest

from ikde.model import detectors as module
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import AdjacentPair, Detector
from ikde.model.validate import NON_ADJACENT, check_robot
from tests.model.drafts import make_detector, make_draft, make_row, reject


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
    monkeypatch.setattr(module, "MAX_PAIRS", 1)
    message = "expected at most 1 pairs of components, got 2"
    pairs = {"some": (("G", "A"), ("G", "B"))}
    reject(message, "detectors", "d", "pairs", pair_lists=pairs, detectors=make_detector())
    monkeypatch.setattr(module, "MAX_PAIRS", 2)
    assert len(CollisionModel.of(check_robot(make_draft(pair_lists=pairs, detectors=make_detector()))).pairs) == 2


@pytest.mark.parametrize("distance", ["1", None, True, np.nan, np.inf, -0.1, 1.01e5])
def test_a_safe_distance_is_a_number_of_at_least_zero_within_100_km(distance):
    detectors = make_detector(safe_distance_m=distance)
    reject("expected a distance of at least 0, up to 100000 m", "detectors", "d", "safe_distance", detectors=detectors)


def test_a_detector_called_none():
    detectors = {**make_detector(), "none": Detector(name="none", spheres="fine", pairs="some")}
    reject("is taken: it stands for no detector at all", "detectors", "none", detectors=detectors)


def test_a_detector_with_unknown_spheres():
    detectors = make_detector(spheres="fin")
    reject("no approximation is called 'fin' (did you mean 'fine'?)", "detectors", "d", "spheres", detectors=detectors)


def test_a_detector_with_unknown_pairs():
    reject("no pair list is called 'all'", "detectors", "d", "pairs", detectors=make_detector(pairs="all"))


def test_an_unknown_default_detector():
    reject("no detector is called 'e'", "default_detector", default_detector="e")
