"""From finished searches to the columns of a part."""

import socket
from collections.abc import Sequence

import pyarrow as pa

from ikde.kernels.arrays import Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector
from ikde.solver.columns import (
    GROUPS,
    Columns,
    make_blockers,
    make_closest,
    make_integers,
    make_verdict,
    make_verdicts,
    make_word,
)
from ikde.solver.metrics import compute_clearances
from ikde.solver.results import SolveResults

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
    world: str | None = None,
) -> pa.Table:
    """The solutions of a part: what depends on recipe and seed only, the same bits in every run.

    Solve i of `numbers` [T] is target i // repeats, repeat i % repeats; `names` has a name a row, `groups` those of
    `GROUPS` that are there beside the columns that always are; of each grader there are four columns. Where the run is
    in a `world`, or in several, rows say in which, and what of it blocked.
    """
    columns = _identity(arm, numbers, repeats, names) | make_verdict(rows)
    if world is not None:
        columns["world"] = make_word(world, len(rows))
    for group, make in GROUPS.items():
        if group in groups:
            columns |= make(rows)
    if world is not None and "reason" in groups:
        columns |= make_blockers(rows)
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
    columns["host"] = make_word(socket.gethostname(), len(rows))
    return pa.table(columns)


def _identity(arm: str, numbers: Ints, repeats: int, names: pa.Array | Sequence[str] | None) -> Columns:
    columns: Columns = {"arm": make_word(arm, len(numbers)), "target": pa.array(numbers // repeats)}
    if names is not None:
        columns["target_name"] = pa.array(names, pa.string()).dictionary_encode()
    columns["repeat"] = make_integers(numbers % repeats)
    return columns


def _graded(rows: SolveResults, grader: Detector) -> Columns:
    collision = place_grader(rows.problem.collision, grader)
    seen = compute_clearances(collision, rows.q)
    columns = make_closest(seen, collision)
    columns["collides"] = make_verdicts(seen.collides)
    return {f"{grader.name}_{name}": columns[name] for name in ("clearance_m", "collides", "pair_a", "pair_b")}


def place_grader(collision: CollisionModel, grader: Detector) -> CollisionModel:
    """A grader in the world of an arm, with its margins; raises `InputError` for what the grader's spheres lack."""
    own = CollisionModel(robot=collision.robot, detector=grader)
    if not collision.is_in_world:
        return own
    known = {*own.components, *(thing.name for thing in collision.world.attached)}
    margins_m = {name: margin_m for name, margin_m in collision.margins_m if name in known}
    return own.in_world(collision.world, collision.margin_m, margins_m)
