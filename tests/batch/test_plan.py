"""A batch counts its solves and knows whether another gives the same answers."""

from dataclasses import replace

from ikde.batch.plan import Arm, Batch
from ikde.batch.sources import ListSource
from ikde.model.target import Target
from tests.problems import problem_of


def make_batch(robot, **changes):
    problem = problem_of(robot)
    batch = Batch(
        name="made",
        robot=robot,
        arms=(Arm(name="auto", method="auto", problem=problem),),
        source=ListSource(targets=[Target((0, 0, 1)), Target((1, 0, 1))]),
        repeats=3,
        seed=0,
        chunk=2,
        graders=(),
        columns=("q",),
        explain=False,
        recipe={"seed": 0, "arms": {"auto": {"population": 50}}},
        file=None,
    )
    return replace(batch, **changes)


def test_solves_are_targets_times_repeats(qiao):
    assert make_batch(qiao).solves == 6


def test_the_hash_is_that_of_the_recipe(qiao):
    batch = make_batch(qiao)
    assert len(batch.hash) == 64
    assert batch.hash == make_batch(qiao, name="another", file="a.yaml").hash
    assert batch.hash != make_batch(qiao, recipe={**batch.recipe, "seed": 1}).hash
