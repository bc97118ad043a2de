"""The evolution of one step: its population, its repair, its verdicts."""

import numpy as np
import pytest

from ikde.kernels.drive import set_step_box, take_drive_step
from ikde.kernels.rng import seed_stream
from ikde.kernels.step_evolution import (
    COLLIDES,
    LIMITED,
    MISSED,
    NO_BOX,
    SOLVED,
    breed_steps,
    draw_population,
    evolve_sample,
    judge_step,
    make_step_workspace,
)
from ikde.model.pack import pack_robot
from ikde.track.optimized import OptimizedSettings, pack_step_search
from tests.track.paper_tasks import follower_of, short_task, start_of

BEST_1, RAND_1 = 1, 0


class Case:
    """Sample 1 of task 1, from a start at its sample 0."""

    def __init__(self, robot, *, changes=None, drive="differential", task=1, **limits):
        self.follower = follower_of(robot, short_task(task), drive=drive, **limits)
        self.robot, self.detector = (
            pack_robot(robot),
            self.follower.collision.arrays,
        )
        self.search = pack_step_search(self.follower, OptimizedSettings())._replace(**(changes or {}))
        self.q, self.size = start_of(robot.name, task).copy(), self.follower.size  # read-only would compile anew
        self.work = make_step_workspace(self.robot, self.detector, len(self.q), self.size, self.search.population)
        seed_stream(np.uint64(1), np.int64(1), np.int64(0), self.work.state)
        set_step_box(
            self.follower.drive, self.follower.track.ranges, self.q, np.zeros(self.size), True, *self.work[5:7]
        )

    def draw(self):
        draw_population(self.robot, self.follower.drive, self.follower.target, 1, self.search, self.q, self.work)

    def judge(self, step, **track):
        follower = self.follower
        settings = follower.track._replace(**track)
        return judge_step(
            self.robot,
            self.detector,
            follower.drive,
            settings,
            follower.target,
            1,
            self.search,
            self.q,
            np.array(step),
            self.work,
        )

    def solve(self, seed=0, last=None, first_step=True, q=None):
        follower, out_q, out_step = self.follower, np.zeros(len(self.q)), np.zeros(self.size)
        last = np.zeros(self.size) if last is None else last
        outcome = evolve_sample(
            self.robot,
            self.detector,
            follower.drive,
            follower.track,
            follower.target,
            1,
            self.search,
            np.uint64(seed),
            self.q if q is None else q,
            last,
            first_step,
            self.work,
            out_q,
            out_step,
        )
        return *outcome, out_q, out_step


def test_of_members_and_opposites_the_best_are_kept_and_sorted(qiao):
    case = Case(qiao)
    case.draw()
    work, population = case.work, case.search.population
    assert (np.diff(work.fitness[:population]) >= 0.0).all()
    assert work.fitness[population - 1] <= work.fitness[population:].min()
    assert (np.abs(work.x) <= 1.0).all()
    pairs = sum((work.x == -row).all(axis=1).any() for row in work.x)
    assert pairs == 2 * population  # far from the ranges' ends every opposite stays


def test_a_range_that_ends_near_makes_the_box_narrow_and_all_stay_in_it(qiao):
    case = Case(qiao)
    case.work.lower[3], case.work.upper[3] = -0.1, 0.3
    case.draw()
    best = np.int64(0)
    for strategy in (BEST_1, RAND_1, RAND_1):
        best = breed_steps(
            case.robot, case.follower.drive, case.follower.target, 1, case.search, strategy, best, case.q, case.work
        )
        inside = (case.work.x >= case.work.lower) & (case.work.x <= case.work.upper)
        assert inside[: case.search.population].all()


def test_no_member_gets_worse_and_the_best_is_known(qiao):
    case = Case(qiao)
    case.draw()
    best = np.int64(0)
    for strategy in (BEST_1, RAND_1, BEST_1):
        before = case.work.fitness[: case.search.population].copy()
        best = breed_steps(
            case.robot, case.follower.drive, case.follower.target, 1, case.search, strategy, best, case.q, case.work
        )
        after = case.work.fitness[: case.search.population]
        assert (after <= before).all()
        assert best == np.argmin(after)


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
def test_a_solved_step_ends_at_the_target(qiao, drive):
    case = Case(qiao, drive=drive)
    verdict, pair, populations, evaluations, q, step = case.solve()
    assert (verdict, pair, populations) == (SOLVED, -1, 1)
    assert 2 * 50 < evaluations < 50 * 1000
    assert case.size == (8 if drive == "differential" else 9)
    assert (np.abs(step) <= 1.0).all()
    end = np.zeros(len(q))
    take_drive_step(case.follower.drive, case.q, step, end)
    np.testing.assert_array_equal(end, q)
    assert case.judge(step)[0] == SOLVED


def test_same_seed_same_bits(qiao):
    first, again, other = Case(qiao).solve(3), Case(qiao).solve(3), Case(qiao).solve(4)
    np.testing.assert_array_equal(first[4], again[4])
    assert first[:4] == again[:4]
    assert (first[4] != other[4]).any()


def test_verdicts(qiao):
    case = Case(qiao)
    step = case.solve()[5]
    assert case.judge(np.zeros(case.size))[0] == MISSED
    outside = case.follower.track.ranges.copy()
    outside[0, 0] = case.q[0] + 1.0
    assert case.judge(step, ranges=outside)[0] == LIMITED
    case.detector = case.detector._replace(safe_distance=10.0)
    verdict, pair = case.judge(step)
    assert verdict == COLLIDES
    assert pair >= 0


@pytest.mark.parametrize("limits", [{"wheel_speed_rad_s": 1e-3}, {"max_distance_m": 0.01, "center": "Oc"}])
def test_what_the_box_does_not_keep_is_judged(qiao, limits):
    step = Case(qiao).solve()[5]
    assert Case(qiao, **limits).judge(step)[0] == LIMITED


def test_an_arc_that_leaves_the_bases_range_on_its_way_is_judged_too(qiao):
    case = Case(qiao, changes={"position_tolerance": 1e3, "orientation_tolerance": 1e3})
    step = np.array([1.0, 1.0, *np.zeros(6)])
    distance, angle = case.follower.drive.largest[:2]
    case.q[2] = 0.5 * (np.pi - angle)  # along y half-way
    farthest = case.q[0] + distance / angle * (1.0 - np.cos(0.5 * angle))
    for beyond, verdict in ((1e-9, SOLVED), (-1e-9, LIMITED)):
        ranges = case.follower.track.ranges.copy()
        ranges[1, 0] = farthest + beyond
        assert case.judge(step, ranges=ranges)[0] == verdict


def test_what_no_population_solves_is_tried_as_often_as_told(qiao):
    case = Case(qiao, changes={"attempts": 3, "generations": 5})
    case.detector = case.detector._replace(safe_distance=10.0)
    verdict, _, populations, evaluations, q, step = case.solve()
    assert (verdict, populations) == (MISSED, 3)
    assert evaluations == 3 * (100 + 5 * 50)
    assert np.isfinite(q).all()
    assert (np.abs(step) <= 1.0).all()


def test_without_a_box_nothing_is_drawn(qiao):
    case = Case(qiao, acceleration=np.full(9, 1e-3))
    assert case.solve(last=np.full(8, 0.5), first_step=False, q=case.q * 0 + qiao.upper)[0] == NO_BOX
