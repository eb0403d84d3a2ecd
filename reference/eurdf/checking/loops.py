"""Whether the loops of a robot close."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from eurdf.checking.advice.quaternions import closes_w_first
from eurdf.diagnostics import Diagnostics
from eurdf.linking.description import Described, Linked

if TYPE_CHECKING:
    from eurdf.kinematics.assembly import Assembly
    from eurdf.kinematics.opening import Opening
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot

#: Loops that are open by no more than this, in rad and of the length of the longest loop, may be so because numbers in
#: the files were rounded to four or five digits.
ROUNDED = 1e-4


def closure_diagnostics(description: Linked, robot: Robot, assembly: Assembly | None = None) -> Diagnostics:
    """EU-CLO-005, EU-CLO-006: the loops close, at the assembled configuration where there is one.

    EU-CLO-016: `assemble` starts at neutral, and searches longer than the least search of the specification.

    Args:
        description: The robot as read, with a mechanism.
        robot: The robot built from it, where there already is one.
        assembly: The result of `assemble`, if it was called already.
    """
    diagnostics = Diagnostics()
    mechanism = description.mechanism
    if not isinstance(description, Described) or not mechanism.constraints:
        return diagnostics
    if "assembled" in mechanism.configurations:
        return assembled_diagnostics(description, robot)
    from eurdf.kinematics.assembly import assemble

    assembly = assemble(robot) if assembly is None else assembly
    if not assembly.closes:
        worst = max(assembly.open, key=_width)
        if assembly.reason == "not decided":
            diagnostics.report(
                "x-loops-not-checked",
                "it is not decided whether the loops close: the search reached its limit of 1e10 multiplications",
                description.place_of_constraint(worst.name),
                "state a configuration 'assembled' (version 2): then the loops are checked there",
            )
            return diagnostics
        diagnostics.report(
            "closure-cannot-close",
            f"no configuration was found that closes the loops; least open: {_told(assembly.open)}",
            description.place_of_constraint(worst.name),
            f"{_closed_to(assembly.open)}: write the numbers of the files with more digits"
            if _is_rounding(robot, assembly.open)
            else _hint_for_open(mechanism, worst.name),
        )
    return diagnostics


def _hint_for_open(mechanism: Mechanism, name: str) -> str:
    if any(coupling.name == name for coupling in mechanism.couplings):
        return "check the coefficients and offsets of the couplings, and that enough joints can move"
    return "check where the frames of the closure are, and that enough joints can move"


def assembled_diagnostics(description: Described, robot: Robot) -> Diagnostics:
    """EU-CLO-005: at ``assembled`` every closure is closed."""
    from eurdf.kinematics.residual import openings_once

    diagnostics = Diagnostics()
    openings = openings_once(robot, robot.configurations["assembled"])
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
    widest = max(openings, key=_width)
    return f"the loops stay open by {_width(widest):.0e} {'m' if widest.position >= widest.angle else 'rad'}"


def _told(openings: Iterable[Opening]) -> str:
    """The open ones, widest first, a few at most."""
    wide = sorted((found for found in openings if found.is_open), key=_width, reverse=True)
    return "; ".join(map(str, wide[:4])) + (f"; and {len(wide) - 4} more" if len(wide) > 4 else "")


def _width(opening: Opening) -> float:
    return max(opening.position, opening.angle)
