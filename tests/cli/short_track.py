"""A track file whose path is followed in a moment."""

SPEC = """
name: short
robot: qiao2021
dt_s: 0.02
samples: 6
path: {expressions: {x: 0.9 + 0.002*k, y: 0.2, z: 0.9}}
"""
