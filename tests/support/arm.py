"""The smallest robot that moves, without a closure: one link that turns on its base."""

from __future__ import annotations

URDF = """\
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"""
DESCRIPTION = 'extended_urdf: "2.0"\nactuators: [shoulder]\n'
