"""A link fixed to another one has the same effect as its inertia added to the other one's."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Inertia, Link, Mechanism, Pose
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.placement import Matrix, matrix_of, vector
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of


def lumping(example: Example, version: Version) -> Pair:
    """A mechanism, and the same with the inertia of each fixed link added to the link that carries it."""
    return Pair(query_of(example.mechanism, version), query_of(lumped(example.mechanism), version))


def lumped(mechanism: Mechanism) -> Mechanism:
    """Each inertia behind a fixed joint added to its parent link, from the leaves to the root."""
    inertias = {link.name: link.inertia for link in mechanism.links}
    for joint in reversed(mechanism.joints):  # a joint is after the one that it hangs from
        if mechanism.type_of(joint) == "fixed" and (carried := inertias[joint.child]) is not None:
            inertias[joint.parent] = together(inertias[joint.parent], carried, matrix_of(joint.origin))
            inertias[joint.child] = None
    return mechanism.replace(links=tuple(Link(name=link.name, inertia=inertias[link.name]) for link in mechanism.links))


def together(one: Inertia | None, other: Inertia, M: Matrix) -> Inertia:
    """Of two bodies, the second of which is at a pose in the frame of the first.

    m = m₁ + m₂, c = (m₁ c₁ + m₂ c₂) / m, and with d from the common centre, I = Σ R I Rᵀ + m (d·d − d dᵀ).
    """
    parts = [(np.eye(4), one)] if one is not None else []
    placed = [(place @ matrix_of(each.pose), each) for place, each in [*parts, (M, other)]]
    mass = sum(each.mass for _, each in placed)
    center = sum((each.mass * place[:3, 3] for place, each in placed), np.zeros(3)) / mass
    total = np.zeros((3, 3))
    for place, each in placed:
        R, d = place[:3, :3], place[:3, 3] - center
        total += R @ _symmetric(each) @ R.T + each.mass * (d @ d * np.eye(3) - np.outer(d, d))
    xx, xy, xz, yy, yz, zz = total[np.triu_indices(3)].tolist()
    return Inertia(mass=mass, pose=Pose(xyz=vector(center)), moments=(xx, xy, xz, yy, yz, zz))


def _symmetric(inertia: Inertia) -> Matrix:
    moments = np.zeros((3, 3))
    moments[np.triu_indices(3)] = inertia.moments
    return np.asarray(moments + np.triu(moments, 1).T)


def has_fixed_mass(mechanism: Mechanism) -> bool:
    """Whether a link on a fixed joint has mass."""
    weighs = {link.name: link.inertia is not None for link in mechanism.links}
    return any(mechanism.type_of(joint) == "fixed" and weighs[joint.child] for joint in mechanism.joints)


PROPERTIES = (
    Property(
        "lumping",
        "A link fixed to another one has the same effect as its inertia added to the other one's.",
        ("EU-INR-005", "EU-INR-006", "EU-JNT-019"),
        (Level.DYNAMICS,),
        related(lumping),
        applies=has_fixed_mass,
    ),
)
