"""Which tests of spheres the proofs leave; written down for ikde's own robots, as proving takes 0.05 to 0.15 s.

What is written down is found by a digest of all that the proofs depend on, their code among it, so that it is passed
over where anything of that is another one. `benchmarks/ship_proofs.py` writes it.
"""

import hashlib
import json
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import RobotArrays
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import Test, list_tests
from ikde.model.generate.proofs import drop_implied, drop_proved, proof_margin

WRITTEN = Path(__file__).with_name("left_tests.json")
DIGITS = 12  # decimals of numbers that a digest depends on: the last ones differ from machine to machine
PROVING = ("../apart.py", "collision.py", "lattice.py", "proofs.py")


class Left(NamedTuple):
    """What is left of the tests of a collision model, and why the others are not."""

    every: int
    implied: int
    proved: int
    tests: list[Test]


def find_left(robot: RobotArrays, collision: CollisionModel) -> Left:
    """Tests that may fail within `Robot.written_ranges`, none implying another: written down, or else proved."""
    known = read_written().get(digest_proofs(robot, collision))
    if known is None:
        return prove_left(robot, collision)
    every, (implied, *numbers) = list_tests(collision.arrays), known
    return Left(len(every), implied, len(every) - implied - len(numbers), [every[k] for k in numbers])


def prove_left(robot: RobotArrays, collision: CollisionModel) -> Left:
    """The same without looking it up."""
    every = list_tests(collision.arrays)
    margin, ranges = proof_margin(collision), collision.robot.written_ranges
    needed = drop_implied(every)
    tests = drop_proved(robot, needed, margin, *ranges) if np.isfinite(margin) else needed
    return Left(len(every), len(every) - len(needed), len(needed) - len(tests), tests)


def write_left(left: Left) -> list[int]:
    """What stands written: how many are implied, then the numbers of those that are left."""
    return [left.implied, *(test.number for test in left.tests)]


@lru_cache(maxsize=1)
def read_written() -> dict[str, list[int]]:
    """Digest -> what `write_left` gave."""
    return json.loads(WRITTEN.read_bytes()) if WRITTEN.is_file() else {}


def digest_proofs(robot: RobotArrays, collision: CollisionModel) -> str:
    """SHA-256, hex, of all that the proofs depend on."""
    digest = hashlib.sha256(_own_source() + repr(proof_margin(collision)).encode())
    for array in (*robot, *collision.arrays[1:-1], *collision.robot.written_ranges):
        digest.update(repr(np.shape(array)).encode() + (np.round(array, DIGITS) + 0.0).tobytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _own_source() -> bytes:
    return b"".join((Path(__file__).parent / name).read_bytes() for name in PROVING)
