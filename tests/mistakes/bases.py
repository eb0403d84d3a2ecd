"""Two valid robots in which mistakes are made: a biped with a rod at each knee, and an ankle with two rods."""

from __future__ import annotations

from collections.abc import Iterator

LIMIT = '    <limit lower="{}" upper="{}" effort="{}" velocity="{}"/>\n'


def link(name: str, mass: float, centre: str, ixx: float, iyy: float, izz: float) -> str:
    moments = f'ixx="{ixx!r}" ixy="0" ixz="0" iyy="{iyy!r}" iyz="0" izz="{izz!r}"'
    return (
        f'  <link name="{name}">\n    <inertial>\n      <origin xyz="{centre}" rpy="0 0 0"/>\n'
        f'      <mass value="{mass!r}"/>\n      <inertia {moments}/>\n    </inertial>\n  </link>\n'
    )


def joint(name: str, kind: str, parent: str, child: str, xyz: str, axis: str = "", limit: str = "") -> str:
    line = f'    <axis xyz="{axis}"/>\n' if axis else ""
    return (
        f'  <joint name="{name}" type="{kind}">\n    <origin xyz="{xyz}" rpy="0 0 0"/>\n    <parent link="{parent}"/>\n'
        f'    <child link="{child}"/>\n{line}{limit}  </joint>\n'
    )


def point(name: str, parent: str, xyz: str) -> str:
    return f'  <link name="{name}"/>\n' + joint(f"{name}_place", "fixed", parent, name, xyz)


def leg(side: str, y: float) -> Iterator[str]:
    """A leg whose knee is driven by a crank at the hip and a rod; y is 1 for the left one, -1 for the right one."""
    yield link(f"{side}_thigh", 2.1, f"0.004 {y * 0.01:g} -0.17", 0.026, 0.025, 0.004)
    yield link(f"{side}_shank", 1.3, "0 0 -0.16", 0.013, 0.013, 0.0011)
    yield link(f"{side}_foot", 0.5, f"0.03 {y * 0.002:g} -0.03", 0.0004, 0.0016, 0.0015)
    yield link(f"{side}_crank", 0.12, "-0.025 0 0", 2e-05, 5e-05, 5e-05)
    yield link(f"{side}_rod", 0.09, "-0.006 0 -0.165", 0.0009, 0.0009, 1e-05)
    thigh, shank, hip = f"{side}_thigh", f"{side}_shank", LIMIT.format(-1.3, 1.1, 90, 14)
    yield joint(f"{side}_hip_motor", "revolute", "pelvis", thigh, f"0 {y * 0.11:g} -0.05", "0 1 0", hip)
    limit = LIMIT.format(-0.5, 0.9, 70, 18)
    crank = f"0.02 {y * 0.04:g} -0.06"
    yield joint(f"{side}_knee_motor", "revolute", thigh, f"{side}_crank", crank, "0 1 0", limit)
    yield joint(f"{side}_crank_pin", "continuous", f"{side}_crank", f"{side}_rod", "-0.055 0 0", "0 1 0")
    limit = LIMIT.format(-0.6, 1.2, 0, 20)
    yield joint(f"{side}_knee", "revolute", thigh, shank, f"0 {y * 0.015:g} -0.36", "0 1 0", limit)
    limit = LIMIT.format(-0.8, 0.7, 45, 12)
    yield joint(f"{side}_ankle_motor", "revolute", shank, f"{side}_foot", "0 0 -0.34", "0 1 0", limit)
    yield link(f"{side}_toe", 0.1, "0.02 0 0", 2e-05, 5e-05, 5e-05)
    follows = LIMIT.format(-0.45, 0.45, 0, 20) + f'    <mimic joint="{side}_ankle_motor" multiplier="-0.5"/>\n'
    yield joint(f"{side}_toe_pin", "revolute", f"{side}_foot", f"{side}_toe", "0.09 0 -0.05", "0 1 0", follows)
    yield point(f"{side}_rod_end", f"{side}_rod", "-0.013 0 -0.33")
    yield point(f"{side}_lever_end", shank, f"-0.048 {y * 0.025:g} -0.03")


BIPED = (
    f'<robot name="biped">\n{link("pelvis", 6.5, "-0.01 0 0.02", 0.05, 0.03, 0.06)}'
    f"{''.join(leg('left', 1))}{''.join(leg('right', -1))}</robot>\n",
    """\
extended_urdf: "2.1"
urdf: robot.urdf
root: floating
closures:
  - name: left_rod_pin
    type: 3d
    frames: [left_rod_end, left_lever_end]
  - name: right_rod_pin
    type: 3d
    frames: [right_rod_end, right_lever_end]
actuators:
  - {joint: left_hip_motor, gear_ratio: 9, rotor_inertia: 6e-05}
  - {joint: left_knee_motor, gear_ratio: 9, rotor_inertia: 6e-05}
  - left_ankle_motor
  - {joint: right_hip_motor, gear_ratio: 9, rotor_inertia: 6e-05}
  - {joint: right_knee_motor, gear_ratio: 9, rotor_inertia: 6e-05}
  - right_ankle_motor
configurations:
  assembled: {}
  raised: {left_hip_motor: -0.4, left_ankle_motor: 0.2}
""",
)


def side_of_ankle(side: str, y: float) -> Iterator[str]:
    """A motor whose crank moves the foot by a rod that is welded to a ball in the foot."""
    limit = LIMIT.format(-0.7, 0.7, 30, 15)
    yield link(f"crank_{side}", 0.06, "-0.02 0 0", 8e-06, 2e-05, 2e-05)
    yield link(f"rod_{side}", 0.05, "0 0 -0.11", 0.0002, 0.0002, 4e-06)
    yield link(f"ball_{side}", 0.01, "0 0 0", 1e-06, 1e-06, 1e-06)
    yield joint(f"motor_{side}", "revolute", "shank", f"crank_{side}", f"0 {y * 0.04:g} -0.12", "0 1 0", limit)
    yield joint(f"cardan_{side}", "revolute", f"crank_{side}", f"rod_{side}", "-0.045 0 0", "1 0 0", FREE)
    yield joint(f"spherical_{side}", "revolute", "foot", f"ball_{side}", f"-0.045 {y * 0.04:g} 0.01", "0 0 1", FREE)
    yield point(f"end_of_rod_{side}", f"rod_{side}", "0 0 -0.2")
    yield point(f"middle_of_ball_{side}", f"ball_{side}", "0 0 0")


FREE = LIMIT.format(-1.5, 1.5, 0, 30)
ANKLE = (
    f'<robot name="ankle">\n{link("thigh", 3.0, "0 0 -0.15", 0.03, 0.03, 0.006)}'
    f"{link('shank', 1.8, '0 0 -0.14', 0.017, 0.017, 0.0015)}{link('cross', 0.08, '0 0 0', 1e-05, 1e-05, 1e-05)}"
    f"{link('foot', 0.7, '0.03 0 -0.03', 0.0005, 0.0023, 0.0022)}"
    f"{joint('motor_knee', 'revolute', 'thigh', 'shank', '0 0 -0.3', '0 1 0', LIMIT.format(0, 1.8, 80, 14))}"
    f"{joint('pitch', 'revolute', 'shank', 'cross', '0 0 -0.33', '0 1 0', LIMIT.format(-0.6, 0.6, 0, 20))}"
    f"{joint('roll', 'revolute', 'cross', 'foot', '0 0 0', '1 0 0', LIMIT.format(-0.4, 0.4, 0, 20))}"
    f"{''.join(side_of_ankle('a', 1))}{''.join(side_of_ankle('b', -1))}</robot>\n",
    """\
extended_urdf: "2.0"
urdf: robot.urdf
closures:
  - name: weld_a
    type: 6d
    frames: [end_of_rod_a, middle_of_ball_a]
  - name: weld_b
    type: 6d
    frames: [end_of_rod_b, middle_of_ball_b]
joints:
  cardan_a: {type: universal, axes: xy}
  cardan_b: {type: universal, axes: xy}
  spherical_a: spherical
  spherical_b: spherical
actuators: [motor_knee, motor_a, motor_b]
configurations:
  assembled: {}
""",
)
