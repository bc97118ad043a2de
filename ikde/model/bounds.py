"""What is proved to be out of reach in given joint ranges, by the positions and the orientations of the tool."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.chain import find_chain
from ikde.model.orientation_reach import OrientationReach, bound_orientation
from ikde.model.reach import Reach, bound_reach
from ikde.model.robot import Robot
from ikde.model.target import Target, Targets


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bounds:
    """Both bounds, ready to be asked about targets."""

    reach: Reach
    orientation: OrientationReach

    def excess(self, target: Target) -> tuple[float, float]:
        """By how much the tool must miss a target at least, m and rad; 0 where a bound cannot tell."""
        return self.reach.excess_m(target.p_world_tool), self.orientation.excess_rad(target)

    def excess_of_many(self, targets: Targets) -> tuple[Floats, Floats]:
        """The same of many targets, [T] m and [T] rad: each as if it were the only one."""
        return self.reach.excess_of_many_m(targets.p_world_tool), self.orientation.excess_of_many_rad(targets)


def find_bounds(robot: Robot, lower: Floats, upper: Floats) -> Bounds:
    """The bounds in joint ranges `lower`, `upper` [N], those that hold after `freeze`; the last ones are kept."""
    return _find_bounds(robot, lower.tobytes(), upper.tobytes())


@lru_cache(maxsize=64)
def _find_bounds(robot: Robot, lower: bytes, upper: bytes) -> Bounds:
    chain = find_chain(robot, np.frombuffer(lower), np.frombuffer(upper))
    return Bounds(reach=bound_reach(chain), orientation=bound_orientation(chain))
