"""Verdicts of `ikde.check_many` among obstacles beside coal's, on scenes of MotionBenchMaker.

    python -m benchmarks.world_verdicts FOLDER ... [--configurations 100] [--first N]

Needs coal (`pip install coal`). Folders as for `benchmarks/scenes.py`. So many random configurations a scene, every
other one anywhere inside the limits, the rest about the request's goal. Spheres are placed by this script from the text
of the URDF (`scenes.Twin`), solids from the scene; coal gives the signed distance of each sphere from each solid,
and the smallest says whether a configuration is free of the world. What is within 1e-9 m of contact is counted, not
compared. coal measures wrong depths where a sphere's centre is inside a cylinder, so distances are compared outside
alone; the sign is right everywhere. Self-collision is not compared.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

import coal
import numpy as np

import ikde
from benchmarks.scenes import Twin, read_goal, read_pose, read_robot, read_yaml
from ikde.io.scene_pairs import find_pairs, read_request

CONTACT_M, SPREAD = 1e-9, 0.05  # m; m or rad


def place_spheres(twin: Twin, names: tuple[str, ...], q: np.ndarray, moved: set[str]) -> list[tuple[np.ndarray, float]]:
    """Centres [3] and radii of all spheres that joints move, in the root link, m."""
    placed = twin.place_links(dict(zip(names, q.tolist(), strict=True)))
    return [
        ((placed[link] @ [*c, 1.0])[:3], r) for link in twin.spheres if link in moved for c, r in twin.spheres[link]
    ]


def find_moved(twin: Twin, names: tuple[str, ...]) -> set[str]:
    """Links that joints move."""
    here, there = (twin.place_links(dict.fromkeys(names, value)) for value in (0.0, 0.3))
    return {link for link in twin.spheres if not np.allclose(here[link], there[link])}


def list_solids(scene: dict[str, Any], placed: dict[str, np.ndarray]) -> list[tuple[Any, Any]]:
    """Geometry and transform of each solid, as coal has them."""
    found = []
    for entry in scene["world"]["collision_objects"]:
        T = placed.get(entry.get("header", {}).get("frame_id", ""), np.eye(4)) @ read_pose(entry.get("pose"))
        for shape, pose in zip(entry["primitives"], entry["primitive_poses"], strict=True):
            T_solid, sizes = T @ read_pose(pose), shape["dimensions"]
            solid = coal.Box(*sizes) if shape["type"] == "box" else coal.Cylinder(sizes[1], sizes[0])
            found.append((solid, coal.Transform3s(T_solid[:3, :3], T_solid[:3, 3])))
    return found


def measure(solids: list[tuple[Any, Any]], spheres: list[tuple[np.ndarray, float]]) -> float:
    """The smallest signed distance of all spheres from all solids, by coal, m."""
    request, least = coal.DistanceRequest(), np.inf
    for centre, radius in spheres:
        ball, T_ball = coal.Sphere(radius), coal.Transform3s(np.eye(3), centre)
        for solid, T in solids:
            least = min(least, coal.distance(ball, T_ball, solid, T, request, coal.DistanceResult()))
    return float(least)


def run_robot(folder: Path, count: int, first: int | None) -> int:
    """Prints a line a robot; returns how many verdicts differ."""
    name, robot, twin = read_robot(folder)
    own, rng, moved = ikde.CollisionModel.of(robot), np.random.default_rng(1), find_moved(twin, robot.joint_names)
    compared = hits = near = wrong = scenes = 0
    worst = 0.0
    for pair in [pair for pairs in find_pairs(folder).values() for pair in pairs[:first]]:
        scene, model = read_yaml(pair.scene), own.in_world(ikde.load_world(pair.scene))
        Q = rng.uniform(*robot.drawn, (count, len(robot.joints)))
        Q[1::2] = read_goal(read_request(pair.request), robot) + rng.normal(0.0, SPREAD, Q[1::2].shape)
        gaps = ikde.check_many(robot, Q, model).gaps_m[:, len(model.pairs) :].min(axis=1)
        solids = list_solids(scene, twin.place_links({}))
        for q, ours in zip(Q, gaps.tolist(), strict=True):
            theirs = measure(solids, place_spheres(twin, robot.joint_names, q, moved))
            if abs(theirs) <= CONTACT_M:
                near += 1
                continue
            compared, hits = compared + 1, hits + (theirs <= 0.0)
            wrong += (ours <= 0.0) != (theirs <= 0.0)
            if theirs > 0.0:
                worst = max(worst, abs(ours - theirs))
        scenes += 1
    print(
        f"{name}: {compared:,} configurations in {scenes} scenes, {hits:,} in collision with the world: {wrong} differ;"
    )
    print(f"  {near} within {CONTACT_M:g} m of contact; distances of free ones differ by {worst:.1e} m", flush=True)
    return wrong


def main() -> None:
    """Reads the options, runs every robot, and ends with 1 where a verdict differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--configurations", type=int, default=100)
    parser.add_argument("--first", type=int, help="scenes of each family; default all")
    options = parser.parse_args()
    sys.exit(sum(run_robot(folder, options.configurations, options.first) for folder in options.folders) > 0)


if __name__ == "__main__":
    main()
