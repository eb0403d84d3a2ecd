"""Residuals and constraint Jacobians that are those of another equation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics import residual
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.placement import placement_of
from eurdf.pinocchio.robot import Robot
from eurdf_conformance.adapters.reference_values import Quantities
from eurdf_conformance.mutants.deviation import Deviation, around, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import mechanism, while_evaluating
from eurdf_conformance.protocol.message import Jacobian


def _rows(change: Callable[[Any], Any], *, spatial: bool) -> Deviation:
    """The residual of the closures of one type is a function of the pose of B in A."""

    def rows(original: Any, aMb: Any, is_spatial: bool) -> Any:
        return change(aMb) if is_spatial is spatial else original(aMb, is_spatial)

    return while_evaluating(lambda: around(residual, "residual_rows", rows))


def _derivative(change: Callable[[Any], Any], *, spatial: bool) -> Deviation:
    """The derivative of the residual of the closures of one type by the twist of B against A."""

    def rows(original: Any, aMb: Any, is_spatial: bool) -> Any:
        return change(aMb) if is_spatial is spatial else original(aMb, is_spatial)

    return while_evaluating(lambda: around(residual, "rows_of_twist", rows))


@mutant("EU-CLO-008")
def angular_rows_first() -> Deviation:
    """The rows of a 6d closure are angular, then linear."""
    return _rows(lambda aMb: np.roll(pin.log6(aMb).vector, 3), spatial=True)


@mutant("EU-CLO-008")
def residual_6d_seen_from_b() -> Deviation:
    """The residual of a 6d closure is that of the pose of A in B."""
    return _rows(lambda aMb: pin.log6(aMb.inverse()).vector, spatial=True)


@mutant("EU-CLO-008")
def position_and_log3() -> Deviation:
    """The linear rows of a 6d closure are the position of B in A, not those of log6."""
    return _rows(lambda aMb: np.concatenate([aMb.translation, pin.log3(aMb.rotation)]), spatial=True)


@mutant("EU-CLO-008")
def roll_pitch_yaw_rows() -> Deviation:
    """The angular rows of a 6d closure are roll, pitch and yaw."""
    return _rows(lambda aMb: np.concatenate([pin.log6(aMb).linear, pin.rpy.matrixToRpy(aMb.rotation)]), spatial=True)


@mutant("EU-CLO-008")
def quaternion_rows() -> Deviation:
    """The angular rows of a 6d closure are twice the vector of the quaternion, as for small angles."""
    return _rows(
        lambda aMb: np.concatenate([pin.log6(aMb).linear, 2.0 * pin.Quaternion(aMb.rotation).coeffs()[:3]]),
        spatial=True,
    )


@mutant("EU-CLO-009")
def residual_3d_seen_from_b() -> Deviation:
    """The residual of a 3d closure is the origin of A in B."""
    return _rows(lambda aMb: aMb.inverse().translation, spatial=False)


@mutant("EU-CLO-009")
def residual_3d_from_b_to_a() -> Deviation:
    """The residual of a 3d closure has the other sign."""
    return _rows(lambda aMb: -aMb.translation, spatial=False)


@mutant("EU-CLO-009")
def residual_3d_in_the_world() -> Deviation:
    """The residual of a 3d closure is along the axes of the world."""

    def residuals(original: Any, self: Quantities) -> dict[str, list[float]]:
        found: dict[str, list[float]] = original(self)
        for closure in self.robot.mechanism.closures:
            if closure.type == "3d":
                oMa = self._body(closure.a.body) * placement_of(closure.a.pose)
                found[closure.name] = (oMa.rotation @ found[closure.name]).tolist()
        return found

    return around(Quantities, "residuals", residuals)


@mutant("EU-CLO-009")
def sides_of_closures_swapped() -> Deviation:
    """Of the two frames of a closure the first is B."""
    return mechanism(
        lambda robot: replace(robot, closures=tuple(replace(each, a=each.b, b=each.a) for each in robot.closures))
    )


@mutant("EU-CLO-009")
def all_closures_6d() -> Deviation:
    """Every closure is 6d."""
    return _type("6d")


@mutant("EU-CLO-008")
def closures_6d_dropped() -> Deviation:
    """A 6d closure is dropped, as a weld constraint of a URDF is by Drake."""
    return mechanism(lambda robot: replace(robot, closures=tuple(each for each in robot.closures if each.type == "3d")))


@mutant("EU-CLO-009")
def closures_3d_dropped() -> Deviation:
    """A 3d closure is said, but has neither residual nor rows in K; Drake drops MuJoCo's connect of two sites."""

    def by_closure(original: Any, self: Quantities, rows: Any) -> dict[str, Any]:
        kept = {closure.name for closure in self.robot.mechanism.closures if closure.type == "6d"}
        return {name: rows for name, rows in original(self, rows).items() if name in kept}

    return around(Quantities, "_by_closure", by_closure)


@mutant("EU-CLO-009", versions=("2",))  # the frames of version 1 have the axes of links
def closures_3d_between_points() -> Deviation:
    """The two frames of a 3d closure are points, seen along the axes of their links, as in Drake."""

    def point(anchor: Anchor) -> Anchor:
        return replace(anchor, pose=Pose(anchor.pose.xyz))

    def pointed(closure: Closure) -> Closure:
        return closure if closure.type == "6d" else replace(closure, a=point(closure.a), b=point(closure.b))

    return mechanism(lambda robot: replace(robot, closures=tuple(map(pointed, robot.closures))))


@mutant("EU-CLO-009")
def frame_b_where_a_is_at_neutral() -> Deviation:
    """Of a closure frame A alone is read: B is where A is at neutral, as for MuJoCo's connect at an anchor."""

    def anchored(robot: Mechanism) -> Mechanism:
        at = {robot.bodies[0].name: Pose()}
        for joint in robot.joints:
            at[joint.child] = at[joint.parent] * joint.placement * joint.offset

        def on_a(closure: Closure) -> Closure:
            a, b = closure.a, closure.b
            return replace(closure, b=replace(b, pose=at[b.body].inverse() * at[a.body] * a.pose))

        return replace(robot, closures=tuple(map(on_a, robot.closures)))

    return mechanism(anchored)


@mutant("EU-CLO-008")
def all_closures_3d() -> Deviation:
    """Every closure is 3d."""
    return _type("3d")


def _type(kind: Any) -> Deviation:
    def typed(closure: Closure) -> Closure:
        return replace(closure, type=kind)

    return mechanism(lambda robot: replace(robot, closures=tuple(map(typed, robot.closures))))


@mutant("EU-CLO-010")
def derivative_of_the_logarithm_forgotten() -> Deviation:
    """K of a 6d closure is the twist of B against A, as if the closure were closed."""
    return _derivative(lambda aMb: np.eye(6), spatial=True)


@mutant("EU-CLO-010")
def derivative_of_the_logarithm_inverted() -> Deviation:
    """K of a 6d closure has the derivative of the logarithm on the wrong side."""
    return _derivative(lambda aMb: pin.Jlog6(aMb), spatial=True)


@mutant("EU-CLO-010")
def turning_of_a_forgotten() -> Deviation:
    """K of a 3d closure leaves out that A turns, as if the closure were closed."""
    return _derivative(lambda aMb: np.eye(3, 6), spatial=False)


def _on_path(loop: Any, **changes: Any) -> Any:
    """The loop with another path."""
    changed = replace(loop)
    vars(changed)["path"] = loop.path._replace(**changes)
    return changed


def _loops(change: Callable[[Any], Any]) -> Deviation:
    """The loops are others, where K is made of them."""
    return while_evaluating(
        lambda: around(residual, "find_loops", lambda original, robot: tuple(map(change, original(robot))))
    )


@mutant("EU-CLO-010")
def motion_of_a_forgotten() -> Deviation:
    """K leaves out the joints that move A."""
    return _loops(lambda loop: _on_path(loop, signs=np.maximum(loop.path.signs, 0.0)))


@mutant("EU-CLO-010", versions=("2",))  # in version 1 no joint mimics
def one_of_two_followers_forgotten() -> Deviation:
    """Where several joints of a loop follow one coordinate, the last one alone counts in K."""
    return _loops(lambda loop: _on_path(loop, mimics=False))


@mutant("EU-CLO-010", versions=("2",))  # in version 1 no joint mimics
def turning_after_a_slide_forgotten() -> Deviation:
    """K leaves out a joint that turns as the prismatic one slides that it follows."""

    def loops(original: Any, robot: Robot) -> Any:
        slides = {joint.name for joint in robot.mechanism.joints if joint.type is JointType.PRISMATIC}
        turning = [
            joint.name
            for joint in robot.mechanism.joints
            if joint.mimic is not None and joint.mimic.joint in slides and joint.name not in slides
        ]
        columns = [robot.model.idx_vExtendeds[robot.model.getJointId(name)] for name in turning]
        return tuple(
            _on_path(loop, signs=np.where(np.isin(loop.path.columns, columns), 0.0, loop.path.signs))
            for loop in original(robot)
        )

    return while_evaluating(lambda: around(residual, "find_loops", loops))


@mutant("EU-CLO-010")
def sign_of_k() -> Deviation:
    """K has the other sign than the residual."""
    return _loops(lambda loop: _on_path(loop, signs=-loop.path.signs))


@mutant("EU-CLO-010")
def rows_of_zeros_left_out() -> Deviation:
    """K lacks the rows that are 0, such as those by which a planar loop that is closed in 6d is redundant."""

    def jacobian(said: Jacobian) -> Jacobian:
        return said.model_copy(
            update={"rows": {name: [row for row in rows if np.any(row)] for name, rows in said.rows.items()}}
        )

    return result(Quantities, "jacobian", jacobian)


def _angle(aMb: Any) -> float:
    return float(np.linalg.norm(pin.log3(aMb.rotation)))


@mutant("EU-CLO-008")
def logarithm_of_small_turns() -> Deviation:
    """The linear rows of a 6d closure that is turned by less than 1e-3 rad are the position of B in A."""

    def rows(aMb: Any) -> Any:
        v, ω = (aMb.translation, pin.log3(aMb.rotation)) if _angle(aMb) < 1e-3 else np.split(pin.log6(aMb).vector, 2)
        return np.concatenate([v, ω])

    return _rows(rows, spatial=True)


@mutant("EU-CLO-010")
def derivative_at_small_turns() -> Deviation:
    """K of a 6d closure that is turned by less than 1e-5 rad is the twist of B against A, as if it were closed."""
    return _derivative(lambda aMb: np.eye(6) if _angle(aMb) < 1e-5 else pin.Jlog6(aMb.inverse()), spatial=True)
