"""A robot of one joint: the least that can touch itself, compiled in a moment."""

from ikde.model.robot import Detector, SphereRow
from tests.random_robots import make_frame, make_robot


def tiny_robot():
    """One joint, whose tool can touch a post."""
    points = [make_frame("post", "world", (0.5, 0.0, 0.2)), make_frame("tool", "arm", (0.5, 0, 0))]
    frames = [make_frame("arm", "world", (0, 0, 0.2), joint="turn", axis=(0, 0, 1)), *points]
    rows = tuple(SphereRow(component=name, start=name, end=name, radius_m=0.1) for name in ("post", "tool"))
    return make_robot(
        {"turn": "revolute"},
        frames,
        lower=-2.0,
        upper=2.0,
        approximations={"spheres": rows},
        pair_lists={"some": (("post", "tool"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
    )
