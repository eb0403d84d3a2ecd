"""Numbers, names and angles in XML, and the bytes of a file."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from lxml import etree

from eurdf.mechanism.pose import AXES, Pose, Vector3

_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def numbers(values: Sequence[float]) -> str:
    """Numbers that are read back to the last bit: the shortest text of at most 17 significant digits of each."""
    return " ".join(repr(float(value) + 0.0).removesuffix(".0") for value in values)


def representable(name: str) -> str:
    """The name, with ``_`` for each character that XML cannot contain."""
    return _NOT_IN_XML.sub("_", name)


def file_content(root: etree._Element) -> bytes:
    """The bytes of an XML file, indented."""
    etree.indent(root, "  ")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8") + b"\n"


def rpy_of(pose: Pose) -> Vector3:
    """Roll, pitch and yaw of an orientation, rad: those that it was read from, if any.

    Of other orientations, the shortest numbers that give exactly its quaternion, if any do. Yaw is 0 where it can be,
    as where the pitch is ±π/2, which leaves it open; else the pitch is between these two.
    """
    if pose.rpy is not None:
        return pose.rpy
    x, y, z = (pose.rotate(axis) for axis in AXES)
    exact = angles_with_yaw(math.atan2(x[1], x[0]), x, y, z)
    level = angles_with_yaw(0.0, x, y, z)
    for digits in range(17):
        for roll, pitch, yaw in (level, exact):
            rounded = round(roll, digits), round(pitch, digits), round(yaw, digits)
            if Pose.from_xyz_rpy(pose.xyz, rounded).quaternion == pose.quaternion:
                return rounded
    return exact


def angles_with_yaw(yaw: float, x: Vector3, y: Vector3, z: Vector3) -> Vector3:
    """Roll, pitch and this yaw, rad, of the frame with these axes, if it has this yaw.

    The roll is found from the yaw, so that rounding is not amplified where the pitch is near ±π/2.
    """
    s, c = math.sin(yaw), math.cos(yaw)
    return math.atan2(s * z[0] - c * z[1], c * y[1] - s * y[0]), math.atan2(-x[2], c * x[0] + s * x[1]), yaw
