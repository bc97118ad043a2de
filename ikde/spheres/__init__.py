"""Spheres that cover the shapes of a robot's links."""
