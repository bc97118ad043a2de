"""What would help where a motion stops at an obstacle: each remedy is tried, from where it stopped, and certified."""

import math
from dataclasses import replace

from ikde.model.collision_model import CollisionModel
from ikde.solver.remedies import FINEST_M, find_largest_margin, let_touch, list_touches, lower_margins
from ikde.track.certify import bound_all
from ikde.track.follower import Rollout, make_follower
from ikde.track.trajectory import TrackStop

HALVINGS = 6  # of what is not known of a margin


def advise(rollout: Rollout, stop: TrackStop, end: int) -> TrackStop:
    """The same stop with what was found to help, if it is at an obstacle, or at what is held, and anything helped.

    `end`: the last sample that is asked for.
    """
    model = rollout.follower.collision
    if stop.pair is None:
        return stop
    is_own = stop.pair in model.pairs  # an obstacle may be called like a component
    hints = list[str | None]()
    if not is_own and stop.pair[1] in {obstacle.name for obstacle in model.obstacles}:
        hints += [_try_removing(rollout, stop.pair[1], end), _try_less_margin(rollout, end)]
    hints += [
        _try_touching(rollout, name, other, end)
        for name, other in list_touches(model, [stop.pair])
        if is_own or name == stop.pair[0]
    ]
    helpful = "; ".join(hint for hint in hints if hint)
    return replace(stop, hint=helpful) if helpful else stop


def _try_removing(rollout: Rollout, name: str, end: int) -> str | None:
    """How much farther it goes without one obstacle."""
    model = rollout.follower.collision
    others = model.own.in_world(model.world.remove(name), model.margin_m, dict(model.margins_m))
    last = _certify(rollout, _go_on(rollout, others, end))
    return _tell(f"without {name}", last, rollout, end)


def _try_touching(rollout: Rollout, name: str, other: str, end: int) -> str | None:
    """How much farther it goes if something that is held may touch something else."""
    last = _certify(rollout, _go_on(rollout, let_touch(rollout.follower.collision, name, other), end))
    return _tell(f"if {name} may touch {other}", last, rollout, end)


def _try_less_margin(rollout: Rollout, end: int) -> str | None:
    """By how much less margin it goes on: the least that was found to lead as far as none at all."""
    model = rollout.follower.collision
    most_m = find_largest_margin(model)
    best = _go_on(rollout, lower_margins(model, most_m), end) if most_m > 0.0 else rollout
    if best.last == rollout.last:
        return None
    low, high = 0, math.ceil(most_m / FINEST_M)
    for _ in range(HALVINGS):
        if high - low <= 1:
            break
        middle = (low + high) // 2
        other = _go_on(rollout, lower_margins(model, middle * FINEST_M), end)
        if other.last >= best.last:
            high, best = middle, other
        else:
            low = middle
    less_m = min(high * FINEST_M, most_m)
    return _tell(f"with {1e3 * less_m:.4g} mm less margin", _certify(rollout, best), rollout, end)


def _go_on(rollout: Rollout, model: CollisionModel, end: int) -> Rollout:
    """The same rollout among other obstacles, followed on from its last sample."""
    plan, track = rollout.follower.plan, rollout.follower.track
    moving = {name: motion for name, motion in plan.moving.items() if name in model.world}
    plan = replace(plan, collision=model, moving=moving)
    return replace(rollout.copy(), follower=make_follower(plan).with_track(margin=track.margin)).resume(end)


def _certify(rollout: Rollout, other: Rollout) -> int:
    """The last sample up to which what `other` adds to a rollout is certified, too."""
    follower, first = other.follower, rollout.last
    around = follower.around(first, len(other.q) - first)
    room = bound_all(follower.collision, other.q[first:], follower.plan.base_drive, around)
    room = room.min(axis=1, initial=math.inf)
    return first + next((k for k, least in enumerate(room) if not least > 0.0), len(room))


def _tell(what: str, last: int, rollout: Rollout, end: int) -> str | None:
    """None where nothing helped."""
    if last == rollout.last:
        return None
    return f"{what} it goes on to the end" if last == end else f"{what} it goes on to sample {last}"
