"""Parsers with other couplings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import coupling, version2
from eurdf_conformance.oracle.description import Coupling
from mutants.mutant import Deviation, instead, means


def _reads(change: Callable[[Coupling], Coupling]) -> Deviation:
    """A coupling is read as another one."""
    return instead(version2, "coupling", lambda right, value: change(right(value)))


@means("EU-CPL-005")
def couplings_add_their_offset() -> Deviation:
    """The offset of a coupling is added to the sum."""
    return _reads(lambda read: replace(read, offset=-read.offset))


@means("EU-CPL-005")
def couplings_have_no_offset() -> Deviation:
    """The offset of a coupling is left out."""
    return _reads(lambda read: replace(read, offset=0.0))


@means("EU-CPL-005")
def couplings_are_of_two_joints() -> Deviation:
    """A coupling ends with its second joint."""
    return _reads(lambda read: replace(read, coefficients=dict(list(read.coefficients.items())[:2])))


@means("EU-CPL-005")
def couplings_are_mimics() -> Deviation:
    """The coefficient of the first joint of a coupling is taken as 1."""
    return _reads(lambda read: replace(read, coefficients=read.coefficients | {next(iter(read.coefficients)): 1.0}))


@means("EU-CPL-005")
def couplings_are_relative() -> Deviation:
    """The residual of a coupling is divided by its largest coefficient."""

    def residual(right: Any, tree: Any, q: Any, of: Coupling) -> Any:
        return right(tree, q, of) / max(map(abs, of.coefficients.values()))

    return instead(coupling, "residual", residual)


@means("EU-CPL-006")
def couplings_forget_turns() -> Deviation:
    """A coupled continuous joint is at an angle of at most half a turn."""

    def residual(right: Any, tree: Any, q: Any, of: Coupling) -> Any:
        continuous = {joint.name for joint in tree.joints if joint.type == "continuous"}
        wrapped = {name: [float(np.arctan2(np.sin(at), np.cos(at))) for at in values] for name, values in q.items()}
        return right(tree, {name: wrapped[name] if name in continuous else q[name] for name in q}, of)

    return instead(coupling, "residual", residual)


@means("EU-CLO-010", versions=("2.1",))
def k_of_couplings_is_of_signs() -> Deviation:
    """K of a coupling has 1 and -1 for its coefficients."""
    return instead(coupling, "jacobian", lambda right, velocities, of: np.sign(right(velocities, of)))
