"""Self-collision of one collision model as straight-line code: the twin of `kernels/clearance.py`.

Everything is seen from the body that carries all components, so the base of a mobile robot does not enter. Spheres are
tested as lattices: one rounding finds the one that is nearest to a point.
"""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import FIRST, LAST, PARENT, CollisionArrays, Floats, RobotArrays
from ikde.model.generate.kinematics import ORIGIN, Pose, Vector, snap, write_point
from ikde.model.generate.lattice import Lattice, component_lattices
from ikde.model.generate.writer import Value, Writer, text

SLACK = 1e-9  # m: more than rounding could hide


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Test:
    """A lattice of one component against one sphere of the other."""

    number: int
    pair: int
    lattice: Lattice
    sphere: Lattice  # with one centre

    @property
    def reach(self) -> float:
        """Distance of the centres at contact, m."""
        return self.lattice.radius + self.sphere.radius


def list_tests(collision: CollisionArrays) -> list[Test]:
    """What has to be tested, pair by pair; of two components the one with the better lattices is the lattice."""
    tests = []
    for pair, (grids, others) in enumerate(_sides(collision)):
        for one in (single for other in others for single in _singles(other)):
            tests += [Test(number=len(tests) + k, pair=pair, lattice=grid, sphere=one) for k, grid in enumerate(grids)]
    return tests


def count_tests(collision: CollisionArrays) -> int:
    """How many `list_tests` would list."""
    return sum(len(grids) * _count(others) for grids, others in _sides(collision))


def count_sphere_pairs(collision: CollisionArrays) -> int:
    """How many pairs of spheres the detector's pairs of components have."""
    spheres = (collision.components[:, LAST] - collision.components[:, FIRST]).astype(int)
    return int(sum(spheres[int(a)] * spheres[int(b)] for a, b in collision.pairs))


def find_root(robot: RobotArrays, tests: list[Test]) -> int:
    """The last body that carries everything that is tested; the world if there is none."""
    chains = [_chain(robot, body) for test in tests for body in (test.lattice.body, test.sphere.body)]
    shared = set.intersection(*map(set, chains)) if chains else {0}
    return max(shared)


def write_margin(writer: Writer, poses: dict[int, Pose], test: Test, root: int) -> str:
    """Squared distance less squared reach of one test. Takes `near_<m>`, the squared reaches."""
    square = _write_square(writer, f"{test.number}", poses, test, root)
    return text(writer.sum(f"gap_{test.number}", (square,), (-1.0, reach_name(test.reach))))


@dataclass(frozen=True, slots=True, kw_only=True)
class Guard:
    """A cheap condition without which none of some tests can fail."""

    values: list[Value]
    condition: str


def group_by_guard(
    writer: Writer, poses: dict[int, Pose], tests: list[Test], root: int
) -> list[tuple[Guard | None, list[Test]]]:
    """The tests of a pair; those of one sphere against what stands still share a box around all of it."""
    groups: dict[tuple[int, tuple[float, ...]] | None, list[Test]] = {}
    for test in tests:
        stands = test.lattice.body == root and test.sphere.body != root
        groups.setdefault((test.sphere.body, tuple(test.sphere.middle)) if stands else None, []).append(test)
    return [(_write_guard(writer, poses, group) if key else None, group) for key, group in groups.items()]


def _write_guard(writer: Writer, poses: dict[int, Pose], tests: list[Test]) -> Guard:
    sphere = tests[0].sphere
    centre = _write_centre(writer, poses[sphere.body], sphere)
    lower = np.min([test.lattice.centres.min(axis=0) - test.reach for test in tests], axis=0)
    upper = np.max([test.lattice.centres.max(axis=0) + test.reach for test in tests], axis=0)
    sides = [
        f"{text(centre[i])} {sign} {text(float(bound[i] + slack))} {'+' if slack > 0.0 else '-'} safe_distance"
        for i in (2, 0, 1)
        for sign, bound, slack in (("<=", upper, SLACK), (">=", lower, -SLACK))
        if isinstance(centre[i], str)
    ]
    return Guard(values=list(centre), condition=" and ".join(sides) or "True")


def reach_name(reach: float) -> str:
    """Name of a squared reach in generated code: by all its digits, in m."""
    return "near_" + f"{reach!r}".replace(".", "_").replace("-", "n")


def _sides(collision: CollisionArrays) -> list[tuple[list[Lattice], list[Lattice]]]:
    """What is tested as lattices in each pair, and what as spheres."""
    lattices = [component_lattices(collision, c) for c in range(len(collision.components))]
    both = [(lattices[int(a)], lattices[int(b)]) for a, b in collision.pairs]
    return [min(((x, y), (y, x)), key=lambda side: len(side[0]) * _count(side[1])) for x, y in both]


def _count(lattices: list[Lattice]) -> int:
    return sum(len(lattice.centres) for lattice in lattices)


def _singles(lattice: Lattice) -> list[Lattice]:
    return [Lattice(body=lattice.body, middle=c, radius=lattice.radius, axes=()) for c in lattice.centres]


def _chain(robot: RobotArrays, body: int) -> list[int]:
    chain = [body]
    while chain[-1] != 0:
        chain.append(int(robot.bodies[chain[-1], PARENT]))
    return chain


def _write_square(writer: Writer, name: str, poses: dict[int, Pose], test: Test, root: int) -> Value:
    """Squared distance from the sphere's centre to the nearest centre of the lattice."""
    pose = poses[test.lattice.body]
    middle = _write_centre(writer, pose, test.lattice)
    centre = _write_centre(writer, poses[test.sphere.body], test.sphere)
    v = [writer.sum(f"v{name}_{'xyz'[i]}", (centre[i],), (-1.0, middle[i])) for i in range(3)]
    if test.lattice.body == root and all(_coordinate(axis[0]) is not None for axis in test.lattice.axes):
        for direction, spacing, count in test.lattice.axes:
            i = _coordinate(direction) or 0
            v[i] = _write_rest(writer, f"{name}_{'xyz'[i]}", v[i], spacing, count)
        return writer.sum(f"square{name}", *((x, x) for x in v))
    corrections = [
        _write_correction(writer, f"{name}_{number}", _write_direction(writer, pose, test.lattice, number), v, axis)
        for number, axis in enumerate(test.lattice.axes)
    ]
    return writer.sum(f"square{name}", *((x, x) for x in v), *((c,) for c in corrections))


def _write_centre(writer: Writer, pose: Pose, lattice: Lattice) -> Vector:
    if pose is ORIGIN:
        x, y, z = (float(value) for value in lattice.middle)
        return x, y, z
    return write_point(writer, writer.label(f"c{lattice.body}", lattice.middle, 1e-6), pose, lattice.middle)


def _write_direction(writer: Writer, pose: Pose, lattice: Lattice, number: int) -> Vector:
    """Direction of an axis of the lattice, seen from the root."""
    direction = snap(lattice.axes[number][0])
    label = writer.label(f"u{lattice.body}", direction, 1e-3)
    x, y, z = (
        writer.sum(f"{label}_{'xyz'[i]}", *((pose.R[i][k], float(direction[k])) for k in range(3))) for i in range(3)
    )
    return x, y, z


def _coordinate(direction: Floats) -> int | None:
    """The coordinate axis that a direction is parallel to."""
    parallel = np.flatnonzero(np.abs(snap(direction)) == 1.0)
    return int(parallel[0]) if len(parallel) else None


def _write_nearest(writer: Writer, name: str, along: Value, spacing: float, count: int) -> str:
    """Where, along the axis from the middle, the nearest sphere stands."""
    half = 0.5 * (count - 1)
    shift = half - np.floor(half)  # an even count stands between the whole steps
    steps = text(writer.sum(f"n{name}", (along, 1.0 / spacing), (float(shift),)))
    low, high = float(shift - half), float(shift + half)
    nearest = writer.let(f"k{name}", f"min(max(np.rint({steps}), {low!r}), {high!r})")
    return text(writer.sum(f"o{name}", (nearest, spacing), (float(-shift * spacing),)))


def _write_rest(writer: Writer, name: str, along: Value, spacing: float, count: int) -> Value:
    """Distance along a coordinate axis to the nearest sphere."""
    if count == 2:
        return writer.let(f"rest{name}", f"abs({text(along)}) - {0.5 * spacing!r}")
    return writer.sum(f"rest{name}", (along,), (-1.0, _write_nearest(writer, name, along, spacing, count)))


def _write_correction(
    writer: Writer, name: str, direction: Vector, v: list[Value], axis: tuple[Floats, float, int]
) -> Value:
    """What the squared distance to the middle changes by: o (o - 2 v.u), o being where the nearest sphere stands."""
    _, spacing, count = axis
    along = writer.sum(f"along{name}", *zip(v, direction, strict=True))
    if count == 2:
        half = 0.5 * spacing
        size = writer.let(f"size{name}", f"abs({text(along)})")
        return writer.sum(f"less{name}", (-2.0 * half, size), (half * half,))
    offset = _write_nearest(writer, name, along, spacing, count)
    twice = writer.sum(f"twice{name}", (offset,), (-2.0, along))
    return writer.sum(f"less{name}", (offset, twice))
