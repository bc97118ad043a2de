"""Spheres that cover the shapes of a robot's links."""

from ikde.spheres.cover import Cover, cover_shapes

__all__ = ["Cover", "cover_shapes"]
