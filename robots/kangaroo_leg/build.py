"""Draws the left leg of Kangaroo. Run as ``python -m robots.kangaroo_leg.build [FOLDER]``.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Sphere, Vector3, ball, cross, prismatic, revolute, unit, write

# Points of the published description, to 0.1 mm, in the pose with the hip at zero, the sole flat and the nut of the
# leg-length actuator 30 mm up its screw. From the knee down, all lies in planes y = const.
YAW_MOUNT = (-0.1151, 0.0988, -0.0308)
YAW_EAR = (-0.0260, 0.1185, -0.0308)
HIP_YAW = (-0.0150, 0.0800, -0.0585)
HIP = (0.0000, 0.0800, -0.1772)
HIP_ROD_TOP = (-0.0894, 0.1469, -0.1949)
THIGH_TOP = (0.0000, 0.1469, -0.2672)
TRIANGLE = (-0.0399, 0.1469, -0.2696)
TRIANGLE_HIP_ROD = (-0.0772, 0.1469, -0.2841)
TRIANGLE_THIGH_ROD = (-0.0763, 0.1469, -0.3519)
NUT = (0.1265, 0.1469, -0.4453)
KNEE = (0.2358, 0.1469, -0.5652)
SHIN_PIN = (0.1995, 0.1469, -0.6476)
ANKLE = (-0.0023, 0.1469, -0.8613)
SOLE = (-0.0030, 0.1469, -0.8915)

#: Up the screw of the leg-length actuator.
SCREW = (-0.4596, 0.0, 0.8881)

# The two actuators of hip pitch and roll are beside each other: x and z of their points.
HIP_BRACKET = (-0.0040, -0.0846)
HIP_MOUNT = (0.0475, -0.0846)
HIP_BALL = (0.0600, -0.1772)

# The chain from each ankle actuator to the foot: x and z of its points, from the actuator down.
ANKLE_MOUNT = (-0.0751, -0.2239)
CRANK_ACTUATOR = (-0.0287, -0.2874)
CRANK_ROD = (-0.0459, -0.3059)
BUTTERFLY_THIGH_ROD = (0.1899, -0.6038)
BUTTERFLY_SHIN_ROD = (0.1794, -0.5448)
FOOT_ROD = (-0.0587, -0.8408)

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
RIGHT = (0.0, -1.0, 0.0)
UP = (0.0, 0.0, 1.0)
DOWN = (0.0, 0.0, -1.0)
#: The roll axis of the foot falls backward, 20 degrees from the sole.
ANKLE_ROLL_AXIS = (-math.cos(math.radians(20.0)), 0.0, math.sin(math.radians(20.0)))

# Forces and velocities as published.
ACTUATOR = Motor(effort=2000.0, velocity=0.4)
LENGTH_ACTUATOR = Motor(effort=5000.0, velocity=0.625)

PELVIS = (
    Box((-0.1, 0.0, 0.01), (0.19, 0.242, 0.04), mass=2.5),
    Box((-0.11, 0.0, -0.05), (0.12, 0.08, 0.09), mass=1.998),
)

MATERIALS = {
    "shell": (0.58, 0.62, 0.68, 1.0),
    "leg": (0.24, 0.25, 0.28, 1.0),
    "motor": (0.5, 0.52, 0.55, 1.0),
    "steel": (0.52, 0.53, 0.56, 1.0),
    "rod": (0.85, 0.5, 0.15, 1.0),
}


@dataclass(frozen=True, slots=True)
class HipActuator:
    """A linear actuator of the hip, from a universal joint to a ball.

    Attributes:
        place: Part of the names of its bodies.
        parent: Body that its bracket hangs from, the cross of the universal joint; None for the pelvis.
        bracket: Centre of the bracket's joint, m.
        axis: Axis of the bracket's joint, through the mount.
        mount: Centre of the universal joint, m.
        end: Centre of the ball, m.
        driven: Body that the ball is on.
        metres: Lowest and highest travel of the nut, seen from the drawn pose, m.
    """

    place: str
    parent: str | None
    bracket: Vector3
    axis: Vector3
    mount: Vector3
    end: Vector3
    driven: str
    metres: tuple[float, float]


YAW_ACTUATOR = HipActuator(
    place="yaw",
    parent=None,
    bracket=YAW_MOUNT,
    axis=DOWN,
    mount=YAW_MOUNT,
    end=YAW_EAR,
    driven="hip_yaw",
    metres=(-0.024, 0.0104),
)


@dataclass(frozen=True, slots=True)
class AnkleChain:
    """A chain from a linear actuator at the hip to the foot: the planes y (m) that its parts lie in.

    Attributes:
        place: Part of the names of its bodies.
        actuator: Plane of the actuator and of the upper end of the rod along the thigh.
        crank: Of the pivot of the crank.
        thigh_rod: Of the lower end of the rod along the thigh.
        butterfly: Of the pivot of the butterfly.
        shin_rod: Of the upper end of the rod along the shin.
        foot: Of its lower end.
    """

    place: str
    actuator: float
    crank: float
    thigh_rod: float
    butterfly: float
    shin_rod: float
    foot: float


ANKLE_CHAINS = (
    AnkleChain("outer", 0.1949, 0.2069, 0.2129, 0.1849, 0.1899, 0.1819),
    AnkleChain("inner", 0.0989, 0.0869, 0.0809, 0.1089, 0.1039, 0.1119),
)


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = Drawing(
        "kangaroo_leg",
        materials=MATERIALS,
        metadata={
            "description": "Left leg of PAL Robotics' Kangaroo on a fixed pelvis, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of PAL Robotics' MuJoCo description kangaroo_full.xml",
        },
    )
    robot.body("pelvis", None, *PELVIS, material="shell", contacts=PELVIS)
    draw_leg(robot)
    return robot


def draw_leg(robot: Drawing, side: str = "") -> None:
    """The left leg, from a body ``pelvis``; ``side`` begins the names of its bodies and closures."""
    draw_hip(robot, side)
    draw_hip_actuator(robot, side, YAW_ACTUATOR)
    for place, y in (("outer", 0.1150), ("inner", 0.0450)):
        actuator = HipActuator(
            place=place,
            parent="hip_yaw",
            bracket=at(HIP_BRACKET, y),
            axis=FORWARD,
            mount=at(HIP_MOUNT, y),
            end=at(HIP_BALL, y),
            driven="hip",
            metres=(-0.05, 0.05),
        )
        draw_hip_actuator(robot, side, actuator)
    draw_thigh(robot, side)
    draw_shin(robot, side)
    draw_leg_length(robot, side)
    for chain in ANKLE_CHAINS:
        draw_ankle_chain(robot, side, chain)


def draw_hip(robot: Drawing, side: str) -> None:
    """The hip from yaw through pitch to roll."""
    robot.body(
        f"{side}hip_yaw",
        revolute(f"free_{side}hip_z", "pelvis", HIP_YAW, UP, degrees=(-15.0, 40.0)),
        Cylinder((-0.015, 0.08, -0.075), (-0.015, 0.08, -0.025), radius=0.03, mass=0.13),
        Cylinder((-0.015, 0.08, -0.0308), YAW_EAR, radius=0.009, mass=0.03),
        Cylinder((-0.004, 0.04, -0.0846), (-0.004, 0.12, -0.0846), radius=0.012, mass=0.12),
        Cylinder((-0.012, 0.08, -0.0846), HIP, radius=0.016, mass=0.299),
        material="leg",
    )
    robot.body(
        f"{side}hip_cross",
        revolute(f"free_{side}hip_y", f"{side}hip_yaw", HIP, LEFT, degrees=(-42.5, 38.0)),
        Cylinder((0.0, 0.052, -0.1772), (0.0, 0.108, -0.1772), radius=0.012, mass=0.0905),
        material="steel",
    )
    yoke = Box((0.03, 0.08, -0.1772), (0.08, 0.09, 0.018), mass=0.35)
    bridge = Box((-0.045, 0.147, -0.212), (0.11, 0.115, 0.025), mass=0.6)
    robot.body(
        f"{side}hip",
        revolute(f"free_{side}hip_x", f"{side}hip_cross", HIP, FORWARD, degrees=(-27.0, 27.0)),
        yoke,
        bridge,
        Box((0.0, 0.115, -0.198), (0.03, 0.11, 0.052), mass=0.3),
        Cylinder(HIP_ROD_TOP, (-0.0894, 0.1469, -0.212), radius=0.014, mass=0.05),
        Cylinder((0.0, 0.1469, -0.212), THIGH_TOP, radius=0.016, mass=0.092),
        Cylinder((0.0, 0.08, -0.2672), (0.0, 0.2138, -0.2672), radius=0.012, mass=0.3),
        material="leg",
        contacts=(yoke, bridge),
    )


def draw_hip_actuator(robot: Drawing, side: str, actuator: HipActuator) -> None:
    """An actuator: bracket, motor, nut and piston.

    The piston turns freely in the nut that drives it. It is cut, and a 6d closure holds what hangs from the ball to it.
    """
    name, mount, end = f"{side}hip_{actuator.place}", actuator.mount, actuator.end
    parent = f"{side}{actuator.parent}" if actuator.parent else "pelvis"
    line = unit((end[0] - mount[0], end[1] - mount[1], end[2] - mount[2]))
    across = unit(cross(actuator.axis, line))
    cut = along(end, line, -0.025)
    robot.body(
        f"{name}_bracket",
        revolute(f"free_{name}_bracket", parent, actuator.bracket, actuator.axis),
        Cylinder(along(mount, actuator.axis, -0.055), along(mount, actuator.axis, -0.025), radius=0.01, mass=0.05),
        Cylinder(along(mount, across, -0.031), along(mount, across, 0.031), radius=0.008, mass=0.106),
        material="leg",
    )
    robot.body(
        f"{name}_motor",
        revolute(f"free_{name}_motor", f"{name}_bracket", mount, across),
        Cylinder(along(mount, line, -0.055), along(mount, line, 0.015), radius=0.027, mass=0.666),
        material="motor",
    )
    robot.body(
        f"{name}_nut",
        prismatic(f"motor_{name}", f"{name}_motor", mount, line, metres=actuator.metres, motor=ACTUATOR),
        Cylinder(along(mount, line, -0.04), along(mount, line, 0.02), radius=0.011, mass=0.06),
        material="steel",
    )
    robot.body(
        f"{name}_piston",
        revolute(f"free_{name}_piston", f"{name}_nut", along(mount, line, 0.02), line),
        Cylinder(along(mount, line, 0.02), cut, radius=0.009, mass=0.045),
        material="steel",
    )
    robot.body(
        f"{name}_end",
        ball(f"ball_{name}_end", f"{side}{actuator.driven}", end),
        Cylinder(cut, end, radius=0.009, mass=0.025),
        Sphere(end, radius=0.012, mass=0.012),
        material="rod",
    )
    robot.close(f"{name}_piston", "6d", f"{name}_piston", f"{name}_end", cut)


def draw_thigh(robot: Drawing, side: str) -> None:
    """The thigh, with the motor and the screw of the leg-length actuator."""
    motor = Cylinder(along(NUT, SCREW, 0.148), along(NUT, SCREW, 0.228), radius=0.045, mass=1.7)
    rails = [Cylinder(beside(THIGH_TOP, y), beside(KNEE, y), radius=0.012, mass=0.4) for y in (0.1189, 0.1749)]
    robot.body(
        f"{side}thigh",
        revolute(f"free_{side}thigh", f"{side}hip", THIGH_TOP, LEFT, degrees=(5.0, 75.0), drawn=51.6),
        motor,
        *rails,
        Cylinder(along(NUT, SCREW, -0.05), along(NUT, SCREW, 0.148), radius=0.008, mass=0.137),
        Cylinder(beside(TRIANGLE, 0.1269), beside(TRIANGLE, 0.1669), radius=0.01, mass=0.05),
        Cylinder(TRIANGLE, THIGH_TOP, radius=0.01, mass=0.05),
        Cylinder(beside(KNEE, 0.1069), beside(KNEE, 0.1869), radius=0.012, mass=0.1),
        material="leg",
        contacts=(motor, *rails),
    )


def draw_shin(robot: Drawing, side: str) -> None:
    """The shin, the ankle's cross, from pitch to roll, and the foot."""
    tube = Cylinder(KNEE, ANKLE, radius=0.018, mass=0.4)
    robot.body(
        f"{side}shin",
        revolute(f"free_{side}knee", f"{side}thigh", KNEE, RIGHT, degrees=(15.0, 145.0), drawn=102.8),
        tube,
        Cylinder(KNEE, SHIN_PIN, radius=0.018, mass=0.225),
        Cylinder(beside(SHIN_PIN, 0.1269), beside(SHIN_PIN, 0.1669), radius=0.01, mass=0.08),
        material="leg",
        contacts=(tube,),
    )
    robot.body(
        f"{side}ankle_cross",
        # PAL states -42.5 to 38 against the line from thigh to ankle, which the shin leaves by -18.8 to 40.9 from here.
        revolute(f"free_{side}ankle_y", f"{side}shin", ANKLE, LEFT, degrees=(-83.4, 56.8)),
        Cylinder(beside(ANKLE, 0.1219), beside(ANKLE, 0.1719), radius=0.01, mass=0.0906),
        material="steel",
    )
    sole = Box(SOLE, (0.24, 0.09, 0.025), mass=0.647)
    heels = [
        Cylinder((FOOT_ROD[0], y, SOLE[2]), (FOOT_ROD[0], y, FOOT_ROD[1]), radius=0.009, mass=0.04)
        for y in (0.1119, 0.1819)
    ]
    robot.body(
        f"{side}foot",
        revolute(f"free_{side}ankle_x", f"{side}ankle_cross", ANKLE, ANKLE_ROLL_AXIS, degrees=(-27.0, 27.0)),
        sole,
        Cylinder(SOLE, ANKLE, radius=0.015, mass=0.1),
        *heels,
        material="shell",
        contacts=(sole,),
    )


def draw_leg_length(robot: Drawing, side: str) -> None:
    """What folds the leg: the nut pushes the shin, and a triangle on the thigh makes hip and knee fold alike."""
    robot.body(
        f"{side}nut",
        prismatic(
            f"motor_{side}leg_length",
            f"{side}thigh",
            NUT,
            SCREW,
            metres=(0.0, 0.149),
            drawn=0.03,
            motor=LENGTH_ACTUATOR,
        ),
        Cylinder(along(NUT, SCREW, -0.02), along(NUT, SCREW, 0.04), radius=0.02, mass=0.442),
        Cylinder(beside(NUT, 0.1189), beside(NUT, 0.1749), radius=0.01, mass=0.15),
        material="steel",
    )
    robot.body(
        f"{side}triangle",
        revolute(f"free_{side}triangle", f"{side}thigh", TRIANGLE, RIGHT),
        Cylinder(TRIANGLE, TRIANGLE_HIP_ROD, radius=0.008, mass=0.03),
        Cylinder(TRIANGLE, TRIANGLE_THIGH_ROD, radius=0.008, mass=0.044),
        Cylinder(TRIANGLE_HIP_ROD, TRIANGLE_THIGH_ROD, radius=0.008, mass=0.034),
        material="motor",
    )
    for name, start, end, mass in (
        ("hip_rod", (f"{side}hip", HIP_ROD_TOP), (f"{side}triangle", TRIANGLE_HIP_ROD), 0.1247),
        ("thigh_rod", (f"{side}triangle", TRIANGLE_THIGH_ROD), (f"{side}shin", SHIN_PIN), 0.2209),
        ("knee_rod", (f"{side}nut", NUT), (f"{side}shin", SHIN_PIN), 0.3247),
    ):
        robot.rod(f"{side}{name}", start, end, radius=0.008, mass=mass, material="rod", ends=("ball", "point"))


def draw_ankle_chain(robot: Drawing, side: str, chain: AnkleChain) -> None:
    """From an actuator at the hip over a crank there and a butterfly at the knee to the foot."""
    name = f"{side}ankle_{chain.place}"
    mount, end = at(ANKLE_MOUNT, chain.actuator), at(CRANK_ACTUATOR, chain.actuator)
    line = unit((end[0] - mount[0], 0.0, end[2] - mount[2]))
    crank_axle, crank_end = beside(THIGH_TOP, chain.crank), at(CRANK_ROD, chain.actuator)
    knee = beside(KNEE, chain.butterfly)
    upper, lower = at(BUTTERFLY_THIGH_ROD, chain.thigh_rod), at(BUTTERFLY_SHIN_ROD, chain.shin_rod)
    robot.body(
        f"{name}_crank",
        revolute(f"free_{name}_crank", f"{side}hip", crank_axle, RIGHT),
        Cylinder(crank_axle, end, radius=0.009, mass=0.034),
        Cylinder(end, crank_end, radius=0.009, mass=0.033),
        material="motor",
    )
    robot.body(
        f"{name}_motor",
        ball(f"ball_{name}_motor", f"{side}hip", mount),
        Cylinder(along(mount, line, -0.055), along(mount, line, 0.015), radius=0.027, mass=0.664),
        material="motor",
    )
    robot.body(
        f"{name}_piston",
        prismatic(f"motor_{name}", f"{name}_motor", mount, line, metres=(-0.021, 0.0245), motor=ACTUATOR),
        Cylinder(along(mount, line, -0.04), end, radius=0.009, mass=0.112),
        Sphere(end, radius=0.012, mass=0.012),
        material="steel",
    )
    robot.close(f"{name}_piston", "3d", f"{name}_piston", f"{name}_crank", end)
    robot.body(
        f"{name}_butterfly",
        revolute(f"free_{name}_butterfly", f"{side}thigh", knee, RIGHT),
        Cylinder(knee, upper, radius=0.009, mass=0.06),
        Cylinder(knee, lower, radius=0.009, mass=0.06),
        material="motor",
    )
    for part, start, target, mass in (
        ("thigh_rod", (f"{name}_crank", crank_end), (f"{name}_butterfly", upper), 0.1096),
        ("shin_rod", (f"{name}_butterfly", lower), (f"{side}foot", at(FOOT_ROD, chain.foot)), 0.1486),
    ):
        robot.rod(f"{name}_{part}", start, target, radius=0.006, mass=mass, material="rod", ends=("ball", "point"))


def along(start: Vector3, direction: Vector3, distance: float) -> Vector3:
    """The point at a distance (m) from another in a direction (of unit length)."""
    return (
        start[0] + distance * direction[0],
        start[1] + distance * direction[1],
        start[2] + distance * direction[2],
    )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


def at(point: tuple[float, float], y: float) -> Vector3:
    """The point (x, z) of a plane ``y`` (m)."""
    return (point[0], y, point[1])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
