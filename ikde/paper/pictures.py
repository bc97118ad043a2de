"""Pictures of the robot with its spheres, as small as a page needs them."""

from collections.abc import Sequence

import numpy as np

from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.plot.images import to_png
from ikde.plot.pose import plot_pose
from ikde.report.page import Figure
from ikde.scene.drawn_pose import draw_pose

SIZE_IN, DPI = (6.4, 5.7), 84


def draw_robot(
    collision: CollisionModel, q: Sequence[float], *, caption: str, target_mm: Sequence[float] | None = None
) -> Figure:
    """The robot at `q` as a detector sees it: arm red, platform blue, colliding components black."""
    target = None if target_mm is None else Target(np.array(target_mm) * 1e-3)
    pose = draw_pose(collision, np.array(q), target=target)
    return Figure(image=to_png(plot_pose(pose, size_in=SIZE_IN), dpi=DPI), alt=caption, caption=caption)
