"""Sources make the same targets however they are cut."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.batch.sources import FreedomSource, GoalSource, ListSource, PointSource, take_goals
from ikde.formats.table_targets import TableSource
from ikde.model.region import Region
from ikde.model.target import Target
from tests.batch.small import target_bits

few = settings(max_examples=25)
POSITIONS = np.arange(30.0).reshape(10, 3)
AXES = np.array([[1.0 + k, 2.0, 3.0 - k] for k in range(10)])


SOURCES = {
    "list": ListSource(targets=[Target(p) for p in POSITIONS]),
    "positions": TableSource(positions=POSITIONS, kind=None, orientations=None),
    "axes": TableSource(positions=POSITIONS, kind="axis", orientations=AXES),
    "rpy": TableSource(positions=POSITIONS, kind="rpy", orientations=AXES),
    "quaternions": TableSource(positions=POSITIONS, kind="quat_wxyz", orientations=np.ones((10, 4))),
    "points": PointSource(count=10, make_points=lambda a, b: POSITIONS[a:b], orientation={"R_world_tool": np.eye(3)}),
}


@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES)
@few
@given(cut=st.integers(0, 10))
def test_any_cut_gives_the_same_targets(source, cut):
    whole = target_bits(source.read(0, source.count))
    assert len(whole) == source.count == 10
    assert target_bits(source.read(0, cut)) + target_bits(source.read(cut, 10)) == whole


@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES)
def test_reading_past_the_end_gives_what_there_is(source):
    assert len(source.read(8, 99)) == 2


@pytest.mark.parametrize(
    ("source", "kind"), [("positions", "position"), ("axes", "axis"), ("rpy", "pose"), ("quaternions", "pose")]
)
def test_a_row_becomes_its_kind_of_target(source, kind):
    target = SOURCES[source].read(4, 5)[0]
    assert target.kind == kind
    np.testing.assert_array_equal(target.p_world_tool, POSITIONS[4])


def test_goals_with_freedom_are_lists_however_they_are_cut():
    free = GoalSource(goals=[Region.box(p, 0.1) for p in POSITIONS[:5]], names=tuple("abcde"))
    same = FreedomSource(source=SOURCES["points"], loosen=lambda target: Region.box(target, 0.1))
    for source in (free, same):
        whole = source.read(0, 99)
        assert len(whole) == source.count
        assert source.read(1, 3) + source.read(3, 5) == whole[1:5]
        assert take_goals(whole, np.array([4, 0, 0])) == [whole[4], whole[0], whole[0]]
    assert (free.names, same.names) == (tuple("abcde"), None)
    assert GoalSource(goals=[Target(POSITIONS[0])]).read(0, 1) == [Target(POSITIONS[0])]
    assert target_bits(take_goals(SOURCES["list"].read(0, 9), np.array([2]))) == target_bits([Target(POSITIONS[2])])
