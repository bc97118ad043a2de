"""A shelf, and a path into it."""

import numpy as np

import ikde

SAMPLES = 20
Y = np.linspace(0.0, 0.2, SAMPLES + 1)
SHELF = {
    "board": {"box": [0.6, 2.0, 0.03], "position": [1.0, 0.2, 0.8]},
    "top": {"box": [0.6, 2.0, 0.03], "position": [1.0, 0.2, 1.15]},
    "back": {"box": [0.03, 2.0, 2.0], "position": [1.35, 0.2, 1.0]},
}


def make_path():
    """0.2 m along y, 20 samples of 20 ms."""
    return ikde.ToolPath.through(np.column_stack([np.full_like(Y, 0.9), Y, np.full_like(Y, 0.9)]), dt_s=0.02)


def place(obstacles, margin_m=0.0, **margins_m):
    """The 9-DoF robot among obstacles."""
    return ikde.CollisionModel.of("qiao2021").in_world(ikde.load_world({"obstacles": obstacles}), margin_m, margins_m)
