"""Draws the left hybrid leg of Disney Research's biped. Run as ``python -m robots.disney_leg.build [FOLDER]``.

World: x forward, y to the left, z up, the origin between the hips, as in the robot's published description; m, kg. The
leg is turned out, so its points are given along its own axes.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Joint, Motor, Vector3, ball, midpoint, revolute, write

#: By how much the leg is turned out about the vertical, rad.
TOE_OUT = math.radians(10.0)

#: How far the plane midway between the two chains of the leg lies to the left, mm.
MIDDLE = 64.4

#: How far from there, mm, lie the tubes of a chain, its servos, its rod, and the horn that moves the rod.
TUBES_OUT, SERVOS_OUT, ROD_OUT, HORN_OUT = 31.75, 30.0, 43.25, 50.4


def leg_point(forward: float, left: float, up: float) -> Vector3:
    """The point of the world (m) that lies so far from its origin along the axes of the leg (mm)."""
    x = forward * math.cos(TOE_OUT) - left * math.sin(TOE_OUT)
    y = forward * math.sin(TOE_OUT) + left * math.cos(TOE_OUT)
    return (x / 1000.0, y / 1000.0, up / 1000.0)


@dataclass(frozen=True, slots=True)
class Chain:
    """One of the two chains from the pelvis to the ankle: a five-bar linkage on a hip that rolls.

    The pivots are (forward, up) along the axes of the leg, mm, in the published pose.

    Attributes:
        name: Of the chain.
        side: The direction that leads out of the leg: 1 is left.
        hip: Pivot of the thigh; the hip rolls at its height.
        knee: Pivot of the shin on the thigh.
        ankle: Centre of the ankle.
        servo: Pivot of the horn.
        horn: Pin of the rod on the horn.
        shin: Pin of the rod on the shin.
    """

    name: str
    side: float
    hip: tuple[float, float]
    knee: tuple[float, float]
    ankle: tuple[float, float]
    servo: tuple[float, float]
    horn: tuple[float, float]
    shin: tuple[float, float]

    def point(self, at: tuple[float, float], out: float = TUBES_OUT) -> Vector3:
        """The point of the world (m) at a point of the chain, so far out from the middle of the leg (mm)."""
        return leg_point(at[0], MIDDLE + self.side * out, at[1])

    def on_shin(self, part: float) -> Vector3:
        """The point of the world (m) that part of the line from the knee to the ankle."""
        (knee_x, knee_z), (ankle_x, ankle_z) = self.knee, self.ankle
        return self.point((knee_x + part * (ankle_x - knee_x), knee_z + part * (ankle_z - knee_z)))

    @property
    def down_shin(self) -> Vector3:
        """Direction from the knee to the ankle, not of length 1."""
        return leg_point(self.ankle[0] - self.knee[0], 0.0, self.ankle[1] - self.knee[1])

    @property
    def across_shin(self) -> Vector3:
        """Direction across the shin and forward, not of length 1."""
        return leg_point(self.knee[1] - self.ankle[1], 0.0, self.ankle[0] - self.knee[0])


# Thighs are 110 mm long, shins 111, horns 47, rods 126.7; from the knee to the pin of the rod, 50.
INNER = Chain(
    name="inner",
    side=-1.0,
    hip=(26.2, -14.25),
    knee=(45.8, -122.5),
    ankle=(25.8, -231.7),
    servo=(50.2, 14.25),
    horn=(93.5, 32.4),
    shin=(86.9, -94.1),
)
OUTER = Chain(
    name="outer",
    side=1.0,
    hip=(27.2, -14.25),
    knee=(46.3, -122.6),
    ankle=(25.8, -231.7),
    servo=(51.2, 14.25),
    horn=(94.6, 32.1),
    shin=(87.5, -94.3),
)

FORWARD = leg_point(1.0, 0.0, 0.0)
LEFT = leg_point(0.0, 1.0, 0.0)
RIGHT = leg_point(0.0, -1.0, 0.0)
TURNED_OUT = (0.0, 0.0, TOE_OUT)

SERVO_SIZE = (0.0465, 0.034, 0.0285)
SERVO = Motor(effort=3.1, velocity=4.71, friction=0.0477)

MATERIALS = {
    "shell": (0.58, 0.62, 0.68, 1.0),
    "servo": (0.2, 0.21, 0.24, 1.0),
    "tube": (0.35, 0.4, 0.48, 1.0),
    "rod": (0.85, 0.5, 0.15, 1.0),
    "foot": (0.25, 0.5, 0.7, 1.0),
}


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = Drawing(
        "disney_leg",
        materials=MATERIALS,
        metadata={
            "description": "Left hybrid leg of Disney Research's biped on a fixed pelvis, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of Disney Research's USD description dr_legs_no_meshes.usda",
        },
    )
    draw_pelvis(robot)
    draw_leg(robot)
    return robot


def draw_pelvis(robot: Drawing) -> None:
    """The pelvis: on either side, the servo that rolls the inner hip and the bearing of the outer one."""
    plate = Box((-0.019, 0.0, 0.006), (0.085, 0.24, 0.012), mass=0.25)
    robot.body("pelvis", None, plate, *hip_mounts(1.0), *hip_mounts(-1.0), material="shell", contacts=(plate,))


def hip_mounts(side: float) -> tuple[Box, Cylinder]:
    """What carries the inner and the outer hip of one side: 1 is left."""
    servo = INNER.point((-24.0, INNER.hip[1]))
    back, front = (OUTER.point((forward, OUTER.hip[1])) for forward in (-20.0, 2.0))
    return (
        Box((servo[0], side * servo[1], servo[2]), SERVO_SIZE, mass=0.082, rpy=(0.0, 0.0, side * TOE_OUT)),
        Cylinder((back[0], side * back[1], back[2]), (front[0], side * front[1], front[2]), radius=0.01, mass=0.012),
    )


def draw_leg(robot: Drawing, prefix: str = "") -> None:
    """The two chains, which the ankle joins, and the foot.

    Args:
        robot: The drawing, with the pelvis.
        prefix: Begins every name of the leg.
    """
    inner_hip, outer_hip = (chain.point((8.9, chain.hip[1])) for chain in (INNER, OUTER))
    roll_motor = revolute(f"{prefix}motor_hip", "pelvis", inner_hip, FORWARD, degrees=(-20.0, 20.0), motor=SERVO)
    roll_bearing = revolute(f"{prefix}free_hip", "pelvis", outer_hip, FORWARD, degrees=(-30.0, 30.0))
    draw_chain(robot, prefix, INNER, roll_motor, part_of_shin=1.0)
    draw_chain(robot, prefix, OUTER, roll_bearing, part_of_shin=0.5)
    draw_ankle(robot, prefix)
    draw_end_of_outer_shin(robot, prefix)


def draw_chain(robot: Drawing, prefix: str, chain: Chain, roll: Joint, part_of_shin: float) -> None:
    """A chain: the hip with its two servos, the thigh, the shin from the knee on, and the horn and rod that bend it."""
    name = f"{prefix}{chain.name}"
    thigh_servo, horn_servo = (
        Box(chain.point((at[0] - 2.0, at[1]), SERVOS_OUT), SERVO_SIZE, mass=0.09, rpy=TURNED_OUT)
        for at in (chain.hip, chain.servo)
    )
    robot.body(f"{name}_hip", roll, thigh_servo, horn_servo, material="servo")
    hip, knee = chain.point(chain.hip), chain.point(chain.knee)
    robot.body(
        f"{name}_thigh",
        revolute(f"{prefix}motor_{chain.name}_thigh", f"{name}_hip", hip, RIGHT, degrees=(-5.0, 40.0), motor=SERVO),
        Cylinder(hip, knee, radius=0.006, mass=0.0693),
        material="tube",
    )
    shin_pin = chain.point(chain.shin, ROD_OUT)
    robot.body(
        f"{name}_shin",
        revolute(f"{prefix}free_{chain.name}_knee", f"{name}_thigh", knee, RIGHT, degrees=(-125.0, 0.0), drawn=-20.6),
        Cylinder(knee, chain.on_shin(part_of_shin), radius=0.006, mass=0.06 * part_of_shin),
        Cylinder(knee, chain.point(chain.shin), radius=0.005, mass=0.02),
        Cylinder(chain.point(chain.shin), shin_pin, radius=0.003, mass=0.0048),
        material="tube",
    )
    servo, horn = (chain.point(at, HORN_OUT) for at in (chain.servo, chain.horn))
    horn_pin = chain.point(chain.horn, ROD_OUT)
    robot.body(
        f"{name}_horn",
        revolute(f"{prefix}motor_{chain.name}_horn", f"{name}_hip", servo, RIGHT, degrees=(-70.0, 25.0), motor=SERVO),
        Cylinder(servo, horn, radius=0.004, mass=0.0104),
        Cylinder(horn, horn_pin, radius=0.002, mass=0.002),
        material="rod",
    )
    robot.rod(
        f"{name}_rod",
        (f"{name}_horn", horn_pin),
        (f"{name}_shin", shin_pin),
        radius=0.003,
        mass=0.0163,
        material="rod",
    )


def draw_ankle(robot: Drawing, prefix: str) -> None:
    """From the inner shin on: its bracket, the axle through both ankles, and the foot, which pitches about the axle."""
    inner, outer = INNER.point(INNER.ankle), OUTER.point(OUTER.ankle)
    robot.body(
        f"{prefix}inner_bracket",
        revolute(f"{prefix}free_twist", f"{prefix}inner_shin", inner, INNER.down_shin, degrees=(-45.0, 45.0)),
        Cylinder(inner, INNER.on_shin(0.75), radius=0.008, mass=0.0239),
        material="servo",
    )
    robot.body(
        f"{prefix}axle",
        revolute(f"{prefix}free_roll", f"{prefix}inner_bracket", inner, INNER.across_shin, degrees=(-45.0, 45.0)),
        Cylinder(inner, outer, radius=0.003, mass=0.0107),
        material="rod",
    )
    middle = midpoint(inner, outer)
    sole = Box(leg_point(30.3, MIDDLE, -262.2), (0.117, 0.07, 0.003), mass=0.04, rpy=TURNED_OUT)
    robot.body(
        f"{prefix}foot",
        revolute(f"{prefix}motor_foot", f"{prefix}axle", middle, LEFT, degrees=(-50.0, 60.0), motor=SERVO),
        sole,
        Box(leg_point(23.8, MIDDLE, -253.35), (0.0465, 0.034, 0.0147), mass=0.0217, rpy=TURNED_OUT),
        Box(leg_point(23.8, MIDDLE, -231.7), SERVO_SIZE, mass=0.082, rpy=TURNED_OUT),
        material="foot",
        contacts=(sole,),
    )


def draw_end_of_outer_shin(robot: Drawing, prefix: str) -> None:
    """From the outer end of the axle on: the ball, its bracket, and the lower half of the outer shin."""
    ankle, middle = OUTER.point(OUTER.ankle), OUTER.on_shin(0.5)
    robot.body(
        f"{prefix}outer_bracket",
        ball(f"{prefix}ball_ankle", f"{prefix}axle", ankle),
        Cylinder(ankle, OUTER.on_shin(0.75), radius=0.008, mass=0.0239),
        material="servo",
    )
    robot.body(
        f"{prefix}outer_shin_end",
        revolute(f"{prefix}free_bracket", f"{prefix}outer_bracket", ankle, OUTER.down_shin),
        Cylinder(middle, ankle, radius=0.006, mass=0.03),
        material="tube",
    )
    robot.close(f"{prefix}outer_shin", "6d", f"{prefix}outer_shin", f"{prefix}outer_shin_end", middle)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
