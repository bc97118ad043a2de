"""URDF as people write it, in pieces: a small arm, and whatever a test does to it."""

from pathlib import Path

ARM = """\
<?xml version="1.0"?>
<robot name="arm">
  <link name="base_link"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.2" rpy="0 0 0.5"/><mass value="2"/>
      <inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0.01" ixz="0" iyz="0.02"/>
    </inertial>
    <collision><origin xyz="0 0 0.3"/><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <link name="fore"><collision><geometry><sphere radius="0.04"/></geometry></collision></link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/><parent link="base_link"/><child link="upper"/><axis xyz="0 1 1"/>
    <limit lower="-1.5" upper="2" velocity="1.2" effort="30"/>
  </joint>
  <joint name="slide" type="prismatic">
    <origin xyz="0.1 0 0.5"/><parent link="upper"/><child link="fore"/><limit lower="0.1" upper="0.4" velocity="0"/>
  </joint>
  <joint name="flange" type="fixed"><origin xyz="0 0 0.1"/><parent link="fore"/><child link="tip"/></joint>
</robot>
"""
FINGERS = """\
  <link name="left"/><link name="right"/>
  <joint name="grip" type="prismatic">
    <parent link="fore"/><child link="left"/><limit lower="0.01" upper="0.05"/>
  </joint>
  <joint name="grip_mimic" type="prismatic">
    <parent link="fore"/><child link="right"/><limit lower="-0.1" upper="0.1"/>
    <mimic joint="grip" multiplier="-2" offset="0.003"/>
  </joint>
"""


def change(old, new):
    """The arm with a piece exchanged, which is there."""
    assert old in ARM
    return ARM.replace(old, new)


def extend(piece):
    """The arm with more in it."""
    return change("</robot>", f"{piece}</robot>")


def joint(name, kind, parent, child, inside=""):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


def write(folder, text, name="arm.urdf"):
    path = Path(folder) / name
    path.write_text(text, encoding="utf-8")
    return path
