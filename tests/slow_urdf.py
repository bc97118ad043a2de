"""Frames of a URDF as its definition says, one multiplication after the other: xml.etree and 4 x 4 matrices alone."""

import xml.etree.ElementTree as ET

import numpy as np


def slow_frames(text, values):
    """T_root_link of every link, joints at `values` by name (else 0)."""
    robot = ET.fromstring(text)
    children = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}

    def frame(link):
        if link not in children:
            return np.eye(4)
        joint = children[link]
        return (
            frame(joint.find("parent").get("link"))
            @ _origin(joint)
            @ _motion(joint, values.get(joint.get("name"), 0.0))
        )

    return {link.get("name"): frame(link.get("name")) for link in robot.findall("link")}


def _numbers(element, key, default):
    return [float(x) for x in (element.get(key, default) if element is not None else default).split()]


def _origin(joint):
    origin = joint.find("origin")
    roll, pitch, yaw = _numbers(origin, "rpy", "0 0 0")
    T = _turn([0, 0, 1], yaw) @ _turn([0, 1, 0], pitch) @ _turn([1, 0, 0], roll)
    T[:3, 3] = _numbers(origin, "xyz", "0 0 0")
    return T


def _motion(joint, value):
    axis = np.array(_numbers(joint.find("axis"), "xyz", "1 0 0"))
    axis = axis / np.sqrt(axis @ axis)
    if joint.get("type") in ("revolute", "continuous"):
        return _turn(axis, value)
    T = np.eye(4)
    if joint.get("type") == "prismatic":
        T[:3, 3] = value * axis
    return T


def _turn(axis, angle):
    """By a quaternion, unlike the formula that is tested."""
    w, (x, y, z) = np.cos(angle / 2), np.sin(angle / 2) * np.array(axis, dtype=float)
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return T
