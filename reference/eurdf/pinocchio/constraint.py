"""The constraints of a mechanism as Pinocchio constraint models."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import pinocchio as pin

from eurdf.closures.kind import ClosureKind, Contact
from eurdf.errors import NoConstraintModel
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Constraint
from eurdf.pinocchio.tree import Tree
from eurdf.pinocchio.tree_few import Site


def contacts_of(constraint: Constraint) -> tuple[Contact, ...]:
    """What Pinocchio has a constraint model for each of; nothing if it has none for the kind of the constraint."""
    return constraint.contacts() if isinstance(constraint, ClosureKind) else ()


def build_constraint_models(constraints: Iterable[Constraint], tree: Tree) -> list[pin.RigidConstraintModel]:
    """The constraint models of the constraints, in their order and under their names.

    Each joins the joints that move the bodies of its frames A and B; its placements are those of the frames in the
    joints, and its residual and forces are expressed in frame A (``LOCAL``). A hinge is two 3d models: ``NAME`` of its
    origin, and ``NAME/axis`` of the point on its axis that is 0.1 m from the origin.

    Raises:
        NoConstraintModel: A constraint is of a kind that Pinocchio does not have.
    """
    constraint_models = []
    for constraint in constraints:
        own = models_of(constraint, contacts_of(constraint), tree.model, tree.site)
        if not own:
            raise NoConstraintModel(constraint.name, constraint.type)
        constraint_models += own
    return constraint_models


def models_of(
    constraint: Constraint, contacts: Iterable[Contact], model: pin.Model, site: Callable[[Anchor], Site]
) -> list[pin.RigidConstraintModel]:
    """Those of contacts of one constraint, whose frames are at some sites of a model."""
    found = []
    for contact in contacts:
        ends = []
        for anchor, point in zip(constraint.anchors, (contact.a, contact.b), strict=True):
            joint, placement = site(anchor)
            ends += [joint, placement * pin.SE3(np.eye(3), np.array(point))]
        type_ = pin.ContactType.CONTACT_6D if contact.is_frame else pin.ContactType.CONTACT_3D
        constraint_model = pin.RigidConstraintModel(type_, model, *ends, pin.ReferenceFrame.LOCAL)
        constraint_model.name = constraint.name + contact.name
        found.append(constraint_model)
    return found
