"""Parsers that compute inertias differently."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import kinematics, mass_matrix, urdf
from eurdf_conformance.oracle.spatial import skew
from mutants.mutant import Deviation, Members, instead


def _inertia(change: Callable[[Any, Any], Members]) -> Deviation:
    """The inertia of a link is another: change(inertia, axes of the element) -> what differs."""

    def changed(right: Any, link: Any) -> Any:
        found = right(link)
        return found and replace(found, **change(found, urdf.origin(link.one("inertial"))[:3, :3]))

    return instead(urdf, "inertia", changed)


def _masses(counts: Callable[[Any, Any], bool]) -> tuple[Deviation, ...]:
    """Some inertias do not count."""

    def masses(right: Any, *arguments: Any) -> Any:
        *others, all_masses = arguments
        return right(*others, [(link, at) for link, at in all_masses if counts(link, at)])

    return tuple(instead(mass_matrix, name, masses) for name in ("mass", "mass_matrix", "center_of_mass"))


MEANS = {
    "EU-INR-006": {
        "The moments of a link are along its own axes, whatever the orientation of `inertial`.": _inertia(
            lambda found, R: {"moments": R.T @ found.moments @ R}
        ),
        "The moments of a link are about its origin, not its centre of mass.": _inertia(
            lambda found, R: {"moments": found.moments + found.mass * skew(found.center) @ skew(found.center)}
        ),
        "The centre of mass of a link is at its origin.": _inertia(lambda found, R: {"center": np.zeros(3)}),
        "Products of inertia have the other sign, as in some CAD programs.": _inertia(
            lambda found, R: {"moments": found.moments * (2 * np.eye(3) - 1)}
        ),
    },
    ("EU-INR-006", "2"): {  # version 1 has no armature
        "M lacks the armatures.": instead(
            mass_matrix, "mass_matrix", lambda right, at, sharing, armature, m: right(at, sharing, 0 * armature, m)
        ),
    },
    "EU-INR-005": {
        "A link behind a fixed joint weighs nothing.": _masses(lambda link, at: np.array_equal(at.pose, np.eye(4))),
        "The mass does not count the root.": _masses(lambda link, at: at.body > 0),
        "The inertia of a link behind a fixed joint counts as if it were at the link before.": instead(
            kinematics.Kinematics, "pose", lambda right, at, frame: at.bodies[frame.body]
        ),
    },
}
