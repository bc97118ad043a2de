"""Two arms on one waist, as URDF: all joints about z, so that hands can meet in front of the torso."""

ARM = """\
  <link name="SIDE_upper">
    <collision><origin xyz="0.12 0 0"/><geometry><sphere radius="0.06"/></geometry></collision>
    <collision><origin xyz="0.22 0 0"/><geometry><sphere radius="0.06"/></geometry></collision>
  </link>
  <link name="SIDE_fore">
    <collision><origin xyz="0.15 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
    <collision><origin xyz="0.25 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <link name="SIDE_hand"/>
  <joint name="SIDE_shoulder" type="revolute">
    <parent link="torso"/><child link="SIDE_upper"/><origin xyz="0 PLACE 0.4"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="10"/>
  </joint>
  <joint name="SIDE_elbow" type="continuous">
    <parent link="SIDE_upper"/><child link="SIDE_fore"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="SIDE_wrist" type="fixed">
    <parent link="SIDE_fore"/><child link="SIDE_hand"/><origin xyz="0.3 0 0"/>
  </joint>
"""
DUAL = f"""\
<robot name="dual">
  <link name="base"/>
  <link name="torso"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="waist" type="revolute">
    <parent link="base"/><child link="torso"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="10"/>
  </joint>
{ARM.replace("SIDE", "left").replace("PLACE", "0.2")}
{ARM.replace("SIDE", "right").replace("PLACE", "-0.2")}
</robot>
"""
TOOLS = {"left": "left_hand", "right": "right_hand"}
