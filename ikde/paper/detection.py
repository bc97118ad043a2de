"""What self-collision detection costs, and where its variants disagree: lists of pairs, centres and surface points."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.kernels.clearance import judge_centres
from ikde.kernels.paper import judge_surfaces
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.paper.inputs import APPROXIMATIONS, PAIR_LISTS, Budget, Inputs
from ikde.paper.section import Computed, make_collision
from ikde.paper.surface import (
    M_STEPS,
    N_STEPS,
    Rule,
    check_surface,
    check_surface_many,
    covering_angle_rad,
    surface_directions,
)
from ikde.paper.timing import clock

SEED = 20211
GRIDS = ((M_STEPS, N_STEPS), (2 * M_STEPS, 2 * N_STEPS), (10 * M_STEPS, 10 * N_STEPS))
SURFACE: tuple[tuple[Rule, tuple[int, int]], ...] = (("eq. 18", GRIDS[0]), *(("eq. 20", grid) for grid in GRIDS))
COPIES = 32  # verdicts on one configuration in a timed call, so that the call weighs little
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class ListVerdicts:
    """An approximation over a list of pairs, how many it compares, and how many configurations collide."""

    component_pairs: int
    sphere_pairs: int  # if it compares all of them
    approximation: str
    pairs: str
    colliding: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ListDifference:
    """Another list against Formula 22 as meant, with the same spheres."""

    approximation: str
    pairs: str
    against: str
    pairs_added: list[list[str]]
    pairs_missing: list[list[str]]
    only_this_collides: int
    only_the_other_collides: int
    configurations: int

    @property
    def changed(self) -> int:
        """Grades that differ."""
        return self.only_this_collides + self.only_the_other_collides


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceDifference:
    """Surface points against centres, Formula 22 as meant; and whether home collides by points."""

    approximation: str
    rule: str
    grid: tuple[int, int]
    covering_angle_deg: float
    home_collides: bool
    surface_collides: int
    centres_collide: int
    only_surface_collides: int
    only_centres_collide: int
    configurations: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Times:
    """Seconds a verdict, over configurations."""

    median_s: float
    p95_s: float
    timed: int  # configurations


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelTimes(Times):
    """Median and p95 over configurations, each of them the median of its rounds."""

    mean_s: float  # of all, one after the other, where a processor cannot learn one's branches by heart


@dataclass(frozen=True, slots=True, kw_only=True)
class ListTimes(KernelTimes):
    """By centres, an approximation over a list of pairs."""

    approximation: str
    pairs: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceTimes:
    """By surface points under eq. 20."""

    approximation: str
    every_point: Times  # every point against every other, as the paper does
    quick: KernelTimes  # only those that can matter
    same_verdicts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """Times of all variants."""

    lists: list[ListTimes]
    surface: list[SurfaceTimes]


@dataclass(frozen=True, slots=True, kw_only=True)
class Detection(Computed):
    """Grades of all variants."""

    lists: list[ListVerdicts]
    lists_differ: list[ListDifference]
    surface_differs: list[SurfaceDifference]
    measured: Measured


def compute_detection(inputs: Inputs) -> Detection:
    """Pairs, time a verdict and verdicts that differ, for lists of pairs and for centres against surface points."""
    robot, budget = inputs.robot, inputs.budget
    Q = draw_configurations(robot, budget.verdicts)
    models = {key: make_collision(robot, *key) for key in product(APPROXIMATIONS, PAIR_LISTS)}
    verdicts = {key: check_centres_many(collision, Q) for key, collision in models.items()}
    few = Q[: budget.surface_verdicts]
    return Detection(
        lists=[
            ListVerdicts(
                component_pairs=len(collision.pairs),
                sphere_pairs=count_sphere_pairs(collision),
                approximation=name,
                pairs=pairs,
                colliding=int(verdicts[name, pairs].sum()),
            )
            for (name, pairs), collision in models.items()
        ],
        lists_differ=[_compare_lists(robot, verdicts, *key) for key in product(APPROXIMATIONS, PAIR_LISTS[1:])],
        surface_differs=list(_compare_surface(robot, few)),
        measured=Measured(
            lists=[
                ListTimes(approximation=name, pairs=pairs, **asdict(_time_centres(collision, Q, budget)))
                for (name, pairs), collision in models.items()
            ],
            surface=[_time_surface(CollisionModel.of(robot, name), Q, budget) for name in APPROXIMATIONS],
        ),
        settings={
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
    )


def draw_configurations(robot: Robot, count: int) -> Floats:
    """Uniform random configurations [count, N] within the limits; a shorter list is the beginning of a longer one."""
    return np.random.default_rng(SEED).uniform(robot.lower, robot.upper, (count, len(robot.joints)))


def check_centres_many(collision: CollisionModel, Q: Floats) -> Bools:
    """Whether each row of `Q` [K, N] collides by [Qiao2021, eq. 21]; [K]."""
    collides = np.empty(len(Q), dtype=bool)
    judge_centres(pack_robot(collision.robot), collision.arrays, Q, collides)
    return collides


def count_sphere_pairs(collision: CollisionModel) -> int:
    """Pairs of spheres in the pairs of components that are compared."""
    sizes: Counter[str] = Counter()
    for row in collision.rows:
        sizes[row.component] += row.count
    return sum(sizes[a] * sizes[b] for a, b in collision.pairs)


def compare_pairs(robot: Robot, one: str, other: str) -> tuple[list[list[str]], list[list[str]]]:
    """Pairs that only list `one` compares, and those that only the `other` does."""
    here, there = ({frozenset(pair): list(pair) for pair in robot.pair_lists[name]} for name in (one, other))
    only_here = [pair for key, pair in here.items() if key not in there]
    return only_here, [pair for key, pair in there.items() if key not in here]


def _compare_lists(robot: Robot, verdicts: Mapping[tuple[str, str], Bools], name: str, pairs: str) -> ListDifference:
    ours, theirs = verdicts[name, PAIR_LISTS[0]], verdicts[name, pairs]
    missing, added = compare_pairs(robot, PAIR_LISTS[0], pairs)
    return ListDifference(
        approximation=name,
        pairs=pairs,
        against=PAIR_LISTS[0],
        pairs_added=added,
        pairs_missing=missing,
        only_this_collides=int((theirs & ~ours).sum()),
        only_the_other_collides=int((ours & ~theirs).sum()),
        configurations=len(ours),
    )


def _compare_surface(robot: Robot, Q: Floats) -> Iterator[SurfaceDifference]:
    for name in APPROXIMATIONS:
        collision = CollisionModel.of(robot, name)
        centres = check_centres_many(collision, Q)
        for rule, grid in SURFACE:
            home, *others = check_surface_many(robot, np.vstack([robot.home, Q]), collision, rule=rule, grid=grid)
            surface = np.array(others)
            yield SurfaceDifference(
                approximation=name,
                rule=rule,
                grid=grid,
                covering_angle_deg=float(np.degrees(covering_angle_rad(*grid))),
                home_collides=bool(home),
                surface_collides=int(surface.sum()),
                centres_collide=int(centres.sum()),
                only_surface_collides=int((surface & ~centres).sum()),
                only_centres_collide=int((centres & ~surface).sum()),
                configurations=len(Q),
            )


def _time_centres(collision: CollisionModel, Q: Floats, budget: Budget) -> KernelTimes:
    judge = partial(judge_centres, pack_robot(collision.robot), collision.arrays)
    return _time_kernel(judge, Q[: budget.timed_verdicts], budget.timing_rounds)


def _time_surface(collision: CollisionModel, Q: Floats, budget: Budget) -> SurfaceTimes:
    robot, points = collision.robot, (surface_directions(), covering_angle_rad())
    judge = partial(judge_surfaces, pack_robot(robot), collision.arrays, *points, collision.limit_m)
    check_surface(robot, Q[0], collision, m_steps=3, n_steps=2)  # compiles or loads
    few, verdicts = Q[: budget.plain_verdicts], []
    plain = [clock(lambda q=q: verdicts.append(check_surface(robot, q, collision).collision)) for q in few]
    quick = _time_kernel(judge, Q[: budget.timed_verdicts], budget.timing_rounds)
    return SurfaceTimes(
        approximation=collision.name,
        every_point=_summarise(np.array(plain)),
        quick=quick,
        same_verdicts=int((check_surface_many(robot, few, collision) == np.array(verdicts)).sum()),
    )


def _time_kernel(judge: Callable[[Floats, Bools], None], Q: Floats, rounds: int) -> KernelTimes:
    copies, out = [np.tile(q, (COPIES, 1)) for q in Q], np.empty(max(COPIES, len(Q)), dtype=bool)
    judge(Q, out)
    each = np.array([[clock(lambda qs=qs: judge(qs, out)) / COPIES for qs in copies] for _ in range(rounds)])
    whole = [clock(lambda: judge(Q, out)) / len(Q) for _ in range(rounds)]
    return KernelTimes(**asdict(_summarise(np.median(each, axis=0))), mean_s=float(np.median(whole)))


def _summarise(seconds: Floats) -> Times:
    return Times(median_s=float(np.median(seconds)), p95_s=float(np.percentile(seconds, 95)), timed=len(seconds))
