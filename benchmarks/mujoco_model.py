"""A robot in MuJoCo's terms, to compare times at the same poses."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.pose import Pose

Vector = npt.NDArray[np.float64]

_HINGES = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.UNIVERSAL)


def mujoco_model(robot: eurdf.Robot, step: float) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The spanning tree of a robot with its springs, its 3d closures as `connect` and its 6d closures as `weld`.

    MuJoCo's integrator is RK4, its other options are its defaults, and it has no contacts and no limits.

    Args:
        robot: The robot; each offset of a joint is the identity.
        step: Time step, s.
    """
    mechanism = robot.mechanism
    top = ET.Element("mujoco")
    ET.SubElement(top, "compiler", angle="radian", boundmass="1e-12", boundinertia="1e-12", balanceinertia="true")
    ET.SubElement(top, "option", integrator="RK4", timestep=repr(step), gravity="0 0 -9.81")
    root = ET.SubElement(top, "worldbody")
    if mechanism.root == "floating":
        root = ET.SubElement(root, "body", name=mechanism.bodies[0].name)
        ET.SubElement(root, "freejoint", name=f"{ROOT_JOINT}/0")
        _add_inertia(root, mechanism.bodies[0])
    bodies = {mechanism.bodies[0].name: root}
    for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
        part = bodies[body.name] = ET.SubElement(
            bodies[joint.parent], "body", {"name": body.name, **_at(joint.placement)}
        )
        properties = joint.properties
        for index, attributes in enumerate(_motions(joint)):
            attributes["armature"] = repr(properties.armature[index] if properties.armature else 0.0)
            if properties.stiffness:
                attributes["stiffness"] = repr(properties.stiffness[index])
                attributes["springref"] = repr(properties.rest[index])
            ET.SubElement(part, "joint", {"name": f"{joint.name}/{index}", **attributes})
        _add_inertia(part, body)
    equality = ET.SubElement(top, "equality")
    for closure in mechanism.closures:
        for end, anchor in (("a", closure.a), ("b", closure.b)):
            ET.SubElement(bodies[anchor.body], "site", {"name": f"{closure.name}/{end}", **_at(anchor.pose)})
        kind = {"3d": "connect", "6d": "weld"}[closure.type]
        ET.SubElement(equality, kind, site1=f"{closure.name}/a", site2=f"{closure.name}/b")
    model = mujoco.MjModel.from_xml_string(ET.tostring(top, "unicode"))
    return model, mujoco.MjData(model)


def move(robot: eurdf.Robot, model: mujoco.MjModel, data: mujoco.MjData, q: Vector, v: Vector) -> None:
    """Bring MuJoCo to a configuration (nq,) and velocity (nv,) of a robot.

    Raises:
        AssertionError: A body is elsewhere than in the robot.
    """
    mujoco.mj_resetData(model, data)
    for name, values in robot.joint_positions(q).items():
        if name == ROOT_JOINT:
            x, y, z, *quaternion = values
            joint = data.joint(f"{name}/0")
            joint.qpos[:3], joint.qpos[3:] = (x, y, z), (quaternion[3], *quaternion[:3])
            joint.qvel[:3], joint.qvel[3:] = pin.Quaternion(np.array(quaternion)).matrix() @ v[:3], v[3:6]
            continue
        slot = robot.slots[name]
        own = v[slot.idx_v : slot.idx_v + slot.nv]
        if slot.joint.type is JointType.SPHERICAL:
            x, y, z, w = values
            data.joint(f"{name}/0").qpos[:] = w, x, y, z
            data.joint(f"{name}/0").qvel[:] = own
        else:
            for index, value in enumerate(values):
                data.joint(f"{name}/{index}").qpos[:] = value
                data.joint(f"{name}/{index}").qvel[:] = own[index]
    mujoco.mj_forward(model, data)
    gap = max((np.abs(_gap(data, closure.name)).max() for closure in robot.mechanism.closures), default=0.0)
    assert gap < 1e-6, f"a closure is open by {gap} m in MuJoCo"


def _add_inertia(part: ET.Element, body: Body) -> None:
    if body.inertia is not None and body.inertia.mass:
        xx, xy, xz, yy, yz, zz = body.inertia.moments
        R = _rotation(body.inertia.pose)
        full = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
        moments = _text([full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2]])
        ET.SubElement(
            part, "inertial", pos=_text(body.inertia.pose.xyz), mass=repr(body.inertia.mass), fullinertia=moments
        )


def _gap(data: mujoco.MjData, closure: str) -> Vector:
    return np.asarray(data.site(f"{closure}/a").xpos - data.site(f"{closure}/b").xpos)


def _motions(joint: Joint) -> list[dict[str, str]]:
    """The joints of MuJoCo that a joint is, from the parent outwards."""
    if joint.type in _HINGES:
        return [{"type": "hinge", "axis": _text(axis)} for axis in joint.axes]
    if joint.type is JointType.PRISMATIC:
        return [{"type": "slide", "axis": _text(joint.axes[0])}]
    if joint.type is JointType.SPHERICAL:
        return [{"type": "ball"}]
    assert joint.type is JointType.FIXED, f"joint '{joint.name}' of type {joint.type.value} is not supported here"
    return []


def _at(pose: Pose) -> dict[str, str]:
    x, y, z, w = pose.quaternion
    return {"pos": _text(pose.xyz), "quat": _text((w, x, y, z))}


def _rotation(pose: Pose) -> npt.NDArray[np.float64]:
    R = np.zeros(9)
    x, y, z, w = pose.quaternion
    mujoco.mju_quat2Mat(R, np.array([w, x, y, z]))
    return R.reshape(3, 3)


def _text(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)
