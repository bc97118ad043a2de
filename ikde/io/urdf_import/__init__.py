"""Robots from URDF: read, cut to the chain that moves the tool, put on a base, given spheres and pairs."""
