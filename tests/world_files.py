"""A world file with every kind of solid, and worlds compared to the bit."""

import numpy as np

GOOD = """\
units: {length: mm, angle: deg}
frames:
  table: {position: [500, 0, 400], rpy: [0, 0, 30]}
  tray: {frame: table, position: [0, 100, 0], quat_wxyz: [0.70710678, 0, 0, 0.70710678]}
obstacles:
  ball: {sphere: {radius: 50}, position: [100, 200, 300], margin: 5}
  top: {box: [800, 600, 30], frame: table, ignore: [base, wheels]}
  can: {cylinder: {radius: 30, height: 120}, frame: tray, group: loose}
  bar: {capsule: {radius: 10, height: 300}, rpy: [0, 90, 0], frame: flange}
  tip: {cone: {radius: 20, height: 60}, rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]]}
  wall: {half_space: {normal: [-1, 0, 0]}, position: [1500, 0, 0]}
  block: {hull: {points: [[0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100], [10, 10, 10]]}}
  dust: {cloud: {points: [[0, 0, 0], [10, 0, 0.1]], radius: 2}, frame: table}
  scan: {cloud: {path: clouds/scan.csv, radius: 3, length: m, drop_invalid: true}, group: loose}
  ground: {columns: {cell: 200, heights: [[10, 20], [10, 0]], base: -5}, position: [0, 0, -100]}
  rack:
    frame: table
    position: [1, 2, 3]
    parts:
      - {box: [10, 20, 30], position: [0, 0, 100], rpy: [10, 20, 30]}
      - {sphere: {radius: 5}}
switched_off: [loose]
"""
SCAN = "x,y,z\n0.1,0.2,0.3\nnan,0,0\n" + "".join(f"{k / 7!r},1e-3,{-k / 3!r}\n" for k in range(1200))


def write_good(folder):
    """The file, with the cloud that it names."""
    (folder / "clouds").mkdir(parents=True)
    (folder / "clouds" / "scan.csv").write_text(SCAN, encoding="utf-8")
    (folder / "world.yaml").write_text(GOOD, encoding="utf-8")
    return folder / "world.yaml"


def assert_same(a, b):
    """Names, numbers, groups: all equal, to the bit."""
    assert a.names == b.names
    assert a.switched_off == b.switched_off
    for one, other in zip(a.obstacles, b.obstacles, strict=True):
        assert same_bits(one.T_world_obstacle, other.T_world_obstacle)
        assert (one.frame, one.margin_m, one.ignore, one.group) == (
            other.frame,
            other.margin_m,
            other.ignore,
            other.group,
        )
        for s, t in zip(one.solids, other.solids, strict=True):
            assert (s.kind, s.size_m) == (t.kind, t.size_m)
            assert same_bits(s.T_obstacle_solid, t.T_obstacle_solid)
            assert same_bits(s.points, t.points)
            assert same_bits(s.triangles, t.triangles)
    assert a.digest == b.digest


def same_bits(a, b):
    if a is None or b is None:
        return a is b
    return (
        a.dtype == b.dtype
        and a.shape == b.shape
        and np.ascontiguousarray(a).tobytes() == np.ascontiguousarray(b).tobytes()
    )
