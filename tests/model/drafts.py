"""Drafts of a robot with nothing wrong, and what is made wrong in them."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.robot import Detector, Joint, Robot, SphereRow
from ikde.model.validate import check_robot
from tests.random_robots import make_frame


def make_joint(name="turn", **changes):
    return Joint(**{"name": name, "kind": "revolute", "lower": -1.0, "upper": 1.0, "home": 0.0, **changes})


def make_row(component="A", start="a", end="tool", **changes):
    return SphereRow(**{"component": component, "start": start, "end": end, "radius_m": 0.1, **changes})


def make_draft(**changes):
    """A robot of two joints and three components with nothing wrong; `changes` make it wrong."""
    parts = {
        "name": "draft",
        "title": "A draft",
        "joints": (make_joint("slide", kind="prismatic"), make_joint("turn")),
        "frames": (
            make_frame("b", "a", (0.2, 0, 0), joint="turn", axis=(0, 0, 1)),
            make_frame("a", "world", joint="slide", axis=(1, 0, 0)),
            make_frame("tool", "b", (0.3, 0, 0)),
        ),
        "tool": "tool",
        "approximations": {
            "fine": (
                make_row("G", "world", "world"),
                make_row("A", "a", "a"),
                make_row("B", "b", "tool", count=3),
            )
        },
        "adjacent": (),
        "pair_lists": {"some": (("G", "B"),)},
        "detectors": {"d": Detector(name="d", spheres="fine", pairs="some")},
        "default_detector": "d",
        "convention": "own",
        "conventions": {"other": {"turn": np.pi}},
        "provenance": {},
    }
    return Robot(**{**parts, **changes})


def reject(message, *where, **changes):
    """`check_robot` must raise this message at this path."""
    with pytest.raises(InputError) as caught:
        check_robot(make_draft(**changes))
    assert message in caught.value.message
    assert caught.value.where == where


def make_detector(**changes):
    return {"d": Detector(**{"name": "d", "spheres": "fine", "pairs": "some", **changes})}
