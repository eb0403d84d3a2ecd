"""What a parser says of hinges, distances and couplings follows from what it says of 6d closures and of coordinates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.oracle import hinge
from eurdf_conformance.oracle.coupling import COUPLED
from eurdf_conformance.oracle.logarithm import log6, log6_derivative
from eurdf_conformance.oracle.spatial import skew
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Coupling, Mechanism, Pose, Spot, Vector
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.placement import Matrix, matrix_of
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.changing import pose_matrix
from eurdf_conformance.properties.relations.saying import with_named_frames
from eurdf_conformance.protocol.message import Values

Rows = tuple[Matrix, Matrix]


def hinges(example: Example, version: Version) -> Pair:
    """A mechanism, and the same one with each 6d closure as a hinge about an axis of any direction and length.

    Where the frames coincide, so do the axes. K_hinge = D ξ, with the twist ξ of B relative to A from K_6d = dlog6 ξ.
    """
    mechanism, chance = _with_6d_closures(example.mechanism), example.chance
    axes: dict[str, Vector] = {each.name: _direction(chance) for each in mechanism.closures}
    other = mechanism.replace(
        closures=tuple(
            each.model_copy(update={"type": "hinge", "axis": axes[each.name]}) for each in mechanism.closures
        )
    )

    def rows(name: str, aMb: Matrix, K: Matrix) -> Rows:
        a = np.array(axes[name]) / np.linalg.norm(axes[name])
        n, theta = hinge.turn(a, aMb[:3, :3] @ a)
        r = np.concatenate([aMb[:3, 3], hinge.plane(a).T @ (theta * n)])
        return r, hinge.derivative(aMb, (a, a)) @ _twist(aMb, K)

    return _carried(mechanism, other, version, rows)


def distances(example: Example, version: Version) -> Pair:
    """A mechanism, and the same one with each 6d closure as a distance, of a point that is beside frame B.

    With the origin of B at p in A, and the point at d in B: r = |p + R d| − |d|, which is zero where the frames
    coincide.
    """
    mechanism, chance = _with_6d_closures(example.mechanism), example.chance
    beside: dict[str, Vector] = {each.name: _direction(chance) for each in mechanism.closures}
    spots = {frame.name: frame.spot for frame in mechanism.frames}
    links = {link.name for link in mechanism.links}
    closures = []
    for each in mechanism.closures:
        d = beside[each.name]
        spot = spots.get(str(each.b)) or Spot(on="link" if each.b in links else "joint", of=str(each.b))
        x, y, z = (matrix_of(spot.pose)[:3, :3] @ d + spot.pose.xyz).tolist()
        moved = Spot(on=spot.on, of=spot.of, pose=Pose(xyz=(x, y, z)))
        update = {"type": "distance", "b": moved, "length": float(np.linalg.norm(d)), "compliance": None}
        closures.append(each.model_copy(update=update))
    other = mechanism.replace(closures=tuple(closures))

    def rows(name: str, aMb: Matrix, K: Matrix) -> Rows:
        d = np.array(beside[name])
        p = aMb[:3, 3] + aMb[:3, :3] @ d
        u = p / np.linalg.norm(p)
        velocity = np.hstack([np.eye(3), -skew(p)]) @ _twist(aMb, K)
        return np.array([np.linalg.norm(p) - np.linalg.norm(d)]), (u @ velocity)[None, :]

    return _carried(mechanism, other, version, rows)


def couplings(example: Example, version: Version) -> Pair:
    """A mechanism without couplings, and the same one with one of all joints that fit, closed at `assembled`."""
    mechanism, chance = with_named_frames(example.mechanism).replace(couplings=()), example.chance
    coefficients = {name: chance.between(0.5, 3.0) for name in _coupled(mechanism)}

    def total(stated: dict[str, tuple[float, ...]]) -> float:
        return sum(c * stated.get(name, (0.0,))[0] for name, c in coefficients.items())

    offset = total(mechanism.configurations["assembled"])
    other = mechanism.replace(couplings=(Coupling(name="all of them", joints=coefficients, offset=offset),))
    stated = list(mechanism.configurations.values())

    def carry(values: Values, index: int) -> Values:
        assert values.residuals is not None
        assert values.jacobian is not None
        row = [coefficients.get(joint, 0.0) for joint, _ in values.jacobian.columns]
        residuals = values.residuals | {"all of them": [total(stated[index]) - offset]}
        jacobian = values.jacobian.model_copy(update={"rows": values.jacobian.rows | {"all of them": [row]}})
        return values.model_copy(update={"residuals": residuals, "jacobian": jacobian})

    return Pair(query_of(mechanism, version), query_of(other, version), carry)


def _carried(
    mechanism: Mechanism, other: Mechanism, version: Version, rows: Callable[[str, Matrix, Matrix], Rows]
) -> Pair:
    """The two mechanisms, where each closure of the second has other rows at the pose of B in A of the first."""

    def carry(values: Values, index: int) -> Values:
        assert values.poses is not None
        assert values.jacobian is not None
        residuals, K = dict(values.residuals or {}), dict(values.jacobian.rows)
        for closure in mechanism.closures:
            a, b = (pose_matrix(values.poses[str(name)]) for name in (closure.a, closure.b))
            r, J = rows(closure.name, np.linalg.inv(a) @ b, np.array(K[closure.name]))
            residuals[closure.name], K[closure.name] = r.tolist(), J.tolist()
        jacobian = values.jacobian.model_copy(update={"rows": K})
        return values.model_copy(update={"residuals": residuals, "jacobian": jacobian})

    return Pair(query_of(mechanism, version), query_of(other, version), carry)


def _with_6d_closures(mechanism: Mechanism) -> Mechanism:
    """The mechanism with its 6d closures only, between frames that have names."""
    named = with_named_frames(mechanism)
    return named.replace(closures=tuple(each for each in named.closures if each.type == "6d"))


def _twist(aMb: Matrix, K: Matrix) -> Matrix:
    return np.asarray(np.linalg.solve(log6_derivative(log6(aMb)), K))


def _direction(chance: Chance) -> Vector:
    return chance.between(0.2, 1.5), chance.between(-1.5, -0.2), chance.between(0.2, 1.5)


def _coupled(mechanism: Mechanism) -> list[str]:
    return [
        joint.name
        for joint in mechanism.joints
        if mechanism.type_of(joint) in COUPLED and not mechanism.mimics(joint) and not joint.name.startswith("x-")
    ]


def has_6d(mechanism: Mechanism) -> bool:
    """Whether a closure is 6d."""
    return any(closure.type == "6d" for closure in mechanism.closures)


def can_couple(mechanism: Mechanism) -> bool:
    """Whether two joints can be coupled."""
    return len(_coupled(mechanism)) > 1


PROPERTIES = (
    Property(
        "hinges",
        "A hinge has the rows that follow from those of a 6d closure of the same frames.",
        ("EU-CLO-014", "EU-CLO-010"),
        (Level.KINEMATICS,),
        related(hinges),
        versions=("2.1",),
        applies=has_6d,
        closures=1,
    ),
    Property(
        "distances",
        "A distance has the row that follows from those of a 6d closure beside it.",
        ("EU-CLO-015", "EU-CLO-010"),
        (Level.KINEMATICS,),
        related(distances),
        versions=("2.1",),
        applies=has_6d,
        closures=1,
    ),
    Property(
        "couplings",
        "A coupling adds one row, the sum of its products, and changes no other value.",
        ("EU-CPL-005", "EU-CPL-003", "EU-CLO-010"),
        (Level.KINEMATICS,),
        related(couplings),
        versions=("2.1",),
        applies=can_couple,
    ),
)
