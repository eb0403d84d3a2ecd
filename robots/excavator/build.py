"""Draws a mini-excavator. Run as ``python -m robots.excavator.build [FOLDER]``.

World: origin on the ground under the swing axis, x forward, y to the left, z up; m, kg. All dimensions are estimates.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, assembled_at, midpoint, prismatic, revolute, write

BOOM_FOOT = (0.5, 0.0, 0.62)
BOOM_KNEE = (1.11, 0.0, 1.53)
ARM_PIN = (2.12, 0.0, 1.56)
BUCKET_PIN = (2.375, 0.0, 0.615)
TEETH = (1.98, 0.0, 0.2)
HEEL = (2.39, 0.0, 0.23)

# The pins of the three cylinders.
BOOM_CYLINDER = ((0.71, 0.0, 0.41), (1.115, 0.0, 1.3))
ARM_CYLINDER = ((1.205, 0.0, 1.656), (2.215, 0.0, 1.81))
BUCKET_CYLINDER = ((2.31, 0.0, 1.51), (2.575, 0.0, 0.795))

# The rest of the bucket's four-bar linkage. Rocker and link share a pin with the rod of the cylinder.
ROCKER_PIN = (2.355, 0.0, 0.795)
LINK_PIN = BUCKET_CYLINDER[1]
BUCKET_EYE = (2.55, 0.0, 0.59)

UP = (0.0, 0.0, 1.0)
ACROSS = (0.0, 1.0, 0.0)

#: Largest pressure (Pa) and flow (m³/s) of the hydraulics.
PRESSURE = 20e6
FLOW = 30e-3 / 60.0

SWING = Motor(effort=4000.0, velocity=0.95, name="swing", control=(-4000.0, 4000.0))


def draw() -> Drawing:
    """The machine with its cylinders about half out."""
    robot = Drawing(
        "excavator",
        materials={
            "tracks": (0.2, 0.2, 0.22, 1.0),
            "house": (0.85, 0.55, 0.12, 1.0),
            "arm": (0.8, 0.45, 0.1, 1.0),
            "barrel": (0.3, 0.35, 0.42, 1.0),
            "rod": (0.6, 0.62, 0.65, 1.0),
        },
        metadata={
            "description": "Mini-excavator: swing, boom, arm and bucket, moved by hydraulic cylinders",
            "license": "BSD-3-Clause",
            "source": "No particular machine: estimates of the size of one of 1.7 t",
        },
    )
    draw_machine(robot)
    draw_arm(robot)
    draw_bucket(robot)
    for name, held in {
        "reach": {"motor_swing": 0.0, "motor_boom": -0.03, "motor_arm": -0.28, "motor_bucket": -0.15},
        "dig": {"motor_swing": 0.0, "motor_boom": -0.22, "motor_arm": -0.05, "motor_bucket": -0.05},
        "carry": {"motor_swing": 0.0, "motor_boom": 0.03, "motor_arm": 0.1, "motor_bucket": 0.12},
        "dump": {"motor_swing": math.pi / 2.0, "motor_boom": 0.16, "motor_arm": -0.1, "motor_bucket": -0.18},
    }.items():
        robot.configure(name, **assembled_at(robot, held))
    return robot


def draw_machine(robot: Drawing) -> None:
    """The tracks, and the house that swings on them."""
    tracks = tuple(Box((0.0, y, 0.17), (1.5, 0.23, 0.34), mass=180.0) for y in (0.38, -0.38))
    frame = Box((0.0, 0.0, 0.24), (0.6, 0.6, 0.16), mass=140.0)
    bearing = Cylinder((0.0, 0.0, 0.3), (0.0, 0.0, 0.38), radius=0.28, mass=30.0)
    robot.body("tracks", None, *tracks, frame, bearing, material="tracks", contacts=tracks)
    bracket = (beam((0.38, 0.0, 0.52), pin, width=0.12, height=0.1, mass=15.0) for pin in (BOOM_FOOT, BOOM_CYLINDER[0]))
    posts = (Cylinder((x, y, 0.5), (x, y, 2.2), radius=0.025, mass=6.0) for x in (-0.55, 0.1) for y in (0.42, -0.42))
    robot.body(
        "house",
        revolute("motor_swing", "tracks", (0.0, 0.0, 0.38), UP, motor=SWING),
        Box((-0.12, 0.0, 0.45), (1.1, 0.96, 0.14), mass=330.0),
        Box((-0.48, 0.0, 0.72), (0.38, 0.9, 0.4), mass=430.0),
        Box((-0.1, 0.0, 0.64), (0.38, 0.45, 0.24), mass=25.0),
        *posts,
        Box((-0.225, 0.0, 2.22), (0.75, 0.94, 0.05), mass=35.0),
        *bracket,
        pin(BOOM_FOOT, half=0.1),
        pin(BOOM_CYLINDER[0], half=0.08),
        material="house",
    )


def draw_arm(robot: Drawing) -> None:
    """The boom and the arm, each with the cylinder that moves it."""
    foot, eye = ARM_CYLINDER
    robot.body(
        "boom",
        revolute("free_boom", "house", BOOM_FOOT, ACROSS),
        beam(BOOM_FOOT, BOOM_KNEE, width=0.13, height=0.14, mass=42.0),
        beam(BOOM_KNEE, ARM_PIN, width=0.13, height=0.12, mass=36.0),
        beam(BOOM_KNEE, BOOM_CYLINDER[1], width=0.08, height=0.06, mass=3.0),
        beam(BOOM_KNEE, foot, width=0.08, height=0.06, mass=3.0),
        pin(BOOM_CYLINDER[1], half=0.08),
        pin(ARM_PIN, half=0.09),
        pin(foot, half=0.07),
        material="arm",
    )
    draw_cylinder(robot, "boom", "house", "boom", BOOM_CYLINDER, bore=0.07, rod=0.04, lengths=(0.67, 1.14))
    robot.body(
        "arm",
        revolute("free_arm", "boom", ARM_PIN, ACROSS),
        beam(ARM_PIN, BUCKET_PIN, width=0.11, height=0.11, mass=30.0),
        beam(ARM_PIN, eye, width=0.09, height=0.1, mass=6.0),
        beam(ARM_PIN, BUCKET_CYLINDER[0], width=0.08, height=0.06, mass=3.0),
        pin(eye, half=0.07),
        pin(BUCKET_CYLINDER[0], half=0.06),
        pin(ROCKER_PIN, half=0.09),
        pin(BUCKET_PIN, half=0.12),
        material="arm",
    )
    draw_cylinder(robot, "arm", "boom", "arm", ARM_CYLINDER, bore=0.06, rod=0.035, lengths=(0.72, 1.16))


def draw_bucket(robot: Drawing) -> None:
    """The bucket, and the linkage through which its cylinder turns it."""
    robot.body(
        "rocker",
        revolute("free_rocker", "arm", ROCKER_PIN, ACROSS),
        *(
            beam(shifted(ROCKER_PIN, y), shifted(LINK_PIN, y), width=0.015, height=0.05, mass=1.5)
            for y in (0.07, -0.07)
        ),
        pin(LINK_PIN, half=0.09),
        material="rod",
    )
    robot.body(
        "link",
        revolute("free_link", "rocker", LINK_PIN, ACROSS),
        *(
            beam(shifted(LINK_PIN, y), shifted(BUCKET_EYE, y), width=0.015, height=0.05, mass=1.5)
            for y in (0.05, -0.05)
        ),
        material="barrel",
    )
    back, mouth = midpoint(HEEL, BUCKET_EYE), midpoint(HEEL, TEETH)
    robot.body(
        "bucket",
        revolute("free_bucket", "arm", BUCKET_PIN, ACROSS),
        *(
            beam(shifted(BUCKET_PIN, y), shifted(BUCKET_EYE, y), width=0.02, height=0.07, mass=1.5)
            for y in (0.09, -0.09)
        ),
        beam(BUCKET_EYE, HEEL, width=0.4, height=0.03, mass=10.0),
        beam(HEEL, TEETH, width=0.4, height=0.02, mass=10.0),
        *(beam(shifted(back, y), shifted(mouth, y), width=0.015, height=0.25, mass=5.0) for y in (0.19, -0.19)),
        pin(BUCKET_EYE, half=0.11),
        material="tracks",
    )
    robot.close("bucket_link", "3d", "link", "bucket", BUCKET_EYE)
    draw_cylinder(robot, "bucket", "arm", "rocker", BUCKET_CYLINDER, bore=0.055, rod=0.03, lengths=(0.55, 0.9))
    robot.frame("teeth", "bucket", TEETH, rpy=(0.0, pitch(BUCKET_PIN, TEETH), 0.0))


def draw_cylinder(
    robot: Drawing,
    name: str,
    base: str,
    end: str,
    pins: tuple[Vector3, Vector3],
    *,
    bore: float,
    rod: float,
    lengths: tuple[float, float],
) -> None:
    """A hydraulic cylinder between two bodies.

    Args:
        robot: What it is drawn into.
        name: Of what it moves.
        base: Body that carries the barrel.
        end: Body that the rod is pinned to.
        pins: Where they are pinned, in the world, m.
        bore: Diameter of the piston, m.
        rod: Diameter of the rod, m.
        lengths: Shortest and longest distance of the pins, m.
    """
    foot, eye = pins
    area, ring = math.pi / 4.0 * bore**2, math.pi / 4.0 * (bore**2 - rod**2)
    control = (-PRESSURE * ring, PRESSURE * area)
    motor = Motor(effort=PRESSURE * area, velocity=FLOW / area, name=f"{name}_cylinder", control=control)
    along = (eye[0] - foot[0], eye[1] - foot[1], eye[2] - foot[2])
    drawn = math.dist(foot, eye)
    # The barrel is as long as fits the shortest length; the rod reaches 5 cm into it at the longest.
    barrel, inside = 0.9 * lengths[0], drawn - (lengths[1] - 0.9 * lengths[0]) - 0.05

    def at(distance: float) -> Vector3:
        share = distance / drawn
        return (foot[0] + share * along[0], 0.0, foot[2] + share * along[2])

    robot.body(
        f"{name}_barrel",
        revolute(f"free_{name}_barrel", base, foot, ACROSS),
        Cylinder(foot, at(barrel), radius=0.6 * bore, mass=2400.0 * barrel * bore),
        material="barrel",
    )
    robot.body(
        f"{name}_rod",
        prismatic(f"motor_{name}", f"{name}_barrel", eye, along, metres=lengths, drawn=drawn, motor=motor),
        Cylinder(at(inside), eye, radius=0.5 * rod, mass=7850.0 * math.pi / 4.0 * rod**2 * (drawn - inside)),
        material="rod",
    )
    robot.close(f"{name}_eye", "3d", f"{name}_rod", end, eye)


def beam(start: Vector3, end: Vector3, *, width: float, height: float, mass: float) -> Box:
    """A beam between two points of a plane of constant y; its width is along y."""
    return Box(midpoint(start, end), (math.dist(start, end), width, height), mass, (0.0, pitch(start, end), 0.0))


def pin(at: Vector3, *, half: float) -> Cylinder:
    """A pin along y, with half its length."""
    return Cylinder(shifted(at, -half), shifted(at, half), radius=0.025, mass=7850.0 * math.pi * 0.025**2 * 2.0 * half)


def pitch(start: Vector3, end: Vector3) -> float:
    """The pitch (rad) that turns x into the direction from one point to another of the same y."""
    return math.atan2(start[2] - end[2], end[0] - start[0])


def shifted(at: Vector3, y: float) -> Vector3:
    """A point moved along y, m."""
    return (at[0], at[1] + y, at[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
