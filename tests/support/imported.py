"""An MJCF file in MuJoCo itself, beside what was imported of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

import eurdf
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.mujoco_witness import mass_matrix


def model_without_meshes(path: Path) -> Any:
    """A file in MuJoCo, without the shapes that are meshes: some models have no files of them."""
    spec = mujoco.MjSpec.from_file(str(path))
    for geom in list(spec.geoms):
        if geom.meshname and geom.parent.explicitinertial:
            for pair in [each for each in spec.pairs if geom.name and geom.name in (each.geomname1, each.geomname2)]:
                spec.delete(pair)
            spec.delete(geom)
    if not any(geom.meshname for geom in spec.geoms):
        for mesh in list(spec.meshes):
            spec.delete(mesh)
    return spec.compile()


class Beside:
    """A robot that was imported, and the same in MuJoCo, whose joints have the same names."""

    def __init__(self, model: Any, mechanism: Mechanism) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self.robot: Robot = build_robot(mechanism, geometry=False)

    def places(self) -> list[tuple[str, int, int, str]]:
        """For each MuJoCo joint: name of the joint here, address in qpos and in qvel, and type."""
        model = self.model
        found = []
        for index in range(model.njnt):
            joint, kind = model.joint(index), int(model.jnt_type[index])
            name = ROOT_JOINT if kind == 0 and joint.name not in self.robot.slots else joint.name
            if name == ROOT_JOINT or name in self.robot.slots:
                found.append((name, int(model.jnt_qposadr[index]), int(model.jnt_dofadr[index]), "fbsh"[kind]))
        return found

    def at(self, qpos: Any) -> Any:
        """Move MuJoCo to a configuration; returns that of the robot."""
        self.data.qpos[:] = qpos
        mujoco.mj_forward(self.model, self.data)
        coordinates: dict[str, list[float]] = {}
        for name, at, _, kind in self.places():
            if kind in "fb":
                at_quaternion = at + (3 if kind == "f" else 0)
                w, x, y, z = qpos[at_quaternion : at_quaternion + 4]
                coordinates[name] = [*qpos[at:at_quaternion], x, y, z, w]
            else:
                coordinates[name] = [qpos[at]]
        return self.robot.configuration(coordinates)

    def random(self, seed: int) -> Any:
        """A configuration of MuJoCo, not a special one."""
        random = np.random.default_rng(seed)
        qpos = np.array(self.model.qpos0)
        mujoco.mj_integratePos(self.model, qpos, random.uniform(-0.5, 0.5, self.model.nv), 1.0)
        return qpos

    def assert_same_poses(self, q: Any) -> None:
        robot = self.robot
        pin.framesForwardKinematics(robot.model, robot.data, q)
        names = {self.model.body(index).name for index in range(self.model.nbody)}
        compared = [body.name for body in robot.mechanism.bodies if body.name in names]
        assert len(compared) > 1
        for name in compared:
            oMf = robot.data.oMf[robot.model.getFrameId(name, pin.FrameType.BODY)]
            np.testing.assert_allclose(oMf.translation, self.data.body(name).xpos, atol=1e-9, err_msg=name)
            np.testing.assert_allclose(oMf.rotation, self.data.body(name).xmat.reshape(3, 3), atol=1e-9, err_msg=name)
        for frame in robot.mechanism.frames:
            oMf = robot.data.oMf[robot.model.getFrameId(frame.name)]
            np.testing.assert_allclose(oMf.translation, self.data.site(frame.name).xpos, atol=1e-9)

    def assert_same_mass_matrix(self, q: Any, *, without: frozenset[str] = frozenset()) -> None:
        """M, in the velocities of the robot; MuJoCo's of a free joint are along the axes of the world."""
        robot, model = self.robot, self.model
        rows = []
        T = np.zeros((model.nv, robot.model.nv))
        for name, _, dof, kind in self.places():
            start = 0 if name == ROOT_JOINT else robot.slots[name].idx_v
            n = {"f": 6, "b": 3}.get(kind, 1)
            rows += range(dof, dof + n)
            block = np.eye(n)
            if kind == "f":
                w, x, y, z = self.data.qpos[3:7] if name == ROOT_JOINT else (1, 0, 0, 0)
                block[:3, :3] = by_hand.quaternion_rotation((x, y, z, w))
            T[dof : dof + n, start : start + n] = block
        M = mass_matrix(model, self.data)
        np.testing.assert_allclose(
            eurdf.mass_matrix(robot, q), T.T @ M @ T, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(M).max())
        )

    def assert_same_openings(self, q: Any) -> None:
        """How far each closure and coupling is open: the norm of MuJoCo's rows, of each point of a hinge the first."""
        data = self.data
        rows = data.efc_id[: data.ne]
        for opening, constraint in zip(
            eurdf.kinematics.closure_openings(self.robot, q), self.robot.mechanism.constraints, strict=True
        ):
            mine = data.efc_pos[: data.ne][rows == self.model.equality(constraint.name).id]
            assert len(mine), constraint.name
            if constraint.type == "coupling":
                residual = eurdf.residual(self.robot, q)
                at = sum(each.rows for each in self.robot.constraints[: self.robot.constraints.index(constraint)])
                np.testing.assert_allclose(abs(residual[at]), abs(mine[0]), atol=1e-9)
                continue
            np.testing.assert_allclose(opening.position, np.linalg.norm(mine[:3]), atol=1e-9)
            if constraint.type == "6d":
                np.testing.assert_allclose(opening.angle, 2.0 * np.arcsin(np.linalg.norm(mine[3:])), atol=1e-9)
