"""What a changed world costs: of 20 objects around a robot one moves, is added or removed before the next answer.

    IKDE_COMPILE=wait python -m benchmarks.moved [--robot ur5] [--rounds 300]

Microseconds, median and p99. *again* is the same question in the same world; *moved*, *added*, *removed* and *margin*
are from the change of the world to the answer in it; *new* is in a world of objects not seen before, *check* one
configuration, *no* a pose that stands in an object.
"""

import argparse
import os
import time
from collections.abc import Callable

import numpy as np

os.environ.setdefault("IKDE_COMPILE", "wait")

import ikde
from benchmarks.machine import describe
from ikde.model.solids import make_solid
from ikde.model.world import Obstacle, World, make_obstacle, make_world

OBJECTS = 20
Times = dict[str, list[float]]


def make_objects(rng: np.random.Generator, clear_of: np.ndarray) -> list[Obstacle]:
    """Boxes and cylinders about a robot, none of them within 0.25 m of points [K, 3]."""
    found: list[Obstacle] = []
    while len(found) < OBJECTS:
        T = np.eye(4)
        T[:3, 3] = rng.uniform((-1.2, -1.2, 0.1), (1.2, 1.2, 1.4))
        is_box = rng.random() < 0.5
        solid = make_solid("box", rng.uniform(0.05, 0.3, 3)) if is_box else make_solid("cylinder", (0.05, 0.2))
        if np.linalg.norm(clear_of - T[:3, 3], axis=1).min() > 0.25 + 0.5 * np.linalg.norm(solid.size_m):
            found.append(make_obstacle(f"object_{len(found)}", [solid], T))
    return found


def time_calls(robot: ikde.Robot, rounds: int, rng: np.random.Generator) -> Times:
    """Every kind of call, interleaved."""
    own, q = ikde.CollisionModel.of(robot), robot.home
    frames = ikde.forward(robot, q)
    target = ikde.Target(frames[robot.tool][:3, 3], R_world_tool=frames[robot.tool][:3, :3])
    points = np.array([T[:3, 3] for T in frames.values()])
    world, spent = make_world(make_objects(rng, points)), {}
    spare = make_obstacle("spare", [make_solid("sphere", (0.05,))], [[1, 0, 0, 5], [0, 1, 0, 5], [0, 0, 1, 5]])
    fist = make_obstacle("fist", [make_solid("sphere", (0.1,))], frames[robot.tool])

    def take(key: str, make: Callable[[], ikde.CollisionModel], *, is_reached: bool = True) -> ikde.CollisionModel:
        started = time.perf_counter()
        model = make()
        result = ikde.solve(robot, target, collision=model)
        spent.setdefault(key, []).append(1e6 * (time.perf_counter() - started))
        assert result.reached == is_reached
        return model

    def change(k: int, world: World) -> World:
        name, T = f"object_{k % OBJECTS}", world[f"object_{k % OBJECTS}"].T_world_obstacle.copy()
        T[:, 3] += rng.uniform(-1e-3, 1e-3, 3)
        larger = world.add(spare)
        model = own.in_world(world)
        for _ in range(3):
            take("again", lambda: model)
        take("moved", lambda: own.in_world(world.move(name, T)))
        take("added", lambda: own.in_world(world.add(spare)))
        take("removed", lambda: own.in_world(larger.remove(name)))
        take("margin", lambda: own.in_world(world, 1e-4 + 1e-9 * k))
        if k % 10 == 0:
            fresh = make_world(make_objects(rng, points))
            take("new", lambda: own.in_world(fresh))
            take("no", lambda: own.in_world(world.add(fist)), is_reached=False)
        started = time.perf_counter()
        ikde.check(robot, q, model)
        spent.setdefault("check", []).append(1e6 * (time.perf_counter() - started))
        return world.move(name, T)

    for k in range(rounds):
        world = change(k, world)
    return spent


def main() -> None:
    """Reads the options and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="ur5")
    parser.add_argument("--rounds", type=int, default=300)
    options = parser.parse_args()
    robot, rng = ikde.load_robot(options.robot), np.random.default_rng(0)
    time_calls(robot, 3, rng)
    print(describe())
    for key, values in time_calls(robot, options.rounds, rng).items():
        median, p99 = np.quantile(values, (0.5, 0.99))
        print(f"{key:8} {median:9.1f} {p99:9.1f}")


if __name__ == "__main__":
    main()
