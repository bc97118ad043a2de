"""Spheres that cover the shapes of a robot's links."""

from collections.abc import Sequence
from typing import Any

from ikde.errors import InputError
from ikde.spheres.shapes import Shape


def cover_shapes(shapes: Sequence[Shape], protrusion_m: float) -> Any:
    """Spheres of shapes that are none themselves."""
    raise InputError(f"a {shapes[0].kind} cannot be covered with spheres yet; --no-spheres does without")
