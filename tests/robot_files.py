"""A robot file as a user writes it, and the robot in such a text."""

from pathlib import Path
from tempfile import TemporaryDirectory

import ikde

GOOD = """\
name: two
units: {length: mm, angle: deg}
sources:
  ours: {kind: calibrated, text: "made up"}
joints:
  slide: {kind: prismatic, lower: -100, upper: 1e3, source: ours}
  turn: {kind: revolute, lower: -90, upper: 90, home: 10}
frames:
  rail: {parent: world, joint: slide, axis: [1, 0, 0], source: {axis: ours}}
  arm:  {parent: rail, xyz: [0, 0, 500], joint: turn, axis: [0, 1, 0]}
  tip:  {parent: arm, xyz: [0, 0, 250.5], rpy: [0, 90, 0]}
tool: tip
spheres:
  coarse:
    - {component: box, from: rail, radius: 200}
    - {component: bar, from: arm, to: tip, radius: 20, count: 4, spacing: even}
pairs:
  all: {pairs: {box: [bar]}}
detectors:
  coarse: {spheres: coarse, pairs: all, safe_distance: 5}
default_detector: coarse
"""
NAMES = ("two", "ours", "slide", "turn", "rail", "arm", "tip", "coarse", "box", "bar", "all")  # in GOOD


def load_text(text):
    """The robot in a file with this text."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "robot.yaml"
        path.write_text(text, encoding="utf-8")
        return ikde.load_robot(path)
