"""Pick and carry: MotionBenchMaker's grasps on tables, the object lifted along a track, and put back.

    python -m benchmarks.pick_and_carry FOLDER ... [--grasps 34] [--lift 0.3] [--protrusion MM] [--out FILE]

Folders as for `benchmarks/scenes.py`. Of each robot so many problems `table_pick`, spread over all: at the request's
goal the gripper holds Can1. It is attached there, may touch the table that it stands on, is lifted straight up by so
many m with the whole pose kept, and is set down again where it stood, by two tracks of three seconds each; then it is
let go. The lift begins in the goal's configuration, or, where that is refused, in one that ikde chooses. A track is
followed and certified, or refused with its reason.

Each motion is judged by this script from the text of URDF and scene, by `scenes.Twin`, which shares nothing with ikde
but the object's spheres, and that these hold the can is checked with points of it. It looks at four moments of each
step: the tool on its line, no sphere of robot or can nearer to an obstacle than the certificate says, the can's none
nearer to a link, and no link nearer to another one of ikde's list. Where a track is refused, the judge looks whether
what is named is near.
"""

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import ikde
from benchmarks.machine import describe
from benchmarks.scenes import Twin, measure, read_goal, read_pose, read_robot, read_yaml
from ikde.io.scene_pairs import find_pairs, read_request

OBJECT, TABLE = "Can1", "table_top"
SAMPLES, DT_S, BETWEEN = 40, 0.075, 4
ON_LINE_M, ON_LINE_RAD, CONTACT_M = 1e-4, 1e-3, 1e-9
BEHIND_M, NEAR_LIMIT_RAD = 0.03, 0.2  # a refusal names something that was as near as this one sample before


class Judge:
    """Distances of a robot that holds a can, by this script."""

    def __init__(self, twin: Twin, names: tuple[str, ...], scene: dict[str, Any], held: Any, pairs: Any) -> None:
        self.twin, self.names, self.held, self.pairs = twin, names, held, pairs
        placed = twin.place_links({})
        self.solids = []
        for entry in scene["world"]["collision_objects"]:
            T = placed.get(entry.get("header", {}).get("frame_id", ""), np.eye(4)) @ read_pose(entry.get("pose"))
            for shape, pose in zip(entry["primitives"], entry["primitive_poses"], strict=True):
                self.solids.append((entry["id"], shape, T @ read_pose(pose)))
        elsewhere = twin.place_links(dict.fromkeys(names, 0.3))
        self.moved = {link for link in twin.spheres if not np.allclose(placed[link], elsewhere[link])}

    def place_object(self, links: dict[str, np.ndarray]) -> np.ndarray:
        """The pose [4, 4] of the can's object, in which the can has a pose of its own."""
        return links[self.twin.tool] @ np.vstack([self.held.T_frame_object, [0.0, 0.0, 0.0, 1.0]])

    def list_gaps(self, q: np.ndarray) -> dict[tuple[str, str], float]:
        """By pair of link, can and obstacle the distance, m."""
        links = self.twin.place_links(dict(zip(self.names, q.tolist(), strict=True)))
        balls = {name: self._place(links[name], own) for name, own in self.twin.spheres.items() if own}
        own = [(sphere[:3], sphere[3]) for sphere in self.held.spheres]
        balls[OBJECT] = self._place(self.place_object(links), own)
        names, found = [name for name in balls if name in (*self.moved, OBJECT)], {}
        centres, radii = (np.concatenate([balls[name][k] for name in names]) for k in (0, 1))
        firsts = np.cumsum([0, *(len(balls[name][1]) for name in names)])[:-1]
        for other, shape, T in self.solids:
            if other != OBJECT:
                gaps = np.minimum.reduceat(measure(shape, (centres - T[:3, 3]) @ T[:3, :3]) - radii, firsts)
                for name, gap in zip(names, gaps.tolist(), strict=True):
                    if (name, other) != (OBJECT, TABLE):
                        found[name, other] = min(found.get((name, other), np.inf), gap)
        for a, b in self.pairs:
            (P, r), (Q, s) = balls[a], balls[b]
            found[a, b] = float((np.linalg.norm(P[:, None] - Q, axis=2) - r[:, None] - s).min())
        return found

    @staticmethod
    def _place(T: np.ndarray, own: list[tuple[np.ndarray, float]]) -> tuple[np.ndarray, np.ndarray]:
        centres = np.array([centre for centre, _ in own]) @ T[:3, :3].T + T[:3, 3]
        return centres, np.array([radius for _, radius in own])

    def holds(self, entry: dict[str, Any]) -> float:
        """How far the point of the can that is farthest out is inside the spheres, m; positive: all are."""
        (shape,), (pose,) = entry["primitives"], entry["primitive_poses"]
        T, (height, radius) = read_pose(pose), shape["dimensions"]
        z, angle, rho = (part.ravel() for part in np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in (13, 24, 6))))
        x, y = radius * rho * np.cos(2 * np.pi * angle), radius * rho * np.sin(2 * np.pi * angle)
        points = np.column_stack([x, y, height * (z - 0.5)]) @ T[:3, :3].T + T[:3, 3]
        away = np.linalg.norm(points[:, None] - self.held.spheres[:, :3], axis=2) - self.held.spheres[:, 3]
        return float(-away.min(axis=1).max())

    def measure_line(self, q: np.ndarray, path: ikde.ToolPath) -> tuple[float, float]:
        """How far the tool is from the line of a path, m, and turned against its start, rad."""
        T = self.twin.place_links(dict(zip(self.names, q.tolist(), strict=True)))[self.twin.tool]
        start, end = path.p_world_tool[[0, -1]]
        share = np.clip((T[:3, 3] - start) @ (end - start) / ((end - start) @ (end - start)), 0.0, 1.0)
        turned = np.linalg.norm(T[:3, :3] - path.R_world_tool[0]) / np.sqrt(2.0)
        return float(np.linalg.norm(T[:3, 3] - start - share * (end - start))), float(turned)


def follow(
    robot: ikde.Robot, q: np.ndarray, rise_m: float, model: ikde.CollisionModel, *, starts_there: bool = True
) -> ikde.Trajectory:
    """Straight up or down from where the tool is at `q`, in that configuration or in any that has the tool there."""
    T = ikde.forward(robot, q)[robot.tool]
    smooth = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, SAMPLES + 1))
    points = T[:3, 3] + rise_m * smooth[:, None] * np.array([0.0, 0.0, 1.0])
    R = np.repeat(T[None, :3, :3], len(points), axis=0)
    path = ikde.ToolPath(p_world_tool=points, R_world_tool=R, orientation="pose", dt_s=DT_S)
    return ikde.follow_path(robot, path, start=q if starts_there else None, collision=model)


def judge_motion(judge: Judge, motion: ikde.Trajectory) -> tuple[float, float, list[str]]:
    """The smallest distance of a whole motion and how far the tool left its line, m; and what is wrong."""
    shares = np.linspace(0.0, 1.0, BETWEEN, endpoint=False)
    rows = [a + share * (b - a) for a, b in zip(motion.q[:-1], motion.q[1:], strict=True) for share in shares]
    gaps = [min(judge.list_gaps(q).values()) for q in (*rows, motion.q[-1])]
    off, turned = np.max([judge.measure_line(q, motion.path) for q in motion.q], axis=0).tolist()
    between = max(judge.measure_line(q, motion.path)[0] for q in rows)
    is_on = off <= ON_LINE_M and turned <= ON_LINE_RAD
    wrong = [] if is_on else [f"the tool is {1e3 * off:.4f} mm from its line, turned by {turned:.6f} rad"]
    assert motion.certificate is not None
    if min(gaps) < motion.certificate.clearance_m - CONTACT_M:
        wrong.append(
            f"{1e3 * min(gaps):.4f} mm is less than the certificate's {1e3 * motion.certificate.clearance_m:.4f}"
        )
    if min(gaps) <= 0.0:
        wrong.append("something touches")
    return min(gaps), between, wrong


def try_lift(
    robot: ikde.Robot, q: np.ndarray, rise_m: float, model: ikde.CollisionModel, row: dict[str, Any]
) -> ikde.Trajectory:
    """From the goal's configuration; where that does not lead up, from the one that ikde finds best."""
    try:
        motion = follow(robot, q, rise_m, model)
        row["from_goal"] = "followed" if motion.reached else str(getattr(motion.stop, "text", ""))
        if motion.reached:
            return motion
    except ikde.InputError as error:
        row["from_goal"] = str(error)
    return follow(robot, q, rise_m, model, starts_there=False)


def run_grasp(robot: ikde.Robot, twin: Twin, pair: Any, options: argparse.Namespace) -> dict[str, Any]:
    """What becomes of one."""
    q, scene, world = read_goal(read_request(pair.request), robot), read_yaml(pair.scene), ikde.load_world(pair.scene)
    fat = None if options.protrusion is None else 1e-3 * options.protrusion
    touch = [TABLE] if TABLE in world else []
    row: dict[str, Any] = {"name": pair.name, "wrong": []}
    started = time.perf_counter()
    try:
        world = world.attach(OBJECT, robot.tool, robot=robot, q=q, may_touch=touch, protrusion_m=fat)
        row["attach_ms"] = 1e3 * (time.perf_counter() - started)
        model = ikde.CollisionModel.of(robot).in_world(world)
        motion = try_lift(robot, q, options.lift, model, row)
    except ikde.InputError as error:
        return {
            **row,
            "end": "refused at the start",
            "reason": str(error),
            **check_refusal(robot, twin, q, scene, world),
        }
    held = world.attached[0]
    judge = Judge(twin, robot.joint_names, scene, held, model.pairs)
    row |= {"protrusion_mm": 1e3 * (held.protrusion_m or 0.0), "spheres": len(held.spheres)}
    entry = next(entry for entry in scene["world"]["collision_objects"] if entry["id"] == OBJECT)
    if judge.holds(entry) < -CONTACT_M:
        row["wrong"].append("the spheres do not hold the can")
    middle = read_pose(entry["primitive_poses"][0])[:, 3]
    place = read_pose(entry.get("pose")) @ middle
    for way in ("lift", "down"):
        row[f"{way}_s"] = motion.search_seconds
        if not motion.reached:
            return {**row, **tell_stop(judge, motion, way, (robot.lower, robot.upper))}
        least, between, wrong = judge_motion(judge, motion)
        row["wrong"] += [f"{way}: {line}" for line in wrong]
        assert motion.certificate is not None
        row[way] = {"least_mm": 1e3 * least, "off_line_mm": 1e3 * between, "certified": motion.certificate.is_free}
        row[way]["certified_mm"] = 1e3 * motion.certificate.clearance_m
        last = motion.q[-1]
        motion = follow(robot, last, -options.lift, model) if way == "lift" else motion
    down = world.detach(OBJECT, robot=robot, q=last)[OBJECT].T_world_obstacle
    row["put_back_mm"] = 1e3 * float(np.linalg.norm(down @ middle - place[:3]))
    if row["put_back_mm"] > 0.5:
        row["wrong"].append("the can is not where it stood")
    is_free = all(row[way]["certified"] for way in ("lift", "down"))
    other = "" if row["from_goal"] == "followed" else ", from another configuration"
    return {**row, "end": f"followed{other}" if is_free else "followed, not certified"}


def check_refusal(robot: ikde.Robot, twin: Twin, q: np.ndarray, scene: dict[str, Any], world: ikde.World) -> Any:
    """What this script sees at a start that was refused: something touches, or a joint is outside its limits."""
    if not world.attached:
        return {}
    pairs = ikde.CollisionModel.of(robot).in_world(world).pairs
    gaps = Judge(twin, robot.joint_names, scene, world.attached[0], pairs).list_gaps(q)
    least, outside = min(gaps.values()), bool(((q < robot.lower) | (q > robot.upper)).any())
    wrong = [] if least <= CONTACT_M or outside else [f"refused, but the nearest is {1e3 * least:.3f} mm away"]
    return {"least_mm": 1e3 * least, "outside": outside, "wrong": wrong}


def tell_stop(judge: Judge, motion: ikde.Trajectory, way: str, limits: tuple[Any, Any]) -> dict[str, Any]:
    """Why a track ended, and whether this script sees what is named as near."""
    stop, (lower, upper) = motion.stop, limits
    assert stop is not None
    told: dict[str, Any] = {"end": f"refused: {way}, {stop.reason}", "reason": stop.text}
    if stop.reason == "joint_limit" and len(motion.q):
        room = float(np.minimum(motion.q[-1] - lower, upper - motion.q[-1]).min())
        told["wrong"] = [f"a limit is named, {room:.3f} rad away at the last sample"] if room > NEAR_LIMIT_RAD else []
    if stop.pair is not None and len(motion.q):
        gaps = judge.list_gaps(motion.q[-1])
        told["named_mm"] = 1e3 * min((gap for pair, gap in gaps.items() if set(stop.pair) == set(pair)), default=np.inf)
        if told["named_mm"] > 1e3 * BEHIND_M:
            told["wrong"] = [f"{' - '.join(stop.pair)} is named, {told['named_mm']:.1f} mm apart at the last sample"]
    return told


def run_robot(folder: Path, options: argparse.Namespace) -> tuple[str, list[dict[str, Any]]]:
    """Rows of one robot."""
    name, robot, twin = read_robot(folder)
    (pairs,) = (found for family, found in find_pairs(folder).items() if family.startswith("table_pick"))
    chosen = [pairs[k] for k in np.linspace(0, len(pairs) - 1, min(options.grasps, len(pairs))).astype(int)]
    rows = []
    for pair in chosen:
        rows.append(run_grasp(robot, twin, pair, options))
        row = rows[-1]
        shown = row.get("reason") or f"{row['lift']}, put back {row['put_back_mm']:.4f} mm off"
        print(f"{row['name']}: {row['end']}: {shown}", *(f"WRONG {line}" for line in row["wrong"]), flush=True)
    ends = Counter(row["end"] for row in rows)
    good = [row for row in rows if row["end"].startswith("followed")]
    print(f"{name}: {len(rows)} grasps, {dict(ends)}, {sum(bool(row['wrong']) for row in rows)} wrong")
    if good:
        least = min(row[way]["least_mm"] for row in good for way in ("lift", "down"))
        seconds = [row[f"{way}_s"] for row in good for way in ("lift", "down")]
        print(f"  least distance {least:.3f} mm; a track takes {np.median(seconds):.3g} s, at most {max(seconds):.3g}")
        print(f"  attaching takes {np.median([row['attach_ms'] for row in good]):.3g} ms", flush=True)
    return name, rows


def main() -> None:
    """Reads the options, runs every robot, and ends with 1 where something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--grasps", type=int, default=34, help="of each robot")
    parser.add_argument("--lift", type=float, default=0.3, help="m")
    parser.add_argument("--protrusion", type=float, help="of the object's spheres, mm; default ikde's own choice")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    found = dict(run_robot(folder, options) for folder in options.folders)
    if options.out:
        options.out.write_text(json.dumps({"machine": describe(), "robots": found}, indent=1), encoding="utf-8")
    sys.exit(any(row["wrong"] for rows in found.values() for row in rows))


if __name__ == "__main__":
    main()
