"""The printed laws, what they make of the second task, and exact priority beside them."""

import numpy as np
import pytest

from ikde.paper.null_space_claims import draw_levels
from ikde.paper.null_space_laws import blend, closed_form_24, closed_form_25, enter, exact, printed, smooth
from ikde.solver.priority import Level
from tests.paper.zhang import ARM, START


@pytest.fixture(scope="module")
def pair():
    """Tool and platform of 200 random arms, by nine speeds and by ten."""
    place, (x1, x2) = draw_levels(ARM, START, np.random.default_rng(1), 200)
    return {
        by: tuple(Level(J, x) for J, x in zip(tasks(place), (x1, x2), strict=True))
        for by, tasks in {"platform": ARM.tasks_by_platform, "wheels": ARM.tasks_by_wheels}.items()
    }


def left(level, x):
    return np.linalg.norm((level.matrix @ x[..., None])[..., 0] - level.wanted, axis=-1)


@pytest.mark.parametrize("by", ["platform", "wheels"])
def test_the_first_task_is_exact_and_the_second_task_is_not(pair, by):
    tool, platform = pair[by]
    assert left(tool, printed(tool, platform)).max() < 1e-13
    assert left(platform, printed(platform, tool)).max() < 1e-13
    assert np.median(left(platform, printed(tool, platform))) > (0.1 if by == "platform" else 0.003)
    assert np.median(left(tool, printed(platform, tool))) > 0.05


def test_closed_forms_of_what_the_second_task_gets(pair):
    tool, platform = pair["platform"]
    got = (platform.matrix @ printed(tool, platform)[..., None])[..., 0]
    np.testing.assert_allclose(got, closed_form_24(tool, platform), atol=1e-13)
    got = (tool.matrix @ printed(platform, tool)[..., None])[..., 0]
    np.testing.assert_allclose(got, closed_form_25(tool, platform), atol=1e-13)


def test_exact_priority_meets_both_in_either_order(pair):
    for tool, platform in pair.values():
        one, other = exact(tool, platform), exact(platform, tool)
        np.testing.assert_allclose(one, other, atol=1e-11 if tool.matrix.shape[-1] == 10 else 1e-12)
        assert max(left(level, one).max() for level in (tool, platform)) < 1e-12


def test_psi_must_be_a_number(pair):
    """A psi of 1/2 misses the tool under the printed laws and not under exact ones; wheels must not differ."""
    tool, platform = pair["wheels"]
    share, size = np.full(200, 0.5), np.linalg.norm(tool.wanted, axis=-1)
    halves = {law: blend(share, law(tool, platform), law(platform, tool)) for law in (printed, exact)}
    assert 0.35 < np.median(left(tool, halves[printed]) / size) < 0.55
    assert np.median(left(tool, halves[exact]) / size) < 1e-14
    one, other = printed(tool, platform), printed(platform, tool)
    psi = np.random.default_rng(2).random(10)
    fight = np.array([1, -1, -1, 1])
    assert np.abs(halves[printed][:, :4] @ fight).max() < 1e-12
    assert np.median(np.abs((psi * one + (1 - psi) * other)[:, :4] @ fight)) > 1e-3


def test_a_task_enters_from_what_is_to_what_should_be(pair):
    """Also where the two are in conflict: both want the same three speeds of the platform."""
    tool, platform = pair["platform"]
    wish = Level(platform.matrix, platform.wanted + 0.1)
    for coming in (tool, wish):
        begin, end = exact(platform, coming, 0.05), exact(coming, platform, 0.05)
        np.testing.assert_allclose(enter(np.zeros(200), coming, platform, 0.05), begin, atol=1e-12)
        np.testing.assert_allclose(enter(np.ones(200), coming, platform, 0.05), end, atol=1e-8)
        half = enter(np.full(200, 0.5), coming, platform, 0.05)
        assert np.abs(half - end).max() <= np.abs(begin - end).max() + 1e-9


def test_smooth_has_no_kink():
    x = np.linspace(-0.5, 1.5, 2001)
    y = smooth(x)
    assert (y[x <= 0].max(), y[x >= 1].min()) == (0.0, 1.0)
    assert np.abs(np.diff(y, 2)).max() < 1e-5
    assert smooth(0.5) == pytest.approx(0.5)
