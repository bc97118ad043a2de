"""Convex hulls of points, with exact signs: whichever way points lie in a plane, the hull is closed and convex."""

from typing import NoReturn

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints

MAX_HULL_TRIANGLES = 2_000  # a distance compares all of them
ROUNDING = 16.0 * np.finfo(float).eps  # of a determinant, as a share of the sizes of its terms
FLAT = "expected points that enclose a volume: these lie in a plane"


def make_hull(points: Floats) -> tuple[Floats, Ints]:
    """Corners [V, 3] and triangles [F, 3] of the convex hull of finite points [K, 3] m.

    Corners keep their order, and the hull of the corners is the same to the bit. Triangles are counter-clockwise from
    outside; points inside a face or an edge are no corners.

    Raises:
        InputError: for points in a plane, and for a hull of more than `MAX_HULL_TRIANGLES`.
    """
    corners = points
    while True:
        triangles = _Hull(corners).triangles
        used = np.unique(triangles)
        if len(used) == len(corners):
            return corners, triangles
        corners = corners[used]


def measure_normals(corners: Floats, triangles: Ints) -> Floats:
    """Outward unit normals [F, 3], from exact numbers: right to rounding for the thinnest triangle."""
    exact = _to_integers(corners)
    a, b, c = (exact[triangles[:, k]] for k in range(3))
    normals = _cross(b - a, c - a)
    largest = np.abs(normals).max(axis=1)
    shares = np.array([[int(x) / int(most) for x in row] for row, most in zip(normals, largest, strict=True)])
    return shares / np.linalg.norm(shares, axis=1, keepdims=True)


class _Hull:
    """A tetrahedron that takes in one point after the other, those that stand out most first."""

    def __init__(self, points: Floats) -> None:
        self._points, self._exact = points, _to_integers(points)
        self._faces: list[tuple[int, int, int]] = []
        self._edges: dict[tuple[int, int], int] = {}  # directed, to the face on their left
        self._above = np.full(len(points), -1)  # a face that each point is outside of
        self._heights = np.zeros(len(points))  # how far, roughly
        self._alive: set[int] = set()
        self._start()
        while (eye := int(np.argmax(self._heights))) >= 0 and self._above[eye] >= 0:
            self._take_in(eye)

    @property
    def triangles(self) -> Ints:
        """[F, 3], in one order."""
        faces = [min((f, (f[1], f[2], f[0]), (f[2], f[0], f[1]))) for f in (self._faces[k] for k in self._alive)]
        return np.array(sorted(faces), dtype=np.int64)

    def _start(self) -> None:
        P = self._points
        a = int(np.lexsort(P.T[::-1])[0])
        b = int(np.argmax(np.linalg.norm(P - P[a], axis=1)))
        c = int(np.argmax(np.linalg.norm(np.cross(P - P[a], P[b] - P[a]), axis=1)))
        order = np.argsort(-np.abs((P - P[a]) @ np.cross(P[b] - P[a], P[c] - P[a])), kind="stable")
        signs = self._signs(order, np.array([[a, b, c]]))[:, 0]
        if not signs.any():
            raise InputError(FLAT, ("points",))
        place = int(np.argmax(signs != 0))
        d = int(order[place])
        if signs[place] > 0:
            b, c = c, b
        new = [self._add(face) for face in ((a, b, c), (a, d, b), (b, d, c), (c, d, a))]
        self._assign(np.arange(len(P)), new)

    def _take_in(self, eye: int) -> None:
        """Exchange the faces that a point is outside of for those from their border to it."""
        alive = sorted(self._alive)
        seen = self._signs(np.array([eye]), np.array([self._faces[k] for k in alive]))[0] > 0
        visible = {face for face, is_seen in zip(alive, seen, strict=True) if is_seen}
        border = []
        for face in sorted(visible):
            a, b, c = self._faces[face]
            border += [(u, v) for u, v in ((a, b), (b, c), (c, a)) if self._edges[v, u] not in visible]
        new = [self._add((a, b, eye)) for a, b in border]
        self._alive -= visible
        if len(self._alive) > 1.1 * MAX_HULL_TRIANGLES:  # rounding took in few that are no corners, if any
            self._refuse("more")
        self._assign(np.flatnonzero(np.isin(self._above, list(visible))), new)
        if not (self._above >= 0).any() and len(self._alive) > MAX_HULL_TRIANGLES:
            self._refuse(f"{len(self._alive):,}")

    @staticmethod
    def _refuse(got: str) -> NoReturn:
        raise InputError(
            f"expected a hull of at most {MAX_HULL_TRIANGLES:,} triangles, got {got}; give fewer points", ("points",)
        )

    def _add(self, face: tuple[int, int, int]) -> int:
        number = len(self._faces)
        self._faces.append(face)
        a, b, c = face
        self._edges[a, b] = self._edges[b, c] = self._edges[c, a] = number
        self._alive.add(number)
        return number

    def _assign(self, rows: Ints, faces: list[int]) -> None:
        """Note for points which of some faces they are outside of, the one that is farthest below them."""
        corners = np.array([self._faces[k] for k in faces])
        outside = self._signs(rows, corners) > 0
        a, b, c = (self._points[corners[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
        heights = np.einsum("kfi,fi->kf", self._points[rows][:, None] - a, normals)
        heights = np.where(outside, np.maximum(heights, np.finfo(float).tiny), -1.0)
        best = np.argmax(heights, axis=1)
        self._heights[rows] = heights[np.arange(len(rows)), best]
        self._above[rows] = np.where(outside.any(axis=1), np.array(faces)[best], -1)

    def _signs(self, rows: Ints, faces: Ints) -> Ints:
        """[k, f] 1 for points outside of faces, -1 inside, 0 in their planes: exactly."""
        P, (a, b, c) = self._points[rows], (self._points[faces[:, k]] for k in range(3))
        to_point, u, v = P[:, None] - a, b - a, c - a
        value = np.einsum("kfi,fi->kf", to_point, np.cross(u, v))
        sizes = np.abs(u[:, [1, 2, 0]] * v[:, [2, 0, 1]]) + np.abs(u[:, [2, 0, 1]] * v[:, [1, 2, 0]])
        doubtful = np.abs(value) <= ROUNDING * np.einsum("kfi,fi->kf", np.abs(to_point), sizes)
        signs = np.sign(value).astype(np.int64)
        if doubtful.any():
            k, f = np.nonzero(doubtful)
            a, b, c = (self._exact[faces[f, corner]] for corner in range(3))
            exact = ((self._exact[rows[k]] - a) * _cross(b - a, c - a)).sum(axis=1)
            signs[k, f] = [(x > 0) - (x < 0) for x in exact]
        return signs


def _to_integers(points: Floats) -> np.ndarray:
    """Coordinates as Python's whole numbers [K, 3], all times one power of two."""
    mantissas, exponents = np.frexp(points)
    lowest = int(exponents[points != 0.0].min(initial=0)) - 53
    whole = np.ldexp(mantissas, 53).astype(np.int64).astype(object)
    return whole << np.where(points == 0.0, 0, exponents - 53 - lowest).astype(object)


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[:, [1, 2, 0]] * v[:, [2, 0, 1]] - u[:, [2, 0, 1]] * v[:, [1, 2, 0]]
