"""Detection cost: pairs, verdicts that differ, and times that are there."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.paper.detection import check_centres_many, compute_detection, count_sphere_pairs, draw_configurations
from ikde.paper.inputs import QUICK
from ikde.paper.section import make_collision
from ikde.paper.surface import check_surface_many
from tests.paper.conftest import is_plain

BUDGET = replace(QUICK, verdicts=300, surface_verdicts=60, timed_verdicts=5, timing_rounds=2)


@pytest.fixture(scope="module")
def section(inputs):
    return compute_detection(replace(inputs, budget=BUDGET))


def test_verdicts_are_those_of_check(qiao):
    Q = draw_configurations(qiao, 60)
    for name in qiao.detectors:
        expected = [ikde.check(qiao, q, name).collision for q in Q]
        assert check_centres_many(CollisionModel.of(qiao, name), Q).tolist() == expected


def test_fewer_configurations_are_the_beginning_of_more(qiao):
    np.testing.assert_array_equal(draw_configurations(qiao, 5), draw_configurations(qiao, 9)[:5])


def test_pairs_of_spheres_are_counted_pair_by_pair(qiao):
    collision = make_collision(qiao, "typical", "load_arm")
    # the load's one sphere against J3, J4, J5, J6 and the spheres of both links and the tool
    assert len(collision.pairs) == 7
    assert count_sphere_pairs(collision) == 4 + 3 + 4 + 3


def test_lists_are_told_apart_by_their_pairs_and_verdicts(qiao, section):
    assert is_plain(section)
    Q = draw_configurations(qiao, BUDGET.verdicts)
    for row in section.lists_differ:
        lists = [set(qiao.pair_lists[getattr(row, key)]) for key in ("pairs", "against")]
        assert {tuple(pair) for pair in row.pairs_added} == lists[0] - lists[1]
        assert {tuple(pair) for pair in row.pairs_missing} == lists[1] - lists[0]
        verdicts = [
            check_centres_many(make_collision(qiao, row.approximation, getattr(row, key)), Q)
            for key in ("pairs", "against")
        ]
        assert row.only_this_collides == sum(verdicts[0] & ~verdicts[1])
        assert row.only_the_other_collides == sum(verdicts[1] & ~verdicts[0])


def test_surface_points_by_eq_20_see_all_that_centres_see_here_and_more(section):
    for row in section.surface_differs:
        seen, missed = row.only_surface_collides, row.only_centres_collide
        assert row.surface_collides == row.centres_collide + seen - missed
        if row.rule == "eq. 20":
            assert missed == 0


def test_times_are_there_for_every_way(section):
    for row in section.measured.lists:
        assert 0.0 < row.median_s <= row.p95_s
    for row in section.measured.surface:
        assert row.every_point.timed == BUDGET.plain_verdicts
        assert row.every_point.median_s > row.quick.median_s > 0.0


class TestPuzzles:
    """The evidence of two entries of docs/misprints.md."""

    def test_eq_18_sees_none_of_880_collisions(self, qiao):
        Q = draw_configurations(qiao, 1000)
        assert check_centres_many(CollisionModel.of(qiao, "typical"), Q).sum() == 880
        assert not check_surface_many(qiao, Q, "typical", rule="eq. 18").any()

    def test_eq_20_with_steps_of_10_deg_rejects_everything_and_with_1_deg_not_home(self, qiao):
        Q = np.vstack([qiao.home, draw_configurations(qiao, 1000)])
        assert check_surface_many(qiao, Q, "typical").all()
        assert not check_surface_many(qiao, Q[:1], "typical", grid=(360, 180)).any()
