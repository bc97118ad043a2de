"""Spheres that stand in a regular row or grid: the nearest of them is found by rounding, not by trying each."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import BODY, FIRST, LAST, CollisionArrays, Floats

SAME = 1e-12  # m


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lattice:
    """Equal spheres of one body, equally spaced along up to two directions at right angles about their middle."""

    body: int
    middle: Floats
    """[3] m, in the body's frame"""
    radius: float
    axes: tuple[tuple[Floats, float, int], ...]
    """Unit direction [3] in the body's frame, spacing in m, count."""

    @property
    def centres(self) -> Floats:
        """Where the spheres are [n, 3], in the body's frame."""
        points = self.middle[None]
        for direction, spacing, count in self.axes:
            steps = (np.arange(count) - 0.5 * (count - 1)) * spacing
            points = (points[:, None] + steps[None, :, None] * direction).reshape(-1, 3)
        return points


def component_lattices(collision: CollisionArrays, component: int) -> list[Lattice]:
    """The spheres of one component as lattices; a sphere inside another of them is left out."""
    body, first, last = (int(x) for x in collision.components[component, [BODY, FIRST, LAST]])
    rows = [row for row in collision.rows if first <= row[2] < last]
    found = [
        _as_row(body, collision, _outside(collision, first, last, range(int(row[2]), int(row[3])))) for row in rows
    ]
    return _pair_up([lattice for group in found for lattice in group])


def _outside(collision: CollisionArrays, first: int, last: int, spheres: range) -> list[int]:
    """Those that are not inside another sphere of their component."""
    centres, radii = collision.p_body_sphere.T, collision.radius
    kept = []
    for i in spheres:
        gaps = radii[first:last] - radii[i] - np.linalg.norm(centres[first:last] - centres[i], axis=1)
        gaps[i - first] = -np.inf
        covered = gaps >= 0.0
        covered[i - first :] &= gaps[i - first :] > 0.0  # of two equal ones the first stays
        if not covered.any():
            kept.append(i)
    return kept


def _as_row(body: int, collision: CollisionArrays, spheres: list[int]) -> list[Lattice]:
    """One row, or single spheres where a row has lost one from its middle."""
    if not spheres:
        return []
    centres, radius = collision.p_body_sphere.T[spheres], float(collision.radius[spheres[0]])
    if len(spheres) == 1:
        return [Lattice(body=body, middle=centres[0], radius=radius, axes=())]
    step = (centres[-1] - centres[0]) / (len(spheres) - 1)
    spacing = float(np.linalg.norm(step))
    if np.ptp(np.diff(spheres)) > 0 or spacing < SAME:
        return [Lattice(body=body, middle=centre, radius=radius, axes=()) for centre in centres]
    middle = 0.5 * (centres[0] + centres[-1])
    return [Lattice(body=body, middle=middle, radius=radius, axes=((step / spacing, spacing, len(spheres)),))]


def _pair_up(rows: list[Lattice]) -> list[Lattice]:
    """Two equal rows side by side become one grid."""
    rest, made = list(rows), []
    while rest:
        row = rest.pop(0)
        partner = next((other for other in rest if _side_by_side(row, other)), None)
        if partner is None:
            made.append(row)
            continue
        rest.remove(partner)
        across = partner.middle - row.middle
        width = float(np.linalg.norm(across))
        middle = 0.5 * (row.middle + partner.middle)
        axes = (*row.axes, (across / width, width, 2))
        made.append(Lattice(body=row.body, middle=middle, radius=row.radius, axes=axes))
    return made


def _side_by_side(a: Lattice, b: Lattice) -> bool:
    if a.radius != b.radius or len(a.axes) != 1 or len(b.axes) != 1:
        return False
    (u, step, count), (v, other_step, other_count) = a.axes[0], b.axes[0]
    across = b.middle - a.middle
    return (
        count == other_count
        and abs(step - other_step) < SAME
        and bool(np.abs(u - v).max() < SAME)
        and bool(np.linalg.norm(across) > SAME)
        and abs(float(across @ u)) < SAME
    )
