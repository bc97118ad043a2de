"""What is left out can never fail: implied tests change no verdict, proved ones stay apart whatever the joints do."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize

from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import list_tests
from ikde.model.generate.proofs import drop_implied, drop_proved, estimate_hits
from ikde.model.pack import pack_robot
from ikde.model.robot import Detector
from ikde.solver.plain import compute_components
from tests import reference
from tests.collision_robots import CASES, RANDOM, SHIPPED, make_row, name_case, two_arms
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot

every_case = pytest.mark.parametrize("case", CASES, ids=name_case)
MARGIN = 0.01


@cache
def split(robot, detector, margin=MARGIN, share=1.0):
    """(tests that stay, tests that are proved never to fail), in a share of the ranges about their middle."""
    middle, half = 0.5 * (robot.lower + robot.upper), 0.5 * share * (robot.upper - robot.lower)
    tests = list_tests(CollisionModel(robot=robot, detector=detector).arrays)
    kept = drop_proved(pack_robot(robot), tests, margin, middle - half, middle + half)
    numbers = {test.number for test in kept}
    return kept, [test for test in tests if test.number not in numbers]


def clearances_of(robot, tests, q):
    """Smallest distance of each test less its reach, m; bodies from the tables, by numpy."""
    T = reference.compute_bodies(pack_robot(robot), q)
    gaps = np.zeros(len(tests))
    for k, test in enumerate(tests):
        a, b = (side.centres @ T[side.body][:3, :3].T + T[side.body][:3, 3] for side in (test.lattice, test.sphere))
        gaps[k] = np.linalg.norm(a - b[0], axis=1).min() - test.reach
    return gaps


def find_nearest(robot, test, rng, starts=4):
    """The smallest clearance that a local search finds inside the limits, m."""
    least = np.inf
    for start in random_q(robot, rng, starts):
        found = minimize(
            lambda q: clearances_of(robot, [test], np.clip(q, robot.lower, robot.upper))[0],
            start,
            method="L-BFGS-B",
            bounds=list(zip(robot.lower, robot.upper, strict=True)),
            options={"maxiter": 25},
        )
        least = min(least, found.fun)
    return least


@every_case
def test_implied_tests_change_no_verdict(case, rng):
    robot, detector = case
    tests = list_tests(CollisionModel(robot=robot, detector=detector).arrays)
    kept = drop_implied(tests)
    numbers = [test.number for test in kept]
    assert set(numbers) <= {test.number for test in tests}
    for q in random_q(robot, rng, 8):
        every = clearances_of(robot, tests, q)
        for safe_distance in (0.0, 0.05, 0.3):
            some = (every[numbers] <= safe_distance).any()
            assert some == (every <= safe_distance).any() or np.abs(every - safe_distance).min() < 1e-9


def test_what_is_implied_is_left_out():
    """A sphere within a larger one of another component, equal components, and the same pair seen from both sides."""
    points = {
        "a": ("f0", (0.3, 0, 0)),
        "b": ("f0", (0.32, 0, 0)),
        "c": ("f0", (0.3, 0, 0.4)),
        "d": ("f0", (0.3505, 0, 0)),  # half a millimetre of it looks out of the large one
    }
    rows = [
        make_row("large", "a", "a", 0.1),
        make_row("small", "b", "b", 0.05),
        make_row("same", "a", "a", 0.1),
        make_row("beside", "c", "c", 0.1),
        make_row("poking", "d", "d", 0.05),
        make_row("other", "tool", "tool", 0.05),
    ]
    pairs = [("large", "other"), ("other", "small"), ("same", "other"), ("beside", "other"), ("poking", "other")]
    robot = two_arms(rows, pairs, points)
    kept = drop_implied(list_tests(CollisionModel.of(robot).arrays))
    assert [test.pair for test in kept] == [0, 3, 4]


def test_shipped_robots_lose_tests(qiao):
    tests = list_tests(CollisionModel.of(qiao).arrays)
    assert len(drop_implied(tests)) < len(tests)
    kept, proved = split(qiao, CollisionModel.of(qiao).detector)
    assert len(proved) >= 5
    assert len(kept) + len(proved) == len(tests)


@every_case
def test_what_is_proved_stays_apart_at_random(case, rng):
    robot, detector = case
    _, proved = split(robot, detector)
    ends = np.where(rng.random((12, len(robot.joints))) < 0.5, robot.lower, robot.upper)
    for q in (*random_q(robot, rng, 12), *ends, robot.home):
        assert (clearances_of(robot, proved, q) > MARGIN).all()


@pytest.mark.parametrize("case", [*SHIPPED, *RANDOM[:4]], ids=name_case)
def test_what_is_proved_stays_apart_when_pulled_together(case, rng):
    """A local search for contact, from the nearest of the proved tests."""
    robot, detector = case
    _, proved = split(robot, detector)
    if not proved:
        return
    rough = np.min([clearances_of(robot, proved, q) for q in random_q(robot, rng, 10)], axis=0)
    for k in np.argsort(rough)[:2]:
        assert find_nearest(robot, proved[k], rng) > MARGIN


@pytest.mark.parametrize("margin", [0.01, 0.1])
@pytest.mark.parametrize("case", RANDOM[:8], ids=name_case)
def test_what_can_touch_is_never_left_out(case, margin, rng):
    """Whatever comes within the margin at one random configuration has to stay."""
    robot, detector = case
    _, proved = split(robot, detector, margin)
    gaps = [clearances_of(robot, proved, q) for q in random_q(robot, rng, 30)]
    assert not proved or np.min(gaps) > margin


def test_a_wider_margin_proves_less(qiao):
    proved = [
        {test.number for test in split(qiao, CollisionModel.of(qiao).detector, margin)[1]}
        for margin in (0.01, 0.1, 1.0)
    ]
    assert proved[0] >= proved[1] >= proved[2]
    assert len(proved[0]) > len(proved[2])


def test_narrower_ranges_prove_more(qiao):
    wide, narrow = (
        {test.number for test in split(qiao, CollisionModel.of(qiao).detector, MARGIN, share)[1]}
        for share in (1.0, 0.2)
    )
    assert narrow > wide


def slider(kinds, axes, *, lower, upper, far=(0.0, 0.0, 0.0)):
    """A chain of joints with a sphere on the world and one at the end, at `far` of the last joint."""
    count = len(kinds)
    frames = [
        make_frame(f"f{k}", f"f{k - 1}" if k else "world", (0.2, 0, 0), joint=f"j{k}", axis=axes[k])
        for k in range(count)
    ]
    rows = (make_row("ground", "world", "world", 0.1), make_row("end", "tool", "tool", 0.1))
    return make_robot(
        {f"j{k}": kind for k, kind in enumerate(kinds)},
        [*frames, make_frame("tool", f"f{count - 1}", far)],
        lower=lower,
        upper=upper,
        approximations={"spheres": rows},
        pair_lists={"some": (("ground", "end"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
    )


@pytest.mark.parametrize("order", [0, 1])
def test_slides_lengthen_what_turns_carry(order, rng):
    """Turn, then slide: the slide's reach counts for the turn. From no contact to contact as the limits widen."""
    kinds, axes = (["revolute", "prismatic"], [(0, 0, 1), (1, 0, 0)])
    kinds, axes = (kinds, axes) if order == 0 else (kinds[::-1], axes[::-1])
    seen = set()
    for size in (0.1, 0.2, 0.35, 0.6, 1.5, 3.0):
        robot = slider(kinds, axes, lower=-size, upper=size, far=(0.3, 0.0, 0.0))
        kept, proved = split(robot, CollisionModel.of(robot).detector)
        Q = random_q(robot, rng, 3000)
        spheres = compute_components(CollisionModel.of(robot), Q)
        nearest = np.linalg.norm(spheres["ground"][0] - spheres["end"][0], axis=-1).min() - 0.2
        assert not proved or nearest > MARGIN
        assert not kept or nearest < MARGIN + 0.05  # the bound is sharp enough for a proof within the budget
        seen.add(bool(proved))
    assert seen == {True, False}


def test_a_turn_carries_what_slides_far_out():
    """A slide holds the end 2 m away from a joint that turns it into the post; links are short."""
    frames = [
        make_frame("turn", "world", joint="turn", axis=(0, 0, 1)),
        make_frame("out", "turn", (0.1, 0, 0), joint="out", axis=(1, 0, 0)),
        make_frame("tool", "out", (0.1, 0, 0)),
        make_frame("post", "world", (0, 2.2, 0)),
    ]
    robot = make_robot(
        {"turn": "revolute", "out": "prismatic"},
        frames,
        lower=-1.0,
        upper=2.0,
        approximations={"spheres": (make_row("post", "post", "post", 0.1), make_row("end", "tool", "tool", 0.1))},
        pair_lists={"some": (("post", "end"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
    )
    first, second = robot.joints
    robot = replace(robot, joints=(first, replace(second, lower=1.9, upper=2.0, home=2.0)))
    (test,), proved = split(robot, CollisionModel.of(robot).detector)
    assert not proved
    assert clearances_of(robot, [test], np.array([0.5 * np.pi, 2.0]))[0] == pytest.approx(-0.2)


@pytest.mark.parametrize("seed", range(4))
def test_random_chains_with_slides_are_proved_soundly(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 5))
    kinds = [str(rng.choice(["revolute", "prismatic"])) for _ in range(count)]
    axes = rng.normal(size=(count, 3))
    for size in (0.1, 0.3, 0.8):
        robot = slider(kinds, axes, lower=-0.5 * size, upper=size, far=rng.uniform(-0.5, 0.5, 3))
        _, proved = split(robot, CollisionModel.of(robot).detector)
        for test in proved:
            assert find_nearest(robot, test, rng, starts=6) > MARGIN
            Q = random_q(robot, rng, 2000)
            spheres = compute_components(CollisionModel.of(robot), Q)
            assert np.linalg.norm(spheres["ground"][0] - spheres["end"][0], axis=-1).min() - 0.2 > MARGIN


def test_what_does_not_move_is_decided_at_once():
    """Two spheres of one body: no joint between them."""
    points = {"a": ("f0", (0.3, 0, 0)), "b": ("f0", (0.3, 0, 0.5)), "c": ("f0", (0.3, 0, 0.15))}
    rows = [make_row(name, name, name, 0.1) for name in points]
    robot = two_arms(rows, [("a", "b"), ("a", "c")], points)
    kept, proved = split(robot, CollisionModel.of(robot).detector)
    assert [test.pair for test in kept] == [1]
    assert [test.pair for test in proved] == [0]


@pytest.mark.parametrize(("height", "proved"), [(5.0, 1), (-0.2, 0)])
def test_bodies_of_two_branches_are_proved_as_well(height, proved):
    points = {"a": ("f0", (0.6, 0, height))}
    robot = two_arms([make_row("x", "a", "a", 0.1), make_row("y", "tool", "tool", 0.1)], [("x", "y")], points)
    assert len(split(robot, CollisionModel.of(robot).detector)[1]) == proved


@pytest.mark.parametrize("case", SHIPPED, ids=name_case)
def test_estimated_hits_are_hits(case, rng):
    """On the configurations that the estimate draws."""
    robot, detector = case
    tests = list_tests(CollisionModel(robot=robot, detector=detector).arrays)
    hits = estimate_hits(pack_robot(robot), tests, robot.lower, robot.upper)
    Q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (hits.shape[1], len(robot.joints)))
    for k in rng.integers(len(Q), size=8):
        gaps = clearances_of(robot, tests, Q[k])
        same = hits[:, k] == (gaps <= 0.0)
        assert (same | (np.abs(gaps) < 1e-9)).all()
