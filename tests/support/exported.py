"""Random robots for exports, and exported robots in the programs that read them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

import eurdf
from eurdf.convert.coordinates import Coordinates
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Root
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.mechanisms import closed_tree
from support.plain_urdf import inertial, pinocchios_own

#: A link's inertia and shape, and a joint's limits, of robots that the tests of formats write.
BODY = inertial(1.5, '<origin xyz="0.1 0.2 0.3"/>')
BALL = '<collision><geometry><sphere radius="0.05"/></geometry></collision>'
LIMIT = '<limit lower="-1" upper="2" effort="7" velocity="3"/>'


def real_inertia(random: np.random.Generator) -> Inertia:
    """Of a few masses: the triangle inequality holds."""
    points = random.uniform(-0.5, 0.5, (6, 3))
    points -= points.mean(axis=0)
    A = sum(p @ p * np.eye(3) - np.outer(p, p) for p in points)
    moments = (A[0, 0], A[0, 1], A[0, 2], A[1, 1], A[1, 2], A[2, 2])
    return Inertia(random.uniform(0.5, 2.0), by_hand.some_pose(random), tuple(map(float, moments)))


def some_properties(joint: Joint, random: np.random.Generator) -> JointProperties:
    """Armature, damping and friction, equal on all axes that one joint of MuJoCo has.

    Planar and floating joints have no armature, which is exported with a loss.
    """
    if joint.type is JointType.FIXED:
        return joint.properties
    nv = joint.type.nv
    together = joint.type in (JointType.SPHERICAL, JointType.PLANAR, JointType.FLOATING)

    def values() -> tuple[float, ...]:
        return tuple(random.uniform(0.1, 1.0, 1).tolist() * nv if together else random.uniform(0.1, 1.0, nv).tolist())

    armature = (0.0,) * nv if joint.type in (JointType.PLANAR, JointType.FLOATING) else values()
    return replace(JointProperties.unlimited(joint.type), armature=armature, damping=values(), friction=values())


def random_robot(seed: int, root: Root = "fixed", **options: Any) -> tuple[Robot, Any]:
    """A tree of all joint types, closed by constraints of all kinds, and a configuration that closes it."""
    random = np.random.default_rng(seed)
    robot, q = closed_tree(random, root=root, **options)
    mechanism = robot.mechanism
    joints = tuple(replace(joint, properties=some_properties(joint, random)) for joint in mechanism.joints)
    bodies = tuple(replace(body, inertia=real_inertia(random)) for body in mechanism.bodies)
    coordinates = robot.joint_positions(q)
    mechanism = replace(
        mechanism, version="2.1", joints=joints, bodies=bodies, configurations={"assembled": coordinates}
    )
    return build_robot(mechanism, geometry=False), q


_HANGING = """<robot name="hanging"><link name="base"/>
{}
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint>
<joint name="k" type="revolute"><parent link="base"/><child link="b"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/>{}</joint>
<joint name="screw" type="revolute"><parent link="base"/><child link="c"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""
_INERTIAL = (
    '<inertial><origin xyz="0.1 0 -0.3"/><mass value="1"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def hanging(mimic: str = "", massless: str = "") -> str:
    """A URDF of two pendulums, j and k, and a joint called screw about the vertical.

    Args:
        mimic: An element of k.
        massless: Names, of a, b and c, of the links without mass; b is that of k.
    """
    links = (f'<link name="{name}">{"" if name in massless else _INERTIAL}</link>' for name in "abc")
    return _HANGING.format("".join(links), mimic)


def values_of_parts(coordinates: Coordinates, q: Any) -> list[list[float]]:
    """The configuration of an exported model, part by part, with angles where it has cosines and sines."""
    values, found = coordinates.to_q(q).tolist(), []
    for part in coordinates.parts:
        mine, values = values[: part.nq], values[part.nq :]
        for index in part.circular:
            mine[index : index + 2] = [float(np.arctan2(mine[index + 1], mine[index]))]
        found.append(mine)
    return found


def near(robot: Robot, q: Any, seed: int = 0) -> tuple[Any, Any]:
    """A configuration near q, loops open, and a velocity."""
    random = np.random.default_rng(seed)
    return pin.integrate(robot.model, q, random.uniform(-0.3, 0.3, robot.model.nv)), random.uniform(
        -1.0, 1.0, robot.model.nv
    )


def witness(robot: Robot, export: eurdf.convert.Export) -> Any:
    """An exported robot in the program that reads it, which has `names`, `at`, `pose`, `inertia_matrix` and `bias`."""
    if export.format == "mjcf":
        return InMuJoCo(robot, export)
    if export.format in ("urdf", "loop-joint"):
        return InPinocchio(robot, export)
    from support import drake_witness

    return {"drake": drake_witness.InDrake, "sdf": drake_witness.TreeInDrake}[export.format](robot, export)


class InPinocchio:
    """The tree of an exported robot in Pinocchio."""

    bias = None

    def __init__(self, robot: Robot, export: eurdf.convert.Export) -> None:
        self.coordinates = export.coordinates
        self.model = pinocchios_own(export.main.decode(), robot.mechanism.root)
        self.data = self.model.createData()
        assert (self.model.nq, self.model.nv) == (self.coordinates.nq, self.coordinates.nv)

    @property
    def names(self) -> list[str]:
        joints = list(zip(self.model.names, self.model.joints, strict=True))[1:]
        return [name for name, joint in joints if joint.nv]

    def at(self, q: Any, v: Any) -> Any:
        self.q = self.coordinates.to_q(q)
        pin.framesForwardKinematics(self.model, self.data, self.q)
        return self.coordinates.rates(q)

    def pose(self, name: str) -> Any:
        return self.data.oMf[self.model.getFrameId(name, pin.FrameType.BODY)].homogeneous

    @property
    def inertia_matrix(self) -> Any:
        """Column by column: Pinocchio's crba has wrong entries where a mimic joint carries several branches."""
        still = np.zeros(self.model.nv)
        gravity = pin.rnea(self.model, self.data, self.q, still, still)
        columns = [pin.rnea(self.model, self.data, self.q, still, each) - gravity for each in np.eye(self.model.nv)]
        return np.array(columns).T


class InMuJoCo:
    """An exported robot in MuJoCo."""

    def __init__(self, robot: Robot, export: eurdf.convert.Export) -> None:
        self.robot, self.coordinates = robot, export.coordinates
        meshes = {path.removeprefix("meshes/"): content for path, content in export.files.items()}
        self.model = mujoco.MjModel.from_xml_string(export.main.decode(), meshes)
        self.model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        self.data = mujoco.MjData(self.model)

    @property
    def names(self) -> list[str]:
        return [self.model.joint(index).name for index in range(self.model.njnt)]

    def at(self, q: Any, v: Any | None = None) -> Any:
        """Move there; returns T: MuJoCo's velocities are T v."""
        self.data.qpos[:] = self.coordinates.to_q(q)
        self.data.qvel[:] = 0.0 if v is None else self.coordinates.to_v(q, v)
        mujoco.mj_forward(self.model, self.data)
        return self.coordinates.rates(q)

    def pose(self, name: str) -> Any:
        """Of a link or a frame, (4, 4)."""
        try:
            found = self.data.body(name)
        except KeyError:
            found = self.data.site(name)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = found.xmat.reshape(3, 3), found.xpos
        return pose

    @property
    def inertia_matrix(self) -> Any:
        return np.array([self.times_mass(column) for column in np.eye(self.model.nv)])

    @property
    def bias(self) -> Any:
        """Forces of inertia and gravity at no acceleration."""
        return self.data.qfrc_bias

    def quaternion_sign(self, site: str, other: str) -> float:
        """1 if MuJoCo's quaternions of two sites are of the same one of the two hemispheres, else -1."""
        found = []
        for name in (site, other):
            at, quaternion = self.model.site(name), np.zeros(4)
            mujoco.mju_mulQuat(quaternion, self.data.xquat[at.bodyid[0]], at.quat)
            found.append(quaternion)
        return float(np.copysign(1.0, found[0] @ found[1]))

    def times_mass(self, vector: Any) -> Any:
        found = np.zeros(self.model.nv)
        mujoco.mj_mulM(self.model, self.data, found, vector)
        return found

    def rows(self, equality: str) -> tuple[Any, Any]:
        """Residual and Jacobian, for velocities of the robot, of an equality; of a configuration set by `at`."""
        d, n = self.data, self.data.ne
        mine = d.efc_id[:n] == self.model.equality(equality).id
        q = self.coordinates.from_q(d.qpos)
        J = d.efc_J.reshape(-1, self.model.nv)[:n][mine] @ self.coordinates.rates(q)
        return d.efc_pos[:n][mine], J
