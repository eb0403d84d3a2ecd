"""The constraints of a mechanism as Pinocchio constraint models."""

from __future__ import annotations

from collections.abc import Iterable

import pinocchio as pin

from eurdf.exceptions import EurdfError
from eurdf.mechanism.constraint import Constraint, FrameClosure, PointClosure
from eurdf.pinocchio.tree import PinocchioTree

_CONTACT: dict[type[Constraint], pin.ContactType] = {
    PointClosure: pin.ContactType.CONTACT_3D,
    FrameClosure: pin.ContactType.CONTACT_6D,
}


class NoConstraintModel(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A constraint has a kind for which Pinocchio has no constraint model.

    Attributes:
        constraint: Name of the constraint.
        type: Its type.
    """

    def __init__(self, constraint: str, type_: str) -> None:
        self.constraint = constraint
        self.type = type_
        super().__init__(
            f"Pinocchio has no constraint model for constraint '{constraint}' of type '{type_}'; "
            "use robot.constraints, and the functions of eurdf"
        )


def has_constraint_models(constraints: Iterable[Constraint]) -> bool:
    """Whether Pinocchio has constraint models for these constraints."""
    return all(type(constraint) in _CONTACT for constraint in constraints)


def build_constraint_models(constraints: Iterable[Constraint], tree: PinocchioTree) -> list[pin.RigidConstraintModel]:
    """One constraint model a constraint, in their order and under their names.

    Each joins the joints that move the bodies of its frames A and B; its placements are those of the frames in the
    joints, and its residual and forces are expressed in frame A (``LOCAL``).

    Raises:
        NoConstraintModel: A constraint is of a kind that Pinocchio does not have.
    """
    constraint_models = []
    for constraint in constraints:
        contact = _CONTACT.get(type(constraint))
        if contact is None:
            raise NoConstraintModel(constraint.name, constraint.type)
        ends = (end for anchor in constraint.anchors for end in tree.site(anchor))
        constraint_model = pin.RigidConstraintModel(contact, tree.model, *ends, pin.ReferenceFrame.LOCAL)
        constraint_model.name = constraint.name
        constraint_models.append(constraint_model)
    return constraint_models
