"""Forces that act on the joints: of motors, springs, damping and friction, and at frames."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from eurdf.array import Matrix, Vector
from eurdf.kinematics.evaluate import Frames, frames
from eurdf.kinematics.named import Named, motor_values_of, velocity_of
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Forces and moments at frames, by frame name: six numbers each, or a `pin.Force`.
External = Mapping[str, ArrayLike]


class AppliedForce:
    """What acts on a robot at one state after the other, besides gravity and its closures."""

    def __init__(self, robot: Robot, external: External | None, dissipation: bool) -> None:
        """Take the forces that do not change, as in `forward_dynamics`.

        Raises:
            ValueError: A frame is unknown, or a force is not six finite numbers.
        """
        self._robot, self._tree, self._dissipation = robot, robot.tree, dissipation
        self._external: tuple[Frames, Matrix] | None = None
        if external is not None and not isinstance(external, Mapping):
            raise ValueError(f"external must map names of frames to forces (6,), not {type(external).__name__}")
        if external:
            forces = [
                checked_array(f"external['{name}']", getattr(given, "vector", given), (6,))
                for name, given in external.items()
            ]
            self._external = frames(robot, list(external), few=True), np.array(forces)

    @property
    def is_constant_zero(self) -> bool:
        """Whether nothing acts but springs, unless motors or additional forces do."""
        return self._external is None and not self._dissipation

    def at(self, q: Vector, v: Vector, u: Named | None = None, tau: Named | None = None) -> Vector:
        """Generalized force (nv,) of all but the springs at q (nq,) and v (nv,).

        Raises:
            ValueError: The motor torques ``u`` (nu,), or the additional forces ``tau`` (nv,), have another shape or are
                not finite.
        """
        force = np.zeros(self._tree.nv) if tau is None else np.array(velocity_of(self._robot, tau, "tau"))
        if u is not None:
            force[self._robot.actuation.idx_v] += motor_values_of(self._robot, u)
        if self._external is not None:
            force += self._at_frames(*self._external, q)
        if self._dissipation:
            force -= self._tree.damping * v + self._tree.dry_friction * np.sign(v)
        return force

    def total(self, q: Vector, v: Vector, u: Named | None = None, tau: Named | None = None) -> Vector:
        """The same with that of the springs."""
        return self.with_springs(q, self.at(q, v, u, tau))

    def with_springs(self, q: Vector, force: Vector) -> Vector:
        """A generalized force (nv,) plus that of the springs at q (nq,)."""
        springs = self._tree.springs
        return force + springs.force(q, len(force)) if len(springs) else force

    def _at_frames(self, at_frames: Frames, forces: Matrix, q: Vector) -> Vector:
        """Sum of the generalized forces: their power is that of the forces."""
        (jacobians,) = at_frames.jacobians(at_frames.at(q[None]))
        return np.asarray(np.einsum("fi,fiv->v", forces, jacobians))
