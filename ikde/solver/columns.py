"""Finished searches as columns of a table, named with their units; null where nothing was checked."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import pyarrow as pa

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.model.target import KINDS, POSITION, Targets
from ikde.solver.engine_table import NAMES
from ikde.solver.engines.search_state import SearchState
from ikde.solver.grade import Outcomes
from ikde.solver.metrics import Clearances, Metrics
from ikde.solver.problem import Problem
from ikde.solver.result import STOP_REASONS, SolveResult
from ikde.solver.verify import MaskedBools

Columns = dict[str, Any]
WORDS = [str(reason) for reason in STOP_REASONS]


class Rows(Protocol):
    """What is read of `SolveResults`, which imports this module."""

    @property
    def problem(self) -> Problem:
        """What was searched."""
        ...

    @property
    def targets(self) -> Targets:
        """One a row."""
        ...

    @property
    def seed(self) -> int:
        """Of all rows."""
        ...

    @property
    def streams(self) -> Sequence[int]:
        """Random streams [T]."""
        ...

    @property
    def singles(self) -> Sequence[SolveResult] | None:
        """The rows as they are, where some goals have freedom."""
        ...

    @property
    def found(self) -> SearchState:
        """What the search found."""
        ...

    @property
    def outcomes(self) -> Outcomes:
        """What the graders say."""
        ...

    def __len__(self) -> int: ...

    def reason(self, index: int) -> str:
        """Why a row ended."""
        ...


def tabulate(rows: Rows) -> pa.Table:
    """A row a target: what repeats it, the verdict, and all groups of columns."""
    columns: Columns = {
        "seed": pa.array(np.full(len(rows), rows.seed, dtype=np.uint64)),
        "stream": pa.array(rows.streams, pa.int64()),
        "method": make_coded(rows.found.engine, NAMES),
    }
    columns |= make_verdict(rows)
    for make in GROUPS.values():
        columns |= make(rows)
    return pa.table(columns)


def make_verdict(rows: Rows) -> Columns:
    """Whether each row was reached, collides and was verified, and why its search ended."""
    outcomes = rows.outcomes
    return {
        "reached": pa.array(outcomes.reached),
        "collision": make_verdicts(outcomes.collision),
        "verified": make_verdicts(outcomes.verified),
        "stop_reason": make_coded(outcomes.stop_reasons, WORDS),
    }


def _joints(rows: Rows) -> Columns:
    return {f"q_{name}": pa.array(rows.found.q[:, k]) for k, name in enumerate(rows.problem.robot.joint_names)}


def _errors(rows: Rows) -> Columns:
    return {
        name: pa.array(getattr(rows.outcomes.metrics, name)) for name in ("position_error_m", "orientation_error_rad")
    }


def _clearance(rows: Rows) -> Columns:
    return make_closest(rows.outcomes.metrics, rows.problem.collision)


def _cost(rows: Rows) -> Columns:
    drawn = {} if rows.singles is None else {"poses": [single.poses for single in rows.singles]}
    return {
        "attempts": make_integers(rows.found.counts[:, ATTEMPTS]),
        "evaluations": pa.array(rows.found.counts[:, EVALUATIONS]),
        "rejected": make_integers(rows.found.counts[:, COLLIDING]),
        **{name: pa.array(counts, pa.int32()) for name, counts in drawn.items()},
    }


def _reason(rows: Rows) -> Columns:
    """Why not, and what would help; null where the target was reached."""
    missed, stories = np.flatnonzero(~rows.outcomes.reached), rows.outcomes.explanations
    codes = np.full(len(rows), -1)
    codes[missed], reasons = _reasons(rows, missed)
    looked_into = sorted(stories)
    hints, helped = _words_and_codes([stories[row].hint for row in looked_into])
    hinted = np.full(len(rows), -1)
    hinted[looked_into] = helped
    return {"reason": make_coded(codes, reasons), "hint": make_coded(hinted, hints)}


def make_blockers(rows: Rows) -> Columns:
    """The pair that was to blame most often, and how often, of rows that were not reached; the robot stands for what
    of it touched an obstacle. Null where nothing blocked."""
    pairs, worst = rows.problem.collision.counted, np.full((len(rows), 2), -1)
    for row in np.flatnonzero(~rows.outcomes.reached).tolist():
        story = rows.outcomes.explanations.get(row)
        counts = rows.found.pair_counts.row(row)[: len(pairs)]
        if story is not None and story.blocking_pairs:
            worst[row] = pairs.index(next(iter(story.blocking_pairs))), max(story.blocking_pairs.values())
        elif counts.any():
            worst[row] = counts.argmax(), counts.max()
    names = {name: place for place, name in enumerate(dict.fromkeys(name for pair in pairs for name in pair))}
    sides = np.array([*([names[a], names[b]] for a, b in pairs), [-1, -1]])  # -1: nothing
    return {
        "blocker_a": make_coded(sides[worst[:, 0], 0], list(names)),
        "blocker_b": make_coded(sides[worst[:, 0], 1], list(names)),
        "blocked": pa.array(np.maximum(worst[:, 1], 0).astype(np.int32)),
    }


def _reasons(rows: Rows, missed: Ints) -> tuple[Ints, list[str]]:
    """The reasons of rows that were missed, as codes and words: one is put into words for all that tell the same."""
    stories, found = rows.outcomes.explanations, rows.found
    own = np.array([row if row in stories else -1 for row in missed.tolist()] if stories else np.full(len(missed), -1))
    facts = (
        own,
        rows.outcomes.stop_reasons[missed],
        found.engine[missed],
        found.counts[missed, ATTEMPTS],
        found.counts[missed, COLLIDING],
    )
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


def _target(rows: Rows) -> Columns:
    """What was asked for. Of an axis target only the quaternion's z axis counts; a position target has none. Of a goal
    with freedom the exact pose that was drawn, and which alternative that is of."""
    targets, quats = rows.targets, np.zeros((len(rows), 4))
    oriented = targets.kind != POSITION
    if oriented.any():
        quats[oriented] = quat_wxyz_from_rotation(targets.R_world_tool[oriented])
    singles = rows.singles
    part = {} if singles is None else {"alternative": pa.array([one.alternative for one in singles], pa.int32())}
    return (
        part
        | {"target_kind": make_coded(targets.kind, KINDS)}
        | {f"target_{axis}_m": pa.array(targets.p_world_tool[:, k]) for k, axis in enumerate("xyz")}
        | {f"target_q{axis}": pa.array(quats[:, k], mask=~oriented) for k, axis in enumerate("wxyz")}
    )


def make_closest(seen: Metrics | Clearances, collision: CollisionModel) -> Columns:
    """Clearance and the pair it is between, null where there is no pair."""
    pairs = collision.all_pairs
    names = {name: place for place, name in enumerate(dict.fromkeys(name for pair in pairs for name in pair))}
    sides = np.array([*([names[a], names[b]] for a, b in pairs), [-1, -1]])  # -1: no pair
    clearance_m = collision.clearances_m(seen.clearance_m, seen.closest_pair)
    return {
        "clearance_m": pa.array(clearance_m, mask=seen.closest_pair < 0),
        "pair_a": make_coded(sides[seen.closest_pair, 0], list(names)),
        "pair_b": make_coded(sides[seen.closest_pair, 1], list(names)),
    }


GROUPS: Mapping[str, Callable[[Rows], Columns]] = {
    "q": _joints,
    "errors": _errors,
    "clearance": _clearance,
    "cost": _cost,
    "reason": _reason,
    "target": _target,
}


def make_verdicts(column: MaskedBools) -> pa.Array:
    """True, false, or null where nothing was checked."""
    return pa.array(column.data, mask=np.ma.getmaskarray(column))


def make_integers(values: Ints) -> pa.Array:
    """Small whole numbers."""
    return pa.array(values.astype(np.int32))


def make_word(word: str, count: int) -> pa.Array:
    """One word in every row."""
    return make_coded(np.zeros(count, dtype=np.int64), [word])


def make_coded(codes: Ints, words: Sequence[str]) -> pa.Array:
    """Words by their index; null where it is negative."""
    indices = pa.array(codes.astype(np.int32), mask=codes < 0)
    return pa.DictionaryArray.from_arrays(indices, pa.array(words, pa.string()))
