"""The shapes that links have in other programs' files, in the frame of their link."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ikde.kernels.arrays import Floats

ShapeKind = Literal["sphere", "box", "cylinder", "capsule", "mesh"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """One collision shape of a link.

    `size` in m: a sphere's radius; a box's full edges along x, y, z; radius and length of a cylinder along z, and of a
    capsule the same without its caps. A mesh has none.
    """

    kind: ShapeKind
    size: tuple[float, ...]
    T_link_shape: Floats
    """[4, 4]"""
    mesh: Path | None = None
    """The file of a mesh, which exists and lies in a folder that may be read from."""
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Of a mesh's coordinates along its own axes, to m; a negative product mirrors it and its faces."""
