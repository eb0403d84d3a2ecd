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


wrong = means("EU-CPL-005")
wrong("The offset of a coupling is added to the sum.", lambda: _reads(lambda read: replace(read, offset=-read.offset)))
wrong("The offset of a coupling is left out.", lambda: _reads(lambda read: replace(read, offset=0.0)))
wrong(
    "A coupling ends with its second joint.",
    lambda: _reads(lambda read: replace(read, coefficients=dict(list(read.coefficients.items())[:2]))),
)
wrong(
    "The coefficient of the first joint of a coupling is taken as 1.",
    lambda: _reads(lambda read: replace(read, coefficients=read.coefficients | {next(iter(read.coefficients)): 1.0})),
)


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


wrong = means("EU-CLO-010", versions=("2.1",))
wrong(
    "K of a coupling has 1 and -1 for its coefficients.",
    lambda: instead(coupling, "jacobian", lambda right, velocities, of: np.sign(right(velocities, of))),
)
