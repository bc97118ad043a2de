"""The motions of section 5.4, the moment at which a detector first touches, and what the paper's grids make of it.

Clearances are plain numpy's: `benchmarks/calibrate.py` asks for them of thousands of robots, which would all have to
be packed for the kernels.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.paper.inputs import meant
from ikde.paper.section import make_collision
from ikde.solver.plain import compute_gaps

SECONDS, FINE_STEPS = 10, 20  # a motion; fine steps in one of its seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """One situation of section 5.4: a uniform motion of 10 s."""

    name: str
    pairs: str
    start_deg: Floats  # [6]
    end_deg: Floats  # [6]
    joint: int  # which of the arm's joints is printed
    fine_step_deg: float
    detected_deg: dict[str, float]  # printed, by detector

    def angle(self, t_s: float) -> float:
        """The printed joint's angle in deg at a time."""
        start, end = self.start_deg[self.joint], self.end_deg[self.joint]
        return float(start + (end - start) * t_s / SECONDS)

    def configurations(self, t_s: Floats) -> Floats:
        """Rows q [K, 9] in m and rad, the base at the origin."""
        arm = self.start_deg + np.multiply.outer(t_s, (self.end_deg - self.start_deg) / SECONDS)
        return np.radians(np.hstack([np.zeros((len(t_s), 3)), arm]))

    def time(self, angle_deg: float) -> float:
        """When the printed joint passes an angle, s."""
        return SECONDS * (angle_deg - self.angle(0.0)) / (self.angle(SECONDS) - self.angle(0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Onset:
    """When a detector first touches, and the first of the paper's grid points at which it does."""

    onset_s: float
    detected_s: float


def read_sweeps(published: Mapping[str, Any]) -> tuple[Sweep, ...]:
    """The three situations as they were meant."""
    return tuple(
        Sweep(
            name=name,
            pairs=entry["pairs"],
            start_deg=np.array(meant(entry)["start_deg"], dtype=float),
            end_deg=np.array(entry["end_deg"], dtype=float),
            joint=int(entry["varies"][1]) - 1,
            fine_step_deg=entry["fine_step_deg"],
            detected_deg=entry["detected_deg"],
        )
        for name, entry in published["situations"].items()
    )


def compute_clearance(collision: CollisionModel, Q: Floats) -> Floats:
    """Clearance beyond the safe distance [K] in m, by plain numpy."""
    return compute_gaps(collision, Q).min(axis=1) - collision.limit_m


def touches(robot: Robot, sweep: Sweep, detector: str, t_s: Floats) -> np.ndarray:
    """Whether a detector finds a collision among the situation's pairs at these times [K]."""
    return compute_clearance(make_collision(robot, detector, sweep.pairs), sweep.configurations(t_s)) <= 0.0


def bisect(test: Callable[[float], bool], inside: float, outside: float, steps: int = 40) -> float:
    """The end of the stretch in which `test` holds, from a value inside and one outside."""
    for _ in range(steps):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if test(middle) else (inside, middle)
    return inside


def find_onset(robot: Robot, sweep: Sweep, detector: str) -> Onset | None:
    """Check every second, then in fine steps, then bisect; None if the start collides or nothing ever does."""
    second = int(np.argmax(touches(robot, sweep, detector, np.arange(SECONDS + 1.0))))
    if second == 0:
        return None
    fine = np.linspace(second - 1, second, FINE_STEPS + 1)
    first = int(np.argmax(touches(robot, sweep, detector, fine)))
    onset = bisect(lambda t: not touches(robot, sweep, detector, np.array([t]))[0], fine[first - 1], fine[first])
    return Onset(onset_s=float(onset), detected_s=float(fine[first]))


def shows_sweep(robot: Robot, sweep: Sweep, detector: str) -> bool:
    """Whether the printed angle is detected: silent at every grid point before it, touching there."""
    steps = round(sweep.time(sweep.detected_deg[detector]) * FINE_STEPS)
    last = (steps - 1) // FINE_STEPS
    grid = np.concatenate([np.arange(float(last)), np.arange(FINE_STEPS * last, steps + 1) / FINE_STEPS])
    seen = touches(robot, sweep, detector, grid)
    return bool(seen[-1]) and not seen[:-1].any()
