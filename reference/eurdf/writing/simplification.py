"""A mechanism with fewer velocities and rows that moves in the same way, and back (Batto et al., 2025, 3.2 and 3.4).

Two rules make a mechanism smaller. Three revolute joints whose axes meet in one point are one spherical joint. A ball
joint whose link a 6d closure holds is a 3d closure: the link is fixed to what held it, and the ball is where the loop
is cut. Masses, and poses of the links that are not between merged axes, stay as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal

from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.diagnostics import quoted
from eurdf.linking.merging import BallChain, find_chains, merge
from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.constraint import RIGID, Closure
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import ROTARY, JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import AXES, IDENTITY, Pose, X, Y, Z
from eurdf.mechanism.same_model import with_whole_joints
from eurdf.writing.rewriting import MechanismTree, Positions, Rewriting, poses_of, size_of

#: What to rewrite: the joints, the closures, or both if it is None.
Only = Literal["joints", "closures"] | None

#: Axes that pass a point within this distance, in m, meet in it without a trace in the poses.
_MEETING = 1e-11

_CONTINUOUS, _SPHERICAL = JointType("continuous"), JointType("spherical")

_FREE_BALL = JointProperties.unlimited(_SPHERICAL)

_MOST_NOTED = 500

_SOFT = "it has compliance"

_LIMITS = ("velocity", "effort", "acceleration", "deceleration", "jerk")

#: Angles, in rad, at which three joints and the ball are compared.
_TRIED = ((0.3, -0.7, 1.1), (-1.2, 0.4, -2.0))


def simplified(mechanism: Mechanism, only: Only = None) -> Rewriting:
    """Balls in place of three revolute joints; then 3d closures in place of a ball joint and a 6d closure."""
    found = Rewriting(mechanism) if only == "closures" else _with_balls(mechanism)
    return found if only == "joints" else found.then(_each_closure(found.mechanism, FrameClosure, _as_point))


def saving(mechanism: Mechanism) -> tuple[str, ...]:
    """A sentence about what `simplified` saves; none if it saves nothing, or the robot has more than 500 joints.

    The time of a rewriting grows with joints times changes.
    """
    if len(mechanism.joints) > _MOST_NOTED:
        return ()
    before = with_whole_joints(mechanism)
    after = simplified(before).mechanism
    if after is before:
        return ()
    one, other = size_of(before), size_of(after)
    rows = f" and {one.nc - other.nc} of {one.nc} constraint rows" if other.nc < one.nc else ""
    saved = f"{one.nv - other.nv} of {one.nv} velocities{rows}"
    return (f"'eurdf simplify' writes the robot without {saved}, with the same motion",)


def expanded(mechanism: Mechanism, only: Only = None) -> Rewriting:
    """A ball joint and a 6d closure in place of each 3d closure; then three revolute joints in place of each ball."""
    found = Rewriting(mechanism)
    if only != "joints":
        found = _each_closure(mechanism, PointClosure, _as_frame)
    return found if only == "closures" else found.then(_with_revolutes(found.mechanism))


def _limits_lost(joints: Iterable[Joint], change: str) -> tuple[str, ...]:
    """A sentence about the limits that joints lose, beside those of position."""
    names = [
        joint.name
        for joint in joints
        if any(math.isfinite(value) for limit in _LIMITS for value in getattr(joint.properties, limit))
    ]
    return (f"limits of velocity and effort of {quoted(names)} {change}",) if names else ()


# -- joints -----------------------------------------------------------------------------------------------------------


def _with_balls(mechanism: Mechanism) -> Rewriting:
    """Each chain of three revolute joints whose axes meet in one point as the spherical joint that it is.

    The links between carry nothing else: no inertia, shape, frame or closure. None of the joints is actuated, coupled,
    limited to less than a turn, or has damping, friction, armature or a spring.
    """
    tree = MechanismTree(mechanism)
    ends = {anchor.body for closure in mechanism.closures for anchor in closure.anchors}
    framed = {frame.body for frame in mechanism.frames}
    found = Rewriting(mechanism)
    kept: dict[str, None] = {}
    merged: set[str] = set()
    joints: list[Joint] = []
    for excluded in (tree.why_not, merged):  # a chain with a joint that must stay may overlap one without
        for chain in find_chains(tree, tree.joints, excluded, ends, rotary=ROTARY):
            names = [joint.name for joint in chain.joints]
            reason = next((f"'{name}' {tree.why_not[name]}" for name in names if name in tree.why_not), "")
            if reason := reason or _not_exact(chain, tree, framed):
                kept[f"joints {quoted(names)} stay, whose axes meet in one point: {reason}"] = None
                continue
            merged.update(names)
            joints += merge(chain, names[-1])
            step = Rewriting(
                mechanism,
                (f"joints {quoted(names)} are the ball joint '{names[-1]}'",),
                lost=_limits_lost(chain.joints, "become those of the axes of the ball"),
                between=tuple(joint.child for joint in chain.joints[:2]),
                steps=(partial(_with_ball, chain),),
            )
            found = found.then(step)
    return replace(found, mechanism=tree.rebuilt(joints) if joints else mechanism, kept=tuple(kept))


def _with_ball(chain: BallChain, positions: Positions) -> Positions:
    """Positions with a ball in place of the three joints of a chain."""
    found = dict(positions)
    turn = _turned(chain, *(found.pop(joint.name)[0] for joint in chain.joints))
    return {**found, chain.joints[2].name: turn.quaternion}


def _not_exact(chain: BallChain, tree: MechanismTree, framed: set[str]) -> str:
    """Why a ball would not move exactly as the three joints; empty if it does."""
    for joint in chain.joints[:2]:
        link = tree.links[joint.child]
        if link.inertia is not None and (link.inertia.mass or any(link.inertia.moments)):
            return f"link '{link.name}' between them has inertia"
        if link.visuals or link.collisions or link.name in framed:
            return f"link '{link.name}' between them has a {'frame' if link.name in framed else 'shape'}, which turns"
    gap = max(math.hypot(*_turned(chain, *angles).xyz) for angles in _TRIED)
    return f"they miss it by {gap:.1g} m" if gap > _MEETING else ""


def _turned(chain: BallChain, *angles: float) -> Pose:
    """What the ball joint of a chain does at these angles, rad: a rotation, and no translation if the axes meet."""
    ball = merge(chain, chain.joints[2].name)[2]
    moved = IDENTITY
    for joint, angle in zip(chain.joints, angles, strict=True):
        moved = moved * joint.placement * joint.transform((angle,)) * joint.offset
    return ball.placement.inverse() * moved * ball.offset.inverse()


def _with_revolutes(mechanism: Mechanism) -> Rewriting:
    """Three continuous joints about x, y and z of its frame in place of each ball joint, singular where y is ±π/2."""
    found, tree = Rewriting(mechanism), MechanismTree(mechanism)
    for ball in (joint for joint in mechanism.joints if joint.type.is_ball):
        if ball.name in tree.why_not:
            kept = f"ball joint '{ball.name}' stays: it {tree.why_not[ball.name]}"
            found = replace(found, kept=(*found.kept, kept))
        else:
            found = found.then(_as_revolutes(MechanismTree(found.mechanism), ball))
    return found


def _as_revolutes(tree: MechanismTree, ball: Joint) -> Rewriting:
    x, y = (tree.unused(f"{ball.name}_{axis}") for axis in "xy")
    joint = partial(Joint, type=_CONTINUOUS, properties=JointProperties.unlimited(_CONTINUOUS))
    joints = (
        joint(x, parent=ball.parent, child=x, placement=ball.placement, axes=(X,)),
        joint(y, parent=x, child=y, axes=(Y,)),
        joint(ball.name, parent=y, child=ball.child, offset=ball.offset, axes=(Z,)),
    )
    return Rewriting(
        tree.rebuilt(joints, (Body(x), Body(y))),
        (f"ball joint '{ball.name}' is the joints {quoted([x, y, ball.name])}, about x, y and z of its frame",),
        lost=_limits_lost([ball], "are left out"),
        steps=(partial(_with_angles, ball, (x, y, ball.name)),),
    )


def _with_angles(ball: Joint, names: Sequence[str], positions: Positions) -> Positions:
    """Positions with the angles of three joints, rad, in place of the quaternion of a ball: R = Rx(a) Ry(b) Rz(c)."""
    x, y, z, w = ball.normalized(positions[ball.name])
    (r00, _, _), (r01, _, _), (r02, r12, r22) = (Pose(quaternion=(x, y, z, w)).rotate(axis) for axis in AXES)
    angles = math.atan2(-r12, r22), math.asin(max(-1.0, min(1.0, r02))), math.atan2(-r01, r00)
    return {**positions, **{name: (angle,) for name, angle in zip(names, angles, strict=True)}}


# -- closures ---------------------------------------------------------------------------------------------------------


def _each_closure(
    mechanism: Mechanism, kind: type[Closure], rewrite: Callable[[MechanismTree, Any], Rewriting]
) -> Rewriting:
    """Rewrite every closure of a kind, one after the other."""
    found, tree = Rewriting(mechanism), MechanismTree(mechanism)
    for closure in mechanism.closures:
        if isinstance(closure, kind):
            found = found.then(rewrite(tree, closure))
            if found.mechanism is not tree.mechanism:
                tree = MechanismTree(found.mechanism)
    return found


def _as_point(tree: MechanismTree, closure: FrameClosure) -> Rewriting:
    """A 3d closure in place of a 6d closure of a link that a passive ball joint carries, and of this joint.

    The link stays, fixed to the body that the closure held it to: with its mass, shapes, frames, and all that hangs
    from it.
    """
    mechanism = tree.mechanism
    kept: list[str] = []
    balls: list[tuple[Any, ...]] = []
    for own, other in ((closure.a, closure.b), (closure.b, closure.a)):
        link, at = tree.rigid[own.body]
        ball = tree.above.get(link)
        if ball is None or not ball.type.is_ball or other.body in (links := tree.below(link)):
            continue
        if tree.rigid[ball.parent][0] == tree.rigid[other.body][0]:
            continue  # no other joint is in the loop: a 3d closure would hold nothing
        why = "" if closure.compliance == RIGID else _SOFT
        if ball.name in tree.why_not:
            why = f"ball joint '{ball.name}' {tree.why_not[ball.name]}"
        elif tree.is_bare(ball.parent, ball):
            why = f"without ball joint '{ball.name}', link '{ball.parent}' would move no mass"
        if why:
            kept.append(f"closure '{closure.name}' stays 6d: {why}")
            continue
        # Rather a link that ends here than one that others hang from, or are closed to; else the lighter one; else that
        # on the heavier body: a rod stays on a light crank, which a servo in a simulation would otherwise move alone.
        held = sum(anchor.body in links for each in mechanism.closures for anchor in each.anchors)
        heavier = -tree.mass_of_whole(ball.parent)
        balls.append((not tree.is_rigid(links), held, tree.mass(*links), heavier, len(balls), ball, at, own, other))
    if not balls:
        return Rewriting(mechanism, kept=tuple(kept))
    *_, ball, at, own, other = min(balls, key=lambda each: each[:5])
    weld = replace(ball.fixed(other.pose * (at * own.pose).inverse()), parent=other.body)
    # The body that held the link keeps its letter.
    ends = Anchor(ball.parent, Pose(ball.placement.xyz)), _anchor(ball.child, Pose(ball.offset.inverse().xyz))
    a, b = ends if own is closure.a else ends[::-1]
    return Rewriting(
        tree.rebuilt([weld], closures=_exchanged(mechanism, closure, PointClosure(closure.name, a, b))),
        (
            f"closure '{closure.name}' is 3d, of '{a.body}' and '{b.body}': it takes the place of ball joint "
            f"'{ball.name}', and '{ball.child}' is fixed to '{other.body}'",
        ),
        lost=_limits_lost([ball], "are left out with the joint"),
        steps=(lambda positions: {name: values for name, values in positions.items() if name != ball.name},),
    )


def _as_frame(tree: MechanismTree, closure: PointClosure) -> Rewriting:
    """A ball joint and a 6d closure in place of a 3d closure: the inverse of `_as_point`.

    The ball carries a link with inertia that is fixed to the body of the closure, if there is one that nothing moving
    hangs from; else a new link, which gets half of the inertia of that body.
    """
    bodies: tuple[Body, ...] = ()
    for own, other in ((closure.b, closure.a), (closure.a, closure.b)) if closure.compliance == RIGID else ():
        weld, links = tree.above.get(own.body), tree.below(own.body)
        if weld and weld.type.is_fixed and tree.is_heavy(own.body) and tree.is_rigid(links) and other.body not in links:
            held = Anchor(weld.parent, weld.placement * weld.offset)
            name, link, offset = weld.name, own.body, Pose(own.pose.xyz).inverse()
            break
        if bodies := _halves(tree, own, closure.name):
            held, offset = Anchor(own.body, Pose(own.pose.xyz)), IDENTITY
            name = link = bodies[1].name
            break
    else:
        why = _SOFT if closure.compliance != RIGID else "neither of its bodies has inertia"
        return Rewriting(tree.mechanism, kept=(f"closure '{closure.name}' stays 3d: {why}",))
    ball = Joint(name, _SPHERICAL, other.body, link, Pose(other.pose.xyz), offset, properties=_FREE_BALL)
    ends = held, _anchor(link, IDENTITY)
    a, b = ends if own is closure.a else ends[::-1]
    closures = _exchanged(tree.mechanism, closure, FrameClosure(closure.name, a, b))

    def with_ball(positions: Positions) -> Positions:
        poses = poses_of(tree.mechanism, positions)
        return {**positions, name: (poses[other.body].inverse() * poses[own.body]).quaternion}

    return Rewriting(
        tree.rebuilt([ball], bodies, closures=closures),
        (f"closure '{closure.name}' is 6d, of '{a.body}' and '{b.body}'; ball joint '{name}' carries '{link}'",),
        steps=(with_ball,),
    )


def _halves(tree: MechanismTree, own: Anchor, closure: str) -> tuple[Body, ...]:
    """The nearest body with inertia that carries an anchor rigidly, and a new link there; each with half of it.

    None if there is no such body.
    """
    link, pose = own.body, Pose(own.pose.xyz)
    while not tree.is_heavy(link):
        joint = tree.above.get(link)
        if joint is None or not joint.type.is_fixed:
            return ()
        pose, link = joint.placement * joint.offset * pose, joint.parent
    body = tree.links[link]
    assert body.inertia is not None
    xx, xy, xz, yy, yz, zz = (each / 2.0 for each in body.inertia.moments)
    half = replace(body.inertia, mass=body.inertia.mass / 2.0, moments=(xx, xy, xz, yy, yz, zz))
    new = Body(tree.unused(f"{closure}_ball"), replace(half, pose=pose.inverse() * half.pose))
    return replace(body, inertia=half), new


def _anchor(body: str, pose: Pose) -> Anchor:
    return Anchor(body, pose, body if pose == IDENTITY else "")


def _exchanged(mechanism: Mechanism, old: Closure, new: Closure) -> tuple[Closure, ...]:
    return tuple(new if each is old else each for each in mechanism.closures)
