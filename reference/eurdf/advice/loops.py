"""Whether the loops of a robot close."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from eurdf.advice.quaternions import closes_w_first
from eurdf.diagnostics import Diagnostics
from eurdf.kinematics.opening import Opening, widest
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism

if TYPE_CHECKING:
    from eurdf.kinematics.assembly import Assembly
    from eurdf.pinocchio.robot import Robot

#: Loops that are open by no more than this, in rad and of the length of the longest loop, may be so because numbers in
#: the files were rounded to four or five digits.
ROUNDED = 1e-4


def closure_diagnostics(read: ReadRobot, robot: Robot, assembly: Assembly | None = None) -> Diagnostics:
    """EU-CLO-005, EU-CLO-006: the loops close, at the assembled configuration where there is one.

    EU-CLO-016: `assemble` starts at neutral, and searches longer than the least search of the specification.
    """
    diagnostics = Diagnostics()
    mechanism = read.mechanism
    if read.yaml is None or not mechanism.constraints:
        return diagnostics
    if "assembled" in mechanism.configurations:
        from eurdf.kinematics.residual import openings_once

        openings = openings_once(robot, robot.configurations["assembled"])
        if any(opening.is_open for opening in openings):
            diagnostics.report(
                "assembled-open",
                f"the loops are open at the assembled configuration: {widest(openings)}",
                read.place_of_configuration("assembled"),
                _hint_for_assembled(robot, openings),
            )
        return diagnostics
    from eurdf.kinematics.assembly import assemble

    assembly = assemble(robot) if assembly is None else assembly
    if not assembly.closes:
        worst = max(assembly.open, key=lambda each: each.width)
        if assembly.reason == "not decided":
            diagnostics.report(
                "x-loops-not-checked",
                "could not determine whether the loops close: the search reached its limit of 1e10 multiplications",
                read.place_of_constraint(worst.name),
                "state a configuration 'assembled' (version 2): then the loops are checked there",
            )
            return diagnostics
        diagnostics.report(
            "closure-cannot-close",
            f"no configuration was found that closes the loops; least open: {widest(assembly.open)}",
            read.place_of_constraint(worst.name),
            f"{_closed_to(assembly.open)}: write the numbers of the files with more digits"
            if _is_rounding(robot, assembly.open)
            else _hint_for_open(mechanism, worst.name),
        )
    return diagnostics


def _hint_for_open(mechanism: Mechanism, name: str) -> str:
    if any(coupling.name == name for coupling in mechanism.couplings):
        return "check the coefficients and offsets of the couplings, and that enough joints can move"
    return "check where the frames of the closure are, and that enough joints can move"


def _hint_for_assembled(robot: Robot, openings: Sequence[Opening]) -> str:
    if closes_w_first(robot, "assembled"):
        return "the loops close if its quaternions are read as w, x, y, z: the order is x, y, z, w"
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
    """How far the loops stay open, in the unit of the widest opening."""
    most = max(openings, key=lambda each: each.width)
    return f"the loops stay open by {most.width:.0e} {'m' if most.position >= most.angle else 'rad'}"
