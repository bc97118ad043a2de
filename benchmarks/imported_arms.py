"""Random poses that imported arms can reach, free of self-collision: how many are solved, as Pinocchio and coal see it.

python benchmarks/imported_arms.py FOLDER [--package-path FOLDER] [--no-spheres] [--poses 1000]

Every URDF below FOLDER with 5 to 9 joints to a tool, with the first such tool. Targets are forward kinematics of
configurations drawn inside the limits and free. What is returned is graded anew: frames by Pinocchio from the URDF,
distances of the spheres by coal, limits by the URDF.
"""

import argparse
import json
import time
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

import ikde
from ikde.errors import IkdeError
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.model.collision_model import CollisionModel
from ikde.model.tree import build_tree
from ikde.solver.plain import compute_gaps

OUT = Path(__file__).parent / "results" / "imported_arms.json"
POSITION_M, ANGLE_RAD = 1e-5, 1e-4


def find_tool(path):
    """The first leaf with 5 to 9 joints above it, none of them a mimic joint; None without."""
    description = read_description(path)
    tree = find_tree(description)
    parents = {joint.parent for joint in description.joints.values()}
    for leaf in tree.order:
        joints = [joint for joint in tree.path(leaf) if joint.kind != "fixed"]
        if leaf not in parents and 5 <= len(joints) <= 9 and not any(joint.mimic for joint in joints):
            return leaf
    return None


def draw_free(robot, count, rng):
    """Configurations inside the limits, free if that is checked."""
    collision, found = CollisionModel.of(robot), []
    while sum(map(len, found)) < count:
        q = rng.uniform(*robot.drawn, (count, len(robot.joints)))
        found.append(q[compute_gaps(collision, q).min(axis=1) > 0.0] if collision.pairs else q)
    return np.concatenate(found)[:count]


class Grader:
    """Frames of Pinocchio, spheres of coal."""

    def __init__(self, path, imported):
        self.robot, self.held = imported.robot, {held.name: held.value for held in imported.held}
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        collision, tree = CollisionModel.of(self.robot), build_tree(self.robot)
        carriers = {body: name for name, body in reversed(tree.frame_body.items()) if self.model.existBodyName(name)}
        self.spheres = {}
        for sphere in collision.spheres:
            link = carriers[sphere.body]
            T_link_body = np.linalg.inv(tree.T_body_frame[link])
            p_link = (T_link_body @ [*sphere.p_body_sphere, 1.0])[:3]
            self.spheres.setdefault(sphere.component, []).append((link, p_link, coal.Sphere(sphere.radius_m)))
        self.pairs = collision.pairs

    def grade(self, q, T_target):
        """Whether a configuration reaches a pose, inside limits, free."""
        theirs = pin.neutral(self.model)
        for name, value in (self.held | dict(zip(self.robot.joint_names, q, strict=True))).items():
            joint = self.model.joints[self.model.getJointId(name)]
            theirs[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(self.model, self.data, theirs)
        at = {frame.name: self.data.oMf[k] for k, frame in enumerate(self.model.frames) if frame.type == pin.BODY}
        error = pin.SE3(T_target).actInv(at[self.robot.tool])
        is_near = np.linalg.norm(error.translation) <= POSITION_M
        is_near &= np.linalg.norm(pin.log3(error.rotation)) <= ANGLE_RAD
        lower, upper = self.model.lowerPositionLimit, self.model.upperPositionLimit
        inside = np.all((lower <= theirs + 1e-9) & (theirs - 1e-9 <= upper))
        return bool(is_near and inside and not self.collides(at))

    def collides(self, at):
        """Whether spheres of a compared pair touch."""
        placed = {
            name: [(coal.Transform3s(np.eye(3), at[link].act(p)), shape) for link, p, shape in own]
            for name, own in self.spheres.items()
        }
        request = coal.DistanceRequest()
        return any(
            coal.distance(one, T_one, other, T_other, request, coal.DistanceResult()) <= 0.0
            for a, b in self.pairs
            for T_one, one in placed[a]
            for T_other, other in placed[b]
        )


def try_arm(path, tool, options, count):
    """One row of the table."""
    started = time.perf_counter()
    imported = read_urdf(path, ImportOptions(tool=tool, **options))
    robot, import_s = imported.robot, time.perf_counter() - started
    spheres = sum(link.spheres for link in imported.links)
    q = draw_free(robot, count, np.random.default_rng(0))
    T = ikde.forward(robot, q)["tool"]
    started = time.perf_counter()
    results = ikde.solve_many(robot, ikde.Targets(T[:, :3, 3], R_world_tool=T[:, :3, :3]))
    solve_s = time.perf_counter() - started
    grader = Grader(path, imported)
    good = sum(grader.grade(result.q, target) for result, target in zip(results, T, strict=True) if result.reached)
    return {
        "file": path.name,
        "tool": tool,
        "joints": len(robot.joints),
        "spheres": spheres,
        "pairs": len(CollisionModel.of(robot).pairs),
        "import_s": round(import_s, 2),
        "solve_s": round(solve_s, 2),
        "poses": count,
        "solved": int(np.sum(results.reached)),
        "confirmed": good,
    }


def main():
    """A line an arm, and the results as a file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--package-path", type=Path, action="append", default=[])
    parser.add_argument("--no-spheres", action="store_true")
    parser.add_argument("--poses", type=int, default=1000)
    asked = parser.parse_args()
    options = {"package_paths": tuple(asked.package_path), "spheres": not asked.no_spheres}
    rows = []
    for path in sorted(asked.folder.rglob("*.urdf")):
        try:
            tool = find_tool(path)
            if tool is None:
                continue
            rows.append(try_arm(path, tool, options, asked.poses))
        except IkdeError as error:
            rows.append({"file": path.name, "refused": getattr(error, "message", str(error))})
        print(" ".join(f"{key}={value}" for key, value in rows[-1].items()), flush=True)
    OUT.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
