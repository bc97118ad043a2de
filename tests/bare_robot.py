"""An arm on a planar base, whose shoulder carries no spheres; and what its spheres do, by hand."""

import numpy as np

BARE = """\
name: bare
title: an arm on a base, without spheres on the shoulder
joints:
  x: {kind: prismatic, lower: -2, upper: 2}
  y: {kind: prismatic, lower: -2, upper: 2}
  yaw: {kind: revolute, lower: -3.1416, upper: 3.1416}
  pan: {kind: revolute, lower: -6.2832, upper: 6.2832}
  lift: {kind: revolute, lower: -6.2832, upper: 6.2832, home: -1.5708}
  elbow: {kind: revolute, lower: -3.1416, upper: 3.1416, home: 1.5708}
frames:
  along: {parent: world, joint: x, axis: [1, 0, 0]}
  across: {parent: along, joint: y, axis: [0, 1, 0]}
  deck: {parent: across, joint: yaw, axis: [0, 0, 1]}
  platform: {parent: deck, xyz: [0, 0, 0.25]}
  shoulder: {parent: deck, xyz: [0.2, 0, 0.68], joint: pan, axis: [0, 0, 1]}
  upper_arm: {parent: shoulder, rpy: [1.5707963267948966, 0, 0], joint: lift, axis: [0, 0, 1]}
  upper_arm_start: {parent: upper_arm, xyz: [0, 0, 0.176]}
  upper_arm_end: {parent: upper_arm, xyz: [-0.613, 0, 0.176]}
  forearm: {parent: upper_arm, xyz: [-0.613, 0, 0], joint: elbow, axis: [0, 0, 1]}
  forearm_start: {parent: forearm, xyz: [0, 0, 0.04]}
  tip: {parent: forearm, xyz: [-0.572, 0, 0.04]}
tool: tip
spheres:
  s:
    - {component: platform, from: platform, radius: 0.35}
    - {component: upper_arm, from: upper_arm_start, to: upper_arm_end, radius: 0.075, count: 8, spacing: even}
    - {component: forearm, from: forearm_start, to: tip, radius: 0.06, count: 8, spacing: even}
detectors:
  d: {spheres: s, safe_distance: 0.01}
default_detector: d
"""


def platform_to_upper_arm(q):
    """Clearance [K] in m between platform and upper arm, worked out by hand for `q` [K, 6]."""
    x, y, yaw, pan, lift, _ = q.T
    turn = yaw + pan
    along = np.stack([-np.cos(turn) * np.cos(lift), -np.sin(turn) * np.cos(lift), -np.sin(lift)], axis=1)
    beside = np.stack([np.sin(turn), -np.cos(turn), np.zeros_like(turn)], axis=1)
    shoulder = np.stack([x + 0.2 * np.cos(yaw), y + 0.2 * np.sin(yaw), np.full_like(x, 0.68)], axis=1)
    platform = np.stack([x, y, np.full_like(x, 0.25)], axis=1)
    spheres = (shoulder + 0.176 * beside)[:, None] + np.linspace(0.0, 0.613, 8)[:, None] * along[:, None]
    return np.linalg.norm(spheres - platform[:, None], axis=2).min(axis=1) - 0.35 - 0.075
