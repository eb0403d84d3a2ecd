"""Frames A and B of a closure change places: the residual is that of the inverse pose."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property, closed
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.changing import pose_matrix
from eurdf_conformance.properties.relations.saying import with_named_frames
from eurdf_conformance.protocol.message import Jacobian, Values


def swapping(example: Example, version: Version) -> Pair:
    """A mechanism whose closures join frames that have names, and the same one with A and B swapped.

    With ᴬM_B = (R, p): 6d, log6 of the inverse is −log6, so r′ = −r and K′ = −K. 3d: r′ = −Rᵀ p, and K′ = −Rᵀ K where
    p is zero; where it is not, K′ has another part that K does not give, and is not compared.
    """
    mechanism = with_named_frames(example.mechanism)
    other = mechanism.replace(
        closures=tuple(each.model_copy(update={"a": each.b, "b": each.a}) for each in mechanism.closures)
    )
    names = list(mechanism.configurations)

    def carry(values: Values, index: int) -> Values:
        assert values.poses is not None
        assert values.residuals is not None
        assert values.jacobian is not None
        turn = {}
        for closure in mechanism.closures:
            a, b = (pose_matrix(values.poses[str(name)])[:3, :3] for name in (closure.a, closure.b))
            turn[closure.name] = -b.T @ a if closure.type == "3d" else -np.eye(6)
        residuals = {name: (turn[name] @ r).tolist() for name, r in values.residuals.items()}
        rows = {name: (turn[name] @ np.array(K)).tolist() for name, K in values.jacobian.rows.items()}
        jacobian = Jacobian(columns=values.jacobian.columns, rows=rows)
        return compared(values.model_copy(update={"residuals": residuals, "jacobian": jacobian}), index)

    def compared(values: Values, index: int) -> Values:
        """Without the rows of K that the relation does not determine."""
        if names[index] == "assembled" or values.jacobian is None:
            return values
        balls = {closure.name for closure in mechanism.closures if closure.type == "3d"}
        rows = {name: K for name, K in values.jacobian.rows.items() if name not in balls}
        return values.model_copy(update={"jacobian": values.jacobian.model_copy(update={"rows": rows})})

    return Pair(query_of(mechanism, version), query_of(other, version), carry, seen=compared)


PROPERTIES = (
    Property(
        "swapping",
        "Swapping the frames A and B gives the residual of the inverse pose.",
        ("EU-CLO-008", "EU-CLO-009", "EU-CLO-010"),
        (Level.KINEMATICS,),
        related(swapping),
        applies=closed,
        closures=1,
    ),
)
