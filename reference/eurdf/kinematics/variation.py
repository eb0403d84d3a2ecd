"""How the terms of the equation of motion and of the constraints vary with q and v, at given a and λ.

With F = M a + h - τ - Kᵀ λ and C = K a + K̇ v + kd K v + kp r, these are ∂F and ∂C: exact at every configuration,
closed or not. The derivative by q is along q ⊕ δq, for constant components v and a.

All motions are seen from the origin of the world. Column l of the Jacobian J is the twist that joint l gives to what it
carries; p is the joint before it, and i a body that l carries. While l moves, each joint keeps its velocity, so that

    ∂Vᵢ = Jₗ × Vᵢ + V′ₗ           with V′ₗ = Vₚ × Jₗ,
    ∂Aᵢ = Jₗ × Aᵢ + A′ₗ - Vᵢ × V′ₗ    with A′ₗ = Aₚ × Jₗ + Vₚ × V′ₗ,

where the first products are those of a rigid motion of what l carries. They drop out of forces on what l carries,
and of the motion of frame B against A unless l is between the two. There, with s = 1 on the way to B and -1 on that
to A, and Φ the matrix that shows twists as A sees them, η = Φ (V_B - V_A) and

    ∂η = s Φ (V′ₗ - V_B × Jₗ),
    ∂η̇ = s Φ (A′ₗ - A_B × Jₗ - (V_A + V_B) × V′ₗ + V_A × (V_B × Jₗ)).

Sources: the recursions are those of Featherstone, *Rigid Body Dynamics Algorithms*, 2008, and the sums over subtrees
those of Singh, Russell, Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector
algebra*, 2022. Arrays have B elements first.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Matrix
from eurdf.closures.kind import PoseArrays, RelativePoses
from eurdf.closures.se3 import IDENTITY_ROTATION, force_cross, motion_cross, skew, transposed, turned
from eurdf.kinematics.evaluate import Evaluator, evaluator

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.pinocchio.tree_dynamics import TreeDynamics


class Variation(NamedTuple):
    """Derivatives of the terms, by q, v and a.

    Attributes:
        K: ∂C/∂a (B, nc, nv).
        M: ∂F/∂a (B, nv, nv), symmetric.
        F_q: ∂F/∂q (B, nv, nv).
        F_v: ∂F/∂v (B, nv, nv).
        C_q: ∂C/∂q (B, nc, nv).
        C_v: ∂C/∂v (B, nc, nv).
    """

    K: Matrix
    M: Matrix
    F_q: Matrix
    F_v: Matrix
    C_q: Matrix
    C_v: Matrix


class _Kind(NamedTuple):
    """Closures of one kind at some configurations, by the twist of B against A, seen from A.

    Attributes:
        pairs: Which pairs of frames are theirs.
        rows: Which rows of the residual.
        P: The derivative (B, k, r, 6) of the residual.
        P_pose: That (B, k, r, 6, 6) of P.
        poses: ᴬM_B.
        kind: The kind.
        fixed: What it prepared.
    """

    pairs: slice
    rows: Any
    P: Matrix
    P_pose: Matrix
    poses: RelativePoses
    kind: Any
    fixed: Any


class Structure:
    """What does not depend on the state of a robot. The Jacobian has n columns, one for each velocity of each joint.

    Attributes:
        owner: The joint (n,) of each column.
        before: The joint (n,) before that.
        moved_by: Whether a column moves a body (joints, n).
        on_path: Whether a column is on the path of a column, the row (n, n): itself is.
        carried: Whether it is on the path of the other, of another joint (n, n).
        velocities: The velocities of the columns, over v (n, nv): those that mimic another have its own. None if they
            are v.
        ends: The joints (2, k) that carry frames A and B of the closures.
        placements: Poses (k, 4, 4) of frames A in these.
        signs: Of each pair (k, n) 1 for a column on the way to B, -1 for one on the way to A.
        row_signs: The same of the pair of each row (nc, n).
        stiffness: That of the springs (nv, nv), diagonal.
        constraint_of_row: The constraint (nc,) of each row.
    """

    def __init__(self, robot: Robot) -> None:
        tree, model = robot.tree, robot.model
        parents = np.array(tree.parents)
        on = np.eye(len(parents))  # of each joint those on its path from the root
        for joint, parent in enumerate(tree.parents[1:], 1):
            on[joint] += on[parent]
        self.owner = np.repeat(np.arange(len(parents)), model.nvExtendeds)
        self.before = parents[self.owner]
        self.moved_by = on[:, self.owner]
        self.on_path = self.moved_by[self.owner]
        self.carried = self.on_path.T * (1.0 - self.on_path)
        moving = [each for joint in tree.moving_velocities for each in joint]
        self.velocities = np.eye(model.nv)[moving] if model.nvExtended > model.nv else None
        self.mass = np.array([inertia.mass for inertia in model.inertias])
        self.lever = np.array([inertia.lever for inertia in model.inertias])
        self.inertia = np.array([inertia.inertia for inertia in model.inertias])
        self.gravity, self.armature = np.array(model.gravity.vector), np.array(model.armature)
        self.damping, springs = tree.damping, tree.springs
        self.stiffness = np.diag(np.bincount(springs.idx_v, springs.stiffness * springs.ratio**2, model.nv))

        constraints = evaluator(robot, few=True)
        pairs = constraints.sites
        self.ends = np.array([[end.joint for end in pair] for pair in pairs], np.intp).reshape(-1, 2).T
        self.placements = np.array([a.placement.homogeneous for a, _ in pairs]).reshape(-1, 4, 4)
        a, b = self.moved_by[self.ends]
        self.signs = b - a
        self.row_signs = np.zeros((constraints.m, len(self.owner)))
        for group in constraints.groups:
            own = self.signs[group.pairs]
            self.row_signs[group.rows] = np.repeat(own, group.m // len(own), axis=0)
        self.constraint_of_row = np.repeat(np.arange(len(robot.constraints)), [each.rows for each in robot.constraints])

    def over_v(self, of_columns: Matrix) -> Matrix:
        """What is (…, n) by the columns, by v (…, nv)."""
        return of_columns if self.velocities is None else of_columns @ self.velocities

    def over_both(self, of_columns: Matrix) -> Matrix:
        """What is (…, n, n) by the columns, by v (…, nv, nv)."""
        return transposed(self.over_v(transposed(self.over_v(of_columns))))


class MotionState:
    """A robot at configurations q, moving with v and a.

    Attributes:
        J: The columns of the Jacobian (B, n, 6), here rows.
        J_rate: J̇ (B, n, 6).
        V_change: V′ (B, n, 6).
        A_change: A′ (B, n, 6), against free fall where A is.
        V: The twists (B, joints, 6) of the bodies.
        A: Their accelerations (B, joints, 6); against free fall unless Pinocchio differentiates the forces.
    """

    def __init__(
        self, structure: Structure, dynamics: TreeDynamics, constraints: Evaluator, q: Matrix, v: Matrix, a: Matrix
    ) -> None:
        """Take q (B, nq), and v and a (B, nv).

        Args:
            structure: That of the robot.
            dynamics: Those of the tree.
            constraints: Evaluates all constraints.
            q: Configurations.
            v: Velocities.
            a: Accelerations.
        """
        self.structure = s = structure
        self.constraints = constraints
        self._placed = constraints.at(q).by_kind
        carriers = s.ends[0].tolist()
        found = [dynamics.derivatives(*each, carriers) for each in zip(q, v, a, strict=True)]
        self._by_pinocchio: Matrix | None = None
        if all(found):
            self._of_a, columns, by_pinocchio = map(np.array, zip(*found, strict=True))
            self.J, self.J_rate, self.V_change, self.A_change = columns.swapaxes(0, 1)
            self.V, self._by_pinocchio = self._twists(v), by_pinocchio.swapaxes(0, 1)
            self.A = self._accelerations(v, a)
            return
        self._poses, self.J = map(np.array, zip(*map(dynamics.columns, q), strict=True))
        self._of_a = self._poses[:, carriers]
        self.V = self._twists(v)
        cross = motion_cross(self.V)
        self.J_rate, self.V_change = turned(cross[:, s.owner], self.J), turned(cross[:, s.before], self.J)
        self.A = self._accelerations(v, a) - s.gravity
        self.A_change = turned(motion_cross(self.A[:, s.before]), self.J)
        self.A_change += turned(cross[:, s.before], self.V_change)

    def _columns(self, v: Matrix) -> Matrix:
        """The velocities (B, n, 1) of the columns."""
        velocities = self.structure.velocities
        return (v if velocities is None else v @ velocities.T)[..., None]

    def _twists(self, v: Matrix) -> Matrix:
        """The twists (B, joints, 6) of the bodies."""
        return np.asarray(self.structure.moved_by @ (self._columns(v) * self.J))

    def _accelerations(self, v: Matrix, a: Matrix) -> Matrix:
        """The derivatives (B, joints, 6) of the twists."""
        return np.asarray(self.structure.moved_by @ (self._columns(a) * self.J + self._columns(v) * self.J_rate))

    def of_tree(self) -> Matrix:
        """The derivatives (3, B, nv, nv) of M a + h by q, v and a."""
        if self._by_pinocchio is not None:
            return self._by_pinocchio
        found = self.structure.over_both(self._by_columns())
        found[2] += np.diag(self.structure.armature)
        return found

    def _by_columns(self) -> Matrix:
        """The derivatives (3, B, n, n) of the forces on the columns by q, v and a, without the armature."""
        s, J, V = self.structure, self.J, self.V
        R, p = self._poses[..., :3, :3], self._poses[..., :3, 3]
        lever = turned(R, s.lever) + p
        moment = skew(s.mass[:, None] * lever)
        inertia = np.zeros((*p.shape[:2], 6, 6))
        inertia[..., :3, :3] = s.mass[:, None, None] * IDENTITY_ROTATION
        inertia[..., :3, 3:], inertia[..., 3:, :3] = -moment, moment
        inertia[..., 3:, 3:] = R @ s.inertia @ transposed(R) - moment @ skew(lever)
        # The force on a body changes by I A′ + B V′, where B = V ×* I - I V × + (· ×* I V).
        momentum = force_cross(turned(inertia, V))
        product = inertia @ motion_cross(V)
        bias = momentum - product - transposed(product)
        force = turned(inertia, self.A) + turned(momentum, V)
        # Sums over what each column carries.
        carried = s.moved_by.T @ np.concatenate(
            (inertia.reshape(*p.shape[:2], 36), bias.reshape(*p.shape[:2], 36), force), axis=-1
        )
        I_sum, B_sum = (carried[..., at : at + 36].reshape(*J.shape, 6) for at in (0, 36))
        force = carried[..., 72:]
        v_change = self.J_rate + self.V_change
        zero = np.zeros_like(J)
        # Where the column l is on the path of j: (I Jⱼ) · A′ₗ + (Bᵀ Jⱼ) · V′ₗ, with the sums of j; ...
        own = np.concatenate((turned(I_sum, J), turned(transposed(B_sum), J)), axis=-1)
        changes = np.array(((self.A_change, self.V_change), (v_change, J), (J, zero)))
        on_path = own @ transposed(np.concatenate((changes[:, 0], changes[:, 1]), axis=-1))
        # ... where l is carried by j: Jⱼ · (I A′ₗ + B V′ₗ + Jₗ ×* f), with the sums of l.
        forces = turned(I_sum, changes[:, 0]) + turned(B_sum, changes[:, 1])
        forces[0] += turned(force_cross(force), J)
        return np.asarray(s.on_path * on_path + s.carried * (J @ transposed(forces)))

    @cached_property
    def frames(self) -> tuple[Matrix, list[_Kind]]:
        """Φ (B, k, 6, 6) of the pairs, and the closures by kind."""
        at = self._of_a @ self.structure.placements
        kinds = []
        for group, poses in zip(self.constraints.groups, self._placed, strict=True):
            kind, fixed = group.kind, group.fixed
            P, P_pose = kind.jacobian(poses, fixed), kind.jacobian_derivative(poses, fixed)
            kinds.append(_Kind(group.pairs, group.rows, P, P_pose, poses, kind, fixed))
        return PoseArrays(at[..., :3, :3], at[..., :3, 3]).twist_in_b(), kinds

    def variation(self, lambdas: Matrix, gains: Matrix, *, dissipation: bool) -> Variation:
        """The derivatives at forces λ (B, nc), with Baumgarte gains kp and kd (constraints, 2).

        Args:
            lambdas: The forces of the constraints.
            gains: Of each constraint kp, 1/s², and kd, 1/s.
            dissipation: Whether the damping of the joints acts; that of dry friction does not vary.
        """
        s, J = self.structure, self.J
        (a, b), count, size = s.ends, len(J), self.constraints.m
        phi, kinds = self.frames
        V_a, V_b, A_b = self.V[:, a], self.V[:, b], self.A[:, b]
        X_a, X_b = motion_cross(V_a), motion_cross(V_b)
        both = np.empty((*phi.shape[:2], 2, 6))  # η and η̇
        both[:, :, 0], both[:, :, 1] = V_b - V_a, A_b - self.A[:, a] - turned(X_a, V_b)
        both = both @ transposed(phi)
        twist = both[:, :, 0]
        # Rows over η̇, η and the pose, as rows over A′, V′ and J.
        phi_b = phi @ X_b
        shown = np.zeros((*phi.shape[:2], 3, 6, 3, 6))
        shown[:, :, 0, :, 0], shown[:, :, 1, :, 1], shown[:, :, 2, :, 2] = phi, phi, phi
        shown[:, :, 0, :, 1], shown[:, :, 1, :, 2] = -(phi @ X_a) - phi_b, -phi_b
        shown[:, :, 0, :, 2] = phi @ (X_a @ X_b - motion_cross(A_b))
        shown = shown.reshape(*phi.shape[:2], 18, 18)
        of_row = gains.T[:, s.constraint_of_row]
        rows = np.zeros((count, size, 18))
        for each in kinds:
            shape = each.P.shape[:3]
            along = both[:, each.pairs, None] @ each.P_pose
            P_twist, P_change = along[..., 0, :], along[..., 1, :]
            bend = each.kind.bend_derivative(each.poses, each.fixed, twist[:, each.pairs])
            by_twist = P_twist + turned(each.P_pose, twist[:, each.pairs, None])
            kp, kd = (own.reshape(*shape[1:], 1) for own in of_row[:, each.rows])
            own = (each.P, by_twist + kd * each.P, P_change + bend + kd * P_twist + kp * each.P)
            found = np.concatenate(own, axis=-1) @ shown[:, each.pairs]
            rows[:, each.rows] = found.reshape(count, -1, 18)
        signs = s.row_signs
        K = signs * (rows[..., :6] @ transposed(J))
        C_q = signs * (rows @ transposed(np.concatenate((self.A_change, self.V_change, J), axis=-1)))
        v_change = np.concatenate((self.J_rate + self.V_change, J), axis=-1)
        C_v = signs * (rows[..., :12] @ transposed(v_change))
        K, C_q, C_v = s.over_v(K), s.over_v(C_q), s.over_v(C_v)
        if self.constraints.couplings is not None:
            couplings, _, own_rows = self.constraints.couplings
            kp, kd = of_row[:, own_rows]
            K[:, own_rows], C_q[:, own_rows] = couplings.K, kp[:, None] * couplings.K
            C_v[:, own_rows] = kd[:, None] * couplings.K
        by_q, F_v, M = self.of_tree()
        F_q = by_q - self.of_forces(lambdas) + s.stiffness
        if dissipation:
            F_v = F_v + np.diag(s.damping)
        return Variation(K, M, F_q, F_v, C_q, C_v)

    def of_forces(self, lambdas: Matrix) -> Matrix:
        """∂(Kᵀ λ)/∂q (B, nv, nv) at constant λ (B, nc).

        The wrenches on frames B move with frames A, and change with the poses. Of a column j between A and B, the
        product with the wrench changes while l is on its path and does not move A, or the reverse.
        """
        s, J = self.structure, self.J
        phi, kinds = self.frames
        B, k, n = *phi.shape[:2], J.shape[1]
        wrenches, turns = np.empty((B, k, 6)), np.empty((B, k, 6, 6))
        for each in kinds:
            shape = each.P.shape[:3]
            forces = lambdas[:, each.rows].reshape(*shape[:2], 1, shape[2])
            wrenches[:, each.pairs] = (forces @ each.P)[..., 0, :]
            turns[:, each.pairs] = (forces @ each.P_pose.reshape(*shape, 36)).reshape(*shape[:2], 6, 6)
        back = transposed(phi)
        wrenches, turns = turned(back, wrenches), back @ turns @ phi
        moved = turned(force_cross(s.signs.T @ wrenches), J)
        found = s.on_path * (moved @ transposed(J))
        between = s.signs[:, :, None] * J[:, None]
        with_a = s.moved_by[s.ends[0]][:, :, None] * J[:, None]
        changes = between @ transposed(turns) + with_a @ transposed(force_cross(wrenches))
        left, right = (each.swapaxes(1, 2).reshape(B, n, 6 * k) for each in (between, changes))
        found += left @ transposed(right)
        return s.over_both(found)

    def of_velocity(self, x: Matrix) -> Matrix:
        """∂(K x)/∂q (B, nc, nv) at constant x (B, nv)."""
        s, J = self.structure, self.J
        phi, kinds = self.frames
        V = self._twists(x)
        twist, phi_b = turned(phi, V[:, s.ends[1]] - V[:, s.ends[0]]), phi @ motion_cross(V[:, s.ends[1]])
        change = turned(motion_cross(V[:, s.before]), J)
        rows = np.zeros((len(J), self.constraints.m, 12))
        for each in kinds:
            by_pose = (twist[:, each.pairs, None, None] @ each.P_pose)[..., 0, :] @ phi[:, each.pairs]
            own = each.P @ phi[:, each.pairs], by_pose - each.P @ phi_b[:, each.pairs]
            rows[:, each.rows] = np.concatenate(own, axis=-1).reshape(len(J), -1, 12)
        columns = transposed(np.concatenate((change, J), axis=-1))
        return s.over_v(s.row_signs * (rows @ columns))
