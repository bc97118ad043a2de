"""Every URDF of `example-robot-data`: imported or refused in one line, and its frames and Jacobians beside Pinocchio's.

python benchmarks/urdfs.py [FOLDER]      (pip install example-robot-data pin)

Each robot is imported for the tool that it has, or for every leaf that a joint moves and no mimic joint; joints off the
chain are held at random values inside their limits. One in which nothing moves drives on a base, its root the tool.
Figures are the largest differences over all frames (m, and entries of rotations) and over the tool's Jacobian, of 10
random configurations for each of 10 sets of held values.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

from ikde.errors import FileError
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.solver.forward import forward
from ikde.solver.jacobian import arm_jacobian

SETS, CONFIGURATIONS, MOST_TOOLS = 10, 10, 6
OUT = Path(__file__).parent / "results" / "urdfs.json"


def find_folder():
    """Where the package keeps its robots."""
    for entry in map(Path, sys.path):
        folder = entry / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    raise SystemExit("example-robot-data is not installed")


def list_tools(path):
    """Leaves that a joint moves, and no mimic joint."""
    description = read_description(path)
    tree = find_tree(description)
    parents = {joint.parent for joint in description.joints.values()}
    found = []
    for leaf in tree.order:
        joints = [joint for joint in tree.path(leaf) if joint.kind != "fixed"]
        if leaf not in parents and joints and not any(joint.mimic for joint in joints):
            found.append(leaf)
    return found


def draw_held(description, rng):
    """Random values of all joints, inside limits of at most half a turn."""
    held = {}
    for joint in description.joints.values():
        if joint.kind in ("revolute", "continuous", "prismatic"):
            held[joint.name] = rng.uniform(max(joint.lower, -3.0), max(min(joint.upper, 3.0), joint.lower))
    return held


def compare(path, base, tool, rng):
    """Joints, frames, and the largest differences of frames and of the tool's Jacobian, of one robot with one tool."""
    model = pin.buildModelFromUrdf(str(path), *([pin.JointModelPlanar()] if base == "omni" else []))
    description = read_description(path)
    tree = find_tree(description)
    chain = {joint.name for joint in tree.path(tool)}
    frame_error = jacobian_error = 0.0
    for _ in range(SETS):
        values = draw_held(description, rng)
        off_chain = {name: float(value) for name, value in values.items() if name not in chain}
        robot = read_urdf(path, ImportOptions(tool=tool, base=base, spheres=False, hold=off_chain)).robot
        q = rng.uniform(*robot.drawn, (CONFIGURATIONS, len(robot.joints)))
        frames, jacobians = forward(robot, q), arm_jacobian(robot, q)
        links = [link for link in tree.order if link in frames]
        for k in range(CONFIGURATIONS):
            theirs = values | dict(zip(robot.joint_names, q[k], strict=True))
            Ts_world, J = run_pinocchio(model, theirs, (robot.joint_names, links, tool))
            frame_error = max(frame_error, *(np.abs(frames[link][k] - Ts_world[link]).max() for link in links))
            jacobian_error = max(jacobian_error, np.abs(jacobians[k] - J).max())
    return len(robot.joints), len(links), frame_error, jacobian_error


def run_pinocchio(model, values, asked):
    """Its frames of links, and its Jacobian of the tool along the tool's own axes, by the joints in their order."""
    joints, links, tool = asked
    data, q = model.createData(), pin.neutral(model)
    for name in model.names[1:]:
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 4:  # a base: x, y, and the heading as a point on a circle
            base = "base" if name == "root_joint" else name
            x, y, yaw = (values[f"{base}_{key}"] for key in ("x", "y", "yaw"))
            q[:4] = [x, y, np.cos(yaw), np.sin(yaw)]
        else:
            value = values[name]
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
    pin.framesForwardKinematics(model, data, q)
    Ts_world = {link: data.oMf[model.getFrameId(link, pin.BODY)].homogeneous for link in links}
    J = pin.computeFrameJacobian(model, data, q, model.getFrameId(tool, pin.BODY), pin.LOCAL)
    if joints[0].endswith("_x"):  # its speeds are along the base's own axes
        J[:, :2] = J[:, :2] @ np.array([[q[2], q[3]], [-q[3], q[2]]])
    columns = [0, 1, 2] if joints[0].endswith("_x") else []
    columns += [model.joints[model.getJointId(name)].idx_v for name in joints[len(columns) :]]
    return Ts_world, J[:, columns]


def try_robot(path, rng):
    """One row of the table."""
    started = time.process_time()
    row = {"file": path.name}
    try:
        tools = list_tools(path)
        base = "urdf" if tools else "omni"
        tools = tools or [find_tree(read_description(path)).root]
        read_urdf(path, ImportOptions(tool=tools[0], base=base, spheres=False))
    except FileError as error:
        return row | {"refused": error.message}
    row |= {"ends": len(tools), "base": base, "import_s": round(time.process_time() - started, 3)}
    compared = [compare(path, base, tool, rng) for tool in tools[:MOST_TOOLS]]
    joints, frames, frame_errors, jacobian_errors = zip(*compared, strict=True)
    return row | {
        "joints": max(joints),
        "frames": max(frames),
        "frame_error": float(max(frame_errors)),
        "jacobian_error": float(max(jacobian_errors)),
    }


def main():
    """A line a robot, and the results as a file."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else find_folder()
    rows = []
    for path in sorted(folder.rglob("*.urdf")):
        rows.append(try_robot(path, np.random.default_rng(0)))
        print(" ".join(f"{key}={value}" for key, value in rows[-1].items()), flush=True)
    imported = [row for row in rows if "refused" not in row]
    worst = {key: max(row[key] for row in imported) for key in ("frame_error", "jacobian_error", "import_s")}
    print(f"{len(imported)} of {len(rows)} imported; worst: {worst}")
    OUT.write_text(json.dumps({"imported": len(imported), "of": len(rows), **worst, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
