"""Buffers and calls that the kernel tests share: the kernels as functions that return what they compute."""

import numpy as np

from ikde.kernels.arrays import CollisionArrays
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot


def run_bodies(robot, q):
    """T_world_body [B, 3, 4] of a robot by the kernel."""
    packed = pack_robot(robot)
    out_T = np.full((len(packed.bodies), 3, 4), np.nan)
    compute_bodies(packed, q, out_T)
    return out_T


def run_tool(robot, T_world_body):
    """T_world_tool [3, 4] by the kernel."""
    out_T = np.full((3, 4), np.nan)
    compute_tool(pack_robot(robot), T_world_body, out_T)
    return out_T


def run_spheres(robot, detector, q):
    """Packed detector, centres [3, S] and bounds [C, 3] by the kernels."""
    packed, T_world_body = CollisionModel(robot=robot, detector=detector).arrays, run_bodies(robot, q)
    centres = np.full((3, len(packed.radius)), np.nan)
    bounds = np.full((len(packed.components), 3), np.nan)
    compute_centres(packed, T_world_body, centres)
    compute_bounds(packed, T_world_body, bounds)
    return packed, centres, bounds


def make_state(word=0):
    """The state of a random stream."""
    return np.array([word], dtype=np.uint64)


def freeze(values, dtype=np.float64):
    """A read-only, C-ordered array, as `pack` gives them."""
    array = np.array(values, dtype=dtype, order="C")
    array.setflags(write=False)
    return array


def two_spheres(distance, radii, safe_distance=0.0):
    """A detector with one pair of single spheres on the world's x axis, and its centres [3, 2] and bounds [2, 3]."""
    centres = np.array([[0.0, distance], [0.0, 0.0], [0.0, 0.0]])
    detector = CollisionArrays(
        safe_distance=float(safe_distance),
        p_body_sphere=freeze(centres),
        radius=freeze(radii),
        components=freeze([(0, 0, 1), (0, 1, 2)], np.int64),
        bounds=freeze([(0.0, 0.0, 0.0, radii[0]), (distance, 0.0, 0.0, radii[1])]),
        pairs=freeze([(0, 1)], np.int64),
        rows=freeze(np.zeros((0, 4)), np.int64),
        offset=freeze([0.0, 0.0]),
        world=freeze([]),
    )
    return detector, centres, np.ascontiguousarray(centres.T)
