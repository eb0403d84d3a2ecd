"""Whether `eurdf assemble` closes open loops and keeps what the configuration states."""

from __future__ import annotations

from eurdf.advice.spelling import common_start
from eurdf.advice.stated_pose import StatedPose
from eurdf.array import Vector
from eurdf.closures import CLOSED
from eurdf.diagnostics import Fix, quoted
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.holding import held_in_turn
from eurdf.linking.robot_files import ReadRobot
from eurdf.pinocchio.robot import Robot
from eurdf.writing.saved_configuration import NAME, with_closed_configuration
from eurdf.writing.yaml_edits import NotEditable

# A closed configuration is near one that is stated if no coordinate differs by more, rad or m.
_NEAR = {"angle": 0.02, "length": 1e-3, "x": 1e-3, "y": 1e-3, "z": 1e-3}
_NEAR_QUATERNION = 0.01

_COMMAND = "`eurdf assemble --write --force`"


def closed_as_stated(
    read: ReadRobot, robot: Robot, pose: StatedPose, q: Vector, summary: str | None = None
) -> list[Fix]:
    """The closed configuration that `eurdf assemble` finds from the open one, if it keeps what the file states.

    All that is stated is held, or else what is actuated of it, or else nothing; what is not held stays near. If joints
    of the open loops are stated away from 0, one that is not may move far, and all if only motors are stated. What
    moves a little where nothing is rounded may hide an error in a length: it is no more than a question.

    Args:
        read: The robot as read, with a configuration ``assembled``.
        robot: The robot.
        pose: It at this configuration.
        q: The same (nq,).
        summary: What the fix does, with ``{}`` for the command.
    """
    stated = read.mechanism.configurations[NAME]
    open_ = [index for index, each in enumerate(pose.constraints) if each.anchors and not pose.opening(index) <= CLOSED]
    in_loops = {name for index in open_ for names in pose.between(index) for name in names} & set(stated)
    only_motors = in_loops <= set(robot.actuation.joints)
    is_away = any(abs(value) > CLOSED for name in in_loops for value in stated[name][:3])
    for held in held_in_turn(robot, stated):
        found = assemble(robot, q, hold=held, restarts=0)
        moved = _moved(robot, q, found.q)
        few = not moved or (is_away and (only_motors or len(moved) == 1))
        if not found.closes or moved & set(stated) or not few:
            continue
        try:
            text, diagnostics = with_closed_configuration(read, robot, found.q)
        except NotEditable:
            return []
        if diagnostics.errors:
            return []
        kept = f" with {quoted(sorted(in_loops))} as stated" if in_loops else ""
        missing = sorted(_moved(robot, q, found.q, CLOSED) - set(stated))
        what = summary or f"state {quoted(missing)} too, as {{}} does: the loops then close{kept}"
        source = read.description.document.source
        start = common_start(source.text, text)
        end = common_start(source.text[:start:-1], text[:start:-1])
        edit = source.edit(start, len(source.text) - end, text[start : len(text) - end])
        forgotten = moved or summary
        question = f"{_COMMAND} closes the loops{kept}: are the coordinates approximate?"
        return [Fix(what.format(_COMMAND), (edit,) if forgotten else (), question)]
    return []


def _moved(robot: Robot, q: Vector, to: Vector, share: float = 1.0) -> set[str]:
    """The joints that are not near where they were, to a share of what counts as near."""
    before, after = robot.joint_positions(q), robot.joint_positions(to)
    return {
        name
        for name, values in before.items()
        if any(
            not abs(one - other) <= share * _NEAR.get(coordinate, _NEAR_QUATERNION)
            for coordinate, one, other in zip(_coordinates(robot, name), values, after[name], strict=True)
        )
    }


def _coordinates(robot: Robot, name: str) -> tuple[str, ...]:
    slot = robot.slots.get(name)
    return slot.joint.type.coordinates if slot else ("x", "y", "z", "qx", "qy", "qz", "qw")
