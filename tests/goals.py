"""Goals that several tests draw from: one of each kind, about one pose."""

from ikde.model.region import Region
from ikde.model.target import Target

POINT = Target((0.4, 0.2, 0.3))
AXIS = Target((0.4, 0.2, 0.3), axis_world_tool=(0, 0, -1))
POSE = Target.from_rpy((0.4, 0.2, 0.3), (0.1, 0.2, 0.3))
REGIONS = [
    Region.box(POINT, 0.01),
    Region.box(AXIS, (0.01, 0.02, 0.0)),
    Region.box(POSE, [(0.0, 0.1), (-0.1, 0.2), (0.0, 0.0)], (0.0, 0.0, 3.0)),
    Region.turn(POSE),
    Region.turn(POSE, (1, 0, 0), (-0.5, 0.2), position_m=0.01, frame="world"),
    Region.cone(AXIS, 0.2),
    Region.look_at((1.0, 0.0, 0.5), (0.3, 0.6)),
    Region.look_at((1.0, 0.0, 0.5), (0.3, 0.6), (1, 0, 0), 0.3),
    Region.any_of([POINT, POSE, Region.cone(AXIS, 0.2)], "best"),
]
