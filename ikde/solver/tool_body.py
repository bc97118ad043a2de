"""What a target proves by itself in a world: what is fixed to the tool is where the target puts it, for any arm.

Where each sphere of the tool's body is stays open by the tolerances, and by what the target says nothing of: about a
position the tool may turn anyhow, about an axis it may spin. Distances change by no more than a point moves, so a
sphere that is too near in the middle of where it may be, by more than it may be away from there, is too near in every
configuration that meets the target. Plain numpy throughout, and no kernel.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import FreeSpheres, Robot
from ikde.model.target import AXIS, POSE, Target, Targets
from ikde.solver.digits import at_least
from ikde.solver.plain import compute_components, compute_frames, list_world
from ikde.solver.problem import Problem
from ikde.solver.result import NO_SOLUTION, STOP_REASONS, StopReason

ROUNDING = 1e-8  # m: what sums lose
NAMED = 3  # in a message about many
CHUNK = 256  # targets at once

_WORLD = STOP_REASONS.index(StopReason.WORLD)


class ToolBody(NamedTuple):
    """Spheres of components that move as the tool does, in the order of their components."""

    components: Ints
    """[C] which components."""
    firsts: Ints
    """[C] where each begins."""
    centres: Floats
    """[n, 3] in the tool's frame, m."""
    radii: Floats
    """[n] m."""


@lru_cache(maxsize=64)
def find_tool_body(own: CollisionModel) -> ToolBody | None:
    """That of a robot; None if none of its components is carried so."""
    robot, q = own.robot, own.robot.home
    frames = {} if own.detector is None else _list_carriers(robot)
    carried: dict[str, bool] = {}
    for row in own.rows:
        ends = (row.frame,) if isinstance(row, FreeSpheres) else (row.start, row.end)
        is_held = all(frames[end] == frames[robot.tool] for end in ends)
        carried[row.component] = carried.get(row.component, True) and is_held
    names = [name for name in own.components if carried[name]]
    if not names:
        return None
    Ts_world = compute_frames(robot, q)
    placed, T = compute_components(own, q, Ts_world), Ts_world[robot.tool]
    return ToolBody(
        components=np.array([own.components.index(name) for name in names]),
        firsts=np.cumsum([0, *(len(placed[name][1]) for name in names)])[:-1],
        centres=np.concatenate([(placed[name][0] - T[:3, 3]) @ T[:3, :3] for name in names]),
        radii=np.concatenate([placed[name][1] for name in names]),
    )


def _list_carriers(robot: Robot) -> dict[str, str]:
    """The frame that a joint moves and that carries each frame, or where the tree begins."""
    carriers: dict[str, str] = {}
    for frame in robot.frames:
        carriers[frame.name] = frame.name if frame.joint is not None else carriers.get(frame.parent, frame.parent)
    return {**{frame.parent: carriers.get(frame.parent, frame.parent) for frame in robot.frames}, **carriers}


def rule_out_by_tool(problem: Problem, targets: Targets) -> Ints:
    """Index of `world` in `STOP_REASONS` for targets [T] at which the tool's body is too near an obstacle, else -1."""
    ruled_out = np.full(len(targets), -1)
    if problem.collision.obstacles and find_tool_body(problem.collision.laden) is not None:
        for first in range(0, len(targets), CHUNK):
            some = slice(first, first + CHUNK)
            ruled_out[some][(measure_shortage(problem, targets[some]) > 0.0).any(axis=(1, 2))] = _WORLD
    return ruled_out


def measure_shortage(problem: Problem, targets: Targets) -> Floats:
    """By how much, at least, each component of the tool's body is too near each obstacle [T, C, O] in m.

    At or below 0 it is not proved to be too near.
    """
    collision, settings = problem.collision, problem.settings
    body, (groups, less_m) = find_tool_body(collision.laden), list_world(collision)
    assert body is not None
    middle, room = _place(body.centres, targets)
    room = room + settings.position_tolerance_m + ROUNDING
    room += settings.orientation_tolerance_rad * np.linalg.norm(body.centres, axis=1)
    nearest = np.full((len(collision.obstacles), len(targets), len(body.firsts)), np.inf)
    for group in groups:
        for owners, distances in group.measure(middle.reshape(-1, 3)):
            gaps = distances.reshape(len(owners), *room.shape) + room - body.radii
            for owner, gap in zip(owners.tolist(), np.minimum.reduceat(gaps, body.firsts, axis=-1), strict=True):
                nearest[owner] = np.minimum(nearest[owner], gap)
    return collision.limit_m + less_m[body.components] - nearest.transpose(1, 2, 0)


def _place(centres: Floats, targets: Targets) -> tuple[Floats, Floats]:
    """The middle of where each point of the tool may be [T, n, 3], and how far it may be from there [T, n], m."""
    R, kind = targets.R_world_tool, targets.kind[:, None]
    known = np.where(
        kind[..., None] == POSE, centres, np.where(kind[..., None] == AXIS, centres * (0.0, 0.0, 1.0), 0.0)
    )
    middle = np.einsum("tij,tnj->tni", R, known) + targets.p_world_tool[:, None]
    return middle, np.linalg.norm(centres - known, axis=-1)


def tell_tool_body(problem: Problem, target: Target) -> tuple[str, dict[tuple[str, str], int]]:
    """One line why a target that is ruled out so has no solution; and the obstacles in the way."""
    collision = problem.collision
    body, short_m = find_tool_body(collision.laden), measure_shortage(problem, Targets.of([target]))[0]
    assert body is not None
    worst = [divmod(place, short_m.shape[1]) for place in np.argsort(-short_m, axis=None, kind="stable").tolist()]
    found: dict[str, str] = {}
    for part, other in worst:
        name = collision.obstacles[other].name
        if short_m[part, other] > 0.0 and name not in found:
            component = collision.components[body.components[part]]
            found[name] = f"{component} - {name} by at least {at_least(1e3 * short_m[part, other])} mm"
    named = ", ".join([*found.values()][:NAMED])
    more = f" and {len(found) - NAMED} more" if len(found) > NAMED else ""
    fixed = f"this {'pose' if target.kind == 'pose' else 'target'} puts what is fixed to the tool too near"
    reason = f"{NO_SOLUTION}: whatever the joints do, {fixed}: {named}{more}"
    return reason, {(problem.robot.name, name): 1 for name in found}
