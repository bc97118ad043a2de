"""The judgement by surface points."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.paper.surface import check_surface, check_surface_many, covering_angle_rad, surface_directions
from tests.conftest import random_q

COARSE = {"m_steps": 12, "n_steps": 6}


def test_directions_are_unit_vectors_and_cover_the_sphere(rng):
    directions = surface_directions(**COARSE)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    points = rng.normal(size=(2000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    nearest = np.arccos(np.clip((points @ directions.T).max(axis=1), -1.0, 1.0))
    assert nearest.max() <= covering_angle_rad(**COARSE)


def test_equation_20_finds_every_contact_of_surfaces_that_centres_find(qiao, rng):
    found = 0
    for q in random_q(qiao, rng, 40):
        clearance = ikde.check(qiao, q).clearance_m
        if -0.09 < clearance <= 0.0:  # shallower than the smallest sphere: the surfaces cross
            found += 1
            assert check_surface(qiao, q, **COARSE).collision
    assert found > 5


def test_equation_18_misses_a_contact_that_equation_20_finds(qiao):
    q = {"q1": np.pi / 2, "q2": 1.9} | dict.fromkeys(("d_x", "d_y", "q_z", "q3", "q4", "q5", "q6"), 0.0)
    assert ikde.check(qiao, q).collision
    assert not check_surface(qiao, q, rule="eq. 18", **COARSE).collision
    assert check_surface(qiao, q, rule="eq. 20", **COARSE).collision


def test_no_detector_is_refused(qiao):
    with pytest.raises(InputError, match="expected a detector, got none"):
        check_surface(qiao, qiao.home, "none")


@pytest.mark.parametrize("rule", ["eq. 18", "eq. 20"])
@pytest.mark.parametrize("detector", ["typical", "improved", "single"])
def test_many_give_the_verdicts_of_one(qiao, rng, rule, detector):
    Q = random_q(qiao, rng, 40)
    one = [check_surface(qiao, q, detector, rule=rule, **COARSE).collision for q in Q]
    assert check_surface_many(qiao, Q, detector, rule=rule, grid=(12, 6)).tolist() == one


def test_many_are_told_apart_on_a_fine_grid(qiao, rng):
    Q = random_q(qiao, rng, 300)
    touching = check_surface_many(qiao, Q, "improved", grid=(360, 180))
    assert 0 < touching.sum() < len(Q)


def test_many_refuse_what_one_refuses(qiao):
    with pytest.raises(InputError, match="expected a detector, got none"):
        check_surface_many(qiao, qiao.home[None], "none")
    with pytest.raises(InputError, match="expected one of eq"):
        check_surface_many(qiao, qiao.home[None], rule="eq. 21")
