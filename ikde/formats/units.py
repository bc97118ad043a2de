"""Units that lengths and angles are written in."""

import math

LENGTHS_M = {"mm": 1e-3, "m": 1.0}
ANGLES_RAD = {"deg": math.pi / 180.0, "rad": 1.0}
