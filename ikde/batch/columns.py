"""From finished searches to the columns of a part."""

import socket
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from ikde.kernels.arrays import Ints
from ikde.model.robot import Detector
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.solver.figures import Clearances, Figures, compute_clearances
from ikde.solver.result import StopReason
from ikde.solver.rows import Rows

Columns = dict[str, Any]
STOP_REASONS = [str(reason) for reason in StopReason]


def make_solutions(
    arm: str,
    rows: Rows,
    *,
    numbers: Ints,
    repeats: int,
    names: Sequence[str] | None,
    groups: Sequence[str],
    graders: Sequence[Detector],
) -> pa.Table:
    """The solutions of a part: what hangs on recipe and seed only, the same bits in every run.

    Args:
        arm: its name.
        rows: the finished searches.
        numbers: [T] number of each solve in its arm; solve i is target i // repeats, repeat i % repeats.
        repeats: solves a target.
        names: a name a row, or None.
        groups: which of `GROUPS`; the rest of the columns is always there.
        graders: further detectors, three columns each.
    """
    columns = _identity(arm, numbers, repeats, names) | _verdict(rows)
    for group, make in GROUPS.items():
        if group in groups:
            columns |= make(rows)
    for grader in graders:
        columns |= _graded(rows, grader)
    return pa.table(columns)


def make_timing(arm: str, rows: Rows, *, numbers: Ints, repeats: int) -> pa.Table:
    """What hangs on the machine: seconds and host of each solve of a part."""
    columns = _identity(arm, numbers, repeats, None)
    columns["solve_seconds"] = pa.array(rows.found.seconds)
    columns["host"] = _word(socket.gethostname(), len(rows))
    return pa.table(columns)


def _identity(arm: str, numbers: Ints, repeats: int, names: Sequence[str] | None) -> Columns:
    columns: Columns = {"arm": _word(arm, len(numbers)), "target": pa.array(numbers // repeats)}
    if names is not None:
        columns["target_name"] = _words(names)
    columns["repeat"] = _integers(numbers % repeats)
    return columns


def _verdict(rows: Rows) -> Columns:
    reasons = [STOP_REASONS.index(story.stop_reason) for story in rows.explanations]
    return {
        "reached": pa.array(rows.reached),
        "verified": pa.array(rows.verified),
        "stop_reason": _coded(np.array(reasons), STOP_REASONS),
    }


def _joints(rows: Rows) -> Columns:
    return {f"q_{name}": pa.array(rows.q[:, k]) for k, name in enumerate(rows.problem.robot.joint_names)}


def _errors(rows: Rows) -> Columns:
    return {name: pa.array(getattr(rows.figures, name)) for name in ("position_error_m", "orientation_error_rad")}


def _clearance(rows: Rows) -> Columns:
    return _closest(rows, rows.figures, rows.problem.detector)


def _cost(rows: Rows) -> Columns:
    return {
        "attempts": _integers(rows.attempts),
        "evaluations": pa.array(rows.evaluations),
        "rejected": _integers(rows.rejected),
    }


def _reason(rows: Rows) -> Columns:
    """Why not, and what would help; null where the target was reached."""
    failures = [None if reached else story for reached, story in zip(rows.reached, rows.explanations, strict=True)]
    return {
        "reason": _words(story and story.reason for story in failures),
        "hint": _words(story and story.hint for story in failures),
    }


def _target(rows: Rows) -> Columns:
    """What was asked for. Of an axis target only the quaternion's z axis counts; a position target has none."""
    positions = np.array([target.p_world_tool for target in rows.targets])
    quats = quat_wxyz_from_rotation(np.array([target.R_world_tool for target in rows.targets]))
    free = np.array([target.kind == "position" for target in rows.targets])
    return (
        {"target_kind": _words(target.kind for target in rows.targets)}
        | {f"target_{axis}_m": pa.array(positions[:, k]) for k, axis in enumerate("xyz")}
        | {f"target_q{axis}": pa.array(quats[:, k], mask=free) for k, axis in enumerate("wxyz")}
    )


def _graded(rows: Rows, grader: Detector) -> Columns:
    seen = compute_clearances(rows.problem.robot, grader, rows.q)
    columns = _closest(rows, seen, grader)
    columns["collides"] = pa.array(seen.collides)
    return {f"{grader.name}_{name}": columns[name] for name in ("clearance_m", "collides", "closest_pair")}


def _closest(rows: Rows, seen: Figures | Clearances, detector: Detector | None) -> Columns:
    """Clearance and the pair it is between, null where there is no pair."""
    pairs = [f"{a}-{b}" for a, b in rows.problem.robot.pairs(detector)]
    return {
        "clearance_m": pa.array(seen.clearance_m, mask=seen.closest_pair < 0),
        "closest_pair": _coded(seen.closest_pair, pairs),
    }


GROUPS: Mapping[str, Callable[[Rows], Columns]] = {
    "q": _joints,
    "errors": _errors,
    "clearance": _clearance,
    "cost": _cost,
    "reason": _reason,
    "target": _target,
}


def _integers(values: Ints) -> pa.Array:
    return pa.array(values.astype(np.int32))


def _word(word: str, count: int) -> pa.Array:
    return _coded(np.zeros(count, dtype=np.int64), [word])


def _coded(codes: Ints, words: Sequence[str]) -> pa.Array:
    """Words by their index; null where it is negative."""
    indices = pa.array(codes.astype(np.int32), mask=codes < 0)
    return pa.DictionaryArray.from_arrays(indices, pa.array(words, pa.string()))


def _words(words: Iterable[str | None]) -> pa.Array:
    return pa.array(words, pa.string()).dictionary_encode()
