"""Sphere approximations: from rows (component, key points, radius, count) and free spheres to spheres on bodies."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import FreeSpheres, Robot, SphereRow
from ikde.model.tree import Tree


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sphere:
    """One sphere, fixed to a body."""

    component: str
    body: int
    p_body_sphere: Floats
    """[3] m"""
    radius_m: float
    row: int
    """Index of its row in the approximation."""
    offset_m: float
    """Along the row's line, from the middle; 0 of a free sphere."""


def row_offsets(row: SphereRow, length_m: float) -> Floats:
    """Where a row's centres stand along its line, measured from the middle [count], m."""
    steps = np.arange(row.count, dtype=np.float64) - 0.5 * (row.count - 1)
    if row.count == 1:
        return steps
    return steps * (2.0 * row.radius_m if row.spacing == "touching" else length_m / (row.count - 1))


def expand_rows(robot: Robot, tree: Tree, approximation: str) -> tuple[Sphere, ...]:
    """All spheres of an approximation, those of one component together, in the order of the rows."""
    rows = robot.approximations[approximation]
    order = robot.components(approximation)
    spheres = []
    for index in sorted(range(len(rows)), key=lambda i: order.index(rows[i].component)):
        row = rows[index]
        if isinstance(row, FreeSpheres):
            spheres += _place_free(row, index, tree)
            continue
        body = tree.frame_body[row.start]
        start, end = tree.T_body_frame[row.start][:3, 3], tree.T_body_frame[row.end][:3, 3]
        length = float(np.linalg.norm(end - start))
        direction = (end - start) / length if length > 0.0 else np.zeros(3)
        spheres += [
            Sphere(
                component=row.component,
                body=body,
                p_body_sphere=0.5 * (start + end) + offset * direction,
                radius_m=row.radius_m,
                row=index,
                offset_m=float(offset),
            )
            for offset in row_offsets(row, length)
        ]
    return tuple(spheres)


def _place_free(free: FreeSpheres, index: int, tree: Tree) -> list[Sphere]:
    T = tree.T_body_frame[free.frame]
    return [
        Sphere(
            component=free.component,
            body=tree.frame_body[free.frame],
            p_body_sphere=T[:3, :3] @ np.array(centre) + T[:3, 3],
            radius_m=radius,
            row=index,
            offset_m=0.0,
        )
        for *centre, radius in free.spheres
    ]


def bounding_sphere(spheres: list[Sphere]) -> tuple[Floats, float]:
    """A sphere around spheres of one body, centred on the middle of their box.

    The radius is a hair too large on purpose, so that rounding can never let a contact slip past it.
    """
    centres = np.array([s.p_body_sphere for s in spheres])
    radii = np.array([s.radius_m for s in spheres])
    middle = 0.5 * ((centres - radii[:, None]).min(axis=0) + (centres + radii[:, None]).max(axis=0))
    radius = float((np.linalg.norm(centres - middle, axis=1) + radii).max())
    return middle, radius * (1.0 + 1e-9) + 1e-12


def approximation_volume_m3(robot: Robot, approximation: str) -> dict[str, float]:
    """Sum of the sphere volumes of each component in m^3 [Qiao2021, Table 2]; overlaps count twice, as there."""
    volumes = dict.fromkeys(robot.components(approximation), 0.0)
    for row in robot.approximations[approximation]:
        radii = [r for *_, r in row.spheres] if isinstance(row, FreeSpheres) else [row.radius_m] * row.count
        volumes[row.component] += sum(4.0 / 3.0 * np.pi * radius**3 for radius in radii)
    return volumes
