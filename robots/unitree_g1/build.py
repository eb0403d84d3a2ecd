"""Draws Unitree's humanoid G1. Run as ``python -m robots.unitree_g1.build [FOLDER]``.

World: origin at the pelvis frame of the robot's published description, x forward, y to the left, z up; m, kg, rad.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from robots.builder import Box, Cylinder, Drawing, Motor, Shape, Solid, Sphere, Vector3, revolute, write
from robots.builder.shape import Matrix3, rotation_of, rpy_of
from robots.builder.solid import solid_of
from robots.unitree_g1_ankle import build as ankle

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
UP = (0.0, 0.0, 1.0)


def planetary(effort: float, velocity: float, inertias: Vector3, first: float, second: float) -> Motor:
    """A motor with a planetary gear of two stages.

    Args:
        effort: N·m, after the gear.
        velocity: rad/s, after the gear.
        inertias: Of the rotor, of what turns between the stages, and of what turns after both, kg·m².
        first: Ratio of the first stage.
        second: Ratio of the second stage.
    """
    ratio = first * second
    behind = inertias[0] * ratio**2 + inertias[1] * second**2 + inertias[2]
    return Motor(effort, velocity, damping=0.05, friction=0.2, gear_ratio=ratio, rotor_inertia=behind / ratio**2)


# The motors, as Unitree calls them.
MOTOR_5020 = planetary(25.0, 37.0, (0.139e-4, 0.017e-4, 0.169e-4), 1.0 + 46.0 / 18.0, 1.0 + 56.0 / 16.0)
MOTOR_7520_14 = planetary(88.0, 32.0, (0.489e-4, 0.098e-4, 0.533e-4), 4.5, 1.0 + 48.0 / 22.0)
MOTOR_7520_22 = planetary(139.0, 20.0, (0.489e-4, 0.109e-4, 0.738e-4), 4.5, 5.0)
#: Its gear and rotor are not published.
MOTOR_5010 = Motor(effort=13.4, velocity=27.0, damping=0.05, friction=0.1)


@dataclass(frozen=True, slots=True)
class Figures:
    """A link of the published description, with the joint that carries it.

    Attributes:
        name: Of the link.
        parent: Link that the joint hangs from.
        xyz: Origin of the joint in the frame of the parent, m.
        rpy: Orientation of the joint in it, rad.
        axis: Of the joint.
        stops: Lowest and highest angle, rad.
        motor: What drives the joint; None if nothing does.
        mass: kg.
        center: Centre of mass in the frame of the link, m.
        moments: xx, xy, xz, yy, yz, zz about the centre of mass, in the axes of the link, kg·m².
        shapes: What we draw for it, in the frame of the link; the link's mass counts, not theirs.
        material: Name of its colour.
        contacts: How many of its shapes, from the first on, may touch other things.
        carried: What is fixed on it, in the frame of the link.
    """

    name: str
    parent: str
    xyz: Vector3
    rpy: Vector3
    axis: Vector3
    stops: tuple[float, float]
    motor: Motor | None
    mass: float
    center: Vector3
    moments: tuple[float, float, float, float, float, float]
    shapes: tuple[Shape, ...]
    material: str
    contacts: int = 0
    carried: tuple[Solid, ...] = ()

    @property
    def joint(self) -> str:
        """Name of the joint that carries it."""
        return "waist_pitch_joint" if self.name == "torso_link" else self.name.replace("_link", "_joint")

    @property
    def solid(self) -> Solid:
        """Its mass with what is fixed on it, in the frame of the link."""
        return solid_of((Solid(self.mass, self.center, symmetric(*self.moments)), *self.carried))


@dataclass(frozen=True, slots=True)
class Place:
    """Where a frame is in the world.

    Attributes:
        rotation: 3 x 3.
        at: m.
    """

    rotation: Matrix3
    at: Vector3

    def point(self, local: Vector3) -> Vector3:
        """A point of the frame, in the world."""
        x, y, z = (np.array(self.at) + self.rotation @ local).tolist()
        return (x, y, z)

    def inner(self, xyz: Vector3, rpy: Vector3) -> Place:
        """Where a frame is that is given in this one."""
        return Place(self.rotation @ rotation_of(rpy), self.point(xyz))

    def shape(self, shape: Shape) -> Shape:
        """A shape of the frame, in the world."""
        if isinstance(shape, Cylinder):
            return replace(shape, start=self.point(shape.start), end=self.point(shape.end))
        if isinstance(shape, Box):
            rpy = rpy_of(self.rotation @ rotation_of(shape.rpy))
            return replace(shape, center=self.point(shape.center), rpy=rpy)
        return replace(shape, center=self.point(shape.center))

    def solid(self, solid: Solid) -> Solid:
        """A solid of the frame, in the world."""
        return Solid(solid.mass, self.point(solid.center), self.rotation @ solid.inertia @ self.rotation.T)


def symmetric(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float) -> Matrix3:
    """The matrix of six moments, 3 x 3."""
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def drum(start: Vector3, end: Vector3, radius: float) -> Cylinder:
    """A cylinder without mass."""
    return Cylinder(start, end, radius, 0.0)


def block(center: Vector3, size: Vector3) -> Box:
    """A box without mass."""
    return Box(center, size, 0.0)


PELVIS = Solid(3.813, (0.0, 0.0, -0.07605), symmetric(0.010549, 0.0, 2.1e-06, 0.0093089, 0.0, 0.0079184))

LEG = (
    Figures(
        "left_hip_pitch_link",
        "pelvis",
        (0.0, 0.064452, -0.1027),
        (0.0, 0.0, 0.0),
        LEFT,
        (-2.5307, 2.8798),
        MOTOR_7520_22,
        1.35,
        (0.002741, 0.047791, -0.02606),
        (0.001811, 3.68e-05, -3.44e-05, 0.0014193, 0.000171, 0.0012812),
        (
            drum((0.0, 0.0, 0.0), (0.0, 0.045, 0.0), 0.042),
            drum((-0.03, 0.052, -0.030465), (0.045, 0.052, -0.030465), 0.042),
        ),
        "motor",
    ),
    Figures(
        "left_hip_roll_link",
        "left_hip_pitch_link",
        (0.0, 0.052, -0.030465),
        (0.0, -0.1749, 0.0),
        FORWARD,
        (-0.5236, 2.9671),
        MOTOR_7520_22,
        1.52,
        (0.029812, -0.001045, -0.087934),
        (0.0023773, -3.8e-06, -0.0003908, 0.0024123, 1.84e-05, 0.0016595),
        (
            drum((0.047, 0.0, 0.0), (0.06, 0.0, 0.0), 0.04),
            block((0.05, 0.0, -0.045), (0.02, 0.06, 0.08)),
            drum((0.025001, 0.0, -0.075), (0.025001, 0.0, -0.12412), 0.045),
        ),
        "shell",
    ),
    Figures(
        "left_hip_yaw_link",
        "left_hip_roll_link",
        (0.025001, 0.0, -0.12412),
        (0.0, 0.0, 0.0),
        UP,
        (-2.7576, 2.7576),
        MOTOR_7520_14,
        1.702,
        (-0.057709, -0.010981, -0.15078),
        (0.0057774, -0.0005411, -0.0023948, 0.0076124, -0.0007072, 0.003149),
        (
            drum((-0.005, 0.0, -0.03), (-0.06, 0.002, -0.15), 0.047),
            drum((0.0, 0.0, 0.0), (0.0, 0.0, -0.04), 0.045),
            drum((-0.078273, -0.055, -0.17734), (-0.078273, 0.03, -0.17734), 0.05),
        ),
        "shell",
        contacts=1,
    ),
    Figures(
        "left_knee_link",
        "left_hip_yaw_link",
        (-0.078273, 0.0021489, -0.17734),
        (0.0, 0.1749, 0.0),
        LEFT,
        (-0.087267, 2.8798),
        MOTOR_7520_22,
        1.932,
        (0.005457, 0.003964, -0.12074),
        (0.011329, 4.82e-05, -4.49e-05, 0.011277, -0.0007146, 0.0015168),
        (
            drum((0.0, 0.0, -0.03), (-0.012, 0.0, -0.27), 0.023),
            drum((0.0, 0.032, 0.0), (0.0, 0.046, 0.0), 0.045),
            block((0.0, 0.03, -0.045), (0.04, 0.025, 0.06)),
            drum((-0.022, 0.0, ankle.MOTOR_A[2] - 0.3), (0.022, 0.0, ankle.MOTOR_A[2] - 0.3), 0.027),
            drum((-0.022, 0.0, ankle.MOTOR_B[2] - 0.3), (0.022, 0.0, ankle.MOTOR_B[2] - 0.3), 0.027),
            block((-0.012, 0.0, -0.265), (0.024, 0.058, 0.02)),
            block((-0.004, 0.026, -0.288), (0.02, 0.006, 0.05)),
            block((-0.004, -0.026, -0.288), (0.02, 0.006, 0.05)),
        ),
        "shell",
        contacts=1,
    ),
    Figures(
        "left_ankle_pitch_link",
        "left_knee_link",
        (0.0, -9.4445e-05, -0.30001),
        (0.0, 0.0, 0.0),
        LEFT,
        (-0.87267, 0.5236),
        None,
        0.074,
        (-0.007269, 0.0, 0.011137),
        (8.4e-06, 0.0, -2.9e-06, 1.89e-05, 0.0, 1.26e-05),
        (
            drum((0.0, -0.023, 0.0), (0.0, 0.023, 0.0), 0.007),
            drum((-0.015, 0.0, -0.017558), (0.015, 0.0, -0.017558), 0.006),
        ),
        "motor",
    ),
    Figures(
        "left_ankle_roll_link",
        "left_ankle_pitch_link",
        (0.0, 0.0, -0.017558),
        (0.0, 0.0, 0.0),
        FORWARD,
        (-0.2618, 0.2618),
        None,
        0.608,
        (0.026505, 0.0, -0.016425),
        (0.0002231, 2e-07, 8.91e-05, 0.0016161, -1e-07, 0.0016667),
        (
            block((0.035, 0.0, -0.025), (0.18, 0.066, 0.02)),
            block((0.02, 0.0, -0.003), (0.012, 0.022, 0.026)),
            block((-0.02, 0.0, -0.006), (0.012, 0.022, 0.02)),
            drum((0.022, 0.015, 0.008), (0.022, -0.015, 0.008), 0.004),
        ),
        "foot",
        contacts=1,
    ),
)

#: The head, on the torso, in its frame. (Figures of head_link and of its fixed joint.)
HEAD = Solid(
    1.036,
    (0.0039635 + 0.005267, 0.000299, -0.044 + 0.449869),
    symmetric(0.004085051, -2.543e-06, -6.9455e-05, 0.004185212, -3.726e-06, 0.001807911),
)

#: The logo, likewise.
LOGO = Solid(0.001, (0.0039635, 0.0, -0.044), symmetric(1e-07, 0.0, 0.0, 1e-07, 0.0, 1e-07))

WAIST = (
    Figures(
        "waist_yaw_link",
        "pelvis",
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        UP,
        (-2.618, 2.618),
        MOTOR_7520_14,
        0.214,
        (0.003494, 0.000233, 0.018034),
        (0.00010673, 2.703e-06, -7.631e-06, 0.00010422, -2.01e-07, 0.0001625),
        (
            drum((0.0, 0.0, 0.0), (0.0, 0.0, 0.018), 0.0425),
            block((-0.0039635, 0.0, 0.028), (0.012, 0.03, 0.03)),
            drum((0.008, 0.0225, 0.027), (0.0264, 0.0225, 0.027), 0.003),
            drum((0.008, -0.0225, 0.027), (0.0264, -0.0225, 0.027), 0.003),
            block((0.0, 0.0, 0.022), (0.022, 0.05, 0.016)),
        ),
        "motor",
    ),
    Figures(
        "waist_roll_link",
        "waist_yaw_link",
        (-0.0039635, 0.0, 0.044),
        (0.0, 0.0, 0.0),
        FORWARD,
        (-0.52, 0.52),
        None,
        0.086,
        (0.0, 2.3e-05, 0.0),
        (7.079e-06, 0.0, 0.0, 6.339e-06, 0.0, 8.245e-06),
        (
            drum((-0.017, 0.0, 0.0), (0.017, 0.0, 0.0), 0.008),
            drum((0.0, -0.02, 0.0), (0.0, 0.02, 0.0), 0.009),
        ),
        "foot",
    ),
    Figures(
        "torso_link",
        "waist_roll_link",
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        LEFT,
        (-0.52, 0.52),
        None,
        6.78,
        (0.000931, 0.000346, 0.15082),
        (0.05905, 3.3302e-05, -0.0017715, 0.047014, -2.2399e-05, 0.025652),
        (
            block((0.004, 0.0, 0.19), (0.13, 0.19, 0.20)),
            Sphere((0.008, 0.0, 0.41), 0.075, 0.0),
            block((-0.02, 0.0, 0.055), (0.05, 0.11, 0.09)),
            drum((0.004, 0.0, 0.29), (0.004, 0.0, 0.36), 0.04),
            drum((-0.03, 0.035, 0.030664), (0.012, 0.035, 0.030664), 0.027),
            drum((-0.03, -0.035, 0.030664), (0.012, -0.035, 0.030664), 0.027),
        ),
        "shell",
        contacts=2,
        carried=(HEAD, LOGO),
    ),
)

#: The hand of rubber, on the last link of the wrist, in its frame.
HAND = Solid(
    0.17,
    (0.0415 + 0.05361310808, 0.003 - 0.0029590524, 0.00215413091),
    symmetric(
        0.00010099485234748,
        3.618590790516e-05,
        -7.4301518642e-07,
        0.00028135871571621,
        3.30189743286e-06,
        0.00021894770413514,
    ),
)

ARM = (
    Figures(
        "left_shoulder_pitch_link",
        "torso_link",
        (0.0039563, 0.10022, 0.24778),
        (0.27931, 5.4949e-05, -0.00019159),
        LEFT,
        (-3.0892, 2.6704),
        MOTOR_5020,
        0.718,
        (0.0, 0.035892, -0.011628),
        (0.0004291, -9.2e-06, 6.4e-06, 0.000453, 2.26e-05, 0.000423),
        (
            drum((0.0, -0.01, 0.0), (0.0, 0.045, 0.0), 0.031),
            drum((-0.028, 0.038, -0.013831), (0.028, 0.038, -0.013831), 0.031),
        ),
        "motor",
    ),
    Figures(
        "left_shoulder_roll_link",
        "left_shoulder_pitch_link",
        (0.0, 0.038, -0.013831),
        (-0.27925, 0.0, 0.0),
        FORWARD,
        (-1.5882, 2.2515),
        MOTOR_5020,
        0.643,
        (-0.000227, 0.00727, -0.063243),
        (0.0006177, -1e-06, 8.7e-06, 0.0006912, -5.3e-06, 0.0003894),
        (
            drum((0.0, 0.00624, -0.03), (0.0, 0.00624, -0.1032), 0.033),
            block((0.0, 0.006, -0.015), (0.07, 0.05, 0.05)),
        ),
        "shell",
        contacts=1,
    ),
    Figures(
        "left_shoulder_yaw_link",
        "left_shoulder_roll_link",
        (0.0, 0.00624, -0.1032),
        (0.0, 0.0, 0.0),
        UP,
        (-2.618, 2.618),
        MOTOR_5020,
        0.734,
        (0.010773, -0.002949, -0.072009),
        (0.0009988, 7.9e-06, 0.0001412, 0.0010605, -2.86e-05, 0.0004354),
        (
            drum((0.0, 0.0, 0.0), (0.008, 0.0, -0.055), 0.03),
            drum((0.015783, -0.03, -0.080518), (0.015783, 0.022, -0.080518), 0.031),
        ),
        "motor",
    ),
    Figures(
        "left_elbow_link",
        "left_shoulder_yaw_link",
        (0.015783, 0.0, -0.080518),
        (0.0, 0.0, 0.0),
        LEFT,
        (-1.0472, 2.0944),
        MOTOR_5020,
        0.6,
        (0.064956, 0.004454, -0.010062),
        (0.0002891, 6.53e-05, 1.72e-05, 0.0004152, -5.6e-06, 0.0004197),
        (
            drum((0.02, 0.002, -0.01), (0.1, 0.002, -0.01), 0.03),
            drum((0.0, 0.022, 0.0), (0.0, 0.032, 0.0), 0.031),
            block((0.02, 0.026, -0.004), (0.05, 0.012, 0.035)),
        ),
        "shell",
        contacts=1,
    ),
    Figures(
        "left_wrist_roll_link",
        "left_elbow_link",
        (0.1, 0.00188791, -0.01),
        (0.0, 0.0, 0.0),
        FORWARD,
        (-1.972222054, 1.972222054),
        MOTOR_5020,
        0.08544498,
        (0.01713944778, 0.00053759094, 4.8864e-07),
        (4.821544023e-05, -4.24511021e-06, 5.10599e-09, 3.722899093e-05, -1.23525e-09, 5.482106541e-05),
        (
            drum((0.0, 0.0, 0.0), (0.012, 0.0, 0.0), 0.028),
            block((0.025, 0.024, 0.0), (0.035, 0.006, 0.03)),
            block((0.025, -0.024, 0.0), (0.035, 0.006, 0.03)),
        ),
        "motor",
    ),
    Figures(
        "left_wrist_pitch_link",
        "left_wrist_roll_link",
        (0.038, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        LEFT,
        (-1.614429558, 1.614429558),
        MOTOR_5010,
        0.684,
        (0.02549150483, -0.00054042511, -0.00054143853),
        (0.00025599000747, -8.61777083e-06, -8.57523406e-06, 0.00071633247299, -1.399472e-10, 0.00071591991283),
        (
            drum((0.0, -0.021, 0.0), (0.0, 0.021, 0.0), 0.025),
            drum((0.051, 0.0, -0.021), (0.051, 0.0, 0.021), 0.025),
            block((0.0255, 0.0, 0.0), (0.03, 0.036, 0.036)),
        ),
        "shell",
    ),
    Figures(
        "left_wrist_yaw_link",
        "left_wrist_pitch_link",
        (0.051, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        UP,
        (-1.614429558, 1.614429558),
        MOTOR_5010,
        0.08457647,
        (0.02200381568, 0.00049485096, 0.00053861123),
        (4.929128828e-05, -4.5735494e-07, 4.45867591e-06, 5.973338134e-05, 4.3217198e-07, 3.928083826e-05),
        (
            block((0.105, 0.0, 0.0), (0.11, 0.035, 0.075)),
            block((0.035, 0.0, 0.024), (0.06, 0.03, 0.006)),
            block((0.035, 0.0, -0.024), (0.06, 0.03, 0.006)),
        ),
        "foot",
        contacts=1,
        carried=(HAND,),
    ),
)

# The left side of the waist, in the frame of waist_yaw_link: the ball on that link, the ball on the crank, and where
# the axis of the crank leaves the motor.
WAIST_BALL = (0.02638, 0.0225, 0.027)
WAIST_CRANK = (0.02638, 0.0225 - 0.011486, 0.027 + 0.048666)
WAIST_MOTOR = (0.02638 - 0.01255, WAIST_CRANK[1] + 0.023977, WAIST_CRANK[2] - 0.001002)


def draw() -> Drawing:
    """The robot with every joint at zero: upright, the forearms forward."""
    robot = Drawing(
        "unitree_g1",
        materials={
            "shell": (0.62, 0.65, 0.7, 1.0),
            "motor": (0.2, 0.21, 0.24, 1.0),
            "foot": (0.35, 0.37, 0.42, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Unitree's humanoid G1 with the rods of its ankles and waist, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures and meshes of Unitree's description of the G1, and feidedao's model of its ankle",
        },
        root="floating",
    )
    hips = (block((0.0, 0.0, -0.05), (0.08, 0.1, 0.1)), drum((0.0, -0.06, -0.1027), (0.0, 0.06, -0.1027), 0.045))
    robot.body("pelvis", None, *hips, material="motor", contacts=hips, solid=PELVIS)
    places = {"pelvis": Place(np.eye(3), (0.0, 0.0, 0.0))}
    for figures in (*LEG, *WAIST, *ARM):
        draw_link(robot, places, figures)
    draw_ankle(robot, places["left_ankle_pitch_link"])
    draw_waist(robot, places["waist_yaw_link"])
    robot.frame("imu_in_pelvis", "pelvis", (0.04525, 0.0, -0.08339))
    robot.frame("imu_in_torso", "torso_link", places["torso_link"].point((-0.03959, -0.00224, 0.14792)))
    camera = places["torso_link"].point((0.0576235, 0.01753, 0.42987))
    robot.frame("d435_link", "torso_link", camera, rpy=(0.0, 0.8307767239493009, 0.0))
    robot.frame("left_sole", "left_ankle_roll_link", places["left_ankle_roll_link"].point((0.035, 0.0, -0.035)))
    robot.mirror("left", "right")
    take_out(robot, "torso_link", *(f"{side}_waist_{part}" for side in ("left", "right") for part in ("crank", "rod")))
    keep_axes(robot)
    return robot


def draw_link(robot: Drawing, places: dict[str, Place], figures: Figures) -> None:
    """A link of the published description; adds its place."""
    at = places[figures.name] = places[figures.parent].inner(figures.xyz, figures.rpy)
    x, y, z = (at.rotation @ figures.axis).tolist()
    joint = revolute(figures.joint, figures.parent, at.at, (x, y, z), motor=figures.motor)
    shapes = tuple(map(at.shape, figures.shapes))
    robot.body(
        figures.name,
        replace(joint, stops=figures.stops),
        *shapes,
        material=figures.material,
        contacts=shapes[: figures.contacts],
        solid=at.solid(figures.solid),
    )


def draw_ankle(robot: Drawing, pitch: Place) -> None:
    """The cranks and rods of the left ankle, as in ``unitree_g1_ankle``, whose origin is on the axis of pitch."""
    for side, motor, ball, foot, degrees, mass in (
        ("A", ankle.MOTOR_A, ankle.CRANK_A, ankle.FOOT_A, (-47.0, 85.0), 0.011),
        ("B", ankle.MOTOR_B, ankle.CRANK_B, ankle.FOOT_B, (-85.0, 47.0), 0.015),
    ):
        turn = revolute(
            f"left_ankle_{side}_joint",
            "left_knee_link",
            pitch.point(motor),
            FORWARD,
            degrees=degrees,
            motor=MOTOR_5020,
        )
        middle = (ankle.CRANK_PLANE, ball[1], ball[2])
        parts = (
            Cylinder(motor, (0.032, 0.0, motor[2]), radius=0.012, mass=0.03),
            Cylinder((ankle.CRANK_PLANE, 0.0, motor[2]), middle, radius=0.005, mass=0.012),
            Cylinder(middle, ball, radius=0.003, mass=0.006),
        )
        crank, rod = f"left_ankle_{side}_link", f"left_ankle_{side}_rod"
        robot.body(crank, turn, *map(pitch.shape, parts), material="motor")
        robot.rod(
            rod,
            ("left_ankle_roll_link", pitch.point(foot)),
            (crank, pitch.point(ball)),
            radius=0.003,
            mass=mass,
            material="rod",
            ends=("universal", "point"),
        )
        take_out(robot, "left_knee_link", crank, rod)


def draw_waist(robot: Drawing, yaw: Place) -> None:
    """The left crank of the waist, on the torso, and the rod to it from the link that yaws."""
    motor, ball = yaw.point(WAIST_MOTOR), yaw.point(WAIST_CRANK)
    turn = revolute(
        "left_waist_joint",
        "torso_link",
        motor,
        FORWARD,
        degrees=(-55.0, 55.0),
        motor=MOTOR_5020,
    )
    plane = motor[0] + 0.0045
    hub, arm = (plane, motor[1], motor[2]), (plane, ball[1], ball[2])
    parts = (
        Cylinder((motor[0] - 0.003, motor[1], motor[2]), hub, radius=0.0195, mass=0.024),
        Cylinder(hub, arm, radius=0.0055, mass=0.009),
        Cylinder(arm, ball, radius=0.003, mass=0.006),
    )
    robot.body("left_waist_crank", turn, *parts, material="motor")
    robot.rod(
        "left_waist_rod",
        ("waist_yaw_link", yaw.point(WAIST_BALL)),
        ("left_waist_crank", ball),
        radius=0.0035,
        mass=0.0125,
        material="rod",
        ends=("universal", "point"),
    )


def take_out(robot: Drawing, link: str, *parts: str) -> None:
    """Takes the masses of bodies, as drawn, out of the published mass of the link that includes them."""
    whole = robot.bodies[link]
    if whole.solid is not None:
        rest = whole.solid.without([solid_of(robot.bodies[part].shapes) for part in parts])
        robot.bodies[link] = replace(whole, solid=rest)


def keep_axes(robot: Drawing) -> None:
    """Turns the axes of the right side round that the mirror turned, so that both sides have Unitree's coordinates."""
    for name, body in robot.bodies.items():
        image = robot.bodies.get(name.replace("right", "left"))
        if "right" in name and body.joint and image and image.joint and body.joint.type == "revolute":
            x, y, z = body.joint.axis
            if float(np.dot(body.joint.axis, image.joint.axis)) < 0.0 and body.joint.stops:
                low, high = body.joint.stops
                robot.bodies[name] = replace(body, joint=replace(body.joint, axis=(-x, -y, -z), stops=(-high, -low)))


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
