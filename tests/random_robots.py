"""Random robots: trees with branches, fixed frames, turns and slides about any axis, rows of spheres, pairs."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from ikde.model.robot import Detector, Frame, Joint, Robot, SphereRow
from ikde.model.rotation import rotation_from_rpy
from ikde.model.validate import check_robot


def random_robot(seed):
    """A robot with 2 to 8 joints, checked; the same for the same seed."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 9))
    kinds = rng.choice(["revolute", "revolute", "prismatic"], count)
    joints = tuple(_random_joint(rng, f"j{k}", str(kind)) for k, kind in enumerate(kinds))
    frames, body_of = _random_frames(rng, count)
    rows = _random_rows(rng, body_of)
    components = list(dict.fromkeys(row.component for row in rows))
    every = list(combinations(components, 2))
    chosen = sorted(rng.choice(len(every), size=rng.integers(1, len(every) + 1), replace=False).tolist())
    return check_robot(
        Robot(
            name=f"random{seed}",
            title="A random robot",
            joints=joints,
            frames=tuple(frames),
            tool="tool",
            approximations={"spheres": rows},
            adjacent=(),
            pair_lists={"some": tuple(every[k] for k in chosen)},
            detectors={
                "some": Detector(
                    name="some", spheres="spheres", pairs="some", safe_distance_m=float(rng.choice([0.0, 0.05]))
                )
            },
            default_detector="some",
            convention="own",
            conventions={},
            provenance={},
        )
    )


def make_robot(kinds, frames, *, lower=-1.0, upper=1.0, tool="tool", **changes):
    """A robot without spheres from `kinds` {joint: kind} and `frames`, checked."""
    joints = tuple(Joint(name=n, kind=kind, lower=lower, upper=upper, home=lower) for n, kind in kinds.items())
    empty = {"approximations": {}, "adjacent": (), "pair_lists": {}, "detectors": {}, "default_detector": "none"}
    names = {"name": "made", "title": "made", "convention": "own", "conventions": {}, "provenance": {}}
    return check_robot(Robot(joints=joints, frames=tuple(frames), tool=tool, **{**empty, **names, **changes}))


def with_ranges(robot, ranges):
    """The robot with other limits of some joints, {name: (lower, upper)}."""
    joints = [
        replace(j, lower=ranges[j.name][0], upper=ranges[j.name][1]) if j.name in ranges else j for j in robot.joints
    ]
    return replace(robot, joints=tuple(joints))


def make_frame(name, parent, xyz=(0, 0, 0), *, rpy=(0, 0, 0), joint=None, axis=None):
    """A frame from plain tuples; the axis is normalised."""
    unit = None if axis is None else np.array(axis, dtype=float) / np.linalg.norm(axis)
    R = rotation_from_rpy(np.array(rpy, dtype=float))
    p = np.array(xyz, dtype=float)
    return Frame(name=name, parent=parent, p_parent_frame=p, R_parent_frame=R, joint=joint, axis=unit)


def _random_joint(rng, name, kind):
    half = np.pi if kind == "revolute" else 1.5
    lower, upper = sorted(rng.uniform(-half, half, 2).tolist())
    return Joint(name=name, kind=kind, lower=lower, upper=upper, home=float(rng.uniform(lower, upper)))


def _random_frames(rng, count):
    """Frames in random order, with the body of each by name; every body gets a fixed frame to span rows of spheres."""
    frames, body_of = [], {"world": "world"}
    for k in range(count):
        # Mostly a chain, now and then a branch.
        parent = list(body_of)[-1] if rng.random() < 0.75 else str(rng.choice(list(body_of)))
        frames.append(_random_frame(rng, f"f{k}", parent, f"j{k}"))
        body_of[f"f{k}"] = f"f{k}"
        for extra in range(int(rng.integers(1, 3))):
            name = f"f{k}_{extra}"
            frames.append(_random_frame(rng, name, f"f{k}", None))
            body_of[name] = f"f{k}"
    frames.append(_random_frame(rng, "base", "world", None))
    frames.append(_random_frame(rng, "tool", f"f{count - 1}", None))
    body_of |= {"base": "world", "tool": f"f{count - 1}"}
    rng.shuffle(frames)
    return frames, body_of


def _random_frame(rng, name, parent, joint):
    xyz = rng.uniform(-0.4, 0.4, 3) * rng.integers(0, 2, 3)
    if joint is None:
        xyz = xyz + rng.uniform(0.05, 0.1, 3)  # never on top of another frame: rows of spheres need a direction
    rpy = rng.uniform(-np.pi, np.pi, 3) if rng.random() < 0.5 else 0.5 * np.pi * rng.integers(-2, 3, 3)
    axis = None
    if joint is not None:
        axis = rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
    return make_frame(name, parent, xyz, rpy=rpy, joint=joint, axis=axis)


def _random_rows(rng, body_of):
    """One or two rows for the world and for each body; some bodies carry two components."""
    rows = []
    for body in dict.fromkeys(body_of.values()):
        on_body = [name for name, carrier in body_of.items() if carrier == body]
        for k in range(int(rng.integers(1, 3))):
            start, end = (str(name) for name in rng.choice(on_body, 2, replace=False))
            count = int(rng.integers(1, 5))
            rows.append(
                SphereRow(
                    component=f"{body}_{k if rng.random() < 0.3 else 0}",
                    start=start,
                    end=start if count == 1 and rng.random() < 0.5 else end,
                    radius_m=float(rng.uniform(0.02, 0.12)),
                    count=count,
                    spacing=str(rng.choice(["touching", "even"])),
                )
            )
    rng.shuffle(rows)
    return tuple(rows)
