"""The text of a module: the engines' own source, with functions written for a robot in place of those of tables."""

import re
from pathlib import Path

from ikde.kernels import analytic, draws, lm
from ikde.kernels.arrays import RobotArrays
from ikde.kernels.tables import LANES
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import count_sphere_pairs, count_tests
from ikde.model.generate.functions import format_find, format_step, format_steps
from ikde.model.generate.left_tests import find_left
from ikde.model.generate.proofs import proof_margin
from ikde.model.pack import pack_robot

SWAPPED = re.compile(r"^from ikde\.kernels\.tables import .*\n", re.MULTILINE)
OWN_IMPORTS = (
    "from ikde.kernels.arrays import SafeDistance",
    "from ikde.kernels.jit import leaf_kernel",
    "from ikde.kernels.trig import sin_cos",
)
TABLE_IMPORT = "from ikde.kernels.tables import find_collision, make_buffers, unpack_used, use_models"
NO_TABLES = '''def use_models(robot, collision):
    """Straight-line code takes the safe distance only: arrays that are handed on cost a tenth of a search in bulk."""
    return 0, SafeDistance(collision.safe_distance)


@leaf_kernel
def unpack_used(numbers, whole):
    """What straight-line code takes of both models, out of the block of a search.

    A literal would be a type of its own, and what draws targets would compile `find_collision` anew.
    """
    return np.int64(0), SafeDistance(numbers[0])


@leaf_kernel
def make_buffers(robot, collision, joints):
    """Straight-line code needs no buffers."""
    return np.int64(0)
'''


MAX_TESTS = 150
"""Beyond so many the check is that of `kernels/tables.py`, compiled in the same time whatever the number of spheres.

Written one by one, 91 tests of the panda take 190 ns in place of 298; 485 of one with 40 single spheres take 325 in
place of 292 and 7 s more to compile. A target in bulk costs the same. To prove pairs apart and to sort them saved less
than a tenth.
"""


def format_module(collision: CollisionModel, kind: str) -> str:
    """The text of a module."""
    robot, arrays, in_tables = collision.robot, pack_robot(collision.robot), count_tests(collision.arrays) > MAX_TESTS
    counts, *checks = (
        [f"{count_sphere_pairs(collision.arrays)} pairs of spheres, in tables."]
        if in_tables
        else _format_tests(arrays, collision)
    )
    sources = [lm, draws, *([analytic] if kind == "pose" and find_ur_arm(robot) else [])]
    imports, engines = zip(*(_split(Path(str(source.__file__))) for source in sources), strict=True)
    functions = [*checks[:1], format_step(arrays, kind), format_steps(arrays, kind), *checks[1:]]
    lines = {line for block in imports for line in block.splitlines() if line.startswith("from ikde")}
    own = [*sorted(lines), *OWN_IMPORTS, *([TABLE_IMPORT] if in_tables else [])]
    first = "\n".join(["import math", "", "import numpy as np", "", *own, "", f"LANES = {LANES}\n"])
    return "\n\n".join([_format_head(kind, len(robot.joints), counts), first, *functions]) + "".join(engines)


def _format_tests(arrays: RobotArrays, collision: CollisionModel) -> list[str]:
    """What is left out, in words; then `make_buffers` and `find_collision` as straight-line code."""
    left, margin = find_left(arrays, collision), proof_margin(collision)
    tested = f"{left.every} tests of rows and spheres, {left.implied} of them implied by others,"
    never = f"{left.proved} proved never to fail inside the joints' ranges, for a safe distance up to {margin:g} m"
    counts = f"{count_sphere_pairs(collision.arrays)} pairs of spheres; {tested}\n{never}; {len(left.tests)} left."
    return [counts, NO_TABLES, format_find(arrays, left.tests, *collision.robot.written_ranges)]


def _split(source: Path) -> tuple[str, str]:
    """Imports and body of an engine's source, without the line that imports the functions to be written."""
    before, after = SWAPPED.split(source.read_text(encoding="utf-8"))
    return before.split('"""\n', 2)[1], after


def _format_head(kind: str, joints: int, counts: str) -> str:
    """What the module is for, in numbers and in words of ikde's own: a name would be run with the rest."""
    return f'''"""Kernels of one robot for {kind} targets, written by ikde: straight-line code, q0 to q{joints - 1}.

{counts}
"""'''
