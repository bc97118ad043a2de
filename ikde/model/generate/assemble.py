"""The text of a module: the engines' own source, with functions written for a robot in place of those of tables."""

import re
from pathlib import Path

import numpy as np

from ikde.kernels import analytic, lm
from ikde.kernels.tables import LANES
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import count_sphere_pairs, list_tests
from ikde.model.generate.functions import format_find, format_judge, format_step, format_steps
from ikde.model.generate.proofs import drop_implied, drop_proved, proof_margin
from ikde.model.pack import pack_robot

SWAPPED = re.compile(r"^from ikde\.kernels\.tables import .*\n", re.MULTILINE)
OWN_IMPORTS = ("from ikde.kernels.jit import leaf_kernel", "from ikde.kernels.trig import sin_cos")
NO_BUFFERS = '''@leaf_kernel
def make_buffers(robot, collision, joints):
    """Straight-line code needs no buffers."""
    return 0
'''


def format_module(collision: CollisionModel, kind: str) -> str:
    """The text of a module."""
    robot, packed, margin = collision.robot, collision.arrays, proof_margin(collision)
    arrays = pack_robot(robot)
    every = list_tests(packed)
    needed = drop_implied(every)
    tests = drop_proved(arrays, needed, margin, robot.lower, robot.upper) if np.isfinite(margin) else needed
    sources = [lm, analytic] if kind == "pose" and find_ur_arm(robot) else [lm]
    imports, engines = zip(*(_split(Path(str(source.__file__))) for source in sources), strict=True)
    functions = [
        NO_BUFFERS,
        format_step(arrays, kind),
        format_steps(arrays, kind),
        format_find(arrays, tests, robot.lower, robot.upper),
        format_judge(arrays, tests),
    ]
    head = _format_head(
        kind, len(robot.joints), margin, (count_sphere_pairs(packed), len(every), len(needed), len(tests))
    )
    lines = sorted({line for block in imports for line in block.splitlines() if line.startswith("from ikde")})
    first = "\n".join(["import math", "", "import numpy as np", "", *lines, *OWN_IMPORTS, "", f"LANES = {LANES}\n"])
    return "\n\n".join([head, first, *functions]) + "".join(engines)


def _split(source: Path) -> tuple[str, str]:
    """Imports and body of an engine's source, without the line that imports the functions to be written."""
    before, after = SWAPPED.split(source.read_text(encoding="utf-8"))
    return before.split('"""\n', 2)[1], after


def _format_head(kind: str, joints: int, margin: float, counts: tuple[int, int, int, int]) -> str:
    """What the module is for, in numbers and in words of ikde's own: a name would be run with the rest."""
    pairs, every, needed, left = counts
    return f'''"""Kernels of one robot for {kind} targets, written by ikde: straight-line code, q0 to q{joints - 1}.

{pairs} pairs of spheres; {every} tests of rows and spheres, {every - needed} of them implied by others,
{needed - left} proved never to fail inside the joint limits, for a safe distance up to {margin:g} m; {left} left.
"""'''
