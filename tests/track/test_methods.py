"""Three methods behind one call: where they start, and which settings are theirs."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.track.follow_path import follow_path
from ikde.track.optimized import OptimizedSettings
from ikde.track.typical import TypicalSettings
from tests.track.paper_tasks import short_task, start_of


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_without_a_start_it_is_that_of_continuation(qiao, method):
    path = short_task(1, samples=2)
    motion = follow_path(qiao, path, method=method)
    np.testing.assert_array_equal(motion.q[0], follow_path(qiao, path, drive=motion.drive).q[0])
    assert motion.method == method
    assert motion.reached_points == 2
    assert len(motion.seconds) == 2
    assert motion.search_seconds > motion.seconds.sum()


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_a_start_that_is_elsewhere_is_refused(qiao, method):
    with pytest.raises(InputError, match="first pose"):
        follow_path(qiao, short_task(1), method=method, start=start_of("qiao2021", 3))


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_a_first_pose_out_of_reach_ends_all_at_once(qiao, method):
    motion = follow_path(qiao, short_task(1), method=method, freeze={"d_x": -4.0, "d_y": 0.0})
    assert motion.stop.reason == "out_of_reach"
    assert motion.stop.sample == 0
    assert len(motion.q) == 0


def test_settings_belong_to_their_method(qiao):
    with pytest.raises(InputError, match="method optimized: expected OptimizedSettings, got TypicalSettings"):
        follow_path(qiao, short_task(1), method="optimized", settings=TypicalSettings())
    with pytest.raises(InputError, match="method continuation: expected ContinuationSettings, got OptimizedSettings"):
        follow_path(qiao, short_task(1), settings=OptimizedSettings())
    with pytest.raises(InputError, match="expected one of continuation, optimized, typical"):
        follow_path(qiao, short_task(1), method="best")
