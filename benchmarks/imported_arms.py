"""Random poses that imported arms can reach, free of self-collision: how many are solved, as Pinocchio and coal see it.

python benchmarks/imported_arms.py FOLDER [--package-path FOLDER] [--no-spheres] [--poses 1000] [--keep FOLDER]

Every URDF below FOLDER with 5 to 9 joints to a tool, with the first such tool. Targets are forward kinematics of
configurations drawn inside the limits and free. What is returned is graded anew by Pinocchio, from the URDF: frames,
limits, and the distances of all spheres of all compared pairs, which coal measures. Where fewer than 1 in 200 random
configurations is free, spheres that stand out less are tried, and the row says so. --keep saves imports, of which a
second run with more poses takes none again; results are written after each arm.
"""

import argparse
import json
import pickle
import time
from functools import lru_cache
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
from ikde.spheres import cover

OUT = Path(__file__).parent / "results"
POSITION_M, ANGLE_RAD = 1e-5, 1e-4
PROTRUSIONS_M = (0.02, 0.01, 0.005)
FREE_SHARE, DRAWN = 1 / 200, 500
MAX_SPHERE_PAIRS = 1e9  # of an arm's answers together, which Pinocchio measures one by one: 2 minutes


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
    """Configurations inside the limits, free if that is checked; the share that is free; None if too few are."""
    collision, found, drawn = CollisionModel.of(robot), [], 0
    while sum(map(len, found)) < count:
        q = rng.uniform(*robot.drawn, (DRAWN, len(robot.joints)))
        found.append(q[compute_gaps(collision, q).min(axis=1) > collision.limit_m] if collision.pairs else q)
        drawn += DRAWN
        if sum(map(len, found)) < FREE_SHARE * drawn:
            return None, sum(map(len, found)) / drawn
    return np.concatenate(found)[:count], sum(map(len, found)) / drawn


class Grader:
    """Frames of Pinocchio, spheres of coal."""

    def __init__(self, path, imported):
        self.robot, self.held = imported.robot, {held.name: held.value for held in imported.held}
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        self.geometry = pin.GeometryModel()
        collision, tree = CollisionModel.of(self.robot), build_tree(self.robot)
        carriers = {body: name for name, body in reversed(tree.frame_body.items()) if self.model.existBodyName(name)}
        numbers = {}
        for k, sphere in enumerate(collision.spheres):
            link = carriers[sphere.body]
            T_link_body = np.linalg.inv(tree.T_body_frame[link])
            frame = self.model.frames[self.model.getBodyId(link)]
            place = frame.placement * pin.SE3(np.eye(3), (T_link_body @ [*sphere.p_body_sphere, 1.0])[:3])
            shape = pin.GeometryObject(f"sphere_{k}", frame.parentJoint, place, coal.Sphere(sphere.radius_m))
            numbers.setdefault(sphere.component, []).append(self.geometry.addGeometryObject(shape))
        for a, b in collision.pairs:
            for one in numbers[a]:
                for other in numbers[b]:
                    self.geometry.addCollisionPair(pin.CollisionPair(one, other))
        self.sphere_pairs = len(self.geometry.collisionPairs)
        self.distances = self.geometry.createData()

    def grade(self, q, T_target):
        """Whether a configuration reaches a pose inside limits, and its clearance in m; None without pairs."""
        theirs = pin.neutral(self.model)
        for name, value in (self.held | dict(zip(self.robot.joint_names, q, strict=True))).items():
            joint = self.model.joints[self.model.getJointId(name)]
            theirs[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(self.model, self.data, theirs)
        tool = self.data.oMf[self.model.getBodyId(self.robot.tool)]
        error = pin.SE3(T_target).actInv(tool)
        is_near = np.linalg.norm(error.translation) <= POSITION_M
        is_near &= np.linalg.norm(pin.log3(error.rotation)) <= ANGLE_RAD
        lower, upper = self.model.lowerPositionLimit, self.model.upperPositionLimit
        inside = np.all((lower <= theirs + 1e-9) & (theirs - 1e-9 <= upper))
        if not self.sphere_pairs:
            return bool(is_near and inside), None
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.distances)
        nearest = pin.computeDistances(self.geometry, self.distances)
        return bool(is_near and inside), self.distances.distanceResults[nearest].min_distance


def import_arm(path, tool, options, keep):
    """The import, made or kept, with its seconds and protrusion: the first of which enough is free."""
    for protrusion_m in PROTRUSIONS_M if options["spheres"] else PROTRUSIONS_M[:1]:
        kept = keep and keep / f"{path.parent.name}_{path.stem}_{protrusion_m * 1e3:g}.pickle"
        if kept and kept.exists():
            imported, import_s = pickle.loads(kept.read_bytes())
        else:
            started = time.process_time()
            imported = read_urdf(path, ImportOptions(tool=tool, protrusion_m=protrusion_m, **options))
            import_s = time.process_time() - started
            if kept:
                kept.write_bytes(pickle.dumps((imported, import_s)))
        q, share = draw_free(imported.robot, 20, np.random.default_rng(1))
        if q is not None:
            break
    return imported, import_s, protrusion_m, share


def grade_all(grader, q, T, clearances):
    """How many answers reach their pose free; the least clearance, and the largest difference from ours, m."""
    good, least, difference = 0, np.inf, 0.0
    for own, target, clearance in zip(q, T, clearances, strict=True):
        is_good, theirs = grader.grade(own, target)
        if theirs is not None:
            is_good &= theirs > 0.0
            least, difference = min(least, theirs), max(difference, abs(theirs - clearance))
        good += is_good
    return good, {"least_clearance_m": float(least), "clearance_difference_m": difference} if least < np.inf else {}


def try_arm(path, tool, options, count, keep):
    """One row of the table."""
    imported, import_s, protrusion_m, share = import_arm(path, tool, options, keep)
    robot, collision = imported.robot, CollisionModel.of(imported.robot)
    grader = Grader(path, imported)
    row = {
        "file": path.name,
        "tool": tool,
        "joints": len(robot.joints),
        "spheres": sum(link.spheres for link in imported.links),
        "pairs": len(collision.pairs),
        "sphere_pairs": grader.sphere_pairs,
        "protrusion_mm": protrusion_m * 1e3,
        "import_cpu_s": round(import_s, 2),
    }
    count = max(min(count, int(MAX_SPHERE_PAIRS / max(grader.sphere_pairs, 1))), 1)
    q, share = draw_free(robot, count, np.random.default_rng(0))
    row["free_share"] = round(share, 4)
    if q is None:
        return row | {"poses": 0, "why": "too few random configurations are free"}
    T = ikde.forward(robot, q)["tool"]
    started = time.perf_counter()
    results = ikde.solve_many(robot, ikde.Targets(T[:, :3, 3], R_world_tool=T[:, :3, :3]))
    row |= {"solve_s": round(time.perf_counter() - started, 2), "poses": count, "solved": int(np.sum(results.reached))}
    reached = np.flatnonzero(results.reached)
    clearances = results.clearance_m if collision.pairs else np.zeros(count)
    good, measured = grade_all(grader, results.q[reached], T[reached], clearances[reached])
    return row | {"confirmed": good} | measured


def main():
    """A line an arm, and the results as a file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--package-path", type=Path, action="append", default=[])
    parser.add_argument("--no-spheres", action="store_true")
    parser.add_argument("--poses", type=int, default=1000)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="of files whose names begin so; other results stay")
    asked = parser.parse_args()
    options = {"package_paths": tuple(asked.package_path), "spheres": not asked.no_spheres}
    out = OUT / ("imported_arms_no_spheres.json" if asked.no_spheres else "imported_arms.json")
    rows = {row["file"]: row for row in json.loads(out.read_text())} if out.exists() and asked.only else {}
    cover.cover_mesh = lru_cache(cover.cover_mesh)  # robots share meshes: of the later ones `import_cpu_s` is less
    paths = sorted(asked.folder.rglob("*.urdf"), key=lambda path: path.name)
    wanted = [path for word in asked.only for path in paths if path.name.startswith(word)] if asked.only else paths
    for path in dict.fromkeys(wanted):
        try:
            tool = find_tool(path)
            if tool is None:
                continue
            rows[path.name] = try_arm(path, tool, options, asked.poses, asked.keep)
        except IkdeError as error:
            rows[path.name] = {"file": path.name, "refused": getattr(error, "message", str(error))}
        print(" ".join(f"{key}={value}" for key, value in rows[path.name].items()), flush=True)
        out.write_text(json.dumps([rows[name] for name in sorted(rows)], indent=1) + "\n")


if __name__ == "__main__":
    main()
