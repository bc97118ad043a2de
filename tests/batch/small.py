"""Batches made by hand, small enough for tests."""

import numpy as np

import ikde
from ikde.batch.plan import Arm, Batch
from ikde.batch.sources import ListSource
from ikde.solver.columns import GROUPS
from tests.flat_settings import flat_settings
from tests.problems import problem_of

ROBOT = ikde.load_robot("qiao2021")
BLINK = {"population": 6, "generations": 1, "restarts": 1}  # a search that ends before it finds anything
FAR = (9.0, 9.0, 9.0)


def make_targets(count):
    points = np.random.default_rng(5).uniform((-1.0, -1.0, 0.4), (1.0, 1.0, 1.2), (count, 3))
    return [ikde.Target(point) for point in points]


def target_bits(targets):
    return [(t.kind, t.p_world_tool.tobytes(), t.R_world_tool.tobytes()) for t in targets]


def make_arm(name="auto", detector=None, method="auto", **settings):
    chosen = flat_settings(ikde.SolveSettings.for_method(method), **settings)
    problem = problem_of(ROBOT, chosen, collision=detector)
    return Arm(name=name, method=chosen.method, problem=problem)


def make_batch(**changes):
    """Twelve targets twice, five solves a part; nothing is found, in no time."""
    facts = {
        "name": "small",
        "robot": ROBOT,
        "arms": (make_arm(**BLINK),),
        "source": ListSource(targets=make_targets(12)),
        "repeats": 2,
        "seed": 7,
        "chunk": 5,
        "graders": (),
        "columns": tuple(GROUPS),
        "explain": False,
        "recipe": {"seed": changes.get("seed", 7)},
        "file": None,
    }
    return Batch(**(facts | changes))


def read_files(folder, kind="solutions"):
    """Name -> bytes of the parts of a run."""
    return {path.name: path.read_bytes() for path in sorted((folder / kind).iterdir())}
