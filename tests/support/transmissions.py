"""Mechanisms with transmissions: robots of the collection, and linkages whose transmission has a closed form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import eurdf
from eurdf.pinocchio.robot import build_robot
from support.described import load
from support.plain_urdf import inertial, joint_element, link_element, robot

#: Robots of the collection, and joints that motors drive through loops.
DRIVEN = {
    "unitree_g1_ankle": ("free_pitch", "free_roll"),
    "tesla_optimus_ankle": ("free_pitch", "free_roll"),
    "talos_leg": ("free_ankle", "motor_ankle"),
    "digit_leg": ("free_foot1", "free_foot2"),
    "kangaroo_leg": ("free_knee", "free_ankle_y", "free_ankle_x"),
}

#: Ankles, waists and other transmissions of two joints of the collection.
OF_TWO_JOINTS = [
    ("unitree_g1_ankle", DRIVEN["unitree_g1_ankle"]),
    ("tesla_optimus_ankle", DRIVEN["tesla_optimus_ankle"]),
    ("talos_leg", DRIVEN["talos_leg"]),
    ("digit_leg", DRIVEN["digit_leg"]),
    ("unitree_g1", ("waist_roll_joint", "waist_pitch_joint")),
    ("battobot", ("left_free_ankle_y", "left_free_ankle_x")),
    ("tello", ("left_free_hip_x", "left_free_hip_y")),
    ("tello", ("left_free_knee", "left_free_ankle")),
    ("toddlerbot_2legs", ("waist_yaw", "waist_roll")),
    ("kangaroo_leg", ("free_hip_y", "free_hip_x")),
    ("five_bar", ("free_elbow_1", "free_elbow_2")),
]


def posed(name: str, seed: int = 0) -> tuple[Any, Any]:
    """A robot of the collection, and a closed configuration with its motors moved by up to 15 % of their ranges."""
    found = eurdf.load(name, geometry=False)
    random = np.random.default_rng(seed)
    motors = {}
    for joint in found.actuation.joints:
        properties = found.slots[joint].joint.properties
        half = 0.15 * (properties.upper[0] - properties.lower[0])
        motors[joint] = found.joint_positions(found.configurations["assembled"])[joint][0] + random.uniform(-half, half)
    return found, eurdf.forward_kinematics(found, motors)


def with_properties(robot: Any, joints: Mapping[str, Mapping[str, Any]], **changes: Any) -> Any:
    """The robot with other properties of some joints, and other changes of its mechanism."""
    changed = [
        replace(each, properties=replace(each.properties, **joints.get(each.name, {})))
        for each in robot.mechanism.joints
    ]
    return build_robot(replace(robot.mechanism, joints=tuple(changed), **changes), geometry=False)


_LIMIT = '<limit lower="-9" upper="9" effort="10" velocity="3"/>'


def _at(x: float, y: float, z: float = 0.0) -> str:
    return f'<origin xyz="{x!r} {y!r} {z!r}"/>'


def _hinge(name: str, parent: str, child: str, at: str) -> str:
    return joint_element(name, "revolute", parent, child, f'<axis xyz="0 0 1"/>{_LIMIT}', at)


def _bars(*names: str) -> list[str]:
    return [link_element("ground"), *(link_element(name, inertial(1.0)) for name in names)]


def four_bar(ground: float, crank: float, coupler: float, follower: float, angles: Sequence[float]) -> Any:
    """A planar four-bar of these lengths, m; the zero of each joint is at x, and the follower turns at (ground, 0).

    It is assembled from angles of crank, coupler and follower in the world, rad.
    """
    urdf = robot(
        *_bars("crank", "coupler", "follower"),
        _hinge("motor", "ground", "crank", _at(0.0, 0.0)),
        _hinge("elbow", "crank", "coupler", _at(crank, 0.0)),
        _hinge("output", "ground", "follower", _at(ground, 0.0)),
    )
    q = {"motor": angles[0], "elbow": angles[1] - angles[0], "output": angles[2]}
    ends = f"{{link: coupler, xyz: [{coupler!r}, 0, 0]}}, {{link: follower, xyz: [{follower!r}, 0, 0]}}"
    return _closed(urdf, ends, q)


def slider_crank(crank: float, rod: float, angle: float) -> Any:
    """A planar slider-crank at an angle of the crank, which turns at the origin, where the zero of the slider is."""
    along = '<axis xyz="1 0 0"/>' + _LIMIT
    urdf = robot(
        *_bars("crank", "rod", "slider"),
        _hinge("motor", "ground", "crank", _at(0.0, 0.0)),
        _hinge("pin", "crank", "rod", _at(crank, 0.0)),
        joint_element("slide", "prismatic", "ground", "slider", along),
    )
    tilt = -np.arcsin(crank * np.sin(angle) / rod)
    reach = crank * np.cos(angle) + rod * np.cos(tilt)
    q = {"motor": angle, "pin": float(tilt - angle), "slide": float(reach)}
    return _closed(urdf, f"{{link: rod, xyz: [{rod!r}, 0, 0]}}, slider", q)


def _closed(urdf: str, ends: str, q: dict[str, float]) -> Any:
    yaml = f"closures:\n  - {{name: loop, type: 3d, frames: [{ends}]}}\nactuators: [motor]\n"
    found = load(urdf, yaml)
    return found, eurdf.assemble(found, found.configuration({name: (value,) for name, value in q.items()})).q
