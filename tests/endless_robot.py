"""An arm whose first and last joints turn without end, beside some that turn twice, and the same with limits."""

ENDLESS = """\
name: endless
units: {length: m, angle: deg}
joints:
  pan:   {kind: continuous, max_speed: 90}
  lift:  {kind: revolute, lower: -110, upper: 110, home: 30}
  elbow: {kind: revolute, lower: -150, upper: 150, home: 60}
  roll:  {kind: revolute, lower: -360, upper: 360}
  bend:  {kind: revolute, lower: -120, upper: 120, home: 40}
  spin:  {kind: continuous, home: 90}
frames:
  column:   {parent: world, joint: pan, axis: [0, 0, 1]}
  shoulder: {parent: column, xyz: [0.1, 0, 0.4], joint: lift, axis: [0, 1, 0]}
  upper:    {parent: shoulder, xyz: [0, 0, 0.4], joint: elbow, axis: [0, 1, 0]}
  fore:     {parent: upper, xyz: [0, 0, 0.15], joint: roll, axis: [0, 0, 1]}
  wrist:    {parent: fore, xyz: [0, 0, 0.25], joint: bend, axis: [0, 1, 0]}
  hand:     {parent: wrist, xyz: [0, 0, 0.1], joint: spin, axis: [0, 0, 1]}
  upper_end: {parent: shoulder, xyz: [0, 0, 0.4]}
  tip:      {parent: hand, xyz: [0.05, 0, 0.05]}
tool: tip
spheres:
  round:
    - {component: post, from: column, radius: 0.12}
    - {component: arm, from: shoulder, to: upper_end, radius: 0.06, count: 5, spacing: even}
    - {component: hand, from: hand, to: tip, radius: 0.04, count: 2, spacing: even}
detectors:
  round: {spheres: round, safe_distance: 0.005}
"""
LIMITED = ENDLESS.replace("kind: continuous", "kind: revolute, lower: -180, upper: 180")
"""Once around, with a seam at the far side of zero."""
