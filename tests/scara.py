"""An arm whose tool stays vertical: what it reaches is known by hand."""

from dataclasses import replace

import numpy as np

from tests.random_robots import make_frame, make_robot


def make_scara(quill_m=1.0):
    """Two links and a wrist about the vertical, a quill along it; the tool points down."""
    robot = make_robot(
        {"j1": "revolute", "j2": "revolute", "quill": "prismatic", "wrist": "revolute"},
        [
            make_frame("a", "world", joint="j1", axis=(0, 0, 1)),
            make_frame("b", "a", (0.5, 0, 0), joint="j2", axis=(0, 0, 1)),
            make_frame("c", "b", (0.3, 0, 0), joint="quill", axis=(0, 0, -1)),
            make_frame("d", "c", joint="wrist", axis=(0, 0, 1)),
            make_frame("tool", "d", rpy=(np.pi, 0, 0)),
        ],
    )
    quill = replace(robot.joints[2], lower=-quill_m, upper=quill_m, home=0.0)
    return replace(robot, joints=(*robot.joints[:2], quill, robot.joints[3]))
