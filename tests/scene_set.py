"""Planning problems for the robot of three joints, as MotionBenchMaker writes them."""

SCENE = """
world:
  collision_objects:
    - id: can
      primitives: [{{type: cylinder, dimensions: [0.3, 0.05]}}]
      primitive_poses: [{{position: [{x}, 0, 0.9], orientation: [0, 0, 0, 1]}}]
"""
REQUEST = """
start_state: {joint_state: {name: [reach, turn, shoulder, finger], position: [0.1, 0, 0, 0.4]}}
goal_constraints:
  - joint_constraints:
      - {position: 0.25, joint_name: reach}
      - {joint_name: turn, position: 1.5}
      - {joint_name: shoulder, position: 0.7}
"""


def write_set(folder):
    """Two families: one problem is free, and in another a can stands where its tool should be."""
    for family, name, x in (("shelf", "0001", 3), ("shelf", "0002", 2), ("table", "0001", 3)):
        (folder / "problems" / family).mkdir(parents=True, exist_ok=True)
        (folder / "problems" / family / f"scene{name}.yaml").write_text(SCENE.format(x=x), encoding="utf-8")
        (folder / "problems" / family / f"request{name}.yaml").write_text(REQUEST, encoding="utf-8")
    return folder
