"""What the sections share: parts of the record, verdicts, and pictures of the robot."""

import pytest

import ikde
from ikde.batch.statistics import Spread
from ikde.model.collision_model import CollisionModel
from ikde.paper import section
from ikde.paper.section import draw_robot, format_spread, judge, make_collision, name_pairs
from ikde.plot.pose import plot_pose


def test_a_verdict_is_that_of_check(qiao):
    verdict, seen = judge(qiao, qiao.home, "single"), ikde.check(qiao, qiao.home, "single")
    assert verdict.collides
    assert verdict.clearance_mm == pytest.approx(1e3 * seen.clearance_m)
    assert verdict.pair == [seen.pairs[0].a, seen.pairs[0].b]
    assert verdict.colliding_pairs == [[pair.a, pair.b] for pair in seen.pairs if pair.collides]


def test_spreads_and_pairs_in_words():
    assert format_spread(Spread(1.5, 5.64, 94.0)) == "1.50 / 5.64 / 94.0"
    assert name_pairs([["G", "L1"], ["G", "L2"]]) == "(G, L1), (G, L2)"
    assert name_pairs([]) == "–"


def test_a_picture_is_a_small_png_with_its_caption(qiao, substitute):
    substitute(section.plot_pose, plot_pose)
    for collision in (CollisionModel.of(qiao, "improved"), make_collision(qiao, "typical", "load_arm")):
        figure = draw_robot(collision, qiao.home.tolist(), caption="home", target_mm=(800, 500, 1000))
        assert figure.image.startswith(b"\x89PNG")
        assert len(figure.image) < 200_000
        assert (figure.caption, figure.alt) == ("home", "home")
