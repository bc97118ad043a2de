"""Places of the base: inside the polygon and the base's ranges, and only where the target is in reach."""

import numpy as np

import ikde
from ikde.model.base_motion import need_base
from ikde.model.base_region import BaseRegion
from ikde.solver.base_places import BasePlaces
from ikde.solver.proof import prove
from tests.problems import TARGET, problem_of

ELL = BaseRegion([(0, -1), (1.2, -1), (1.2, 0.2), (0.3, 0.2), (0.3, 1.5), (0, 1.5)])
CORNERS = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])


def test_each_place_is_inside(qiao):
    places, boxes = BasePlaces(problem_of(qiao), ELL, 0, 0), set()
    x, y, _ = need_base(qiao)
    for number in range(1, 60):
        asked = places.narrow(number, TARGET)
        low, high = asked.lower[[x, y]], asked.upper[[x, y]]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        assert ELL.contains(middle + CORNERS * half).all()
        assert prove(asked, TARGET) == (0.0, 0.0)
        assert ((low == high) == np.isin(["d_x", "d_y"], asked.frozen)).all()
        boxes.add(tuple(middle))
    assert len(boxes) > 30


def test_the_first_is_the_box_about_the_polygon(qiao):
    places = BasePlaces(problem_of(qiao), ELL, 0, 0)
    asked = places.narrow(0, TARGET)
    assert asked is places.whole
    assert asked.lower[:2].tolist() == [0.0, -1.0]
    assert asked.upper[:2].tolist() == [1.2, 1.5]


def test_where_nothing_is_in_reach_there_is_no_place(qiao):
    places = BasePlaces(problem_of(qiao), ELL, 0, 0)
    assert places.narrow(1, ikde.Target((9.0, 0.5, 1.0))) is None


def test_ranges_hold(qiao):
    asked = problem_of(qiao, freeze={"d_x": 0.1})
    places = BasePlaces(asked, ELL, 0, 0)
    assert places.whole.lower[0] == places.whole.upper[0] == 0.1
    assert places.narrow(3, TARGET).lower[0] == 0.1
