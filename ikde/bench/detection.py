"""What self-collision detection costs, and where its variants disagree: lists of pairs, centres and surface points."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ikde.bench.approximation import APPROXIMATIONS
from ikde.bench.budget import FULL, Budget
from ikde.bench.misprints import Data
from ikde.bench.plain_search import make_collision
from ikde.kernels.arrays import Floats
from ikde.kernels.clearance import judge_centres
from ikde.kernels.surface import judge_surfaces
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.model.surface import M_STEPS, N_STEPS, covering_angle_rad, surface_directions
from ikde.solver.surface import Rule, check_surface, check_surface_many

SEED = 20211
PAIR_LISTS = ("formula_22", "formula_22_printed", "non_adjacent")
GRIDS = ((M_STEPS, N_STEPS), (2 * M_STEPS, 2 * N_STEPS), (10 * M_STEPS, 10 * N_STEPS))
SURFACE: tuple[tuple[Rule, tuple[int, int]], ...] = (("eq. 18", GRIDS[0]), *(("eq. 20", grid) for grid in GRIDS))
COPIES = 32  # verdicts on one configuration in a timed call, so that the call weighs little
Bools = NDArray[np.bool_]


def compute_detection(robot: Robot, budget: Budget = FULL) -> Data:
    """Pairs, time a verdict and verdicts that differ, for lists of pairs and for centres against surface points.

    Args:
        robot: qiao2021.
        budget: how many random configurations.
    """
    Q = draw_configurations(robot, budget.verdicts)
    detectors = {(name, pairs): make_collision(robot, name, pairs) for name in APPROXIMATIONS for pairs in PAIR_LISTS}
    verdicts = {key: check_centres_many(detector, Q) for key, detector in detectors.items()}
    few = Q[: budget.surface_verdicts]
    return {
        "exact": {
            "lists": [
                {**_name(key), **count_pairs(detectors[key]), "colliding": int(verdicts[key].sum())}
                for key in detectors
            ],
            "lists_differ": [
                _compare_lists(robot, verdicts, name, pairs) for name in APPROXIMATIONS for pairs in PAIR_LISTS[1:]
            ],
            "surface_differs": list(_compare_surface(robot, few)),
        },
        "measured": {
            "lists": [{**_name(key), **_time_centres(detectors[key], Q, budget)} for key in detectors],
            "surface": [_time_surface(CollisionModel.of(robot, name), Q, budget) for name in APPROXIMATIONS],
        },
        "settings": {
            "source": "[Qiao2021, eq. 18 to 22]",
            "configurations": "uniform within the joint limits",
            "seed": SEED,
            "verdicts": len(Q),
            "surface_verdicts": len(few),
            "plain_verdicts": budget.plain_verdicts,
            "timed_verdicts": min(budget.timed_verdicts, len(Q)),
            "surface_grid": [M_STEPS, N_STEPS],
            "time_includes": "poses of all bodies, centres of all spheres, comparisons until the first hit",
            "threads": 1,
        },
    }


def draw_configurations(robot: Robot, count: int) -> Floats:
    """Uniform random configurations [count, N] within the limits; a shorter list is the beginning of a longer one."""
    return np.random.default_rng(SEED).uniform(robot.lower, robot.upper, (count, len(robot.joints)))


def check_centres_many(collision: CollisionModel, Q: Floats) -> Bools:
    """Whether each row of `Q` [K, N] collides by [Qiao2021, eq. 21]; [K]."""
    collides = np.empty(len(Q), dtype=bool)
    judge_centres(pack_robot(collision.robot), collision.arrays, Q, collides)
    return collides


def count_pairs(collision: CollisionModel) -> Data:
    """How many pairs of components are compared, and of spheres if none is skipped."""
    sizes: Counter[str] = Counter()
    for row in collision.rows:
        sizes[row.component] += row.count
    pairs = collision.pairs
    return {"component_pairs": len(pairs), "sphere_pairs": sum(sizes[a] * sizes[b] for a, b in pairs)}


def _name(key: tuple[str, str]) -> Data:
    return {"approximation": key[0], "pairs": key[1]}


# ---- verdicts that differ


def compare_pairs(robot: Robot, one: str, other: str) -> tuple[list[list[str]], list[list[str]]]:
    """Pairs that only list `one` looks at, and those that only the `other` does."""
    here, there = ({frozenset(pair): list(pair) for pair in robot.pair_lists[name]} for name in (one, other))
    only_here = [pair for key, pair in here.items() if key not in there]
    return only_here, [pair for key, pair in there.items() if key not in here]


def _compare_lists(robot: Robot, verdicts: Mapping[tuple[str, str], Bools], name: str, pairs: str) -> Data:
    """Another list against Formula 22 as meant, with the same spheres."""
    ours, theirs = verdicts[name, PAIR_LISTS[0]], verdicts[name, pairs]
    missing, added = compare_pairs(robot, PAIR_LISTS[0], pairs)
    return {
        "approximation": name,
        "pairs": pairs,
        "against": PAIR_LISTS[0],
        "pairs_added": added,
        "pairs_missing": missing,
        "only_this_collides": int((theirs & ~ours).sum()),
        "only_the_other_collides": int((ours & ~theirs).sum()),
        "configurations": len(ours),
    }


def _compare_surface(robot: Robot, Q: Floats) -> Iterator[Data]:
    """Surface points against centres, Formula 22 as meant; and what either says of home."""
    for name in APPROXIMATIONS:
        detector = CollisionModel.of(robot, name)
        centres = check_centres_many(detector, Q)
        for rule, (m_steps, n_steps) in SURFACE:
            rows = np.vstack([robot.home, Q])
            home, *seen = check_surface_many(robot, rows, detector, rule=rule, m_steps=m_steps, n_steps=n_steps)
            surface = np.array(seen)
            yield {
                "approximation": name,
                "rule": rule,
                "grid": [m_steps, n_steps],
                "covering_angle_deg": float(np.degrees(covering_angle_rad(m_steps, n_steps))),
                "home_collides": bool(home),
                "surface_collides": int(surface.sum()),
                "centres_collide": int(centres.sum()),
                "only_surface_collides": int((surface & ~centres).sum()),
                "only_centres_collide": int((centres & ~surface).sum()),
                "configurations": len(Q),
            }


# ---- times


def _time_centres(collision: CollisionModel, Q: Floats, budget: Budget) -> Data:
    arrays, packed = pack_robot(collision.robot), collision.arrays
    rows = Q[: budget.timed_verdicts]
    return _time_kernel(lambda qs, out: judge_centres(arrays, packed, qs, out), rows, budget.timing_rounds)


def _time_surface(collision: CollisionModel, Q: Floats, budget: Budget) -> Data:
    """Eq. 20 both ways: every point against every other, as the paper does, and only those that can matter."""
    robot = collision.robot
    arrays, packed, angle = pack_robot(robot), collision.arrays, covering_angle_rad()
    directions = surface_directions()

    def judge(qs: Floats, out: Bools) -> None:
        judge_surfaces(arrays, packed, directions, angle, collision.limit_m, qs, out)

    check_surface(robot, Q[0], collision, m_steps=3, n_steps=2)  # compiles or loads
    few, seen = Q[: budget.plain_verdicts], []
    plain = [_clock(lambda q=q: seen.append(check_surface(robot, q, collision).collision)) for q in few]
    quick = _time_kernel(judge, Q[: budget.timed_verdicts], budget.timing_rounds)
    return {
        "approximation": collision.name,
        "every_point": _summarise(np.array(plain)),
        "quick": quick,
        "same_verdicts": int((check_surface_many(robot, few, collision) == np.array(seen)).sum()),
    }


def _time_kernel(judge: Callable[[Floats, Bools], None], Q: Floats, rounds: int) -> Data:
    """Seconds a verdict: median and p95 over configurations, each of them the median of its rounds.

    `mean_s` is over all configurations one after the other, where a processor cannot learn one's branches by heart.
    """
    copies, out = [np.tile(q, (COPIES, 1)) for q in Q], np.empty(max(COPIES, len(Q)), dtype=bool)
    judge(Q, out)
    each = np.array([[_clock(lambda qs=qs: judge(qs, out)) / COPIES for qs in copies] for _ in range(rounds)])
    whole = [_clock(lambda: judge(Q, out)) / len(Q) for _ in range(rounds)]
    return {**_summarise(np.median(each, axis=0)), "mean_s": float(np.median(whole))}


def _summarise(seconds: Floats) -> Data:
    return {"median_s": float(np.median(seconds)), "p95_s": float(np.percentile(seconds, 95)), "timed": len(seconds)}


def _clock(run: Callable[[], object]) -> float:
    begin = time.perf_counter_ns()
    run()
    return 1e-9 * (time.perf_counter_ns() - begin)
