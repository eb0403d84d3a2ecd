"""A URDF, with or without loop joints, as Pinocchio reads it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree

from eurdf.array import Matrix, Vector
from eurdf.convert.verification.read_model import CannotRead, Exported, Range, ReadModel, opening_between
from eurdf.kinematics.opening import Opening


class PinocchioModel(ReadModel):
    """See `ReadModel`. Pinocchio reads the tree; loop joints are read from the file, and moved with its frames."""

    reader = f"Pinocchio {pin.__version__}"
    unverified = ("the fall is not simulated: Pinocchio reads no loops",)

    def __init__(self, exported: Exported) -> None:
        self._exported, text = exported, exported.path.read_bytes()
        self._file: Any = etree.fromstring(text)
        root = [pin.JointModelFreeFlyer()] if exported.robot.mechanism.root == "floating" else []
        try:
            self.model = pin.buildModelFromXML(text.decode(), *root)
        except (RuntimeError, ValueError) as error:
            raise CannotRead(self.reader, error) from None
        self.data = self.model.createData()
        joints: list[Any] = self._file.findall("joint")
        self._mimics: dict[str, Any] = {
            joint.get("name"): mimic for joint in joints if (mimic := joint.find("mimic")) is not None
        }

    @property
    def mass(self) -> float:
        return sum(float(each.mass) for each in self.model.inertias)

    def mass_matrix(self, q: Vector) -> Matrix:
        values, T = self._moved(q)
        M = np.triu(pin.crba(self.model, self.data, values))
        return np.asarray(T.T @ (M + np.triu(M, 1).T) @ T)

    def openings(self, q: Vector) -> tuple[Opening, ...]:
        values, _ = self._moved(q)
        pin.framesForwardKinematics(self.model, self.data, values)
        loops = {loop.get("name"): loop for loop in self._file.iterfind("loop_joint")}
        closures = (each for each in self._exported.robot.mechanism.closures if each.name in loops)
        return tuple(self._opening(closure, loops[closure.name]) for closure in closures)

    def ranges(self, q: Vector) -> tuple[Range, ...]:
        values, _ = self._moved(q)
        found = []
        for name, joint in list(zip(self.model.names, self.model.joints, strict=True))[1:]:  # after the universe
            if joint.nq == joint.nv == 1:
                at = joint.idx_q
                limits = self.model.lowerPositionLimit[at], self.model.upperPositionLimit[at]
                found.append(Range(name, float(values[at]), *map(float, limits)))
        return tuple(found)

    def _moved(self, q: Vector) -> tuple[Vector, Matrix]:
        """Pinocchio's configuration at q (nq,) of the robot, and T: its velocities are T v. Mimic joints follow."""
        map_, model = self._exported.coordinates, self.model
        given, rates = map_.to_q(q), map_.rates(q)
        values, T = pin.neutral(model), np.zeros((model.nv, rates.shape[1]))
        own: dict[str, tuple[float, Any]] = {}
        at_q = at_v = 0
        for name in map_.names:
            joint = model.joints[model.getJointId(name)]
            mine = given[at_q : at_q + joint.nq]
            values[joint.idx_q : joint.idx_q + joint.nq] = mine
            T[joint.idx_v : joint.idx_v + joint.nv] = rates[at_v : at_v + joint.nv]
            own[name] = float(mine[0] if joint.nq == 1 else np.arctan2(mine[1], mine[0])), rates[at_v]
            at_q, at_v = at_q + joint.nq, at_v + joint.nv
        for name, mimic in self._mimics.items():
            factor, offset = float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0))
            value, rate = own[mimic.get("joint")]
            joint = model.joints[model.getJointId(name)]
            value = factor * value + offset
            values[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
            T[joint.idx_v] = factor * rate
        return values, T

    def _opening(self, closure: Any, loop: Any) -> Opening:
        ends = []
        for tag in ("link1", "link2"):
            end = loop.find(tag)
            rpy, xyz = (np.array(end.get(each).split(), float) for each in ("rpy", "xyz"))
            oMf = self.data.oMf[self.model.getFrameId(end.get("link"), pin.FrameType.BODY)]
            ends.append((oMf * pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)).homogeneous)
        return opening_between(closure, ends[0], ends[1])
