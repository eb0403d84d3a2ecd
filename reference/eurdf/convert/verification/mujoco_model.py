"""An MJCF file as MuJoCo reads it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import mujoco
import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.convert.verification.read_model import CannotRead, Diverged, Exported, Instant, Range, ReadModel
from eurdf.kinematics.opening import Opening

_SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)
_BAD = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


class MuJoCoModel(ReadModel):
    """See `ReadModel`. What MuJoCo says of each equality of the file is its opening."""

    reader = f"MuJoCo {mujoco.__version__}"
    shorter = "divide timestep, and the first number of solref, by 2 in the file"

    def __init__(self, exported: Exported) -> None:
        self.coordinates = exported.coordinates
        try:
            self.model = mujoco.MjModel.from_xml_path(str(exported.path))
        except ValueError as error:
            raise CannotRead(self.reader, error) from None
        # At an infinite number, MuJoCo sets the time back to 0 and goes on.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.step = self.model.opt.timestep
        self.data = mujoco.MjData(self.model)
        self.velocities = [
            (self.model.joint(joint).name, "m" if self.model.jnt_type[joint] == _SLIDE else "rad")
            for joint in self.model.dof_jntid
        ]
        self._scales = [self._scale(equality) for equality in range(self.model.neq)]

    @property
    def mass(self) -> float:
        return float(self.model.body_mass.sum())

    def mass_matrix(self, q: Vector) -> Matrix:
        self._at(q)
        T = self.coordinates.rates(q)
        found = np.zeros((self.model.nv, T.shape[1]))
        for column, velocity in zip(found.T, T.T, strict=True):
            product = np.zeros(self.model.nv)
            mujoco.mj_mulM(self.model, self.data, product, velocity.copy())
            column[:] = product
        return np.asarray(T.T @ found)

    def openings(self, q: Vector) -> tuple[Opening, ...]:
        self._at(q)
        return self._openings()

    def ranges(self, q: Vector) -> tuple[Range, ...]:
        self._at(q)
        model, qpos = self.model, self.data.qpos
        return tuple(
            Range(model.joint(joint).name, float(qpos[model.jnt_qposadr[joint]]), *model.jnt_range[joint].tolist())
            for joint in np.flatnonzero(model.jnt_limited)
        )

    def fall(self, q: Vector, seconds: float, *, slower: int = 1, contacts: bool = True) -> Iterator[Instant]:
        model, data = self.model, self.data
        flags, step, solref = model.opt.disableflags, model.opt.timestep, model.eq_solref.copy()
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION  # else position servos move to 0
        if not contacts:
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        model.opt.timestep /= slower
        model.eq_solref[:, 0] /= slower
        messages: list[str] = []
        before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(messages.append)  # else it writes to the terminal and to MUJOCO_LOG.TXT
        try:
            self._at(q)
            for count in range(1, round(seconds / model.opt.timestep) + 1):
                mujoco.mj_step(model, data)
                if any(data.warning[kind].number for kind in _BAD) or not np.isfinite(data.qvel).all():
                    raise Diverged(messages[0] if messages else "")
                time = count * model.opt.timestep
                yield Instant(time, data.qpos.copy(), data.qvel.copy(), self._openings(), self._contact())
        finally:
            mujoco.set_mju_user_warning(before)
            model.opt.disableflags, model.opt.timestep, model.eq_solref[:] = flags, step, solref

    def _at(self, q: Vector) -> None:
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self.coordinates.to_q(q)
        mujoco.mj_forward(self.model, self.data)

    def _contact(self) -> tuple[str, str, float] | None:
        contacts = self.data.contact
        if not len(contacts):
            return None
        deepest = int(np.argmin(contacts.dist))
        one, other = (self.model.body(self.model.geom_bodyid[geom]).name for geom in contacts.geom[deepest])
        return one, other, max(0.0, -float(contacts.dist[deepest]))

    def _scale(self, equality: int) -> tuple[str, bool]:
        """Name of an equality, and whether its one row, if it has one, is a length."""
        model = self.model
        kind, first = model.eq_type[equality], model.eq_obj1id[equality]
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            length = model.jnt_type[first] == _SLIDE
        elif kind == mujoco.mjtEq.mjEQ_TENDON:
            wrap = model.tendon_adr[first]
            joint = model.wrap_type[wrap] == mujoco.mjtWrap.mjWRAP_JOINT
            length = not joint or model.jnt_type[model.wrap_objid[wrap]] == _SLIDE
        else:
            length = True
        return model.equality(equality).name, bool(length)

    def _openings(self) -> tuple[Opening, ...]:
        data, found = self.data, []
        ids, rows = data.efc_id[: data.ne], data.efc_pos[: data.ne]
        for equality, (name, length) in enumerate(self._scales):
            mine = rows[ids == equality]
            distance = float(np.linalg.norm(mine[:3])) if length else 0.0
            angle = 0.0
            if len(mine) == 6:  # of a weld: the vector of a quaternion, sin(θ/2) u
                angle = 2.0 * math.asin(min(1.0, float(np.linalg.norm(mine[3:]))))
            elif not length:
                angle = float(np.linalg.norm(mine))
            found.append(Opening(name, distance, angle))
        return tuple(found)
