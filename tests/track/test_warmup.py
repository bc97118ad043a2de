"""What is warmed up serves tracks of every kind, on either drive."""

import numpy as np
import pytest

import ikde
from ikde.kernels.jit import compile_clock
from ikde.solver.warmup import warm_up
from ikde.track.follow_path import follow_path
from ikde.track.warmup import list_track_stages


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
def test_a_track_then_compiles_nothing(qiao, drive):
    stage = next(stage for stage in list_track_stages(qiao) if stage.name == "track, continuation")
    warm_up([stage])
    p, R = np.array([[0.8, 0.2, 0.9], [0.8, 0.202, 0.9]]), np.tile(np.eye(3), (2, 1, 1))
    for turn in (None, R):
        with compile_clock() as clock:
            motion = follow_path(qiao, ikde.ToolPath.through(p, dt_s=0.02, R_world_tool=turn), drive=drive)
        assert motion.reached
        assert clock.seconds == 0.0


def test_every_method_has_a_stage():
    names = [stage.name for stage in list_track_stages(ikde.load_robot("ur5"))]
    assert names == ["track, continuation", "track, optimized", "track, typical"]
