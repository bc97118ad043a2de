"""The arm of [Zhang2022], and where its runs start."""

import numpy as np

from ikde.paper.mecanum_arm import MecanumArm
from ikde.paper.null_space import load_zhang

NUMBERS = load_zhang()
ARM = MecanumArm.of(NUMBERS)
START = np.array(NUMBERS["calibrated"]["start_rad"])
