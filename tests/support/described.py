"""Robots from the texts of their two files, small ones among them."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.pinocchio.configuration import configuration_vector
from support.plain_urdf import inertial, joint_element, link_element, robot

LIMITED = '<axis xyz="{}"/><limit lower="-3" upper="3" effort="1" velocity="1"/>'


def load(urdf: str, yaml: str = "", **options: Any) -> eurdf.Robot:
    """The robot of a URDF and a description; of a bare URDF where there is none.

    A description that states no version is of version 1 if it has a key of it, else of version 2.0.
    """
    with tempfile.TemporaryDirectory() as folder:
        options.setdefault("geometry", False)
        return eurdf.load(written(Path(folder), urdf, yaml), **options)


def codes(urdf: str, yaml: str = "") -> list[str]:
    """The codes of everything that is found, in order."""
    with tempfile.TemporaryDirectory() as folder:
        return [found.code for found in eurdf.check(written(Path(folder), urdf, yaml)).diagnostics]


def written(folder: Path, urdf: str, yaml: str) -> Path:
    """The files of `load`, in a folder."""
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    if not yaml:
        return folder / "robot.urdf"
    one = re.search(r"^(closed_loop|type|name_mot|joint_name|joint_type|note):", yaml, re.MULTILINE)
    stated = yaml.startswith("extended_urdf:")
    (folder / "robot.yaml").write_text(yaml if one or stated else f'extended_urdf: "2.0"\n{yaml}', encoding="utf-8")
    return folder / "robot.yaml"


def body(name: str, content: str = "") -> str:
    return link_element(name, inertial(0.7, '<origin xyz="0.1 -0.2 0.3" rpy="0.4 0.5 0.6"/>') + content)


def revolute(name: str, parent: str, child: str, axis: Sequence[float] = (0, 0, 1), origin: str = "") -> str:
    xyz = " ".join(repr(float(value)) for value in axis)
    return joint_element(name, "revolute", parent, child, LIMITED.format(xyz), origin)


def origin(oMj: Any) -> str:
    """The origin element of a placement."""
    rpy = pin.rpy.matrixToRpy(oMj.rotation)
    xyz, angles = (" ".join(repr(float(value)) for value in values) for values in (oMj.translation, rpy))
    return f'<origin xyz="{xyz}" rpy="{angles}"/>'


def q_of(robot: eurdf.Robot, coordinates: Mapping[str, Sequence[float]]) -> Any:
    return configuration_vector(robot.mechanism, robot.model, coordinates)


def mass_matrix(model: Any, q: Any) -> Any:
    """Column i is the force that unit acceleration i takes, from the inverse dynamics.

    Pinocchio's ``crba`` is wrong, up to 4.1 at least, where a joint follows one of another branch.
    """
    data, still = model.createData(), np.zeros(model.nv)
    gravity = pin.rnea(model, data, q, still, still).copy()
    columns = [pin.rnea(model, data, q, still, unit) - gravity for unit in np.eye(model.nv)]
    return np.array(columns).reshape(model.nv, model.nv).T


def at(model: Any, joint: str) -> tuple[int, int, int, int]:
    """Indices of a joint's coordinates and velocities: idx_q, nq, idx_v, nv."""
    last = model.getJointId(joint)
    assert last < model.njoints, f"no joint '{joint}'"
    first = last - model.existJointName(f"{joint}/1")  # a universal or cylindrical joint is two in series
    return model.idx_qs[first], sum(model.nqs[first : last + 1]), model.idx_vs[first], sum(model.nvs[first : last + 1])


STAR_CONTENT = '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>'
STAR_JOINTS = {"a": "revolute", "b": "continuous", "c": "prismatic", "d": "revolute", "e": "planar", "f": "floating"}
STAR_JOINTS["g"] = "fixed"

STAR = robot(
    link_element("base"),
    *(body(f"l{name}") for name in STAR_JOINTS),
    *(joint_element(name, kind, "base", f"l{name}", STAR_CONTENT) for name, kind in STAR_JOINTS.items()),
)


#: Length of the strut at the zero of its slide, m. It starts below the point (1, 0, 0) at which the body is.
STRUT = 1.0

_TURN, _AT = '<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/>', '<origin xyz="1 0 -1"/>'


def strut(kind: str, reach: float = 0.9) -> Any:
    """A robot whose actuator is planar, spherical or floating, with a slide that moves `reach` both ways, m."""
    slide = f'<axis xyz="0 0 1"/><limit lower="{-reach!r}" upper="{reach!r}" effort="1" velocity="1"/>'
    own = "revolute" if kind == "spherical" else kind
    urdf = robot(
        *(link_element(name, inertial()) for name in ("ground", "body", "sleeve", "rod")),
        joint_element("mover", own, "ground", "body", _TURN if own != "floating" else ""),
        joint_element("pivot", "revolute", "ground", "sleeve", _TURN, _AT),
        joint_element("slide", "prismatic", "sleeve", "rod", slide),
    )
    joints = "  pivot: {type: universal, axes: xy}\n" + ("  mover: spherical\n" if kind == "spherical" else "")
    ends = f"{{link: body, xyz: [1, 0, 0]}}, {{link: rod, xyz: [0, 0, {STRUT!r}]}}"
    closure = f"closures:\n  - {{name: end, type: 3d, frames: [{ends}]}}\n"
    return load(urdf, f"{closure}joints:\n{joints}actuators: [mover]\n")


ARM = """\
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
ARM_DESCRIPTION = 'extended_urdf: "2.0"\nactuators: [shoulder]\n'
