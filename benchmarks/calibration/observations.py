"""What the paper prints of collisions, and whether a robot shows it.

Everything is a row of `Observation`: a text, the printed value, ours, a margin and whether it holds. Angles
in deg and lengths in mm, because they stand beside the paper's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from calibration.gaps import compute_gaps
from ikde.io.yaml_file import read_yaml
from ikde.kernels.arrays import Floats
from ikde.model.robot import Pairs, Robot
from ikde.solver.joints import read_joints

DETECTORS = ("typical", "improved")
PUBLISHED = Path(__file__).parents[2] / "tests" / "published.yaml"


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
def load_published() -> dict:
    """The printed figures, as plain data."""
    return read_yaml(PUBLISHED).data


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """One situation of section 5.4: a uniform motion of 10 s."""

    name: str
    pairs: str
    start_deg: Floats
    end_deg: Floats
    joint: int
    fine_step_deg: float
    detected_deg: dict[str, float]

    def angle(self, t_s: Floats) -> Floats:
        """The printed joint's angle in deg at a time."""
        return self.start_deg[self.joint] + (self.end_deg - self.start_deg)[self.joint] * t_s / 10.0

    def configurations(self, t_s: Floats) -> Floats:
        """Rows q [K, 9] in m and rad, the base at the origin."""
        arm = self.start_deg + np.multiply.outer(t_s, (self.end_deg - self.start_deg) / 10.0)
        return np.radians(np.hstack([np.zeros((len(t_s), 3)), arm]))

    def time(self, angle_deg: float) -> float:
        """When the printed joint passes an angle."""
        return float(10.0 * (angle_deg - self.angle(0.0)) / (self.angle(10.0) - self.angle(0.0)))


@cache
def load_sweeps() -> tuple[Sweep, ...]:
    """The three situations, Situation 1 with its start put right."""
    return tuple(
        Sweep(
            name=name,
            pairs=entry["pairs"],
            start_deg=np.array(entry.get("misprint", entry)["start_deg"], dtype=float),
            end_deg=np.array(entry["end_deg"], dtype=float),
            joint=int(entry["varies"][1]) - 1,
            fine_step_deg=entry["fine_step_deg"],
            detected_deg=entry["detected_deg"],
        )
        for name, entry in load_published()["situations"].items()
    )


def compute_clearance(robot: Robot, detector: str, Q: Floats, pairs: Pairs | None = None) -> Floats:
    """Clearance beyond the safe distance [K] in m, over the detector's pairs or those given."""
    chosen = robot.detector(detector)
    pairs = robot.pair_lists[chosen.pairs] if pairs is None else pairs
    return compute_gaps(robot, chosen.spheres, pairs, Q).min(axis=1) - chosen.safe_distance_m


def touches(robot: Robot, sweep: Sweep, detector: str, t_s: Floats) -> np.ndarray:
    """Whether a detector, looking at the situation's pairs, sees a collision at these times."""
    pairs = robot.pair_lists[sweep.pairs]
    return compute_clearance(robot, detector, sweep.configurations(np.atleast_1d(t_s)), pairs) <= 0.0


def bisect(test: Callable[[float], bool], inside: float, outside: float, steps: int = 40) -> float:
    """The end of the stretch in which `test` holds, from a value inside and one outside."""
    for _ in range(steps):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if test(middle) else (inside, middle)
    return inside


def find_onset(robot: Robot, sweep: Sweep, detector: str) -> tuple[float | None, float | None]:
    """Angle in deg at which a detector first touches, and the one that the paper's two grids give."""
    second = int(np.argmax(touches(robot, sweep, detector, np.arange(11.0))))
    if second == 0:
        return None, None
    fine = second - 1 + np.arange(21) / 20.0
    first = int(np.argmax(touches(robot, sweep, detector, fine)))
    onset = bisect(lambda t: not touches(robot, sweep, detector, t)[0], fine[first - 1], fine[first])
    return float(sweep.angle(onset)), float(sweep.angle(fine[first]))


def shows_sweep(robot: Robot, sweep: Sweep, detector: str) -> bool:
    """Whether the printed angle is detected: silent at every grid point before it, touching there."""
    steps = round(sweep.time(sweep.detected_deg[detector]) * 20)
    last = (steps - 1) // 20
    grid = np.concatenate([np.arange(last), np.arange(20 * last, steps + 1) / 20.0])
    seen = touches(robot, sweep, detector, grid)
    return bool(seen[-1]) and not seen[:-1].any()


def observe_sweep(robot: Robot, sweep: Sweep, detector: str) -> Observation:
    """The angle that the grids give; the slack is the onset's distance to the nearest grid point."""
    printed = sweep.detected_deg[detector]
    onset, detected = find_onset(robot, sweep, detector)
    name = f"situation {sweep.name}, {detector}"
    if onset is None or detected is None:
        return Observation(name=name, printed=f"{printed:g}", ours="none", slack=-1.0, unit="fine steps")
    place = abs(printed - onset) / sweep.fine_step_deg
    inside = min(place, 1.0 - place) if abs(detected - printed) < 1e-6 else -abs(detected - printed)
    ours = f"{detected:.2f} (onset {onset:.4f})"
    return Observation(name=name, printed=f"{printed:g}", ours=ours, slack=inside, unit="fine steps")


def observe_labels(robot: Robot) -> list[Observation]:
    """Table 5's labels: s rows free with both detectors, f rows colliding with the typical one."""
    labelled = [row for row in load_published()["table_5"] if row["free"] is not None]
    Q = read_joints(robot, [[*np.array(row["q"][:2]) / 1e3, *row["q"][2:]] for row in labelled], "classical")
    typical, improved = (1e3 * compute_clearance(robot, detector, Q) for detector in DETECTORS)
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
        gap = 1e3 * float(compute_clearance(robot, detector, robot.home[None])[0])
        found.append(
            Observation(name=f"home, {detector}", printed=printed, ours=f"{gap:+.2f} mm", slack=sign * gap, unit="mm")
        )
    return found


def observe_volumes(robot: Robot) -> list[Observation]:
    """Table 2: volumes of the spheres, all of a detector's components in one line, to five digits."""
    found = []
    for detector in DETECTORS:
        volumes = dict.fromkeys(robot.components(detector), 0.0)
        for row in robot.approximations[detector]:
            volumes[row.component] += row.count * 4.0 / 3.0 * np.pi * (1e3 * row.radius_m) ** 3
        printed = {name: entry[detector]["volume_mm3"] for name, entry in load_published()["table_2"].items()}
        same = sum(f"{volumes[name]:.4e}" == f"{printed[name]:.4e}" for name in printed)
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
    """Everything that hangs on where the spheres stand."""
    sweeps = [observe_sweep(robot, sweep, detector) for sweep in load_sweeps() for detector in DETECTORS]
    return [*observe_home(robot), *sweeps, *observe_labels(robot)]


def first_failure(robot: Robot) -> str | None:
    """The first observation that a robot does not show: `observe_collisions` without onsets, faster."""
    for sweep in load_sweeps():
        for detector in DETECTORS:
            if not shows_sweep(robot, sweep, detector):
                return f"situation {sweep.name}, {detector}"
    others = (*observe_home(robot), *observe_labels(robot))
    return next((seen.name for seen in others if not seen.holds), None)
