"""A strut of variable length between the ground and a body that an actuator with several coordinates moves."""

from __future__ import annotations

from typing import Any

from support.described import load
from support.plain_urdf import inertial, joint_element, link_element, robot

#: Length of the strut at the zero of its slide, m. It starts below the point (1, 0, 0) at which the body is.
LENGTH = 1.0

_TURN, _AT = '<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/>', '<origin xyz="1 0 -1"/>'


def strut(kind: str, reach: float = 0.9) -> Any:
    """The robot.

    Args:
        kind: Of the actuator: planar, spherical or floating.
        reach: Position limit of the slide, both ways, m.
    """
    slide = f'<axis xyz="0 0 1"/><limit lower="{-reach!r}" upper="{reach!r}" effort="1" velocity="1"/>'
    own = "revolute" if kind == "spherical" else kind
    urdf = robot(
        *(link_element(name, inertial()) for name in ("ground", "body", "sleeve", "rod")),
        joint_element("mover", own, "ground", "body", _TURN if own != "floating" else ""),
        joint_element("pivot", "revolute", "ground", "sleeve", _TURN, _AT),
        joint_element("slide", "prismatic", "sleeve", "rod", slide),
    )
    joints = "  pivot: {type: universal, axes: xy}\n" + ("  mover: spherical\n" if kind == "spherical" else "")
    ends = f"{{link: body, xyz: [1, 0, 0]}}, {{link: rod, xyz: [0, 0, {LENGTH!r}]}}"
    closure = f"closures:\n  - {{name: end, type: 3d, frames: [{ends}]}}\n"
    return load(urdf, f"{closure}joints:\n{joints}actuators: [mover]\n")
