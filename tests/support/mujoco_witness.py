"""MuJoCo as a witness: a mechanism of the suite in its terms, where it says poses, K at closed loops, M and masses.

It shares nothing with the oracle nor with Pinocchio. It reads MJCF, written here from the mechanism, and works with
velocities of its own, which `Witness.rates` makes of those of the files. Inertias are exact to rounding from its
release 3.15 on, to 1e-7 before.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import numpy.typing as npt

from eurdf_conformance.properties.mechanism import Change, Inertia, Joint, Mechanism, Pose, Spot

Array = npt.NDArray[np.float64]
Coordinates = Mapping[str, Sequence[float]]

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
#: kg and kg·m² of what weighs nothing and moves: MuJoCo refuses to move what does.
LEAST = 1e-14

_ROOT = Joint(name="root_joint", type="floating", parent="", child="")


def _text(numbers: Sequence[float]) -> str:
    return " ".join(map(repr, map(float, numbers)))


class Witness:
    """A mechanism without merged joints, as MuJoCo has it."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self._carried = {joint.child: joint for joint in mechanism.joints}
        self._joints = {joint.name: joint for joint in mechanism.joints}
        if mechanism.root == "floating":
            self._joints["root_joint"] = _ROOT
        # By joint of the mechanism the joints of MuJoCo that it is: their types and axes.
        self._parts: dict[str, list[tuple[str, Sequence[float]]]] = {}
        top = ET.Element("mujoco")
        least = {"boundmass": repr(LEAST), "boundinertia": repr(LEAST)}
        ET.SubElement(top, "compiler", angle="radian", eulerseq="XYZ", inertiafromgeom="false", **least)
        bodies = {"": ET.SubElement(top, "worldbody")}
        (root,) = {link.name for link in mechanism.links} - self._carried.keys()
        order = [root]
        for name in order:  # it grows as it is walked
            order += [joint.child for joint in mechanism.joints if joint.parent == name]
            bodies[name] = self._body(bodies, name)
        self.model = mujoco.MjModel.from_xml_string(ET.tostring(top, "unicode"))
        self.data = mujoco.MjData(self.model)

    def _body(self, bodies: Mapping[str, ET.Element], name: str) -> ET.Element:
        joint = self._carried.get(name)
        pose = joint.origin if joint else Pose()
        body = ET.SubElement(
            bodies[joint.parent if joint else ""], "body", name=name, pos=_text(pose.xyz), euler=_text(pose.rpy)
        )
        if joint or self.mechanism.root == "floating":
            joint = joint or _ROOT
            self._parts[joint.name] = self._motion(joint)
            for i, (kind, axis) in enumerate(self._parts[joint.name]):
                ET.SubElement(body, "joint", name=f"{joint.name}/{i}", type=kind, axis=_text(axis))
        (inertia,) = (link.inertia for link in self.mechanism.links if link.name == name)
        if inertia:
            xx, xy, xz, yy, yz, zz = _turned(inertia)
            full = _text((xx, yy, zz, xy, xz, yz))
            ET.SubElement(body, "inertial", pos=_text(inertia.pose.xyz), mass=repr(inertia.mass), fullinertia=full)
        for spot_name, spot in self._spots().items():
            if (spot.of if spot.on == "link" else self._joints[spot.of].child) == name:
                ET.SubElement(body, "site", name=spot_name, pos=_text(spot.pose.xyz), euler=_text(spot.pose.rpy))
        return body

    def _spots(self) -> dict[str, Spot]:
        """The ends of closures, and the frames of all names."""
        mechanism = self.mechanism
        named = {joint.name: Spot(on="joint", of=joint.name) for joint in mechanism.joints}
        named |= {link.name: Spot(on="link", of=link.name) for link in mechanism.links}
        named |= {frame.name: frame.spot for frame in mechanism.frames}
        ends = {f"{closure.name}/{end}": getattr(closure, end) for closure in mechanism.closures for end in "ab"}
        found = {f"frame/{name}": spot for name, spot in named.items()}
        return found | {name: named[end] if isinstance(end, str) else end for name, end in ends.items()}

    def _motion(self, joint: Joint) -> list[tuple[str, Sequence[float]]]:
        """The joints of MuJoCo, from the parent outwards, that a joint is."""
        axis = joint.axis or _AXES["x"]
        change = self.mechanism.changes.get(joint.name, Change())
        match self.mechanism.type_of(joint):
            case "revolute" | "continuous":
                return [("hinge", axis)]
            case "prismatic":
                return [("slide", axis)]
            case "cylindrical" | "helical":
                return [("slide", axis), ("hinge", axis)]
            case "universal":
                axes = [_AXES[letter] if isinstance(letter, str) else letter for letter in change.axes or ()]
                return [("hinge", each) for each in axes]
            case "spherical":
                return [("ball", _AXES["z"])]
            case "planar":
                return [("slide", _AXES["x"]), ("slide", _AXES["y"]), ("hinge", _AXES["z"])]
            case "floating":
                return [("slide", axis) for axis in _AXES.values()] + [("ball", _AXES["z"])]
        return []

    def at(self, q: Coordinates) -> None:
        """Move to a configuration; a joint that is left out is at its neutral."""
        self.data.qpos[:] = self.model.qpos0
        for name, joint in self._joints.items():
            for i, value in enumerate(self._values(joint, q)):
                if self._parts[name][i][0] == "ball":
                    x, y, z, w = np.asarray(value) / np.linalg.norm(value)
                    self.data.joint(f"{name}/{i}").qpos[:] = w, x, y, z
                else:
                    self.data.joint(f"{name}/{i}").qpos[:] = value
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def _values(self, joint: Joint, q: Coordinates) -> list[Any]:
        """The coordinates of the joints of MuJoCo that a joint is."""
        kind = self.mechanism.type_of(joint)
        if kind == "fixed":
            return []
        if joint.mimic:
            (leader,) = self._values(self._joints[joint.mimic.joint], q)
            return [joint.mimic.multiplier * leader + joint.mimic.offset]
        given = [float(each) for each in q.get(joint.name, ())]
        if kind == "floating":
            given = given or [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
            return [*given[:3], given[3:]]
        if kind == "spherical":
            return [given or [0.0, 0.0, 0.0, 1.0]]
        if kind == "helical":
            angle = (given or [0.0])[0]
            return [self._lead(joint) * angle, angle]
        return list(given or [0.0] * len(self._parts[joint.name]))

    def _lead(self, joint: Joint) -> float:
        """m a radian, of a helical joint."""
        pitch = self.mechanism.changes[joint.name].pitch
        assert pitch is not None
        return pitch / (2.0 * math.pi)

    def rates(self, q: Coordinates, columns: Sequence[tuple[str, int]]) -> Array:
        """What turns velocities of the files, in an order, into those of MuJoCo, at a configuration."""
        T = np.zeros((self.model.nv, len(columns)))
        for name, parts in self._parts.items():
            joint = leader = self._joints[name]
            block = np.eye(sum(3 if kind == "ball" else 1 for kind, _ in parts))
            while leader.mimic:
                block *= leader.mimic.multiplier
                leader = self._joints[leader.mimic.joint]
            match self.mechanism.type_of(joint):
                case "helical":
                    block = np.array([[self._lead(joint)], [1.0]])
                case "planar":  # slides along the axes of the joint, not of the child
                    block[:2, :2] = _of_angles((0.0, 0.0, self._values(joint, q)[2]))[:2, :2]
                case "floating":
                    block[:3, :3] = _of_quaternion(self._values(joint, q)[3])
            if parts:
                first = self.model.joint(f"{name}/0").dofadr[0]
                mine = [columns.index((leader.name, i)) for i in range(block.shape[1])]
                T[first : first + len(block), mine] = block
        return T

    def pose(self, site: str) -> tuple[Array, Array]:
        """Rotation and origin, m, in the world: of ``frame/`` and a name, or of a closure, ``/`` and ``a`` or ``b``."""
        found = self.data.site(site)
        return found.xmat.reshape(3, 3).copy(), found.xpos.copy()

    def mass_matrix(self) -> Array:
        """M in MuJoCo's velocities, without armatures."""
        mujoco.mj_crb(self.model, self.data)
        return mass_matrix(self.model, self.data)

    def jacobian(self, closure: str) -> Array:
        """The rows of K of a closure that is closed, in MuJoCo's velocities: how B moves relative to A, seen from A."""
        (kind,) = (each.type for each in self.mechanism.closures if each.name == closure)
        linear, angular = self._relative(closure)
        R, _ = self.pose(f"{closure}/a")
        return np.vstack([R.T @ each for each in ((linear,) if kind == "3d" else (linear, angular))])

    def _relative(self, closure: str) -> tuple[Array, Array]:
        found = []
        for end in "ab":
            linear, angular = np.zeros((2, 3, self.model.nv))
            mujoco.mj_jacSite(self.model, self.data, linear, angular, self.model.site(f"{closure}/{end}").id)
            found.append((linear, angular))
        (one, turning), (other, turned) = found
        return other - one, turned - turning

    @property
    def mass(self) -> float:
        """kg, of all links."""
        return float(self.model.body_mass.sum())

    @property
    def center_of_mass(self) -> Array:
        """In the world, m."""
        return np.array(self.data.subtree_com[0])


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """M where mj_crb was called, one column after the other: a call that releases have in common."""
    M = np.zeros((model.nv, model.nv))
    for row, unit in zip(M, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    return M


def _turned(inertia: Inertia) -> Array:
    """The moments along the axes of the link: MuJoCo takes those of a full matrix along no others."""
    xx, xy, xz, yy, yz, zz = inertia.moments
    R = _of_angles(inertia.pose.rpy)
    found = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
    return np.asarray(found[np.triu_indices(3)])


def _of_angles(rpy: Sequence[float]) -> Array:
    wxyz = np.zeros(4)
    mujoco.mju_euler2Quat(wxyz, np.asarray(rpy, dtype=float), "XYZ")
    return _rotation(wxyz)


def _of_quaternion(xyzw: Sequence[float]) -> Array:
    x, y, z, w = np.asarray(xyzw) / np.linalg.norm(xyzw)
    return _rotation(np.array([w, x, y, z]))


def _rotation(wxyz: Array) -> Array:
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, wxyz)
    return R.reshape(3, 3)


def read_urdf(path: Path) -> mujoco.MjModel:
    """A URDF as MuJoCo reads it, whose root link is its world; without shapes, and with links that weigh nothing."""
    robot = ET.parse(path).getroot()
    for link in robot.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    spec = mujoco.MjSpec.from_string(ET.tostring(robot, "unicode"))
    spec.compiler.fusestatic = False
    spec.compiler.boundmass = spec.compiler.boundinertia = LEAST
    return spec.compile()
