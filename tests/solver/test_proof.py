"""A proof counts beyond the tolerances only, and is the same for one target and for many."""

import numpy as np
import pytest

import ikde
from ikde.model.target import Targets
from ikde.solver.proof import prove, prove_many
from tests.problems import problem_of
from tests.scara import make_scara


@pytest.mark.parametrize(
    ("far_m", "off_rad", "proved"),
    [
        (0.0, 0.0, (0, 0)),
        (0.02, 0.0, (1, 0)),
        (0.005, 0.0, (0, 0)),
        (0.0, 0.2, (0, 1)),
        (0.0, 0.05, (0, 0)),
        (1, 1, (1, 1)),
    ],
)
def test_what_is_off_by_more_than_the_tolerance_is_excluded(far_m, off_rad, proved):
    settings = ikde.SolveSettings(position_tolerance_m=0.01, orientation_tolerance_rad=0.1)
    problem = problem_of(make_scara(), settings)
    target = ikde.Target((0.8 + far_m, 0.0, 0.0), axis_world_tool=(np.sin(off_rad), 0.0, -np.cos(off_rad)))
    found = prove(problem, target)
    assert found == pytest.approx((far_m * proved[0], off_rad * proved[1]), abs=1e-12)
    far, off = prove_many(problem, Targets.of([target, target]))
    assert list(zip(far.tolist(), off.tolist(), strict=True)) == [found, found]
