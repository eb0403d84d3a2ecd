"""Motions that need no actuator: of a rod that spins about its own line, of a wheel, of the root, against a spring."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.kinematics.analysis import Analysis
from eurdf.kinematics.loop import joints_of_loops
from eurdf.kinematics.loop_analysis import LoopAnalysis, Motion, sparse_basis
from eurdf.kinematics.scale import characteristic_length
from eurdf.pinocchio.robot import Robot

# By how much lines that count as one may differ, in rad and characteristic lengths: the numbers in files are rounded.
_SAME_LINE = 1e-3

# How far the centre of mass of a wheel may be from its axis, in radii of gyration.
_CENTRED = 0.02

_ROOT_JOINTS = frozenset({"JointModelFreeFlyer", "JointModelPlanar"})


class PassiveMotions:
    """Finds the motions that need no actuator, of one robot whose structure was looked at once."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        model = robot.model
        self._parents, self._widths = model.parents.tolist(), model.nvExtendeds.tolist()
        self._first, self._columns = model.idx_vs.tolist(), model.idx_vExtendeds.tolist()
        self._joints: dict[int, list[int]] = {}  # by velocity; several where joints mimic another
        for joint in range(1, model.njoints):
            for velocity in range(self._first[joint], self._first[joint] + self._widths[joint]):
                self._joints.setdefault(velocity, []).append(joint)
        self._inner = frozenset(self._parents)
        self._length = characteristic_length(robot)
        self._jacobian: tuple[Vector, Matrix] | None = None
        self._sprung = [
            slot.idx_v + k
            for slot in robot.slots.values()
            for k, stiffness in enumerate(slot.joint.properties.stiffness)
            if stiffness
        ]

    def needing_actuators(self, loop: LoopAnalysis) -> list[Motion]:
        """The uncontrolled motions of a group of loops, except spins of rods, and those that springs resist.

        A spin is a motion by which all bodies that move turn about one fixed line: their twists, seen from a point of
        the line, are multiples of one that only turns. Motions that differ by spins of single bodies count as one.
        """
        motions = self._unsprung(loop.motions)
        found = self._not_spins(motions)
        if found and len(motions) > 1 and len(spins := self._spins(self._twists(motions))):
            rest = np.linalg.svd(spins)[2][len(spins) :]  # the combinations that are orthogonal to the spins
            return self._not_spins(self._combined(motions, rest))
        return found

    def _not_spins(self, motions: Sequence[Motion]) -> list[Motion]:
        twists = self._twists(motions) if motions else ()
        turns = (_turns_about_one_line(each, self._length) for each in twists)
        return [motion for motion, is_spin in zip(motions, turns, strict=True) if not is_spin]

    def all_needing_actuators(self, analysis: Analysis) -> list[Motion]:
        """The uncontrolled motions of a robot, in its loops and outside of them, except those that need no actuator."""
        found = [motion for loop in analysis.loops for motion in self.needing_actuators(loop)]
        return [*found, *self.outside_needing_actuators(analysis)]

    def outside_needing_actuators(self, analysis: Analysis) -> list[Motion]:
        """Those outside of the loops: neither against a spring nor motions of the root or a wheel."""
        in_loops = sum(len(loop.motions) for loop in analysis.loops)
        outside = analysis.motions[in_loops:]
        return [each for each in outside if self._unsprung([each]) and not self._is_root_or_wheel(each)]

    def _unsprung(self, motions: Sequence[Motion]) -> Sequence[Motion]:
        """Of motions at one configuration, and all that they combine to, those that stretch no spring."""
        stretched = self.basis(motions)[:, self._sprung]
        if not stretched.any():
            return motions
        combinations, stretches, _ = np.linalg.svd(stretched)
        rank = int((stretches > _SAME_LINE).sum())
        return self._combined(motions, combinations[:, rank:].T)

    def basis(self, motions: Sequence[Motion]) -> Matrix:
        """The velocities (k, nv) of k motions."""
        basis = np.zeros((len(motions), self._robot.model.nv))
        for row, motion in zip(basis, motions, strict=True):
            row[motion.velocities] = motion.values
        return basis

    def _combined(self, motions: Sequence[Motion], combinations: Matrix) -> list[Motion]:
        """A basis of combinations (r, k) of k motions at one configuration."""
        names = self._robot.tree.velocity_names
        found = []
        for row in sparse_basis(combinations @ self.basis(motions)):
            moving = np.flatnonzero(row)
            joints = tuple(dict.fromkeys(names[index] for index in moving.tolist()))
            found.append(Motion(joints, moving, row[moving], motions[0].q))
        return found

    def _spins(self, twists: Matrix) -> Matrix:
        """The combinations (r, k) of k motions by which a single body spins, from the twists (k, bodies, 6) of all."""
        scaled = twists / np.repeat([self._length, 1.0], 3)
        bodies: list[Matrix] = []  # that move, each once: parts that are rigid to one another move alike
        for body in np.moveaxis(scaled, 1, 0):
            if np.abs(body).max() > _SAME_LINE and all(np.abs(body - other).max() > _SAME_LINE for other in bodies):
                bodies.append(body)
        found = []
        for body in bodies:
            others = np.hstack([other for other in bodies if other is not body] or [np.zeros((len(twists), 1))])
            combinations, moves, _ = np.linalg.svd(others)
            still = combinations[:, int((moves > _SAME_LINE * moves[0]).sum()) :].T
            if len(still) == 1 and _turns_about_one_line(
                [(still[0] @ body) * np.repeat([self._length, 1.0], 3)], self._length
            ):
                found.append(still[0])
        return np.array(found)

    def _is_root_or_wheel(self, motion: Motion) -> bool:
        """Whether a motion outside of the loops is one of a floating or planar root, or of a wheel.

        A wheel is what a hinge carries at the end of the tree with its centre of mass on the axis.
        """
        model = self._robot.model
        joint = self._joints[int(motion.velocities[0])][0]
        joint_model, inertia = model.joints[joint], model.inertias[joint]
        if self._widths[joint] > 1:
            return self._parents[joint] == 0 and joint_model.shortname() in _ROOT_JOINTS
        if joint in self._inner or joint in self._robot.tree.in_series.values() or not inertia.mass > 0.0:
            return False
        data = joint_model.createData()
        joint_model.calc(data, motion.q)
        slides, axis = np.split(data.S.reshape(6), 2)
        radius = np.sqrt(np.trace(inertia.inertia) / (2.0 * inertia.mass))
        return bool(not slides.any() and np.linalg.norm(np.cross(axis, inertia.lever)) <= _CENTRED * radius)

    def _twists(self, motions: Sequence[Motion]) -> Matrix:
        """Twists (k, bodies, 6) in the world, linear and angular, of the bodies of joints that k motions of loops move.

        Bodies further out move as one of these does.
        """
        q = motions[0].q
        if self._jacobian is None or self._jacobian[0] is not q:
            self._jacobian = q, self._robot.tree.jacobian_along(joints_of_loops(self._robot), q)
        J, basis = self._jacobian[1], self.basis(motions)
        twists: dict[int, Matrix] = {}
        moved = {joint for motion in motions for index in motion.velocities.tolist() for joint in self._joints[index]}
        for joint in sorted(moved):  # parents come first
            column, first, width = self._columns[joint], self._first[joint], self._widths[joint]
            above = self._parents[joint]
            while above and above not in twists:
                above = self._parents[above]
            own = basis[:, first : first + width] @ J[:, column : column + width].T
            twists[joint] = twists.get(above, 0.0) + own
        # Between two joints in series there is no body.
        bodies = [twist for joint, twist in twists.items() if joint not in self._robot.tree.in_series]
        return np.stack(bodies, axis=1) if bodies else np.zeros((len(motions), 0, 6))


def _turns_about_one_line(twists: Sequence[Vector], length: float) -> bool:
    """Whether twists are such, except those of bodies that do not move.

    Each is (6,), linear and angular, m/s and rad/s; the velocities that they come from are about 1. The characteristic
    length is in m.
    """
    if not len(twists):
        return True
    linear, angular = np.split(np.array(twists), 2, axis=1)
    speeds = np.sqrt((angular * angular).sum(axis=1))
    fastest = int(np.argmax(speeds))
    turning = float(speeds[fastest])
    if not turning > _SAME_LINE:
        return False
    axis = angular[fastest] / turning
    # The point of the line that is nearest to the origin of the world, from which each ω × p + v is seen.
    point = pin.skew(axis) @ linear[fastest] / turning
    sliding = linear + angular @ pin.skew(point)
    tilting = angular @ pin.skew(axis)
    bound = (_SAME_LINE * turning) ** 2
    with np.errstate(over="ignore"):  # then it is above the bound
        slides, tilts = ((each * each).sum(axis=1).max() for each in (sliding, tilting))
    return bool(slides <= bound * length * length and tilts <= bound)
