"""Whether the loops of a robot close."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eurdf.closures import CLOSED
from eurdf.diagnostics import Diagnostics, Fix
from eurdf.kinematics.opening import Opening, widest
from eurdf.linking.robot_files import ReadRobot

if TYPE_CHECKING:
    from eurdf.advice.stated_pose import StatedPose
    from eurdf.array import Vector
    from eurdf.kinematics.assembly import Assembly
    from eurdf.pinocchio.robot import Robot

#: Loops that are open by no more than this, in rad and of the length of the longest loop, may be so because numbers in
#: the files were rounded to four or five digits.
ROUNDED = 1e-4

_ASSEMBLED = "assembled"

# Open closures whose frames others may fit better by name.
_MOST_NAMED = 8


def closure_diagnostics(read: ReadRobot, robot: Robot, assembly: Assembly | None = None) -> Diagnostics:
    """EU-CLO-005, EU-CLO-006: the loops close, at the assembled configuration where there is one.

    EU-CLO-016: `assemble` starts at neutral, and searches longer than the least search of the specification.
    """
    diagnostics = Diagnostics()
    mechanism = read.mechanism
    if read.yaml is None or not mechanism.constraints:
        return diagnostics
    from eurdf.kinematics.residual import openings_once

    stated = robot.configurations.get(_ASSEMBLED)
    if stated is not None:
        openings = openings_once(robot, stated)
        if any(opening.is_open for opening in openings):
            _report_assembled(read, robot, stated, openings, diagnostics)
        return diagnostics
    from eurdf.kinematics.assembly import assemble

    assembly = assemble(robot) if assembly is None else assembly
    if assembly.closes:
        return diagnostics
    worst = max(assembly.open, key=lambda each: each.width)
    if assembly.reason == "not decided":
        diagnostics.report(
            "x-loops-not-checked",
            "could not determine whether the loops close: the search reached its limit of 1e10 multiplications",
            read.place_of_constraint(worst.name),
            "state a configuration 'assembled' (version 2): then the loops are checked there",
        )
        return diagnostics
    pose = _pose(robot, robot.configuration({}))
    hint: str | None
    fixes: Sequence[Fix] = ()
    if _is_rounding(robot, assembly.open):
        hint = f"{_closed_to(assembly.open)}: write the numbers of the files with more digits"
    else:
        from eurdf.advice.likely_joints import missing_types
        from eurdf.advice.open_loops import suggested_by_names

        causes = _causes(read, robot, pose, None)[0]
        # Neutral need not be where the loops are to close.
        widest_open = sorted(assembly.open, key=lambda each: -each.width)[:_MOST_NAMED]
        causes += suggested_by_names(read, pose, {each.name for each in widest_open})
        hint, fixes = _asked(read, worst.name, causes)
        fixes = [*fixes, *missing_types(read, robot)]
    diagnostics.report(
        "closure-cannot-close",
        f"no configuration was found that closes the loops; least open: {widest(assembly.open)}{_unmoved(pose)}",
        read.place_of_constraint(worst.name),
        hint,
        fixes,
    )
    return diagnostics


def _report_assembled(
    read: ReadRobot, robot: Robot, q: Vector, openings: Sequence[Opening], diagnostics: Diagnostics
) -> None:
    """Report that loops are open at the assembled configuration, and why."""
    from eurdf.advice.stated_configuration import closed_as_stated
    from eurdf.kinematics.assembly import assemble

    pose, unmoved = _pose(robot, q), ""
    hint: str | None
    if _is_rounding(robot, openings):
        more = f"{_closed_to(openings)}: write more digits, as {{}} does"
        fixes, least = closed_as_stated(read, robot, pose, q, more), assemble(robot)
        hint = more.format("`eurdf assemble --write --force`")
        if not least.closes:
            hint = f"{_closed_to(least.open)} at best: write the numbers of the URDF with more digits"
    else:
        unmoved = _unmoved(pose)
        causes, doubtful = _causes(read, robot, pose, _ASSEMBLED)
        if not unmoved and not any(fix.edits for fix in causes):
            found = closed_as_stated(read, robot, pose, q)
            asked = [replace(fix, edits=()) for fix in found]
            causes = [*causes[:1], *asked, *causes[1:]] if doubtful else [*found, *causes]
        hint, fixes = _asked(read, max(openings, key=lambda each: each.width).name, causes)
    diagnostics.report(
        "assembled-open",
        f"the loops are open at the assembled configuration: {widest(openings)}{unmoved}",
        read.place_of_configuration(_ASSEMBLED),
        hint,
        fixes,
    )


def advise_on_neutral(read: ReadRobot, robot: Robot, diagnostics: Diagnostics) -> bool:
    """Report loops that close far from neutral, and exactly there after one slip, where no 'assembled' is stated."""
    from eurdf.advice.open_loops import causes_of_open_loops, proposed
    from eurdf.kinematics.residual import openings_once

    neutral = robot.configuration({})
    openings = openings_once(robot, neutral)
    count = sum(each.is_open for each in openings)
    # Where no loop is closed, neutral need not be a configuration that anybody looked at.
    all_open = count == len(openings)
    if count < 1 + all_open or _is_rounding(robot, openings):
        return False
    pose = _pose(robot, neutral)
    causes = causes_of_open_loops(read, pose, None, only_exchanged=all_open)
    found = [fix for fix in proposed(causes, count) if fix.edits]
    if found:
        worst = max(range(len(robot.constraints)), key=pose.opening)
        diagnostics.report(
            "x-open-at-neutral",
            "the loops are open where all joints are at 0, and close exactly there with one change",
            read.place_of_constraint(robot.constraints[worst].name),
            found[0].question,
        )
    return bool(found)


def _pose(robot: Robot, q: Vector) -> StatedPose:
    from eurdf.advice.stated_pose import StatedPose

    return StatedPose(robot.mechanism, robot.joint_positions(q, mimic=True))


def _causes(read: ReadRobot, robot: Robot, pose: StatedPose, configuration: str | None) -> tuple[list[Fix], bool]:
    """Slips without which the loops close exactly; or else about, which is no more than a question.

    And whether there may be a slip: to guess a parent or a frame is always possible where one joint should be at 0.
    """
    from eurdf.advice.open_loops import causes_of_open_loops, proposed
    from eurdf.advice.slip import GUESSED
    from eurdf.kinematics.scale import characteristic_length

    loops = sum(not pose.opening(index) <= CLOSED for index in range(len(pose.constraints)))
    if causes := causes_of_open_loops(read, pose, configuration):
        return proposed(causes, loops), any(each.rank < GUESSED or each.change.placements for each in causes)
    about = causes_of_open_loops(read, pose, configuration, ROUNDED * min(1.0, characteristic_length(robot)))
    return [replace(fix, edits=()) for fix in proposed(about, loops)], False


def _unmoved(pose: StatedPose) -> str:
    """For a message: a gap that no joint changes."""
    for index, constraint in enumerate(pose.constraints):
        gap = None if pose.opening(index) <= CLOSED else pose.unmoved(index)
        length = 0.0 if gap is None else float(gap @ gap) ** 0.5
        if gap is not None and length > ROUNDED:
            along = (gap / length).round(6)
            along *= 1.0 if along[along.nonzero()][0] > 0.0 else -1.0
            axis = " ".join(f"{value + 0.0:.3g}" for value in along)
            shown = Opening(constraint.name, length, 0.0)
            return f"; {shown} along [{axis}] of the root link, in which no joint moves it: no configuration closes it"
    return ""


def _asked(read: ReadRobot, name: str, causes: Sequence[Fix]) -> tuple[str | None, list[Fix]]:
    """The causes to try, and the hint that asks about the others, or about the constraint of a name if there are none.

    Without a hint, those that were tried are asked about.
    """
    certain = [fix for fix in causes if fix.edits]
    if asked := [fix.question for fix in causes if fix.question and not fix.edits]:
        return " ".join(asked[:2]), certain
    if any(fix.question for fix in certain):
        return None, certain
    if any(coupling.name == name for coupling in read.mechanism.couplings):
        return "are the coefficients and offsets of the couplings right, and can enough joints move?", certain
    stated = f", and does '{_ASSEMBLED}' state all joints" if _ASSEMBLED in read.mechanism.configurations else ""
    return f"are the frames of closure '{name}' where they belong, can enough joints move{stated}?", certain


def _is_rounding(robot: Robot, openings: Iterable[Opening]) -> bool:
    """Whether closures are open by no more than numbers that were rounded explain."""
    from eurdf.kinematics.scale import characteristic_length

    length = characteristic_length(robot)
    return all(opening.position <= ROUNDED * length and opening.angle <= ROUNDED for opening in openings)


def _closed_to(openings: Iterable[Opening]) -> str:
    """How far the loops stay open, in the unit of the widest opening."""
    most = max(openings, key=lambda each: each.width)
    return f"the loops stay open by {most.width:.0e} {'m' if most.position >= most.angle else 'rad'}"
