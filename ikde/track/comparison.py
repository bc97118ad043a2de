"""Ways to follow a path beside one another: what each reaches, breaks and costs, over seeds and random starts."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from itertools import chain
from typing import Any, TypeVar

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.solver.progress import Progress
from ikde.solver.search import usable_cores
from ikde.solver.settings import BulkOptions
from ikde.solver.solve import solve_many
from ikde.track.follower import make_follower
from ikde.track.plan import TrackPlan
from ikde.track.run import run_track
from ikde.track.spec import TrackMethod
from ikde.track.starts import EXACT
from ikde.track.summary import TrackSummary, summarise_track
from ikde.track.trajectory import TrackStop, Trajectory

Item = TypeVar("Item")
Result = TypeVar("Result")

METHODS: tuple[TrackMethod, ...] = ("typical", "optimized", "continuation")
STARTED_ANYWHERE = ("optimized", "continuation")
"""Methods for which the start matters: `typical` begins anew at every sample."""
ONCE = EXACT.with_changes(method="lm", restarts=1)
MIN_MOTION = np.zeros(3)
DRAWS_PER_START = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackBudget:
    """How often each method is run."""

    seeds: int
    starts: int
    """Random configurations at the first pose."""


FULL = TrackBudget(seeds=10, starts=100)
QUICK = TrackBudget(seeds=2, starts=5)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Compared:
    """One track and the methods that followed it."""

    plan: TrackPlan
    motions: Mapping[str, TrackSummary]
    """Of the first seed."""
    data: Mapping[str, Any]
    """All seeds and starts, as plain data."""


def count_runs(tracks: int, methods: Sequence[TrackMethod], budget: TrackBudget) -> int:
    """Motions of a whole comparison."""
    return tracks * sum(budget.seeds + (budget.starts if m in STARTED_ANYWHERE else 0) for m in methods)


def compare_methods(
    plan: TrackPlan, methods: Sequence[TrackMethod], budget: TrackBudget, progress: Progress
) -> Compared:
    """Follow one track by each method with every seed, and from every start; all begin where `continuation` does.

    The first seed has the machine for itself: its times are what a sample takes.
    """
    motions, runs, seeds = {}, [], range(plan.seed, plan.seed + budget.seeds)
    start = find_start(plan) if set(methods) - {"continuation"} else None
    for method in methods:
        progress.begin(f"{plan.name}: {method}")
        given = None if method == "continuation" else start
        run = partial(_follow_seed, plan, method, given)
        for seed, motion in zip(seeds, chain([run(seeds[0])], _side_by_side(run, seeds[1:])), strict=True):
            motions.setdefault(method, motion)
            runs.append({"method": method, "drive": motion.trajectory.drive, "seed": seed, **measure(motion)})
            progress.advance(1)
    progress.begin(f"{plan.name}: random starts")
    ends = count_dead_ends(plan, [method for method in methods if method in STARTED_ANYWHERE], budget.starts, progress)
    about = {"name": plan.name, "file": plan.file, "points": plan.path.samples, "dt_s": plan.path.dt_s}
    about["world"] = _name_world(plan)
    return Compared(plan=plan, motions=motions, data={**about, "runs": runs, "dead_ends": ends})


def _name_world(plan: TrackPlan) -> dict[str, Any] | None:
    """The world by its file and digest, and what is kept from it, m; None without one."""
    model = plan.collision
    if not model.obstacles:
        return None
    kept = {"margin_m": model.margin_m, "margins_m": dict(model.margins_m)}
    return {"file": plan.world_file, "digest": model.world.digest, **kept}


def find_start(plan: TrackPlan) -> Floats | None:
    """Where `continuation` begins; None if it does not even begin."""
    q = run_track(plan, method="continuation").q
    return q[0] if len(q) else None


def _follow_seed(plan: TrackPlan, method: TrackMethod, start: Floats | None, seed: int) -> TrackSummary:
    """One motion, measured."""
    trajectory = run_track(plan, method=method, start=start, seed=seed)
    return summarise_track(plan.collision, trajectory)


def _side_by_side(run: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Results in order, an item a core: the kernels let go of Python's lock."""
    with ThreadPoolExecutor(usable_cores()) as pool:
        try:
            yield from pool.map(run, items)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def measure(motion: TrackSummary) -> dict[str, Any]:
    """A motion's row of the table; None where there is nothing to measure or nothing was checked."""
    graded, trajectory = motion.grade, motion.trajectory
    broken, seconds = asdict(graded.violations), trajectory.seconds
    return {
        "points": trajectory.path.samples,
        "reached_points": motion.met_points,
        "largest_axis_error_mm": 1e3 * graded.largest_axis_error_m,
        "largest_total_error_mm": 1e3 * graded.total_error_m,
        "largest_rotation_error_rad": graded.largest_orientation_error_rad,
        "broken": broken,
        "limit_violations": sum(count for name, count in broken.items() if name not in ("error", "collision")),
        "colliding_samples": broken["collision"],
        "smallest_clearance_mm": _in_mm(graded.clearance_m),
        "certified_clearance_mm": _in_mm(motion.certificate.clearance_m if motion.certificate else None),
        "largest_deviation_mm": 1e3 * float(trajectory.deviation_m.max(initial=0.0)),
        "largest_sideways_m_s": float(np.abs(graded.sideways_m_s).max(initial=0.0)),
        "largest_jump_m": motion.largest_step("prismatic"),
        "largest_jump_rad": motion.largest_step("revolute"),
        "smallest_singular_value": _finite(float(motion.singular_values.min(initial=np.inf))),
        "median_s": float(np.median(seconds)) if len(seconds) else None,
        "p99_s": float(np.quantile(seconds, 0.99)) if len(seconds) else None,
        "search_s": trajectory.search_seconds,
        "stop": trajectory.stop.text if trajectory.stop else None,
    }


def count_dead_ends(plan: TrackPlan, methods: Sequence[TrackMethod], count: int, progress: Progress) -> dict[str, Any]:
    """How often each method, and the greedy follower without backtracking, end early from random starts."""
    starts = draw_random_starts(plan, count, plan.seed)
    follower = make_follower(plan.with_changes(method="continuation"))
    reached = {"greedy": [follower.begin(start, MIN_MOTION).resume().last for start in starts]}
    stops, seconds = {}, {}
    for method in methods:
        motions = list(_follow_from(plan, method, starts, progress))
        seconds[method] = [motion.search_seconds for motion in motions]
        reached[method] = [motion.reached_points for motion in motions]
        stops[method] = Counter(name_stop(motion.stop) for motion in motions if motion.stop)
    early = {name: sum(points < plan.path.samples for points in ends) for name, ends in reached.items()}
    why = {name: dict(counts.most_common()) for name, counts in stops.items()}
    return {"starts": len(starts), **early, "stops": why, "reached_points": reached, "search_s": seconds}


def draw_random_starts(plan: TrackPlan, count: int, seed: int) -> Floats:
    """Free configurations [S, N], S <= count, at the path's first pose, where random ones come to rest."""
    robot, target = plan.robot, plan.path.targets()[0]
    rng, found, prismatic = np.random.default_rng(seed), [], robot.is_prismatic
    options = {"collision": plan.collision, "bulk": BulkOptions(threads=1, explain=False)}
    place, (lower, upper) = np.resize(target.p_world_tool, prismatic.sum()), robot.drawn
    for _ in range(DRAWS_PER_START * count):
        near = rng.uniform(lower, upper)
        shifted = place + rng.uniform(-1.0, 1.0, len(place))
        near[prismatic] = np.clip(shifted, lower[prismatic], upper[prismatic])
        row = solve_many(robot, [target], ONCE, near=near, **options)
        found += list(row.q[row.reached])
        if len(found) == count:
            break
    return np.array(found).reshape(-1, len(robot.joints))


def _follow_from(plan: TrackPlan, method: TrackMethod, starts: Floats, progress: Progress) -> Iterator[Trajectory]:
    for motion in _side_by_side(lambda start: run_track(plan, method=method, start=start), starts):
        yield motion
        progress.advance(1)


def name_stop(stop: TrackStop) -> str:
    """The reason, and the pair or the limit that it names."""
    return f"{stop.reason.value} {'-'.join(stop.pair or (stop.limit or '',))}".strip()


def _in_mm(length_m: float | None) -> float | None:
    return None if length_m is None else 1e3 * length_m


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
