"""The constraints of a mechanism as Pinocchio constraint models."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import pinocchio as pin

from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.errors import NoConstraintModel
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.pose import Vector3, direction
from eurdf.pinocchio.tree import Tree
from eurdf.pinocchio.tree_few import Site

#: Number of constraint models of each kind of constraint.
_NUMBER: Mapping[type[Constraint], int] = {PointClosure: 1, FrameClosure: 1, HingeClosure: 2}

#: Distance of the point on the axis of a hinge from its origin, m.
_ON_AXIS = 0.1


def number_of_models(constraint: Constraint) -> int:
    """Number of constraint models that Pinocchio needs for a constraint; 0 if it has none for its kind."""
    return _NUMBER.get(type(constraint), 0)


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
        if not number_of_models(constraint):
            raise NoConstraintModel(constraint.name, constraint.type)
        ends = [tree.site(anchor) for anchor in constraint.anchors]
        contact = pin.ContactType.CONTACT_6D if isinstance(constraint, FrameClosure) else pin.ContactType.CONTACT_3D
        constraint_models.append(_model(constraint.name, contact, tree, ends))
        if isinstance(constraint, HingeClosure):
            on_axis = [_along(end, axis) for end, axis in zip(ends, constraint.axes, strict=True)]
            constraint_models.append(_model(f"{constraint.name}/axis", contact, tree, on_axis))
    return constraint_models


def _along(frame: Site, axis: Vector3) -> Site:
    """The frame, moved along an axis of its own."""
    return Site(frame.joint, frame.placement * pin.SE3(np.eye(3), _ON_AXIS * np.array(direction(axis))))


def _model(name: str, contact: pin.ContactType, tree: Tree, ends: Iterable[Site]) -> pin.RigidConstraintModel:
    joints_and_placements = (each for end in ends for each in end)
    constraint_model = pin.RigidConstraintModel(contact, tree.model, *joints_and_placements, pin.ReferenceFrame.LOCAL)
    constraint_model.name = name
    return constraint_model
