"""What the paper prints of collisions, and whether a robot shows it.

Everything is a row of `Observation`: a text, the printed value, ours, a margin and whether it holds. Angles
in deg and lengths in mm, because they stand beside the paper's.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.spheres import approximation_volume_m3
from ikde.paper.inputs import APPROXIMATIONS, load_published
from ikde.paper.solutions import read_row
from ikde.paper.sweeps import Sweep, compute_clearance, find_onset, read_sweeps, shows_sweep


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """One line: `slack` is positive when it holds, in `unit`; labels and home in mm, onsets in fine steps."""

    name: str
    printed: str
    ours: str
    slack: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether the robot shows it."""
        return self.slack > 0.0


@cache
def load_sweeps() -> tuple[Sweep, ...]:
    """The three situations, Situation 1 with its start put right."""
    return read_sweeps(load_published())


def observe_sweep(robot: Robot, sweep: Sweep, detector: str) -> Observation:
    """The angle that the grids give; the slack is the onset's distance to the nearest grid point."""
    printed = sweep.detected_deg[detector]
    found = find_onset(robot, sweep, detector)
    name = f"situation {sweep.name}, {detector}"
    if found is None:
        return Observation(name=name, printed=f"{printed:g}", ours="none", slack=-1.0, unit="fine steps")
    onset, detected = sweep.angle(found.onset_s), sweep.angle(found.detected_s)
    place = abs(printed - onset) / sweep.fine_step_deg
    inside = min(place, 1.0 - place) if abs(detected - printed) < 1e-6 else -abs(detected - printed)
    ours = f"{detected:.2f} (onset {onset:.4f})"
    return Observation(name=name, printed=f"{printed:g}", ours=ours, slack=inside, unit="fine steps")


def observe_labels(robot: Robot) -> list[Observation]:
    """Table 5's labels: s rows free with both detectors, f rows colliding with the typical one."""
    labelled = [row for row in load_published()["table_5"] if row["free"] is not None]
    Q = np.array([read_row(robot, row["q"]) for row in labelled])
    typical, improved = (1e3 * compute_clearance(CollisionModel.of(robot, name), Q) for name in APPROXIMATIONS)
    return [
        Observation(
            name=f"Table 5, target {row['target']}, {row['row']}",
            printed="free with both" if row["free"] else "typical collides",
            ours=f"{a:+.2f} / {b:+.2f} mm",
            slack=float(min(a, b) if row["free"] else -a),
            unit="mm",
        )
        for row, a, b in zip(labelled, typical, improved, strict=True)
    ]


def observe_home(robot: Robot) -> list[Observation]:
    """Home is free with both detectors; one sphere a component collides there [Qiao2021, section 5.3.1]."""
    found = []
    for detector, sign, printed in (
        ("typical", 1, "free"),
        ("improved", 1, "free"),
        ("single", -1, "collides"),
    ):
        gap = 1e3 * float(compute_clearance(CollisionModel.of(robot, detector), robot.home[None])[0])
        found.append(
            Observation(name=f"home, {detector}", printed=printed, ours=f"{gap:+.2f} mm", slack=sign * gap, unit="mm")
        )
    return found


def observe_volumes(robot: Robot) -> list[Observation]:
    """Table 2: volumes of the spheres, all of a detector's components in one line, to five digits."""
    found = []
    for detector in APPROXIMATIONS:
        volumes = approximation_volume_m3(robot, detector)
        printed = {name: entry[detector]["volume_mm3"] for name, entry in load_published()["table_2"].items()}
        same = sum(f"{1e9 * volumes[name]:.4e}" == f"{printed[name]:.4e}" for name in printed)
        found.append(
            Observation(
                name=f"Table 2, volumes, {detector}",
                printed=f"{len(printed)} volumes",
                ours=f"{same} equal to five digits",
                slack=1.0 if same == len(printed) else -1.0,
                unit="",
            )
        )
    return found


def observe_collisions(robot: Robot) -> list[Observation]:
    """Everything that depends on where the spheres stand."""
    sweeps = [observe_sweep(robot, sweep, detector) for sweep in load_sweeps() for detector in APPROXIMATIONS]
    return [*observe_home(robot), *sweeps, *observe_labels(robot)]


def first_failure(robot: Robot) -> str | None:
    """The first observation that a robot does not show: `observe_collisions` without onsets, faster."""
    for sweep in load_sweeps():
        for detector in APPROXIMATIONS:
            if not shows_sweep(robot, sweep, detector):
                return f"situation {sweep.name}, {detector}"
    others = (*observe_home(robot), *observe_labels(robot))
    return next((seen.name for seen in others if not seen.holds), None)
