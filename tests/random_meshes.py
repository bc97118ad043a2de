"""Random meshes of every kind of trouble, from a seed: the same seed draws the same triangles."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from tests.mesh_bodies import box, make_l, write_stl

Draw = np.random.Generator


class RandomMesh(NamedTuple):
    """Triangles, and what is asked of a cover."""

    kind: str
    triangles: Floats  # [T, 3, 3] m, as the file holds them
    scale: tuple[float, float, float]
    protrusion_m: float


def draw_mesh(seed: int, folder: Path) -> tuple[RandomMesh, Path]:
    """A mesh of the kind `seed % len(KINDS)`, turned and moved, and its file, binary STL or OBJ."""
    rng = np.random.default_rng(seed)
    kind = list(KINDS)[seed % len(KINDS)]
    triangles, protrusion_m = KINDS[kind](rng)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    triangles = triangles @ turn.T + 0.2 * np.abs(triangles).max() * rng.normal(size=3)
    x, y, z = (rng.choice([-1.0, 1.0], 3) if rng.random() < 0.5 else np.ones(3)).tolist()
    if rng.random() < 0.5:
        path = write_stl(folder / "mesh.stl", triangles)
        triangles = triangles.astype(np.float32).astype(float)
    else:
        path = folder / "mesh.obj"
        lines = [f"v {' '.join(map(repr, corner))}" for corner in triangles.reshape(-1, 3).tolist()]
        lines += [f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(triangles))]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return RandomMesh(kind, triangles * (x, y, z), (x, y, z), protrusion_m), path


def _rings(radius: Floats, height: Floats, around: int) -> Floats:
    """The closed surface between outlines [N] turned about z; its ends lie on z."""
    angles = 2.0 * np.pi * np.arange(around) / around
    points = np.stack([np.outer(np.cos(angles), radius), np.outer(np.sin(angles), radius)], axis=2)
    points = np.concatenate([points, np.broadcast_to(height[None, :, None], (around, len(height), 1))], axis=2)
    points[:, [0, -1], :2] = 0.0
    a, c = points[:, :-1], np.roll(points, -1, axis=0)[:, 1:]
    b, d = np.roll(points, -1, axis=0)[:, :-1], points[:, 1:]
    both = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    return both[(both != np.roll(both, -1, axis=1)).any(axis=2).all(axis=1)]


def _ball(rng: Draw) -> tuple[Floats, float]:
    polar = np.linspace(0.0, np.pi, 8)
    return _rings(rng.uniform(0.02, 0.15) * np.sin(polar), -0.1 * np.cos(polar), 12), 0.02


def _vase(rng: Draw) -> tuple[Floats, float]:
    radius = np.r_[0.0, rng.uniform(0.02, 0.12, 5), 0.0]
    return _rings(radius, np.r_[0.0, np.sort(rng.uniform(0.0, 0.3, 5)), 0.3], 9), 0.03


def _ring(rng: Draw) -> tuple[Floats, float]:
    u, v = np.meshgrid(2.0 * np.pi * np.arange(12) / 12, 2.0 * np.pi * np.arange(7) / 7, indexing="ij")
    away = rng.uniform(0.08, 0.15) + rng.uniform(0.01, 0.05) * np.cos(v)
    points = np.stack([away * np.cos(u), away * np.sin(u), 0.04 * np.sin(v)], axis=2)
    points += rng.choice([0.0, 0.02]) * rng.normal(size=points.shape)  # where far, it passes through itself
    a, b = points, np.roll(points, -1, axis=0)
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3), 0.03


def _box(rng: Draw) -> tuple[Floats, float]:
    return box(*rng.uniform(0.01, 0.25, 3)), float(rng.choice([0.01, 0.02, 0.04]))


def _crossing(rng: Draw) -> tuple[Floats, float]:
    parts = [box(*rng.uniform(0.03, 0.15, 3)) + 0.05 * rng.normal(size=3) for _ in range(int(rng.integers(2, 5)))]
    return np.concatenate([part[:, :: int(rng.choice([1, -1]))] for part in parts]), 0.025


def _nested(rng: Draw) -> tuple[Floats, float]:
    inner = box(0.05, 0.04, 0.06) + rng.uniform(0.001, 0.04, 3)
    return np.concatenate([box(0.12, 0.11, 0.13), inner[:, :: int(rng.choice([1, -1]))]]), 0.03


def _open(rng: Draw) -> tuple[Floats, float]:
    body = _box(rng)[0] if rng.random() < 0.5 else _vase(rng)[0]
    return body[rng.permutation(len(body))[: max(2, int(0.8 * len(body)))]], 0.03


def _sheets(rng: Draw) -> tuple[Floats, float]:
    corners = 0.1 * rng.normal(size=(4, 3))
    flat = np.array([[corners[0], corners[1], corners[2]]])
    return (flat if rng.random() < 0.5 else np.concatenate([flat, flat + 0.3])), 0.02


def _soup(rng: Draw) -> tuple[Floats, float]:
    return 0.1 * rng.normal(size=(int(rng.integers(1, 9)), 3, 3)), 0.04


def _plate(rng: Draw) -> tuple[Floats, float]:
    return box(rng.uniform(0.05, 0.3), rng.uniform(0.05, 0.2), 10.0 ** rng.uniform(-6, -2.5)), 0.02


def _needle(rng: Draw) -> tuple[Floats, float]:
    long, thin = rng.uniform(0.1, 0.6), 10.0 ** rng.uniform(-6, -3)
    sliver = np.array([[[0.0, 0, 0], [long, 0, 0], [0.5 * long, thin, 0]]])
    return (sliver if rng.random() < 0.3 else np.concatenate([box(long, thin, thin), sliver + 0.05])), 0.01


def _touching(rng: Draw) -> tuple[Floats, float]:
    """Boxes that share an edge, a corner or a face: three and four faces at one edge, and faces twice."""
    shift = np.array([[1.0, 1, 0], [1, 1, 1], [1, 0, 0], [0.5, 0, 0]])[int(rng.integers(4))]
    size = rng.uniform(0.04, 0.1, 3)
    return np.concatenate([box(*size), box(*size) + shift * size]), 0.02


def _doubled(rng: Draw) -> tuple[Floats, float]:
    body = _box(rng)[0] if rng.random() < 0.5 else 0.5 * make_l()
    line = np.array([[body[0, 0], body[0, 1], 0.5 * (body[0, 0] + body[0, 1])]])
    return np.concatenate([body, body[: int(rng.integers(1, 6))], line, body[:1, [0, 0, 1]]]), 0.02


def _tiny(rng: Draw) -> tuple[Floats, float]:
    small = 10.0 ** rng.uniform(-4, -2.5)
    return small * make_l(), float(rng.choice([0.02, 0.05 * small]))


def _huge(rng: Draw) -> tuple[Floats, float]:
    large = rng.uniform(10.0, 40.0)
    return large * make_l(), 0.02 * large


KINDS: dict[str, Callable[[Draw], tuple[Floats, float]]] = {
    "box": _box,
    "ball": _ball,
    "vase": _vase,
    "ring": _ring,
    "boxes that cross": _crossing,
    "one in another": _nested,
    "open": _open,
    "sheets": _sheets,
    "soup": _soup,
    "plate": _plate,
    "needle": _needle,
    "boxes that touch": _touching,
    "faces twice": _doubled,
    "tiny": _tiny,
    "huge": _huge,
}
"""Each draws triangles and how far spheres may stand out, in m."""
