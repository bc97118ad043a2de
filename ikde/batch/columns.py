"""From finished searches to the columns of a part."""

import socket
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from ikde.kernels.arrays import Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.model.target import KINDS, POSITION
from ikde.solver.metrics import Clearances, Metrics, compute_clearances
from ikde.solver.result import STOP_REASONS
from ikde.solver.results import SolveResults
from ikde.solver.verify import MaskedBools

Columns = dict[str, Any]
WORDS = [str(reason) for reason in STOP_REASONS]
OWN_WORDS = ("target_name", "reason", "hint")  # columns of words that other rows do not have


def make_solutions(
    arm: str,
    rows: SolveResults,
    *,
    numbers: Ints,
    repeats: int,
    names: pa.Array | Sequence[str] | None,
    groups: Sequence[str],
    graders: Sequence[Detector],
) -> pa.Table:
    """The solutions of a part: what depends on recipe and seed only, the same bits in every run.

    Solve i of `numbers` [T] is target i // repeats, repeat i % repeats; `names` has a name a row, `groups` those of
    `GROUPS` that are there beside the columns that always are; of each grader there are four columns.
    """
    columns = _identity(arm, numbers, repeats, names) | _verdict(rows)
    for group, make in GROUPS.items():
        if group in groups:
            columns |= make(rows)
    for grader in graders:
        columns |= _graded(rows, grader)
    return pa.table(columns)


def keep_own_words(solutions: pa.Table) -> pa.Table:
    """Solutions whose words hang on their rows alone, and stand in the order in which they come."""
    for name in OWN_WORDS:
        if name in solutions.column_names:
            words = solutions[name].cast(pa.string()).combine_chunks().dictionary_encode()
            solutions = solutions.set_column(solutions.column_names.index(name), name, words)
    return solutions


def make_timing(arm: str, rows: SolveResults, *, numbers: Ints, repeats: int) -> pa.Table:
    """What depends on the machine: seconds and host of each solve of a part."""
    columns = _identity(arm, numbers, repeats, None)
    columns["solve_seconds"] = pa.array(rows.found.seconds)
    columns["host"] = _word(socket.gethostname(), len(rows))
    return pa.table(columns)


def _identity(arm: str, numbers: Ints, repeats: int, names: pa.Array | Sequence[str] | None) -> Columns:
    columns: Columns = {"arm": _word(arm, len(numbers)), "target": pa.array(numbers // repeats)}
    if names is not None:
        columns["target_name"] = pa.array(names, pa.string()).dictionary_encode()
    columns["repeat"] = _integers(numbers % repeats)
    return columns


def _verdict(rows: SolveResults) -> Columns:
    return {
        "reached": pa.array(rows.reached),
        "collision": _verdicts(rows.collision),
        "verified": _verdicts(rows.verified),
        "stop_reason": _coded(rows.stop_reasons, WORDS),
    }


def _joints(rows: SolveResults) -> Columns:
    return {f"q_{name}": pa.array(rows.q[:, k]) for k, name in enumerate(rows.problem.robot.joint_names)}


def _errors(rows: SolveResults) -> Columns:
    return {name: pa.array(getattr(rows, name)) for name in ("position_error_m", "orientation_error_rad")}


def _clearance(rows: SolveResults) -> Columns:
    return _closest(rows.outcomes.metrics, rows.problem.collision)


def _cost(rows: SolveResults) -> Columns:
    return {
        "attempts": _integers(rows.attempts),
        "evaluations": pa.array(rows.evaluations),
        "rejected": _integers(rows.rejected),
    }


def _reason(rows: SolveResults) -> Columns:
    """Why not, and what would help; null where the target was reached."""
    missed, stories = np.flatnonzero(~rows.reached), rows.outcomes.explanations
    codes = np.full(len(rows), -1)
    codes[missed], reasons = _reasons(rows, missed)
    looked_into = sorted(stories)
    hints, helped = _words_and_codes([stories[row].hint for row in looked_into])
    hinted = np.full(len(rows), -1)
    hinted[looked_into] = helped
    return {"reason": _coded(codes, reasons), "hint": _coded(hinted, hints)}


def _reasons(rows: SolveResults, missed: Ints) -> tuple[Ints, list[str]]:
    """The reasons of rows that were missed, as codes and words: one is put into words for all that tell the same."""
    stories, found = rows.outcomes.explanations, rows.found
    own = np.array([row if row in stories else -1 for row in missed.tolist()] if stories else np.full(len(missed), -1))
    facts = (own, rows.stop_reasons[missed], found.engine[missed], rows.attempts[missed], rows.rejected[missed])
    _, first, which = np.unique(
        np.column_stack([*facts, found.excess_m[missed], found.excess_rad[missed], found.ruled_out[missed]]),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    words, codes = _words_and_codes([rows.reason(int(missed[row])) for row in first])
    return np.array(codes, dtype=np.int64)[which.ravel()], words


def _words_and_codes(words: Sequence[str | None]) -> tuple[list[str], list[int]]:
    """Different words in the order in which they come, and the index of each; -1 for None."""
    known: dict[str, int] = {}
    codes = [-1 if word is None else known.setdefault(word, len(known)) for word in words]
    return list(known), codes


def _target(rows: SolveResults) -> Columns:
    """What was asked for. Of an axis target only the quaternion's z axis counts; a position target has none."""
    targets, quats = rows.targets, np.zeros((len(rows), 4))
    oriented = targets.kind != POSITION
    if oriented.any():
        quats[oriented] = quat_wxyz_from_rotation(targets.R_world_tool[oriented])
    return (
        {"target_kind": _coded(targets.kind, KINDS)}
        | {f"target_{axis}_m": pa.array(targets.p_world_tool[:, k]) for k, axis in enumerate("xyz")}
        | {f"target_q{axis}": pa.array(quats[:, k], mask=~oriented) for k, axis in enumerate("wxyz")}
    )


def _graded(rows: SolveResults, grader: Detector) -> Columns:
    collision = CollisionModel(robot=rows.problem.robot, detector=grader)
    seen = compute_clearances(collision, rows.q)
    columns = _closest(seen, collision)
    columns["collides"] = _verdicts(seen.collides)
    return {f"{grader.name}_{name}": columns[name] for name in ("clearance_m", "collides", "pair_a", "pair_b")}


def _closest(seen: Metrics | Clearances, collision: CollisionModel) -> Columns:
    """Clearance and the pair it is between, null where there is no pair."""
    names = list(dict.fromkeys(name for pair in collision.pairs for name in pair))
    sides = np.array([*([names.index(a), names.index(b)] for a, b in collision.pairs), [-1, -1]])  # -1: no pair
    return {
        "clearance_m": pa.array(seen.clearance_m, mask=seen.closest_pair < 0),
        "pair_a": _coded(sides[seen.closest_pair, 0], names),
        "pair_b": _coded(sides[seen.closest_pair, 1], names),
    }


GROUPS: Mapping[str, Callable[[SolveResults], Columns]] = {
    "q": _joints,
    "errors": _errors,
    "clearance": _clearance,
    "cost": _cost,
    "reason": _reason,
    "target": _target,
}


def _verdicts(column: MaskedBools) -> pa.Array:
    """True, false, or null where nothing was checked."""
    return pa.array(column.data, mask=np.ma.getmaskarray(column))


def _integers(values: Ints) -> pa.Array:
    return pa.array(values.astype(np.int32))


def _word(word: str, count: int) -> pa.Array:
    return _coded(np.zeros(count, dtype=np.int64), [word])


def _coded(codes: Ints, words: Sequence[str]) -> pa.Array:
    """Words by their index; null where it is negative."""
    indices = pa.array(codes.astype(np.int32), mask=codes < 0)
    return pa.DictionaryArray.from_arrays(indices, pa.array(words, pa.string()))
