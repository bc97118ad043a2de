"""What a page says of worlds: solved by world and by blocker, and a worst row looked at again."""

from dataclasses import replace

from ikde.batch.statistics import Rate
from ikde.report.batch_page.clearance import make_clearance
from ikde.report.batch_page.worlds import make_worlds
from ikde.report.page import Table


def test_solved_by_world_and_by_blocker(placed):
    by_world, by_blocker = (block for block in make_worlds(placed).blocks if isinstance(block, Table))
    rates = {arm.facts.world: arm.rate for arm in placed.arms}
    assert rates["kitchen"].count < rates["none"].count
    assert [row[:3] for row in by_world.rows] == [(n, "12", f"{rates[n].count}") for n in ("none", "kitchen")]
    assert by_world.rows[1][-1].startswith("can")
    blocked = by_blocker.rows[0]
    assert blocked[:2] == ("kitchen", "can")
    assert int(blocked[2]) == placed.arms[1].blockers["can"] > 0


def test_a_run_in_no_world_says_nothing_of_any(placed):
    bare = tuple(replace(arm, world=None) for arm in placed.manifest.arms)
    assert make_worlds(replace(placed, manifest=replace(placed.manifest, arms=bare))) is None
    assert sum((arm.rate for arm in placed.arms), Rate(0, 0)).total == 24


def test_clearance_is_that_from_obstacles_too_in_a_world(placed, answers):
    notes = [make_clearance(run).blocks[0].note for run in (placed, answers)]
    assert ["from an obstacle" in note for note in notes] == [True, False]
