"""The canonical description, EU-CAN-001."""

from __future__ import annotations

from typing import Any, cast

from eurdf_conformance.oracle.configuration import stated
from eurdf_conformance.oracle.coupling import require_coupled
from eurdf_conformance.oracle.description import Actuator, Coupling, Description
from eurdf_conformance.oracle.joint_property import properties
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.tree import Joint, Tree
from eurdf_conformance.oracle.urdf import Shape, Urdf
from eurdf_conformance.protocol.message import (
    CanonicalActuator,
    CanonicalClosure,
    CanonicalCompliance,
    CanonicalCoupling,
    CanonicalJoint,
    CanonicalMimic,
    CanonicalRobot,
    CanonicalShape,
    Pose,
)


def canonical(urdf: Urdf, description: Description, tree: Tree) -> CanonicalRobot:
    """The canonical description of a robot."""
    joints = {joint.name: joint for joint in tree.joints[1:]}
    link_of = links_of_bodies(tree)
    motors = {actuator.joint: actuator for actuator in description.actuators}
    return CanonicalRobot(
        name=urdf.name,
        version=description.version,
        root=description.root,
        links=list(urdf.links),
        frames=list(description.frames),
        joints=[
            canonical_joint(joint, link_of[joint.parent], link_of[i], motors.get(joint.name))
            for i, joint in enumerate(tree.joints)
            if i > 0
        ],
        closures=[
            CanonicalClosure(
                name=closure.name,
                type=closure.type,
                a=link_of[tree.refer(closure.a).body],
                b=link_of[tree.refer(closure.b).body],
                axes=[axis.tolist() for axis in closure.axes] or None,
                length=closure.length,
                compliance=CanonicalCompliance(**closure.compliance) if closure.compliance else None,
            )
            for closure in description.closures
        ],
        actuators=[canonical_actuator(actuator, joints) for actuator in description.actuators],
        configurations={
            name: {joint: q.tolist() for joint, q in stated(tree, configuration).items()}
            for name, configuration in description.configurations.items()
        },
        couplings=[canonical_coupling(coupling, tree) for coupling in description.couplings],
        shapes=[canonical_shape(name, shape) for name, link in urdf.links.items() for shape in link.shapes],
        own=description.own,
    )


def canonical_coupling(coupling: Coupling, tree: Tree) -> CanonicalCoupling:
    """As written; its joints have one coordinate each, EU-CPL-003."""
    require_coupled(tree, coupling)
    return CanonicalCoupling(name=coupling.name, joints=coupling.coefficients, offset=coupling.offset)


def canonical_shape(link: str, shape: Shape) -> CanonicalShape:
    """A shape where the URDF puts it in its link, EU-CAN-006. No merge moves a link at zero."""
    M = shape.placement
    return CanonicalShape(
        link=link,
        use=cast(Any, shape.use),
        type=cast(Any, shape.type),
        size=shape.size.tolist(),
        file=shape.file,
        pose=Pose(rotation=M[:3, :3].tolist(), translation=M[:3, 3].tolist()),
    )


def links_of_bodies(tree: Tree) -> list[str]:
    """One link of each body. The body between the two joints of a universal one has no link, but its own name."""
    found: dict[int, str] = {}
    for name, placed in tree.links.items():
        found.setdefault(placed.body, name)
    for i, joint in enumerate(tree.joints):
        name = joint.name
        while i not in found and name in tree.links:
            name += "'"
        found.setdefault(i, name)
    return [found[i] for i in range(len(tree.joints))]


def canonical_joint(joint: Joint, parent: str, child: str, motor: Actuator | None) -> CanonicalJoint:
    """A joint that moves."""
    mimic = joint.mimic
    return CanonicalJoint(
        name=joint.name,
        type=cast(Any, joint.type),
        parent=parent,
        child=child,
        mimic=CanonicalMimic(**vars(mimic)) if mimic else None,
        **vars(properties(joint, motor)),
    )


def canonical_actuator(actuator: Actuator, joints: dict[str, Joint]) -> CanonicalActuator:
    """A joint with a motor, for each of its velocities, EU-ACT-007."""
    if actuator.joint not in joints or not (nv := joints[actuator.joint].kind.nv) or joints[actuator.joint].mimic:
        raise NotRead(f"the actuator {actuator.joint!r}")
    return CanonicalActuator(
        joint=actuator.joint,
        gear_ratio=[actuator.gear_ratio] * nv,
        rotor_inertia=[actuator.rotor_inertia] * nv,
        name=actuator.name,
        control=actuator.control,
    )
