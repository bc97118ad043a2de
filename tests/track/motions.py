"""Small motions, made up: a base that drives on an arc while two joints turn."""

import numpy as np

from ikde.track.certify import Certificate
from ikde.track.path import ToolPath
from ikde.track.trajectory import Trajectory
from ikde.track.verify_track import TrackGrade, Violations

NAMES = ("d_x", "d_y", "q_z", "q1", "q2")


KEPT = Violations(error=0, range=0, speed=0, acceleration=0, wheel=0, distance=0, collision=0, sideways=0)


def make_motion(*, drive="differential", reached=4, stop=None, base=True, dt_s=0.02, orientation="free", **changes):
    """A motion of 4 samples after the start, of which `reached` were reached; -1: not even the start."""
    k = np.arange(reached + 1.0)
    steps = max(reached, 0)
    turn = 0.1 * k
    q = np.column_stack([0.3 * np.sin(turn), 0.3 * (1 - np.cos(turn)), turn, 1 / 3 + 0.01 * k, -1e-5 * k**2])
    path = ToolPath(
        name="made up",
        dt_s=dt_s,
        p_world_tool=np.column_stack([np.arange(5) / 100, np.zeros(5), np.ones(5)]),
        orientation=orientation,
        R_world_tool=None if orientation == "free" else np.tile(np.eye(3), (5, 1, 1)),
    )
    v, omega, wheels = np.full(steps, 1.5), np.full(steps, 5.0), np.tile([0.5, 2.5], (steps, 1))
    pairs = changes.pop("pairs", 1)
    graded = TrackGrade(
        error_m=np.full((len(q), 3), 1e-9),
        orientation_error_rad=np.zeros(len(q)),
        speeds=np.diff(q, axis=0) / dt_s,
        driven=np.diff(q, axis=0) / dt_s,
        v=v,
        omega=omega,
        wheel_speeds=wheels,
        sideways_m_s=np.zeros(steps),
        gaps_m=np.full((len(q), pairs), 0.05),
        extras_m=np.zeros(pairs),
        distance_m=np.full(len(q), np.nan),
        violations=changes.pop("violations", KEPT),
    )
    proof = (
        Certificate(clearance_m=0.04, segment_m=np.full(steps, 0.04), room_m=np.full(steps, 0.04))
        if pairs and steps
        else None
    )
    given = {
        "path": path,
        "joint_names": NAMES,
        "base_joints": NAMES[:3] if base else (),
        "drive": drive,
        "method": "continuation",
        "limits": None,
        "q": q,
        "v": v if drive == "differential" else np.tile([1.0, 0.5], (steps, 1)),
        "omega": omega,
        "wheel_speeds": wheels if drive == "differential" else None,
        "stop": stop,
        "seconds": np.full(steps, 1e-4),
        "search_seconds": 0.25,
        "grade": graded,
        "certificate": proof,
        "deviation_m": np.full(steps, 1e-5),
        "deviation_rad": np.full(steps, 1e-5),
    }
    return Trajectory(**{**given, **changes})
