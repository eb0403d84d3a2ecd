"""Parsers that compute inertias differently."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from eurdf_conformance.oracle import kinematics, mass_matrix, urdf
from eurdf_conformance.oracle.spatial import skew
from eurdf_conformance.protocol.reply import accepted
from support.mutants.mutant import Answer, Deviation, answers, instead, means


def _inertia(change: Callable[[Any, Any], Any]) -> Deviation:
    """The inertia of a link is another: change(inertia, element of the link)."""

    def changed(right: Any, link: Any) -> Any:
        found = right(link)
        return found and change(found, link)

    return instead(urdf, "inertia", changed)


def _axes(link: Any) -> Any:
    return urdf.origin(link.one("inertial"))[:3, :3]


@means("EU-INR-006")
def inertia_along_the_link() -> Deviation:
    """The moments of a link are along its own axes, whatever the orientation of `inertial`."""
    return _inertia(lambda found, link: replace(found, moments=_axes(link).T @ found.moments @ _axes(link)))


@means("EU-INR-006")
def inertia_about_the_link() -> Deviation:
    """The moments of a link are about its origin, not its centre of mass."""

    def about_origin(found: Any, link: Any) -> Any:
        c = skew(found.center)
        return replace(found, moments=found.moments + found.mass * c @ c)

    return _inertia(about_origin)


@means("EU-INR-006")
def centre_of_mass_at_the_link() -> Deviation:
    """The centre of mass of a link is at its origin."""
    return _inertia(lambda found, link: replace(found, center=np.zeros(3)))


@means("EU-INR-006")
def products_of_inertia_with_the_other_sign() -> Deviation:
    """Products of inertia have the other sign, as in some CAD programs."""
    return _inertia(lambda found, link: replace(found, moments=found.moments * (2 * np.eye(3) - 1)))


@means("EU-INR-006", versions=("2",))  # version 1 has no armature
def armature_is_forgotten() -> Deviation:
    """M lacks the armatures."""
    return instead(
        mass_matrix, "mass_matrix", lambda right, at, sharing, armature, m: right(at, sharing, 0 * armature, m)
    )


@means("EU-INR-005")
def links_behind_fixed_joints_weigh_nothing() -> Deviation:
    """A link behind a fixed joint weighs nothing."""
    return _masses(lambda link, at: np.array_equal(at.pose, np.eye(4)))


@means("EU-INR-005")
def root_weighs_nothing() -> Deviation:
    """The mass does not count the root."""
    return _masses(lambda link, at: at.body > 0)


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


@means("EU-INR-005")
def links_behind_fixed_joints_are_not_moved() -> Deviation:
    """The inertia of a link behind a fixed joint counts as if it were at the link before."""
    return instead(kinematics.Kinematics, "pose", lambda right, at, frame: at.bodies[frame.body])


def _not_checked(code: str, at: str) -> Callable[[Answer, Path, Path], Answer]:
    """An error is not found where the line of its place has this text."""

    def answer(right: Answer, *files: Path) -> Answer:
        if {issue.code for issue in right.issues} != {code}:
            return right
        (issue,) = right.issues
        (file,) = (file for file in files if file.name == issue.file)
        line = file.read_text(encoding="utf-8").splitlines()[(issue.line or 1) - 1]
        return accepted() if at in line else right

    return answer


@answers("EU-INR-007")
def distances_of_links_may_overflow(right: Answer, description: Path, urdf: Path) -> Answer:
    """The coordinates of a link are finite, and its distance is not checked."""
    return _not_checked("derived-not-finite", "<link")(right, description, urdf)


@answers("EU-INR-007", versions=("2",))
def distances_of_frames_may_overflow(right: Answer, description: Path, urdf: Path) -> Answer:
    """The coordinates of an added frame are finite, and its distance is not checked."""
    return _not_checked("derived-not-finite", "name: pad")(right, description, urdf)


@answers("EU-INR-007", versions=("2",))
def screws_may_overflow(right: Answer, description: Path, urdf: Path) -> Answer:
    """The limits of a screw that was prismatic are not checked."""
    return _not_checked("derived-not-finite", "pitch: ")(right, description, urdf)


@answers("EU-INR-007", versions=("2",))
def chains_of_mimics_may_overflow(right: Answer, description: Path, urdf: Path) -> Answer:
    """The offset of a mimic joint with respect to the end of its chain is not checked."""
    return _not_checked("derived-not-finite", "<mimic")(right, description, urdf)


@answers("EU-INR-007", versions=("2.1",))
def offsets_of_couplings_may_overflow(right: Answer, description: Path, urdf: Path) -> Answer:
    """The offset of a coupling is not divided by its largest coefficient."""
    return _not_checked("derived-not-finite", "offset: ")(right, description, urdf)
