"""Parsers that compute inertias differently."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import kinematics, mass_matrix, urdf
from eurdf_conformance.oracle.spatial import skew
from mutants.mutant import Deviation, instead, means


def _inertia(change: Callable[[Any, Any], Any]) -> Deviation:
    """The inertia of a link is another: change(inertia, element of the link)."""

    def changed(right: Any, link: Any) -> Any:
        found = right(link)
        return found and change(found, link)

    return instead(urdf, "inertia", changed)


def _axes(link: Any) -> Any:
    return urdf.origin(link.one("inertial"))[:3, :3]


wrong = means("EU-INR-006")
wrong(
    "The moments of a link are along its own axes, whatever the orientation of `inertial`.",
    lambda: _inertia(lambda found, link: replace(found, moments=_axes(link).T @ found.moments @ _axes(link))),
)


@means("EU-INR-006")
def inertia_about_the_link() -> Deviation:
    """The moments of a link are about its origin, not its centre of mass."""

    def about_origin(found: Any, link: Any) -> Any:
        c = skew(found.center)
        return replace(found, moments=found.moments + found.mass * c @ c)

    return _inertia(about_origin)


wrong = means("EU-INR-006")
wrong(
    "The centre of mass of a link is at its origin.",
    lambda: _inertia(lambda found, link: replace(found, center=np.zeros(3))),
)
wrong(
    "Products of inertia have the other sign, as in some CAD programs.",
    lambda: _inertia(lambda found, link: replace(found, moments=found.moments * (2 * np.eye(3) - 1))),
)

wrong = means("EU-INR-006", versions=("2",))
# version 1 has no armature
wrong(
    "M lacks the armatures.",
    lambda: instead(
        mass_matrix, "mass_matrix", lambda right, at, sharing, armature, m: right(at, sharing, 0 * armature, m)
    ),
)

wrong = means("EU-INR-005")
wrong(
    "A link behind a fixed joint weighs nothing.", lambda: _masses(lambda link, at: np.array_equal(at.pose, np.eye(4)))
)
wrong("The mass does not count the root.", lambda: _masses(lambda link, at: at.body > 0))


def _masses(counts: Callable[[Any, Any], bool]) -> Deviation:
    """Some inertias do not count."""

    def masses(right: Any, *arguments: Any) -> Any:
        *others, all_masses = arguments
        return right(*others, [(link, at) for link, at in all_masses if counts(link, at)])

    return _all(*(instead(mass_matrix, name, masses) for name in ("mass", "mass_matrix", "center_of_mass")))


def _all(*deviations: Deviation) -> Deviation:
    @contextmanager
    def entered() -> Any:
        with ExitStack() as stack:
            for deviation in deviations:
                stack.enter_context(deviation)
            yield

    return entered()


wrong = means("EU-INR-005")
wrong(
    "The inertia of a link behind a fixed joint counts as if it were at the link before.",
    lambda: instead(kinematics.Kinematics, "pose", lambda right, at, frame: at.bodies[frame.body]),
)
