"""Motions that several tests look at, made once; and straight paths."""

from functools import lru_cache
from pathlib import Path

import numpy as np

import ikde
from ikde.io.plan_file import load_track
from ikde.track.follow_path import follow_path
from ikde.track.path import ToolPath

TASKS = ("task1", "task2", "task3", "task4", "task4_minus_x")
DRIVES = ("differential", "omnidirectional")
FOLDER = Path(__file__).parents[2] / "configs" / "tracks"


@lru_cache
def load_task(name):
    """The plan of one of the paper's tasks."""
    return load_track(FOLDER / f"qiao2022_{name}.yaml")


@lru_cache
def robot():
    """The 9-DoF robot, the same object each time."""
    return ikde.load_robot("qiao2021")


@lru_cache
def follow_task(name, drive):
    """The motion along one of the paper's tasks."""
    return follow_path(robot(), load_task(name).path, drive=drive)


def make_line(start, end, samples, **asked):
    """A straight path of even pace, 20 ms a sample."""
    shares = np.linspace(0.0, 1.0, samples + 1)[:, None]
    p = (1.0 - shares) * np.array(start) + shares * np.array(end)
    return ToolPath.through(p, dt_s=0.02, **{key: np.tile(value, (samples + 1, 1)) for key, value in asked.items()})
