"""`eurdf.check`: everything that can be found wrong with a robot."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from eurdf.advice.angles import advise_on_angles
from eurdf.advice.lengths import advise_on_lengths
from eurdf.advice.mimics import advise_on_mimics
from eurdf.advice.quaternions import advise_on_quaternions, closes_w_first
from eurdf.description import Description, describe, find_meshes
from eurdf.diagnostics import Diagnostics
from eurdf.diagnostics.report import Report
from eurdf.reading.given import Given

if TYPE_CHECKING:
    from eurdf.kinematics.assembly import Assembly
    from eurdf.kinematics.residual import Opening
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot

#: Loops that are open by no more than this, in rad and of the length of the longest loop, may be so because numbers in
#: the files were rounded to four or five digits.
ROUNDED = 1e-4


def check(
    path: Given,
    urdf: Given | None = None,
    *,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> Report:
    """Check a robot: EU-DIA-001, EU-DIA-003, each fault is told that no error hides.

    Beside what breaks a clause it gives advice (EU-DIA-006): warnings without a clause, whose codes begin with ``x-``.

    Args:
        path: A folder, a YAML file, a bare URDF or xacro, the name of a robot of the collection, ``-`` for standard
            input, a pipe, or a text: one that begins with ``<`` is a URDF, any other a description.
        urdf: A URDF in place of the one that the description names: a file, ``-``, a pipe or a text.
        package_dirs: Folders to look for the packages of meshes in, before ``ROS_PACKAGE_PATH`` and
            ``AMENT_PREFIX_PATH``.
        xacro_args: Values of the arguments of a xacro.

    Returns:
        The findings of all phases, in the order of the phases.

    Raises:
        RobotNotFound: Where there are no such files.
        CannotExpand: A xacro has an error, or `xacro_args` are given for what is no xacro.
        MissingExtra: A xacro is given, and the extra ``xacro`` is not installed.
    """
    description = describe(path, urdf, package_dirs=package_dirs, xacro_args=xacro_args)
    diagnostics = description.diagnostics
    meshes: dict[str, str] = {}
    if description.urdf is not None:
        meshes, missing = find_meshes(description, package_dirs)
        for found in missing:
            diagnostics.add(found)
    mechanism = description.mechanism
    if mechanism is not None and not diagnostics.refused:
        if mechanism.closures:
            _check_loops(description, mechanism)
        else:
            advise_on_quaternions(description, None, diagnostics)
        advise_on_mimics(description, diagnostics)
        advise_on_angles(description, diagnostics)
        advise_on_lengths(description, meshes, diagnostics)
    return Report(description.path, tuple(diagnostics))


def _check_loops(description: Description, mechanism: Mechanism) -> None:
    """Report what needs a simulator: whether the loops close and, where there is no error, advice on how they move."""
    # Only now: a description without closures is checked without a simulator.
    from eurdf.advice.actuation import advise_on_actuation
    from eurdf.advice.limits import advise_on_limits
    from eurdf.advice.massless import advise_on_massless_links
    from eurdf.kinematics.assembly import assemble
    from eurdf.pinocchio.robot import build_robot

    diagnostics = description.diagnostics
    robot = build_robot(mechanism, geometry=False)
    assembly = None if "assembled" in robot.configurations else assemble(robot)
    for found in closure_diagnostics(description, robot, assembly):
        diagnostics.add(found)
    given_up = assembly is not None and assembly.reason == "given up"
    if not given_up and not diagnostics.error_count:
        q = robot.configurations["assembled"] if assembly is None else assembly.q
        advise_on_quaternions(description, robot, diagnostics)
        advise_on_massless_links(description, robot, q, diagnostics)
        advise_on_actuation(description, robot, q, diagnostics)
        advise_on_limits(description, robot, q, diagnostics)


def closure_diagnostics(
    description: Description, robot: Robot | None = None, assembly: Assembly | None = None
) -> Diagnostics:
    """EU-CLO-005, EU-CLO-006: the loops close, at the assembled configuration where there is one.

    Args:
        description: The robot as read, with a mechanism.
        robot: The robot built from it, where there already is one.
        assembly: What `assemble` found of it, where it was asked already.
    """
    diagnostics = Diagnostics()
    mechanism = description.mechanism
    if mechanism is None or not mechanism.closures:
        return diagnostics
    # Only now: a description without closures is checked without a simulator.
    from eurdf.kinematics.assembly import assemble
    from eurdf.pinocchio.robot import build_robot

    if robot is None:
        robot = build_robot(mechanism, geometry=False)
    if "assembled" in mechanism.configurations:
        return assembled_diagnostics(description, robot)
    assembly = assemble(robot) if assembly is None else assembly
    if not assembly.closes:
        worst = max(assembly.open, key=_width)
        closure = next(closure for closure in mechanism.closures if closure.name == worst.name)
        if assembly.reason == "given up":
            diagnostics.report(
                "x-loops-not-checked",
                "whether the loops can be closed was not computed: too many closures share their joints",
                description.place_of_closure(closure),
                "state a configuration 'assembled' (version 2): the loops are checked at it",
            )
            return diagnostics
        diagnostics.report(
            "closure-cannot-close",
            f"no configuration was found that closes the loops; at the best, {_told(assembly.open)}",
            description.place_of_closure(closure),
            f"{_closed_to(assembly.open)}: write the numbers of the files with more digits"
            if _is_rounding(robot, assembly.open)
            else "check where its frames are, and that enough joints can move",
        )
    return diagnostics


def assembled_diagnostics(description: Description, robot: Robot) -> Diagnostics:
    """EU-CLO-005: at ``assembled`` every closure is closed."""
    from eurdf.kinematics.residual import closure_openings

    diagnostics = Diagnostics()
    openings = closure_openings(robot, robot.configurations["assembled"])
    if any(opening.is_open for opening in openings):
        diagnostics.report(
            "assembled-open",
            f"the loops are open at the assembled configuration: {_told(openings)}",
            description.place_of_configuration("assembled"),
            _hint_for_assembled(robot, openings),
        )
    return diagnostics


def _hint_for_assembled(robot: Robot, openings: Sequence[Opening]) -> str:
    if closes_w_first(robot, "assembled"):
        return "they close where its quaternions are read w first: the order is x, y, z, w"
    if not _is_rounding(robot, openings):
        return "`eurdf assemble --write --force` writes a configuration that closes them, if it finds one"
    from eurdf.kinematics.assembly import assemble

    least = assemble(robot)
    if least.closes:
        return f"{_closed_to(openings)}: write more digits, as `eurdf assemble --write --force` does"
    return f"{_closed_to(least.open)} at best: write the numbers of the URDF with more digits"


def _is_rounding(robot: Robot, openings: Iterable[Opening]) -> bool:
    """Whether closures are open by no more than numbers that were rounded explain."""
    from eurdf.kinematics.scale import characteristic_length

    length = characteristic_length(robot)
    return all(opening.position <= ROUNDED * length and opening.angle <= ROUNDED for opening in openings)


def _closed_to(openings: Iterable[Opening]) -> str:
    """How far the loops are closed, in the unit of the widest opening."""
    widest = max(openings, key=_width)
    return f"they are closed to {_width(widest):.0e} {'m' if widest.position >= widest.angle else 'rad'}"


def _told(openings: Iterable[Opening]) -> str:
    """The open ones, widest first, a few at most."""
    wide = sorted((found for found in openings if found.is_open), key=_width, reverse=True)
    return "; ".join(map(str, wide[:4])) + (f"; and {len(wide) - 4} more" if len(wide) > 4 else "")


def _width(opening: Opening) -> float:
    return max(opening.position, opening.angle)
