"""The residual of a coupling and its derivative: chapter Couplings, EU-CPL-005, EU-CPL-006 and EU-CLO-010.

r = Σ cᵢ qᵢ − offset. qᵢ is the one coordinate of joint i as files have it: a length, or an angle with its whole turns.
"""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.configuration import Configuration, stated
from eurdf_conformance.oracle.description import Coupling
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.spatial import Array
from eurdf_conformance.oracle.tree import Tree

#: For each type of joint that can be coupled, whether its coordinate is an angle, `a`, or a length, `l`.
COUPLED = {"revolute": "a", "continuous": "a", "helical": "a", "prismatic": "l"}


def residual(tree: Tree, q: Configuration, coupling: Coupling) -> Array:
    """One number, in the unit of the products cᵢ qᵢ."""
    coordinates = stated(tree, q)
    terms = [c * coordinates.get(name, np.zeros(1))[0] for name, c in coupling.coefficients.items()]
    return np.array([sum(terms) - coupling.offset])


def jacobian(velocities: list[tuple[str, int]], coupling: Coupling) -> Array:
    """The row of K."""
    return np.array([[coupling.coefficients.get(name, 0.0) for name, _ in velocities]])


def unit(tree: Tree, coupling: Coupling) -> tuple[float, str]:
    """The largest coefficient, and whether the coordinate of its joint is an angle or a length."""
    largest = max(coupling.coefficients, key=lambda name: abs(coupling.coefficients[name]))
    return abs(coupling.coefficients[largest]), COUPLED[tree_joint(tree, largest)]


def require_coupled(tree: Tree, coupling: Coupling) -> None:
    """EU-CPL-003: its joints have one coordinate of their own each."""
    for name in coupling.coefficients:
        if tree_joint(tree, name) not in COUPLED:
            raise NotRead(f"the joint {name!r} is coupled")


def tree_joint(tree: Tree, name: str) -> str:
    """The type of a joint of that name; empty where none moves by itself."""
    return next((joint.type for joint in tree.joints[1:] if joint.name == name and not joint.mimic), "")
