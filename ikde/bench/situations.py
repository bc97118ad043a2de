"""Situations 1 to 3 and Figures 9 to 11: clearance over time, the detected angle, and the real contact after it."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.bench.approximation import APPROXIMATIONS
from ikde.bench.budget import FULL, Budget
from ikde.bench.misprints import Data, meant
from ikde.bench.sweeps import FINE_STEPS, SECONDS, Sweep, find_onset, read_sweeps
from ikde.model.robot import Robot
from ikde.solver.figures import compute_clearances


def compute_situations(robot: Robot, published: Mapping[str, Any], budget: Budget = FULL) -> Data:
    """Each situation's motion as both detectors see it, over its own pairs.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
        budget: how fine the curves are.
    """
    return {
        "exact": {
            "situations": [
                _compute_situation(robot, sweep, published["situations"][sweep.name], budget.curve_points)
                for sweep in read_sweeps(published)
            ]
        },
        "measured": {},
        "settings": {
            "source": "[Qiao2021, section 5.4]",
            "grid": f"every second, then {FINE_STEPS} fine steps in the second that ends in collision",
            "curve_points": budget.curve_points,
        },
    }


def _compute_situation(robot: Robot, sweep: Sweep, entry: Data, points: int) -> Data:
    t_s = np.linspace(0.0, SECONDS, points)
    simulator = entry["simulator"]
    return {
        "situation": sweep.name,
        "pairs": sweep.pairs,
        "pair_count": len(robot.pair_lists[sweep.pairs]),
        "varies": entry["varies"],
        "start_deg": {"printed": entry["start_deg"], "meant": sweep.start_deg.tolist()},
        "end_deg": entry["end_deg"],
        "misprint": entry.get("misprint"),
        "simulator": {
            "t_s": simulator["t_s"],
            "angle_at_s": sweep.time(simulator["angle_deg"]),
            "angle_deg": {"printed": simulator["angle_deg"], "meant": meant(simulator)["angle_deg"]},
            "misprint": simulator.get("misprint"),
        },
        "detectors": [_compute_detection(robot, sweep, entry, name) for name in APPROXIMATIONS],
        "curve": {
            "t_s": t_s.tolist(),
            "angle_deg": [sweep.angle(t) for t in t_s],
            "clearance_mm": {name: _compute_curve(robot, sweep, name, t_s) for name in APPROXIMATIONS},
        },
    }


def _compute_curve(robot: Robot, sweep: Sweep, detector: str, t_s: np.ndarray) -> list[float]:
    seen = compute_clearances(sweep.look(robot, detector), sweep.configurations(t_s))
    return (1e3 * seen.clearance_m).tolist()


def _compute_detection(robot: Robot, sweep: Sweep, entry: Data, detector: str) -> Data:
    """One detector: the angle on the paper's grid, the true onset, and how early both are against the simulator.

    `early_deg` is positive if the detector speaks before the simulator's contact: the motion that it gives away.
    """
    found = find_onset(robot, sweep, detector)
    if found is None:
        return {
            "detector": detector,
            "printed_deg": sweep.detected_deg[detector],
            "agrees": False,
            "detected_deg": None,
        }
    contact_s = entry["simulator"]["t_s"]
    times = np.array([found.detected_s - 1.0 / FINE_STEPS, found.detected_s, contact_s])
    look, Q = sweep.look(robot, detector), sweep.configurations(times)
    seen = compute_clearances(look, Q)
    speed = sweep.angle(1.0) - sweep.angle(0.0)
    detected, printed = sweep.angle(found.detected_s), sweep.detected_deg[detector]
    return {
        "detector": detector,
        "printed_deg": printed,
        "detected_deg": detected,
        "agrees": abs(detected - printed) < 1e-6,
        "detected_s": found.detected_s,
        "onset_deg": sweep.angle(found.onset_s),
        "onset_s": found.onset_s,
        "pair": list(look.pairs[seen.closest_pair[1]]),
        "clearance_mm": dict(
            zip(("step_before", "detected", "contact"), (1e3 * seen.clearance_m).tolist(), strict=True)
        ),
        "early_s": contact_s - found.onset_s,
        "early_deg": {
            "printed": float(np.sign(speed)) * (meant(entry["simulator"])["angle_deg"] - printed),
            "ours": abs(speed) * (contact_s - found.onset_s),
        },
        "q_detected": Q[1].tolist(),
        "q_contact": Q[2].tolist(),
    }
