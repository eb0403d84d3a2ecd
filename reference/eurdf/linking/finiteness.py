"""Whether what follows from the numbers of the files is finite, as the numbers are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import chain
from operator import add, attrgetter

from eurdf.diagnostics import Diagnostics, Place
from eurdf.format.extension import Extension
from eurdf.format.urdf.data import Urdf
from eurdf.linking.inertia import turned
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.mimic import Mimic, drivers
from eurdf.mechanism.pose import IDENTITY, Pose

#: Three factors below this, m, kg or kg·m², have a finite product, and so have sums of many of these.
_MODERATE = 1e90

# In compiled code, since each robot that is loaded is asked.
_mass, _moments, _centre = attrgetter("mass"), attrgetter("moments"), attrgetter("pose.xyz")
_origin = attrgetter("placement.xyz")


def check_finite(mechanism: Mechanism, urdf: Urdf, extension: Extension | None, diagnostics: Diagnostics) -> None:
    """EU-INR-007: armatures, poses at zero, relations of mimic joints, and inertias about joints are finite.

    One error for a robot: what depends on a quantity that is not finite is not finite either.

    Args:
        mechanism: A mechanism without errors.
        urdf: To point into.
        extension: To point into; None for a bare URDF.
        diagnostics: Gets what is found.
    """
    found = next(_not_finite(mechanism, urdf, extension), None)
    if found is not None:
        what, place = found
        hint = "write numbers of the size that the robot has, in m, kg and rad"
        diagnostics.report(
            "derived-not-finite", f"{what} is not finite, although the numbers in the files are", place, hint
        )


def _not_finite(mechanism: Mechanism, urdf: Urdf, extension: Extension | None) -> Iterator[tuple[str, Place]]:
    joints = {joint.name: joint for joint in mechanism.joints}
    leaders = drivers({name: joint.mimic for name, joint in joints.items() if joint.mimic is not None})
    if extension is not None:
        for entry in extension.actuators:
            if not all(map(math.isfinite, joints[entry.joint].properties.armature)):
                what = f"the armature of joint '{entry.joint}', gear_ratio² · rotor_inertia,"
                yield what, extension.document.place(entry.pointer)
        pointers = {entry.name: entry.pointer for entry in extension.joints}
        for name, what in _not_finite_at_leaders(leaders, joints):
            place = urdf.document.place(urdf.joints[name].element)
            yield what, extension.document.place(pointers[name]) if name in pointers else place
    for name, mimic in leaders.items():
        if not (math.isfinite(mimic.multiplier) and math.isfinite(mimic.offset)):
            element = next(urdf.joints[name].element.iterchildren("mimic"))
            what = f"the relation of mimic joint '{name}' to joint '{mimic.joint}', multiplier or offset,"
            yield what, urdf.document.place(element)
    if not _is_moderate(mechanism):
        yield from _poses_and_inertias_not_finite(mechanism, urdf, extension)
    if extension is not None:
        yield from _couplings_not_finite(mechanism, extension)


def _is_moderate(mechanism: Mechanism) -> bool:
    """Whether the norm of all lengths, masses and moments is so small that no pose and no inertia can overflow."""
    inertias = [body.inertia for body in mechanism.bodies if body.inertia is not None]
    vectors = chain(
        map(_moments, inertias),
        map(_centre, inertias),
        map(_origin, mechanism.joints),
        [joint.offset.xyz for joint in mechanism.joints if joint.offset is not IDENTITY],
        [frame.pose.xyz for frame in mechanism.frames],
        [anchor.pose.xyz for closure in mechanism.closures for anchor in closure.anchors],
    )
    return math.hypot(*chain.from_iterable(vectors), *map(_mass, inertias)) < _MODERATE


def _poses_and_inertias_not_finite(
    mechanism: Mechanism, urdf: Urdf, extension: Extension | None
) -> Iterator[tuple[str, Place]]:
    root = mechanism.bodies[0]
    pose_of = {root.name: IDENTITY}  # in the frame of the root, at zero
    in_joint = {root.name: (root.name, IDENTITY)}  # the body that the last joint moves, and the pose in its frame
    inertia_of = {body.name: body.inertia for body in mechanism.bodies}
    total: dict[str, tuple[float, ...]] = {}
    for name, joint in [(root.name, None), *((joint.child, joint) for joint in mechanism.joints)]:
        if joint is not None:
            step = joint.placement * joint.offset
            pose_of[name] = pose_of[joint.parent] * step
            moved, before = in_joint[joint.parent]
            in_joint[name] = (moved, before * step) if joint.type is JointType.FIXED else (name, joint.offset)
            if not _is_finite(pose_of[name]):
                link = urdf.links.get(name, urdf.links[urdf.root])
                yield f"the pose of link '{name}' at zero", urdf.document.place(link.element)
        inertia = inertia_of[name]
        if inertia is not None:
            moved, pose = in_joint[name]
            total[moved] = tuple(map(add, total.get(moved, (0.0,) * 7), _about_origin(pose, inertia)))
            if not all(map(math.isfinite, total[moved])):
                link = urdf.links[name]
                element = link.element if link.inertial is None else link.inertial
                yield f"the inertia of link '{name}' about the origin of its joint", urdf.document.place(element)
    if extension is not None:
        pointers = {entry.name: entry.pointer for entry in extension.frames}
        for frame in mechanism.frames:
            if frame.name in pointers and not _is_finite(pose_of[frame.body] * frame.pose):
                yield f"the pose of frame '{frame.name}' at zero", extension.document.place(pointers[frame.name])
        pointers = {entry.name: entry.pointer for entry in extension.closures}
        for closure in mechanism.closures:
            if not all(_is_finite(pose_of[anchor.body] * anchor.pose) for anchor in closure.anchors):
                what = f"the pose of a frame of closure '{closure.name}' at zero"
                yield what, extension.document.place(pointers[closure.name])


def _couplings_not_finite(mechanism: Mechanism, extension: Extension) -> Iterator[tuple[str, Place]]:
    pointers = {entry.name: entry.pointer for entry in extension.couplings}
    for coupling in mechanism.couplings:
        sizes = [abs(coefficient) for _, coefficient in coupling.coefficients]
        if not (math.isfinite(sum(sizes)) and math.isfinite(coupling.offset / max(sizes))):
            what = f"the sum of the coefficients of coupling '{coupling.name}', or its offset divided by the largest,"
            yield what, extension.document.place(pointers[coupling.name])


def _not_finite_at_leaders(leaders: Mapping[str, Mimic], joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
    """The mimic joints with a property that is not finite at their leader (EU-JNT-032), and what it is."""
    for name, mimic in leaders.items():
        m, own = abs(mimic.multiplier), joints[name].properties
        for key, factor in (("armature", m * m), ("damping", m * m), ("friction", m), ("stiffness", m * m)):
            # Zero times infinity is not a number, but nothing is added at the leader.
            if any(each and not math.isfinite(factor * each) for each in getattr(own, key)):
                yield name, f"the {key} of mimic joint '{name}' at its leader '{mimic.joint}'"


def _about_origin(pose: Pose, inertia: Inertia) -> tuple[float, ...]:
    """The mass, and the six components of the rotational inertia about the origin, along the axes there."""
    at, mass = pose * inertia.pose, inertia.mass
    xx, xy, xz, yy, yz, zz = turned(inertia.moments, at)
    x, y, z = at.xyz
    return (
        mass,
        xx + mass * (y * y + z * z),
        xy - mass * x * y,
        xz - mass * x * z,
        yy + mass * (x * x + z * z),
        yz - mass * y * z,
        zz + mass * (x * x + y * y),
    )


def _is_finite(pose: Pose) -> bool:
    return math.isfinite(math.hypot(*pose.xyz)) and all(map(math.isfinite, pose.quaternion))
