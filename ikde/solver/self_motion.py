"""Motion that leaves the tool where it is asked to be: uphill, within joint ranges and free of collision.

What is raised is the smallest of some numbers, of which there may be one. Each step is the one that raises their
linearised minimum most, less the square of its length, in the null space of the tool: the nearest point of a polytope
(`kernels/dual_active_set.py`). Then the tool is brought back onto its target by Newton's steps, pairs that it brought
too near apart with it. A step that does not raise the true minimum, or ends out of a range or in collision, is taken
shorter.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.dual_active_set import find_nearest_point, make_half_spaces
from ikde.model.target import Target, Targets
from ikde.solver.jacobian import ASKED_ROWS, frame_jacobian
from ikde.solver.objectives import Objective, differentiate_gaps
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.problem import ROUNDING, Problem, shrink
from ikde.solver.verify import compute_orientation_errors

MAX_STEPS = 150
MAX_RETURNS = 12  # Newton's steps back onto the target
RANK = 1e-6  # of the largest singular value: what is below it does not move the tool
REACH_M = 0.05  # beyond what is asked for: nearer pairs are constrained
KEPT_M, INSIDE_M = 1e-3, 1e-8  # beyond what is asked for: what is kept, or what there was if less, at least the second
SLIP = 0.9  # of that: how much is enough where a step ends
DONE = 1e-9  # of what is raised: a step that promises less is not taken
FIRST_STEP, MAX_STEP, SHORTEST = 0.1, 10.0, 1e-9  # square of a length over what it raises, in shares of joint ranges
PROMISED = 0.1  # how much of what it promised a step shall raise; else the next one is shorter


class Climb(NamedTuple):
    """Where a way uphill ends."""

    q: Floats
    """[N]"""
    steps: int
    settled: bool
    """Whether it ended where no step promises more; False: after `MAX_STEPS`, or where steps get no shorter."""


class Slope(NamedTuple):
    """What is known at a configuration."""

    free: Floats
    """[N, d] orthogonal unit vectors along which the tool stays, in weighted joints."""
    values: Floats
    """[K] of which the smallest is raised."""
    slopes: Floats
    """[K, N] by the joints."""
    rooms: Floats
    """[k] what near pairs keep beyond what is asked for, m."""
    gradients: Floats
    """[k, N] theirs."""
    uphill: Floats | None
    """[N] the slope of a single value along the free directions, in weighted joints."""


@dataclass(kw_only=True)
class SelfMotion:
    """Where the target allows the robot to go."""

    problem: Problem
    target: Target
    kept_m: float = INSIDE_M
    """What pairs keep beyond what is asked for."""

    def climb(self, q: Floats, objective: Objective) -> Climb:
        """From `q` [N], which meets the target, to a local maximum of what is raised.

        Where it ends is as good as `q` at least, and good as `is_good` says, if a step was taken.
        """
        self.kept_m = max(INSIDE_M, min(KEPT_M, float(self._list_rooms(q).min(initial=np.inf))))
        here, best, size, bend = q, objective.worth(q), FIRST_STEP, np.eye(len(q))
        slope = self._linearise(here, objective)
        for steps in range(MAX_STEPS):
            step, promised = self._choose_step(here, slope, _scale(slope.free, bend) * np.sqrt(size))
            if promised <= DONE * min(1.0, size) * max(1.0, abs(best)):
                return Climb(here, steps, True)
            end = self._come_back(here, here + step)
            value = -np.inf if end is None else objective.worth(end)
            is_as_promised = value >= best + PROMISED * promised
            if end is None or value <= best:
                size *= 0.3
                if size < SHORTEST:
                    return Climb(here, steps, False)
                continue
            before, slope = slope, self._linearise(end, objective)
            if before.uphill is not None and slope.uphill is not None:
                is_first = here is q
                size = 1.0 if is_first else size
                moved = (end - here) * self.problem.weights
                bend = _update_bend(bend, moved, before.uphill - slope.uphill, is_first)
            here, best = end, value
            size = min(2.0 * size, MAX_STEP) if is_as_promised else 0.7 * size
        return Climb(here, MAX_STEPS, False)

    def _linearise(self, q: Floats, objective: Objective) -> Slope:
        """What steps from `q` [N] are chosen by."""
        free, (values, slopes) = self._find_free(q), objective.climb(q)
        uphill = free @ (free.T @ (slopes[0] * self.moving)) if len(values) == 1 else None
        return Slope(free, values, slopes, *self._find_contacts(q), uphill)

    def is_good(self, q: Floats) -> bool:
        """Whether `q` [N] is on the target, in the ranges and free."""
        problem, settings = self.problem, self.problem.settings
        T = compute_frames(problem.robot, q)[problem.robot.tool]
        position = float(np.linalg.norm(T[:3, 3] - self.target.p_world_tool))
        angle = float(compute_orientation_errors(Targets.of([self.target]), T[None, :3, :3])[0])
        on_target = position <= shrink(settings.position_tolerance_m) and angle <= shrink(
            settings.orientation_tolerance_rad
        )
        inside = bool(((q >= problem.lower) & (q <= problem.upper)).all())
        return on_target and inside and bool((self._list_rooms(q) > self._enough_m).all())

    @property
    def _enough_m(self) -> float:
        return max(ROUNDING, SLIP * self.kept_m)

    def _list_rooms(self, q: Floats) -> Floats:
        """What each pair keeps beyond what is asked for [..., P], m."""
        return compute_gaps(self.problem.collision, q) - self.problem.collision.limit_m

    @cached_property
    def moving(self) -> Floats:
        """[N] by how much of a m or a rad a step of 1 moves a joint: 1 / weight, 0 for one that is held."""
        problem = self.problem
        return np.where(problem.upper > problem.lower, 1.0 / problem.weights, 0.0)

    def _find_free(self, q: Floats) -> Floats:
        """Orthogonal unit vectors [N, d] along which the tool stays, in weighted joints; those held are left out."""
        moves = self.moving > 0.0
        values, Vt = np.linalg.svd((self._miss(q)[0] * self.moving)[:, moves])[1:]
        rank = int((values > RANK * max(values.max(initial=0.0), 1e-12)).sum())
        free = np.zeros((len(q), int(moves.sum()) - rank))
        free[moves] = Vt[rank:].T
        return free

    def _choose_step(self, q: Floats, slope: Slope, scaled: Floats) -> tuple[Floats, float]:
        """The step [N] that raises the smallest value most, less |z|^2 / 2, and by how much it should.

        `scaled`: the directions [N, d] whose multiples z it is made of, in weighted joints.
        """
        values, slopes = slope.values, slope.slopes
        free = scaled * self.moving[:, None]
        if not free.any():
            return np.zeros_like(q), 0.0
        least = float(values.min())
        near = values < least + np.abs(slopes @ free).sum(axis=1) * 3.0 + 1e-9  # what one step can make the smallest
        rows, offsets = [np.column_stack([slopes[near] @ free, -np.ones(near.sum())])], [least - values[near]]
        problem = self.problem
        held = np.flatnonzero(self.moving > 0.0)
        for sign, room in ((1.0, q - problem.lower), (-1.0, problem.upper - q)):
            rows.append(np.column_stack([sign * free[held], np.zeros(len(held))]))
            offsets.append(-room[held])
        rows.append(np.column_stack([slope.gradients @ free, np.zeros(len(slope.rooms))]))
        offsets.append(self.kept_m - slope.rooms)
        y = _find_nearest(np.vstack(rows), np.concatenate(offsets), np.append(np.zeros(free.shape[1]), 1.0))
        if y is None:
            return np.zeros_like(q), 0.0
        step = free @ y[:-1]
        return step, float((values + slopes @ step).min() - least)

    def _find_contacts(self, q: Floats) -> tuple[Floats, Floats]:
        """The rooms [k] of the pairs that are near, and their gradients [k, N]."""
        rooms = self._list_rooms(q)
        near = np.flatnonzero(rooms < REACH_M)
        return rooms[near], differentiate_gaps(self.problem, q, near)

    def _miss(self, q: Floats) -> tuple[Floats, Floats]:
        """The rows [r, N] of the tool's Jacobian that the target asks for, and what it misses [r], in its own axes."""
        robot, target = self.problem.robot, self.target
        T = compute_frames(robot, q)[robot.tool]
        R, shift = T[:3, :3], T[:3, :3].T @ (target.p_world_tool - T[:3, 3])
        rows = ASKED_ROWS[{"position": "free", "axis": "axis", "pose": "pose"}[target.kind]]
        miss = np.zeros(6)
        miss[:3] = shift
        if target.kind == "axis":
            x, y, z = R.T @ target.R_world_tool[:, 2]
            miss[3:] = _scale_sine(np.array([-y, x, 0.0]), z)
        elif target.kind == "pose":
            D = R.T @ target.R_world_tool
            sine = 0.5 * np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]])
            miss[3:] = _scale_sine(sine, 0.5 * (np.trace(D) - 1.0))
        return frame_jacobian(robot, q, robot.tool, "frame")[:rows], miss[:rows]

    def _come_back(self, start: Floats, q: Floats) -> Floats | None:
        """The configuration near `q` [N] that meets the target, in the ranges and free; None if none is found."""
        problem, moving = self.problem, self.moving
        q = np.clip(q, problem.lower, problem.upper)
        contacts, gradients = np.empty(0, dtype=np.int64), np.empty((0, len(q)))
        for _ in range(MAX_RETURNS):
            jacobian, miss = self._miss(q)
            rooms = self._list_rooms(q)
            contacts = np.union1d(contacts, np.flatnonzero(rooms <= self._enough_m)).astype(np.int64)
            if np.abs(miss).max() < 1e-13 and (rooms > self._enough_m).all():
                break
            if len(contacts) != len(gradients):
                if len(contacts) > np.count_nonzero(moving):
                    return None
                gradients = differentiate_gaps(problem, start, contacts)
            wanted = np.concatenate([miss, self.kept_m - rooms[contacts]])
            at_end = ((q <= problem.lower) | (q >= problem.upper)) & (moving > 0.0)
            change = _solve(np.vstack([jacobian, gradients]), wanted, moving)
            out = at_end & ((q + change < problem.lower) | (q + change > problem.upper))
            if out.any():  # at an end and pushed beyond it: the others do it
                change = _solve(np.vstack([jacobian, gradients]), wanted, np.where(out, 0.0, moving))
            q = np.clip(q + change, problem.lower, problem.upper)
        return q if self.is_good(q) else None


def _scale(free: Floats, bend: Floats) -> Floats:
    """The directions `free` [N, d], of such lengths that |z|^2 is what the step by z bends, by `bend` [N, N]."""
    L = np.linalg.cholesky(free.T @ bend @ free)
    return np.asarray(np.linalg.solve(L, free.T).T, dtype=float)


def _update_bend(bend: Floats, step: Floats, change: Floats, is_first: bool) -> Floats:
    """How slopes change along steps, after one more, by the damped formula of Broyden, Fletcher, Goldfarb and Shanno.

    [Nocedal2006, procedure 18.2]; of a first step the matrix has its size, too.
    """
    across = float(step @ change)
    if is_first and across > 0.0:
        bend = np.eye(len(step)) * float(change @ change) / across
    bent = bend @ step
    whole = float(step @ bent)
    if whole <= 0.0:
        return bend
    share = 1.0 if across >= 0.2 * whole else 0.8 * whole / (whole - across)
    mixed = share * change + (1.0 - share) * bent
    return bend - np.outer(bent, bent) / whole + np.outer(mixed, mixed) / float(step @ mixed)


def _solve(jacobian: Floats, wanted: Floats, moving: Floats) -> Floats:
    """The least weighted change [N] of the joints that changes what a `jacobian` [r, N] is of by `wanted` [r]."""
    return moving * (np.linalg.pinv(jacobian * moving, rcond=RANK) @ wanted)


def _scale_sine(sine: Floats, cosine: float) -> Floats:
    """The rotation vector [3] whose axis times the sine of its angle this is."""
    size = float(np.linalg.norm(sine))
    return sine if size < 1e-12 else sine * (np.arctan2(size, cosine) / size)


def _find_nearest(normals: Floats, offsets: Floats, y: Floats) -> Floats | None:
    """The point nearest to `y` [D] with normals [W, D] . y >= offsets [W]; None if there is none."""
    lengths = np.linalg.norm(normals, axis=1)
    kept = lengths > 1e-12
    spaces = make_half_spaces.plain(int(kept.sum()), len(y))
    spaces.normals[:] = normals[kept] / lengths[kept, None]
    spaces.offsets[:] = offsets[kept] / lengths[kept]
    point = y.copy()
    with np.errstate(all="ignore"):
        return point if find_nearest_point.plain(spaces, int(kept.sum()), point) else None
