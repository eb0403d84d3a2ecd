"""The residual of the closures, r(q), and its derivative, the constraint Jacobian K(q).

A 6d closure has the six rows log6(ᴬM_B), (linear, angular) (EU-CLO-008), and a 3d closure has the three of the origin
of B in A (EU-CLO-009). K is the exact derivative, K v = d/dt r(q ⊕ t v) at t = 0 (EU-CLO-010), at every configuration,
closed or not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.loop import find_loops

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: A closure that is open by no more than this, in m or rad, counts as closed (EU-CLO-005).
CLOSED = 1e-6


def residual(robot: Robot, q: Vector, data: Any = None) -> Vector:
    """Residual of all closures, stacked in their order: log6(ᴬM_B) or ᴬp_B (EU-CLO-008, EU-CLO-009).

    Args:
        robot: The robot.
        q: Configuration (nq,).
        data: A `pin.Data` of the model to compute in. Without one, forward kinematics runs along the loops alone, in
            time and memory linear in their length: slower for small robots, but a `pin.Data` holds some 8 nv³ numbers.

    Returns:
        r (nc,): m and rad.
    """
    loops = find_loops(robot)
    placements = _placements(robot, q, data)
    r = np.empty(loops[-1].rows.stop if loops else 0)
    for loop, constraint in zip(loops, robot.constraint_models, strict=True):
        aMb = _frame_a(placements, constraint).actInv(_frame_b(placements, constraint))
        r[loop.rows] = residual_rows(aMb, loop.spatial)
    return r


def residual_and_jacobian(robot: Robot, q: Vector, data: Any = None) -> tuple[Vector, Matrix]:
    """Residual of all closures and its derivative (EU-CLO-010).

    With J_A and J_B the world Jacobians of the bodies of A and B, the rows of K are those of `rows_of_twist` times
    Ad(ᴬM_0) · (J_B - J_A).

    Args:
        robot: The robot.
        q: Configuration (nq,).
        data: A `pin.Data` of the model to compute in, or None: see `residual`.

    Returns:
        r (nc,), and K (nc, nv), in m and rad over the units of v.
    """
    loops = find_loops(robot)
    if data is None:
        placements, J = jacobian_along(robot, q)
    else:
        J = pin.computeJointJacobians(robot.model, data, q).reshape(6, -1)  # (6,) where nv is 1
        placements = data.oMi
    nc = loops[-1].rows.stop if loops else 0
    r, K = np.empty(nc), np.zeros((nc, robot.model.nv))
    for loop, constraint in zip(loops, robot.constraint_models, strict=True):
        oMa, oMb = _frame_a(placements, constraint), _frame_b(placements, constraint)
        aMb = oMa.actInv(oMb)
        r[loop.rows] = residual_rows(aMb, loop.spatial)
        projection = rows_of_twist(aMb, loop.spatial) @ oMa.toActionMatrixInverse()
        path = loop.path
        block = projection @ (J[:, path.columns] * path.signs)
        if path.mimics:
            np.add.at(K[loop.rows].T, path.velocities, block.T)
        else:
            K[loop.rows, path.velocities] = block
    return r, K


def residual_rows(aMb: Any, spatial: bool) -> Vector:
    """The rows of one closure: log6(ᴬM_B) for a 6d one, (linear, angular), and ᴬp_B for a 3d one; m and rad."""
    return np.asarray(pin.log6(aMb).vector if spatial else aMb.translation)


def rows_of_twist(aMb: Any, spatial: bool) -> Matrix:
    """The derivative of `residual_rows` by the twist of B against A, seen from A: (6, 6) or (3, 6).

    It is Jlog6(ᴬM_B) · Ad(ᴮM_A) = Jlog6(ᴮM_A) for a 6d closure and [1, -skew(ᴬp_B)] for a 3d one.
    """
    if spatial:
        return np.asarray(pin.Jlog6(aMb.inverse()))
    rows = np.eye(3, 6)
    rows[:, 3:] = -pin.skew(aMb.translation)
    return rows


@dataclass(frozen=True, slots=True)
class Opening:
    """How far a closure is open.

    Attributes:
        name: Name of the closure.
        position: Distance between the origins of A and B, m.
        angle: Angle between A and B, rad; 0 for a 3d closure, which leaves it free.
    """

    name: str
    position: float
    angle: float

    def __str__(self) -> str:
        parts = []
        if self.position > CLOSED or self.angle <= CLOSED:
            parts.append(f"{self.position * 1e3:.3g} mm")
        if self.angle > CLOSED:
            parts.append(f"{math.degrees(self.angle):.3g} degrees")
        return f"'{self.name}' by {' and '.join(parts)}"

    @property
    def is_open(self) -> bool:
        """Whether it is open by more than `CLOSED`; what is no number is open."""
        return not max(self.position, self.angle) <= CLOSED


def closure_openings(robot: Robot, q: Vector, data: Any = None) -> tuple[Opening, ...]:
    """How far each closure is open, in their order.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        data: A `pin.Data` of the model to compute in, or None: see `residual`.
    """
    placements = _placements(robot, q, data)
    openings = []
    for constraint in robot.constraint_models:
        aMb = _frame_a(placements, constraint).actInv(_frame_b(placements, constraint))
        angle = math.hypot(*pin.log3(aMb.rotation)) if constraint.residualSize() == 6 else 0.0
        openings.append(Opening(constraint.name, math.hypot(*aMb.translation), angle))
    return tuple(openings)


def _frame_a(placements: Any, constraint: Any) -> Any:
    return placements[constraint.joint1_id] * constraint.joint1_placement


def _frame_b(placements: Any, constraint: Any) -> Any:
    return placements[constraint.joint2_id] * constraint.joint2_placement


def _placements(robot: Robot, q: Vector, data: Any) -> Any:
    """World placements, by joint, of the joints that carry the frames."""
    if data is None:
        return {joint: placement for joint, placement, _ in _kinematics_along(robot, q)}
    pin.forwardKinematics(robot.model, data, q)
    return data.oMi


def jacobian_along(robot: Robot, q: Vector) -> tuple[dict[int, Any], Matrix]:
    """World placements by joint, and the world Jacobian (6, nvExtended), zero but in the columns of the loops.

    Rows are linear, of the point at the origin of the world, and angular. A joint that mimics another has columns of
    its own, those from ``model.idx_vExtendeds[joint]``.
    """
    model = robot.model
    placements, J = {}, np.zeros((6, model.nvExtended))
    first_column, width = model.idx_vExtendeds, model.nvExtendeds
    for joint, placement, joint_data in _kinematics_along(robot, q):
        placements[joint] = placement
        if joint_data is not None:
            columns = slice(first_column[joint], first_column[joint] + width[joint])
            J[:, columns] = placement.toActionMatrix() @ joint_data.S.reshape(6, -1)
    return placements, J


def _kinematics_along(robot: Robot, q: Vector) -> Iterator[tuple[int, Any, Any]]:
    """Index, world placement and `pin.JointData` of the joints that carry frames and of all their ancestors.

    The first is the universe, without joint data.
    """
    model = robot.model
    parents = model.parents.tolist()
    needed = {0}
    for constraint in robot.constraint_models:
        for joint in (constraint.joint1_id, constraint.joint2_id):
            while joint not in needed:
                needed.add(joint)
                joint = parents[joint]
    placements = {0: pin.SE3.Identity()}
    yield 0, placements[0], None
    joints, joint_placements = model.joints, model.jointPlacements
    for joint in sorted(needed - {0}):  # a parent has a lower index than its child
        joint_model = joints[joint]
        joint_data = joint_model.createData()
        joint_model.calc(joint_data, q)
        placements[joint] = placements[parents[joint]] * joint_placements[joint] * joint_data.M
        yield joint, placements[joint], joint_data
