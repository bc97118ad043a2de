"""Speeds for several tasks on one robot, in order of priority: each as far as those before it leave room.

A task is a matrix A and what A x should be. The first is met by least squares; each further one among the motions that
change nothing of those before it, so the answer is lexicographic. Without bounds it is the recursion

    x_k = x_(k-1) + (A_k N_(k-1))^# (b_k - A_k x_(k-1)),

where N is the projector onto the null space of all tasks before [Siciliano1991, Baerlocher1998]. It is kept as an
orthonormal basis and never damped, so a later task cannot leak into an earlier one. What is damped is the inverse,
where a singular value falls below `softest`: 1 / s becomes s / softest^2, so no task asks for more than
|b| / softest of speed. Bounds hold for all tasks: each level's optimum inside them is found by a dual active set
(`kernels/dual_active_set.py`), in a metric in which the level's own directions count and the others hardly do, and from
there exactly, by taking up and dropping bounds until no multiplier has the wrong sign [Nocedal2006, 16.5].
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.kernels.dual_active_set import HalfSpaces, find_nearest_point

SOFTEST = 0.05
"""Singular value below which an inverse is damped: m/s (or the unit of a row) for a unit of speed."""
RANK = 1e-9  # singular values below are none: no speed serves the task there
IDLE = 0.1  # weight of directions that a level does not need, as a share of the softest of those that it does
ROUNDS = 100
SETTLED = 1e-11  # of a multiplier, or of how fast a step nears a bound
STEEP = 1e-9  # slope below which a level cannot change a bound
NEARLY = 1e-6  # by which a bound may be missed where rounding adds up: more is no answer
INSIDE = 1e-8  # by which a bound may be missed; whatever needs it exactly cuts that off


class Level(NamedTuple):
    """What is asked with one priority."""

    matrix: Floats
    """A [m, n]"""
    wanted: Floats
    """What A x should be [m]."""


class Bounds(NamedTuple):
    """lower <= rows x <= upper."""

    rows: Floats
    """[C, n]"""
    lower: Floats
    """[C]"""
    upper: Floats
    """[C]"""


class Speeds(NamedTuple):
    """The answer: speeds, and of each level what limits it."""

    x: Floats
    """[n]"""
    ranks: tuple[int, ...]
    """Of what the levels before leave of each level's matrix."""
    smallest: tuple[float, ...]
    """Its smallest singular value, of as many as there are rows, or motions left: 0 where rows cannot be served."""
    damped: tuple[bool, ...]
    """Whether one of its singular values is so small that its inverse is damped."""
    holding: tuple[tuple[int, ...], ...]
    """Bounds that keep each level from doing better: rows of `Bounds`."""
    within: bool
    """Whether the bounds are kept; False if no speeds keep them all: then none is kept."""


def damped_inverse(matrix: Floats, softest: float = SOFTEST) -> Floats:
    """The pseudo-inverse [..., n, m] of matrices [..., m, n], with s / softest^2 for 1 / s where s is below."""
    U, s, Vt = np.linalg.svd(matrix, full_matrices=False)
    return (Vt.mT * _invert(s, softest)[..., None, :]) @ U.mT


def null_projector(matrix: Floats) -> Floats:
    """Projectors [..., n, n] onto the null spaces of matrices [..., m, n]: what a matrix does not see of x."""
    _, s, Vt = np.linalg.svd(matrix, full_matrices=False)
    return np.eye(matrix.shape[-1]) - (Vt.mT * (s > RANK)[..., None, :]) @ Vt


def recurse(levels: Sequence[Level], softest: float = SOFTEST) -> Floats:
    """Speeds [..., n] by the recursion as it is written in textbooks; one problem or many side by side.

    `solve_levels` gives the same, and more: bounds, and what limits each level.
    """
    x, above = np.zeros((*levels[0].matrix.shape[:-2], levels[0].matrix.shape[-1])), None
    for matrix, wanted in levels:
        left = wanted - (matrix @ x[..., None])[..., 0]
        open_ = matrix if above is None else matrix @ null_projector(above)
        x = x + (damped_inverse(open_, softest) @ left[..., None])[..., 0]
        above = matrix if above is None else np.concatenate([above, matrix], axis=-2)
    return x


def solve_levels(levels: Sequence[Level], bounds: Bounds | None = None, softest: float = SOFTEST) -> Speeds:
    """The least speeds x [n] that serve the levels in their order, inside the bounds.

    Args:
        levels: at least one, the first before all others; rows of one are weighed against each other as they are.
        bounds: hold for every level, before the first.
        softest: where singular values are damped; 0 damps nothing.
    """
    size = levels[0].matrix.shape[1]
    x, free = np.zeros(size), np.eye(size)
    within = bounds is None or bool((bounds.lower <= bounds.upper).all())
    bounds = bounds if within else None
    ranks, smallest, damped, holding, is_bound = [], [], [], [], False
    for matrix, wanted in levels:
        U, s, Vt = np.linalg.svd(matrix @ free, full_matrices=True)
        rank = int((s > RANK).sum())
        along = _invert(s[:rank], softest) * (U[:, :rank].T @ (wanted - matrix @ x))
        open_ = free @ Vt.T
        step, holds = open_[:, :rank] @ along, ()
        if bounds is not None and not _is_inside(bounds, x + step):
            weights = np.maximum(s[:rank], softest)
            idle = IDLE * weights[-1] if rank else 1.0
            found = _stay_inside(bounds, x, open_, np.r_[weights, np.full(open_.shape[1] - rank, idle)], along)
            if found is not None:
                (step, holds), is_bound = found, True
            elif _is_inside(bounds, x, NEARLY):
                step = np.zeros(size)  # so little room is left that rounding takes it
            else:
                bounds, within = None, False
        x, free = x + step, open_[:, rank:]
        ranks.append(rank)
        smallest.append(float(s[-1]) if len(s) and len(s) == len(matrix) else 0.0)
        damped.append(bool((s[:rank] < softest).any()))
        holding.append(holds)
    if bounds is not None and is_bound:
        x = _rest(bounds, x, free) if free.shape[1] else x
        within = _is_inside(bounds, x, NEARLY)
    return Speeds(x, tuple(ranks), tuple(smallest), tuple(damped), tuple(holding), within)


def _invert(s: Floats, softest: float) -> Floats:
    """1 / s, below `softest` s / softest^2; 0 for what is none."""
    safe = np.where(s > RANK, np.maximum(s, softest), 1.0)
    return np.where(s > RANK, np.minimum(s / safe, 1.0) / safe, 0.0)


def _is_inside(bounds: Bounds, x: Floats, within: float = INSIDE) -> bool:
    values = bounds.rows @ x
    return bool((values >= bounds.lower - within).all() and (values <= bounds.upper + within).all())


def _rest(bounds: Bounds, x: Floats, free: Floats) -> Floats:
    """The least of what all levels leave open."""
    along = -(free.T @ x)
    if _is_inside(bounds, x + free @ along):
        return x + free @ along
    found = _stay_inside(bounds, x, free, np.ones(free.shape[1]), along)
    return x if found is None else x + found[0]


def _stay_inside(
    bounds: Bounds, x: Floats, open_: Floats, weights: Floats, along: Floats
) -> tuple[Floats, tuple[int, ...]] | None:
    """A step of one level inside the bounds, and the bounds that hold it; None if there is none.

    Args:
        bounds: of all speeds.
        x: what the levels before gave [n].
        open_: directions [n, k] that are open, those that the level needs first.
        weights: how much a unit of each counts [k].
        along: what the level would have of its own directions [r].
    """
    slopes, values = bounds.rows @ open_, bounds.rows @ x
    steep = np.flatnonzero(np.linalg.norm(slopes, axis=1) > STEEP)
    if not len(steep):  # what is outside stays there, whatever this level does
        return open_[:, : len(along)] @ along, ()
    box = Bounds(slopes[steep], (bounds.lower - values)[steep], (bounds.upper - values)[steep])
    start = _find_start(box, weights, along)
    if start is None:
        return None
    point, active = _improve(box, weights[: len(along)], along, *start)
    return open_ @ point, tuple(sorted(int(steep[k]) for k in active))


def _find_start(box: Bounds, weights: Floats, along: Floats) -> tuple[Floats, list[int]] | None:
    """The point inside the bounds that is nearest to what the level would have, and the bounds that hold it."""
    count, y = len(box.rows), np.zeros(len(weights))
    normals = box.rows / weights
    sizes = np.linalg.norm(normals, axis=1)
    normals /= sizes[:, None]
    spaces = _make_room(2 * count, len(weights))
    spaces.normals[:count], spaces.normals[count:] = normals, -normals
    spaces.offsets[:count], spaces.offsets[count:] = box.lower / sizes, -box.upper / sizes
    y[: len(along)] = weights[: len(along)] * along
    if not find_nearest_point(spaces, 2 * count, y):
        return None
    used = spaces.active[: int(np.argmax(spaces.active < 0))]
    return y / weights, [int(k) % count for k in used]


def _improve(box: Bounds, weights: Floats, along: Floats, point: Floats, active: list[int]) -> tuple[Floats, list[int]]:
    """The point [k] that serves the level best, from one inside the bounds: exactly, by bounds taken up and dropped.

    Only the first r directions count, with `weights` [r]; the others are free to make room for them.
    """
    needed = len(along)
    for _ in range(ROUNDS):
        U, s, Vt = np.linalg.svd(box.rows[active], full_matrices=True)
        rank = int((s > STEEP).sum())
        open_ = Vt[rank:].T
        pull = weights * (along - point[:needed])
        step = open_ @ (damped_inverse(weights[:, None] * open_[:needed], 0.0) @ pull)
        share, blocking = _find_blocking(box, point, step, active)
        point = point + share * step
        if blocking >= 0:
            active = [*active, blocking]
            continue
        slope = -weights * weights * (along - point[:needed])
        multipliers = U[:, :rank] @ ((Vt[:rank, :needed] @ slope) / s[:rank])
        is_low = _is_low(box, point, active)
        wrong = np.where(is_low, -multipliers, multipliers)
        wrong[box.upper[active] - box.lower[active] < SETTLED] = 0.0  # one value: it may hold either way
        if not active or wrong.max() <= SETTLED:
            return point, [k for k, m in zip(active, multipliers, strict=True) if abs(m) > SETTLED]
        active = [k for place, k in enumerate(active) if place != int(np.argmax(wrong))]
    return point, active


def _is_low(box: Bounds, point: Floats, active: list[int]) -> NDArray[np.bool_]:
    """Which of the active bounds are lower ones."""
    values = box.rows[active] @ point
    return np.abs(values - box.lower[active]) <= np.abs(values - box.upper[active])


def _find_blocking(box: Bounds, point: Floats, step: Floats, active: list[int]) -> tuple[float, int]:
    """The share of a step that stays inside the bounds, and the bound that ends it; 1 and -1 if none does."""
    values, rates = box.rows @ point, box.rows @ step
    room = np.where(rates > 0.0, box.upper - values, box.lower - values)
    shares = np.full(len(values), np.inf)
    np.divide(room, rates, out=shares, where=np.abs(rates) > SETTLED)
    shares[active] = np.inf
    first = int(np.argmin(shares))
    return (max(float(shares[first]), 0.0), first) if shares[first] < 1.0 else (1.0, -1)


def _make_room(count: int, size: int) -> HalfSpaces:
    more, active = np.empty(size + 1), np.full(size + 1, -1)
    return HalfSpaces(
        np.empty((count, size)),
        np.empty(count),
        active,
        more,
        np.empty((size + 1, size + 1)),
        more.copy(),
        more.copy(),
        np.empty(size),
    )
