"""`eurdf.check`: everything that can be found wrong with a robot."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from eurdf.description import Description, describe, find_meshes
from eurdf.diagnostics import Diagnostics
from eurdf.diagnostics.report import Report

if TYPE_CHECKING:
    from eurdf.kinematics.assembly import Assembly
    from eurdf.kinematics.residual import Opening
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot


def check(path: str | os.PathLike[str], urdf: str | os.PathLike[str] | None = None) -> Report:
    """Check a robot: EU-DIA-001, EU-DIA-003, each fault is told that no error hides.

    Args:
        path: A folder, a YAML file, a bare URDF, or the name of a robot of the collection.
        urdf: A URDF in place of the one that the description names.

    Returns:
        The findings of all phases, in the order of the phases.

    Raises:
        RobotNotFound: Where there are no such files.
    """
    description = describe(path, urdf)
    diagnostics = description.diagnostics
    if description.urdf is not None:
        for found in find_meshes(description)[1]:
            diagnostics.add(found)
    mechanism = description.mechanism
    if mechanism is not None and mechanism.closures and not diagnostics.refused:
        for found in _loop_diagnostics(description, mechanism):
            diagnostics.add(found)
    return Report(description.path, tuple(diagnostics))


def _loop_diagnostics(description: Description, mechanism: Mechanism) -> Diagnostics:
    """What needs a simulator: whether the loops close and, where there is no error, advice on how they move."""
    # Only now: a description without closures is checked without a simulator.
    from eurdf.advice.actuation import advise_on_actuation
    from eurdf.advice.limits import advise_on_limits
    from eurdf.kinematics.assembly import assemble
    from eurdf.pinocchio.robot import build_robot

    robot = build_robot(mechanism, geometry=False)
    assembly = None if "assembled" in robot.configurations else assemble(robot)
    diagnostics = closure_diagnostics(description, robot, assembly)
    if not description.diagnostics.error_count + diagnostics.error_count:
        q = robot.configurations["assembled"] if assembly is None else assembly.q
        advise_on_actuation(description, robot, q, diagnostics)
        advise_on_limits(description, robot, q, diagnostics)
    return diagnostics


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
        diagnostics.report(
            "closure-cannot-close",
            f"no configuration was found that closes the loops; at the best, {_told(assembly.open)}",
            description.place_of_closure(closure),
            "check where its frames are, and that enough joints can move",
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
            "`eurdf assemble` finds a configuration that closes them; --write states it",
        )
    return diagnostics


def _told(openings: Iterable[Opening]) -> str:
    """The open ones, widest first, a few at most."""
    wide = sorted((found for found in openings if found.is_open), key=_width, reverse=True)
    return "; ".join(map(str, wide[:4])) + (f"; and {len(wide) - 4} more" if len(wide) > 4 else "")


def _width(opening: Opening) -> float:
    return max(opening.position, opening.angle)
