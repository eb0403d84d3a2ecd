"""A robot with a joint of every type in a row, on a floating root."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from support.plain_urdf import inertial, joint_element, link_element, robot

Configuration = Mapping[str, Sequence[float]]

#: Of each link that weighs: mass, centre of mass, and diagonal of the inertia about it.
MASSES = {
    f"link_{index}": (1.0 + 0.1 * index, (0.1, -0.05 * index, 0.2), (0.1, 0.2 + 0.01 * index, 0.25))
    for index in (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 13, 14)
}

_JOINTS = [
    ("turn", "revolute", (1.0, 2.0, 2.0)),
    ("spin", "continuous", (0.0, 1.0, 0.0)),
    ("slide", "prismatic", (0.0, 3.0, 4.0)),
    ("plane", "planar", (0.0, 0.0, 1.0)),
    ("fly", "floating", None),
    ("ball", "revolute", (0.0, 0.0, 1.0)),
    ("cardan", "revolute", (0.0, 0.0, 1.0)),
    ("skew_cardan", "continuous", (0.0, 0.0, 1.0)),
    ("cylinder", "revolute", (1.0, 1.0, 0.0)),
    ("screw", "prismatic", (0.0, 0.0, -2.0)),
    ("m1", "revolute", (1.0, 0.0, 0.0)),
    ("m2", "revolute", (0.0, 1.0, 0.0)),
    ("m3", "continuous", (0.0, 0.0, 1.0)),
    ("follower", "revolute", (0.0, 1.0, 0.0)),
]

DESCRIPTION = """\
extended_urdf: "2.0"
root: floating
closures:
  - {name: far, type: 6d, frames: [tip, {link: link_0, xyz: [0.5, 0, 0.1], rpy: [0.1, 0.2, 0.3]}]}
  - {name: near, type: 3d, frames: [link_4, tip]}
joints:
  ball: {type: spherical, armature: 0.1}
  cardan: {type: universal, axes: xz}
  skew_cardan: {type: universal, axes: [[1, 0, 0], [1, 2, 0.5]]}
  cylinder: cylindrical
  screw: {type: helical, pitch: 0.4, armature: 0.2}
  merged: {type: spherical, merges: [m1, m2, m3]}
actuators:
  - turn
  - {joint: slide, gear_ratio: 50, rotor_inertia: 1.0e-4}
frames:
  - {name: tip, link: link_14, xyz: [0.1, 0.2, 0.3], rpy: [1, 0.5, -0.5]}
configurations:
  ready: {turn: 0.3, ball: [0, 0, 0.6, 0.8], screw: 0.5}
x-note: {series: 7}
"""

#: Not a special place for any of them.
CONFIGURATION: Configuration = {
    "root_joint": [0.1, -0.2, 0.3, 0.1, 0.2, 0.3, float(np.sqrt(0.86))],
    "turn": [0.4],
    "spin": [2.5],
    "slide": [0.13],
    "plane": [0.2, -0.1, 0.7],
    "fly": [-0.1, 0.2, 0.15, 0.5, -0.1, 0.7, 0.5],
    "ball": [0.2, 0.4, -0.4, 0.8],
    "cardan": [0.5, -0.8],
    "skew_cardan": [-0.3, 0.9],
    "cylinder": [0.12, 0.6],
    "screw": [1.7],
    "merged": [0.1, 0.7, 0.1, 0.7],
}


def write_every_joint(folder: Path) -> tuple[Path, Path]:
    """Write the two files."""
    links = []
    for index in range(15):
        weight = MASSES.get(f"link_{index}")
        content = ""
        if weight is not None:
            mass, center, (ixx, iyy, izz) = weight
            content = inertial(mass, f'<origin xyz="{_text(center)}"/>', (ixx, 0, 0, iyy, 0, izz))
        links.append(link_element(f"link_{index}", content))
    joints = []
    for index, (name, kind, axis) in enumerate(_JOINTS):
        content = "" if axis is None else f'<axis xyz="{_text(axis)}"/>'
        if kind in ("revolute", "prismatic"):
            content += '<limit lower="-3" upper="3" effort="10" velocity="5"/>'
        if name == "follower":
            content += '<mimic joint="turn" multiplier="-0.5" offset="0.2"/>'
        # The axes of m1, m2 and m3 meet in the origin of m1, away from that of m3.
        origin = {"m2": "", "m3": '<origin xyz="0 0 0.3"/>'}.get(
            name, f'<origin xyz="0.3 -0.1 {0.05 * index!r}" rpy="0.2 {0.1 * index!r} -0.4"/>'
        )
        joints.append(joint_element(name, kind, f"link_{index}", f"link_{index + 1}", content, origin))
    description, urdf = folder / "robot.yaml", folder / "robot.urdf"
    description.write_text(DESCRIPTION, encoding="utf-8")
    urdf.write_text(robot(*links, *joints, name="every joint"), encoding="utf-8")
    return description, urdf


def _text(values: Sequence[float]) -> str:
    return " ".join(map(repr, values))
