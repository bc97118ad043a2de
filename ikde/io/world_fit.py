"""Whether a world fits a robot: all that does not, each at its place in the world's file."""

from collections.abc import Iterator

from ikde.errors import InputError, nearest
from ikde.io.world_file import ReadWorld
from ikde.model.collision_model import CollisionModel
from ikde.model.pack_world import find_fixed_frames
from ikde.model.world import Obstacle
from ikde.solver.standing import StandingObstacle, find_standing_obstacles, refuse_attached


def check_fit(found: ReadWorld, collision: CollisionModel) -> tuple[StandingObstacle, ...]:
    """What is as far from an obstacle in every configuration, without touching it.

    Raises:
        InputError: for the first thing that does not fit, the others as its notes: frames and components that the robot
            does not have, and what touches an obstacle whatever its joints do.
    """
    standing, faults = _check(found, collision)
    if faults:
        first, *others = faults
        for other in others:
            first.add_note(str(other))
        raise first
    return standing


def _check(found: ReadWorld, collision: CollisionModel) -> tuple[tuple[StandingObstacle, ...], list[InputError]]:
    world, faults, unfit = found.world, list[InputError](), set[str]()
    for obstacle in world.obstacles:
        own = list(_find_unknown(found, obstacle, collision))
        faults += own
        unfit |= {obstacle.name} if own else set()
    with found.errors():
        model = collision.in_world(world.remove(*unfit))
        refuse_attached(model)
    standing = find_standing_obstacles(model)
    touching = [pair for pair in standing if pair.touches]
    for name in dict.fromkeys(pair.obstacle for pair in touching):
        some = [pair for pair in touching if pair.obstacle == name]
        depths = ", ".join(f"{pair.component} {1e3 * pair.clearance_m:.4g} mm" for pair in some)
        ignored = ", ".join(pair.component for pair in some)
        message = f"touched in every configuration: {depths}; if that is meant, write `ignore: [{ignored}]` there"
        faults.append(found.error(message, name))
    return tuple(pair for pair in standing if not pair.touches), faults


def _find_unknown(found: ReadWorld, obstacle: Obstacle, collision: CollisionModel) -> Iterator[InputError]:
    frames = find_fixed_frames(collision.robot)
    if obstacle.frame not in frames:
        is_there = obstacle.frame in {frame.name for frame in collision.robot.frames}
        why = ": a joint moves it" if is_there else nearest(obstacle.frame, frames)
        yield found.error(f"no frame that stays in its place is called {obstacle.frame!r}{why}", obstacle.name, "frame")
    for place, name in enumerate(obstacle.ignore):
        if name not in collision.components:
            message = f"no component is called {name!r}{nearest(name, collision.components)}"
            yield found.error(message, obstacle.name, "ignore", place)
