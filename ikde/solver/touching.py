"""Pairs that touch whatever the joints do, so that nothing is free, and pairs that stand close without ever moving."""

import json
import re
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector, Pairs, Robot
from ikde.model.validate import NON_ADJACENT
from ikde.solver.plain import compute_gaps

CONFIGURATIONS = 1_000
FIRST = 16  # of them: few pairs are left after these
ROOM = 2**22  # gaps at a time, of pairs or of the spheres of one: 100 MB
CLOSE_M, STILL_M = 0.02, 1e-9  # a gap that could be asked for as a margin; what rounding may move it by
TO_FILL_IN = "why they may touch"
PLAIN_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")  # a key that YAML reads as it is


@dataclass(frozen=True, slots=True, kw_only=True)
class AlwaysTouching:
    """Pairs of a detector that touch in every configuration that was drawn, and how to leave them out."""

    pairs: Pairs
    remedy: str
    """What to do if they may touch, in a few words."""
    lines: tuple[str, ...]
    """What to write into the robot's file for it, with reasons to fill in; nothing for a pair list of the file."""

    def __str__(self) -> str:
        named = ", ".join(f"{a} - {b}" for a, b in self.pairs)
        touch = "touches" if len(self.pairs) == 1 else "touch"
        return f"{named} {touch} in each of {CONFIGURATIONS:,} random configurations"


@lru_cache(maxsize=64)
def find_always_touching(collision: CollisionModel) -> AlwaysTouching | None:
    """Pairs within the safe distance in each of 1,000 random configurations inside the limits, the same every time."""
    robot, detector = collision.robot, collision.detector
    if detector is None:
        return None
    drawn = draw_configurations(robot)
    pairs, done = collision.pairs, 0
    while pairs and done < CONFIGURATIONS:
        piece = drawn[done : done + min(count_at_once(collision, pairs), FIRST if done == 0 else CONFIGURATIONS)]
        largest = compute_gaps(collision, piece, pairs).max(axis=0)
        pairs = tuple(pair for pair, gap in zip(pairs, largest, strict=True) if gap <= collision.limit_m)
        done += len(piece)
    if not pairs:
        return None
    remedy, lines = _leave_out(robot, detector, pairs)
    return AlwaysTouching(pairs=pairs, remedy=remedy, lines=lines)


@dataclass(frozen=True, slots=True, kw_only=True)
class StandingPair:
    """A pair with one clearance in every configuration that was drawn: no safe distance may be as large."""

    a: str
    b: str
    clearance_m: float


@lru_cache(maxsize=64)
def find_standing(collision: CollisionModel) -> tuple[StandingPair, ...]:
    """Compared pairs that are free, but at one and the same gap of at most 20 mm; closest first."""
    if collision.detector is None:
        return ()
    drawn = draw_configurations(collision.robot)
    pairs, done, least, most = collision.pairs, 0, np.array(np.inf), np.array(-np.inf)
    while pairs and done < CONFIGURATIONS:
        piece = drawn[done : done + min(count_at_once(collision, pairs), FIRST if done == 0 else CONFIGURATIONS)]
        gaps = compute_gaps(collision, piece, pairs)
        least, most = np.minimum(least, gaps.min(axis=0)), np.maximum(most, gaps.max(axis=0))
        stands = (most - least <= STILL_M) & (least > collision.limit_m) & (most <= CLOSE_M)
        pairs = tuple(pair for pair, is_still in zip(pairs, stands, strict=True) if is_still)
        least, most, done = least[stands], most[stands], done + len(piece)
    gaps_m = np.reshape(least, -1)[: len(pairs)].tolist()
    found = (StandingPair(a=a, b=b, clearance_m=gap) for (a, b), gap in zip(pairs, gaps_m, strict=True))
    return tuple(sorted(found, key=lambda pair: pair.clearance_m))


def draw_configurations(robot: Robot) -> Floats:
    """The 1,000 random configurations [K, N] inside the limits, the same every time."""
    return np.random.default_rng(0).uniform(*robot.drawn, (CONFIGURATIONS, len(robot.joints)))


def count_at_once(collision: CollisionModel, pairs: Pairs) -> int:
    """Configurations for whose gaps there is room."""
    spheres: Counter[str] = Counter()
    for row in collision.rows:
        spheres[row.component] += row.count
    return max(1, ROOM // max(len(pairs), *(spheres[a] * spheres[b] for a, b in pairs)))


def _leave_out(robot: Robot, detector: Detector, pairs: Pairs) -> tuple[str, tuple[str, ...]]:
    if detector.pairs != NON_ADJACENT:
        return f"take {'it' if len(pairs) == 1 else 'them'} out of the pair list {detector.pairs}", ()
    entries: dict[str, dict[str, str]] = {}
    for a, b in pairs:
        entries.setdefault(a, {pair.b: pair.reason for pair in robot.adjacent if pair.a == a})[b] = TO_FILL_IN
    lines = tuple(f"{_quote(a)}: {_flow(others)}" for a, others in entries.items())
    if robot.adjacent:
        return "write under adjacent: pairs: of the robot file", lines
    return "add to the robot file", (f"adjacent: {{pairs: {{{', '.join(lines)}}}}}",)


def _flow(reasons: dict[str, str]) -> str:
    """`{b: "why"}`, as YAML in one line."""
    return f"{{{', '.join(f'{_quote(b)}: {json.dumps(why, ensure_ascii=False)}' for b, why in reasons.items())}}}"


def _quote(key: str) -> str:
    return key if PLAIN_WORD.fullmatch(key) else json.dumps(key, ensure_ascii=False)
