"""Other numbers of poses, configurations and constraints, as slips: a sign, a unit, a digit, the frame they are in."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import permutations, product
from typing import Any

import numpy as np

from eurdf.advice.quaternions import w_first
from eurdf.advice.slip import AS_THERE, GUESSED, LIKELY, POSSIBLE, RARE, SURE, OpenLoops, Slip, Token, written
from eurdf.advice.spelling import OF_ANGLE, OF_LENGTH, in_unit, negated, other_side, shortest, with_one_slip
from eurdf.advice.stated_pose import Change, Side, meets
from eurdf.format.closure_model import NamedFrame, PoseEntry
from eurdf.mechanism.constraint import Coupling
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.pose import AXES, IDENTITY, ORIGIN, Pose, Vector3

# Nobody writes smaller numbers in mm or degrees.
_LEAST_IN_UNIT = 1.0

# In place of edits: a slip that any error explains is no more than a question.
_NEVER_CERTAIN: Sequence[tuple[Token | None, str]] = ((None, ""),)


@dataclass(frozen=True, slots=True)
class _WrittenPose:
    """A pose that a file states.

    Attributes:
        what: What it is the pose of.
        link: The link in whose frame it is.
        pose: The pose.
        rpy: Its angles as stated, rad; None if it has a quaternion.
        there: Position and angles of the same on the other side of the robot, or None.
        sides: The frames of open closures that move with it.
        xyz: The numbers of its position; empty if they are not written.
        turns: Those of its angles.
        joint: The joint that it places; None for a frame of closures.
    """

    what: str
    link: str
    pose: Pose
    rpy: Vector3 | None
    there: tuple[Vector3, Vector3 | None] | None
    sides: Sequence[Side]
    xyz: Sequence[Token]
    turns: Sequence[Token]
    joint: str | None = None

    def moved(self, loops: OpenLoops, pose: Pose) -> Change:
        """What is otherwise if it is another pose."""
        if self.joint is not None:
            return Change(placements={self.joint: pose})
        anchors = {(index, of): loops.pose.constraints[index].anchors[of] for index, of in self.sides}
        return Change(anchors={side: replace(anchor, pose=pose) for side, anchor in anchors.items()})


def other_poses(loops: OpenLoops) -> Iterator[Slip]:
    """Other poses of the joints of open loops, and of the frames of their closures."""
    signs = _signs(loops)
    for placed in _written_poses(loops):
        expected = None
        if placed.there is not None:
            expected = tuple(s * value + 0.0 for s, value in zip(signs, placed.there[0], strict=True))
        if placed.xyz:
            yield from _other_positions(loops, placed, expected)
        if placed.rpy is not None:
            yield from _other_turns(loops, placed, placed.rpy)


def _other_positions(loops: OpenLoops, placed: _WrittenPose, expected: Sequence[float] | None) -> Iterator[Slip]:
    old, xyz = [token.text for token in placed.xyz], placed.pose.xyz

    def tried(rank: int, texts: Sequence[str], note: str = "") -> Slip:
        x, y, z = map(float, texts)
        if expected is not None:  # a position that is as there is right, and one that becomes so is likely
            was, would_be = (math.dist(each, expected) <= loops.exact for each in (xyz, (x, y, z)))
            rank += AS_THERE * was - would_be
        change = placed.moved(loops, Pose((x, y, z), placed.pose.quaternion, placed.pose.rpy))
        what, edits = f"the position of {placed.what}", zip(placed.xyz, texts, strict=True)
        # Of slips of one rank, that with fewer changes is likelier.
        score = -0.001 * abs(len("".join(texts)) - len("".join(old)))
        return written(rank, change, what, " ".join(texts), " ".join(old), edits, score=score, note=note)

    for unit, factor in OF_LENGTH.items() if max(map(abs, xyz)) >= _LEAST_IN_UNIT else ():
        yield tried(SURE if unit == "mm" else LIKELY, [in_unit(text, factor) for text in old], f" ({unit})")
    for order in permutations(range(3)):
        if (texts := [old[index] for index in order]) != old:
            yield tried(POSSIBLE, texts)
    parent = loops.pose.poses[placed.link]
    if parent != IDENTITY:
        in_link = parent.inverse().act(xyz)
        yield tried(RARE, [shortest(each, 1e-9) for each in in_link], " (a point of the root link)")
    if expected is not None:
        yield tried(LIKELY, [shortest(each, 1e-9) for each in expected])
    for side, k in product(placed.sides, range(3)):
        for step in _steps_along(loops, side, parent.rotate(AXES[k])):
            found = _slip(old[k], xyz[k] + step, OF_LENGTH, loops.exact)
            if found is None and expected is not None and abs(expected[k] - xyz[k] - step) <= loops.exact:
                found = POSSIBLE, shortest(expected[k], 1e-9)
            if found is not None:
                yield tried(found[0], [*old[:k], found[1], *old[k + 1 :]])


def _other_turns(loops: OpenLoops, placed: _WrittenPose, rpy: Vector3) -> Iterator[Slip]:
    options = [(SURE, tuple(map(math.radians, rpy)), " (degrees)")] if any(rpy) else []
    for k in range(3):
        others = {rpy[k] + quarters * math.pi / 2: GUESSED for quarters in (-1, 1, 2)}
        if rpy[k]:
            others |= {-rpy[k]: POSSIBLE, 0.0: LIKELY if abs(rpy[k]) > 2.0 * math.pi else RARE}
        options += [(rank, (*rpy[:k], other, *rpy[k + 1 :]), "") for other, rank in others.items()]
    turned = placed.there and placed.there[1]
    as_there = AS_THERE * (turned is not None and list(map(abs, turned)) == list(map(abs, rpy)))
    old = [token.text for token in placed.turns]
    for rank, angles, note in options:
        texts = [f"{angle + 0.0:.10g}" for angle in angles]
        if old:
            as_written = [{float(text): text for text in (negated(was), was)} for was in old]
            texts = [those.get(angle, text) for those, text, angle in zip(as_written, texts, angles, strict=True)]
        roll, pitch, yaw = map(float, texts)
        change = placed.moved(loops, Pose.from_xyz_rpy(placed.pose.xyz, (roll, pitch, yaw)))
        edits = zip(placed.turns, texts, strict=True) if old else [(None, "")]
        what, shown = f"the orientation of {placed.what}", " ".join(old) or "0 0 0"
        yield written(rank + as_there, change, what, " ".join(texts), shown, edits, note=note)


def _steps_along(loops: OpenLoops, side: Side, axis: Vector3) -> Iterator[float]:
    """By how much a frame of a closure has to move along an axis, m, for the origins to be where they belong."""
    (index, of), pose = side, loops.pose
    gap = np.subtract(pose.frame((index, 1 - of)).xyz, pose.frame(side).xyz)
    along = float(gap @ axis)
    if meets(pose.constraints[index]):
        yield along
        return
    square = along**2 - float(gap @ gap) + getattr(pose.constraints[index], "length", 0.0) ** 2
    if square >= 0.0:
        yield from (along + math.sqrt(square), along - math.sqrt(square))


def _written_poses(loops: OpenLoops) -> Iterator[_WrittenPose]:
    """The poses that the files state of joints of open loops, and of frames of their closures."""
    urdf, description = loops.read.urdf, loops.read.description
    first = {entry.name: entry.merges[0] for entry in description.joints if entry.merges}
    for made, sides in loops.joints.items():
        name = first.get(made, made)
        joint = urdf.joints.get(name)
        if joint is None or loops.pose.joints[made].placement != joint.placement:
            continue
        image = urdf.joints.get(other_side(name) or "")
        origin, turned = (loops.in_urdf(name, "origin", attribute) for attribute in ("xyz", "rpy"))
        yield _WrittenPose(
            f"joint '{name}'",
            joint.parent,
            joint.placement,
            _angles(joint.placement),
            image and (image.placement.xyz, _angles(image.placement)),
            sides,
            _numbers(origin.parts() if origin else ()),
            _numbers(turned.parts() if turned else ()),
            made,
        )
    added = {entry.name: entry for entry in description.frames}
    closures = {entry.name: entry for entry in description.closures}
    stated: dict[Any, tuple[str, PoseEntry, Any, list[Side]]] = {}
    for side in loops.sides:
        index, of = side
        entry, name = loops.entry(index).frames[of], loops.pose.constraints[index].name
        if not isinstance(entry, NamedFrame):
            other = closures.get(other_side(name) or "")
            found = f"frame {'AB'[of]} of closure '{name}'", entry, other and other.frames[of]
        elif (frame := added.get(entry.target)) is not None:
            found = f"frame '{frame.name}'", frame, added.get(other_side(frame.name) or "")
        else:
            continue
        stated.setdefault(found[1].pointer, (*found, []))[3].append(side)
    for what, entry, other, sides in stated.values():
        index, of = sides[0]
        anchor = loops.pose.constraints[index].anchors[of]
        xyz, turns = (_numbers([loops.in_yaml(*entry.pointer, key, k) for k in range(3)]) for key in ("xyz", "rpy"))
        there = other and (other.xyz, other.rpy)
        yield _WrittenPose(what, anchor.body, anchor.pose, entry.rpy, there, sides, xyz, turns)


def _numbers(tokens: Sequence[Token | None]) -> list[Token]:
    """Three numbers, or nothing."""
    found = [token for token in tokens if token is not None and token.is_number]
    return found if len(found) == 3 else []


def _angles(pose: Pose) -> Vector3 | None:
    """Roll, pitch and yaw as they are stated; None of a quaternion."""
    return pose.rpy or (ORIGIN if pose.quaternion[3] == 1.0 else None)


def _signs(loops: OpenLoops) -> Sequence[float]:
    """By which most coordinates of the positions of joints on one side are those on the other."""
    joints, votes = loops.read.urdf.joints, [0.5, -0.5, 0.5]
    for name, joint in joints.items():
        if (there := joints.get(other_side(name) or "")) is not None:
            for k, (one, other) in enumerate(zip(joint.placement.xyz, there.placement.xyz, strict=True)):
                if one and abs(abs(one) - abs(other)) <= loops.exact:
                    votes[k] += math.copysign(1.0, one * other)
    return [math.copysign(1.0, vote) for vote in votes]


def other_coordinates(loops: OpenLoops) -> Iterator[Slip]:
    """Other coordinates of joints of open loops in the configuration, or other axes of these joints."""
    name, mechanism = loops.configuration, loops.pose.mechanism
    if name is None:
        return
    stated = mechanism.configurations[name]
    every = w_first(mechanism, stated)
    # The root joint, which is no joint of the mechanism, moves no loop.
    moving = {ball: values for ball, values in every.items() if ball in loops.pose.joints}
    alone = [{ball: values} for ball, values in moving.items() if len(every) > 1]
    for turned in (every, *alone) if moving else ():
        edits: list[tuple[Token | None, str]] = []
        for ball, values in turned.items():
            tokens = [loops.in_yaml("configurations", name, ball, k) for k in range(len(values) - 4, len(values))]
            edits += [(tokens[k - 1], after.text) for k, after in enumerate(tokens) if after is not None]
        what = f"the quaternion of {' and '.join(map(repr, turned))} in '{name}'"
        change = Change(coordinates={ball: values for ball, values in turned.items() if ball in moving})
        yield written(SURE, change, what, "x, y, z, w", "w, x, y, z", edits)
    for joint in (loops.pose.joints[each] for each in loops.joints):
        if len(joint.type.coordinates) != 1 or joint.name not in loops.pose.coordinates:
            continue
        value = loops.pose.coordinates[joint.name][0]
        axis = loops.in_urdf(joint.name, "axis", "xyz") if joint.name in loops.read.urdf.joints else None
        if value and axis is not None and joint.mimic is None and (old := _numbers(axis.parts())):
            new = [negated(token.text) if float(token.text) else token.text for token in old]
            change, what = _turned(loops, joint.name, -value), f"the axis of joint '{joint.name}'"
            yield written(POSSIBLE, change, what, " ".join(new), axis.text, zip(old, new, strict=True), score=-0.1)
            words = [token.text for token in old]
            for texts in sorted({*permutations(words)} - {tuple(words)}):
                x, y, z = map(float, texts)
                other_axis = replace(joint, axes=((x, y, z),)).transform((value,))
                placement = joint.placement * other_axis * joint.transform((value,)).inverse()
                change = Change(placements={joint.name: placement})
                yield written(POSSIBLE, change, what, " ".join(texts), axis.text, zip(old, texts, strict=True))
        token = loops.in_yaml("configurations", name, joint.name)
        if token is None or not token.is_number:
            continue
        units = OF_LENGTH if joint.type.slides else OF_ANGLE
        closing = [-value, *(float(in_unit(token.text, factor)) for factor in units.values())]
        for other in (*closing, *(value + step for step in _turns_of(loops, joint))):
            rank, text = _slip(token.text, other, units, loops.exact) or (GUESSED, shortest(other, loops.exact / 10.0))
            change, what = _turned(loops, joint.name, float(text)), f"joint '{joint.name}' in configuration '{name}'"
            yield written(rank, change, what, text, token.text, [(token, text)])


def _turned(loops: OpenLoops, joint: str, value: float) -> Change:
    """The change of a coordinate, and of those that follow it."""
    leaders = loops.pose.mechanism.leaders
    followers = {name: each for name, each in leaders.items() if each.joint == joint}
    values = {name: (each.multiplier * value + each.offset,) for name, each in followers.items()}
    return Change(coordinates={joint: (value,), **values})


def _turns_of(loops: OpenLoops, joint: Joint) -> Iterator[float]:
    """By how much the coordinate of a joint has to change for the frames of a closure to be where they belong."""
    frame = loops.pose.poses[joint.parent] * joint.placement
    motion = joint.motions[0]
    axis = np.array(frame.rotate(motion.axis or AXES[0]))
    for index, of in loops.joints[joint.name]:
        if meets(loops.pose.constraints[index]):
            mine, other = (np.subtract(loops.pose.frame((index, each)).xyz, frame.xyz) for each in (of, 1 - of))
            if motion.turns:
                across = float(mine @ other - (axis @ mine) * (axis @ other))
                yield math.atan2(float(axis @ np.cross(mine, other)), across)
            else:
                yield float(axis @ (other - mine))


def other_constraints(loops: OpenLoops) -> Iterator[Slip]:
    """Other numbers of the closures that are open, such as the length of a rod, or another type."""
    for index in loops.indices:
        closure: Any = loops.pose.constraints[index]
        if not closure.anchors:
            yield from _of_coupling(loops, index, closure)
            continue
        pointer, numbers, freer = loops.entry(index).pointer, closure.stated(), closure.with_orientation_free()
        if freer is not closure:
            what, change = f"the type of closure '{closure.name}'", Change(constraints={index: freer})
            yield written(
                RARE, change, what, freer.type, closure.type, _NEVER_CERTAIN
            )  # it closes whatever the angles are
        for key, sign in product((key for key, value in numbers.items() if isinstance(value, float)), (1.0, -1.0)):
            token = loops.in_yaml(*pointer, key)
            other = numbers[key] + sign * loops.pose.opening(index)
            if token is not None and token.is_number and other > 0.0:
                likely = _slip(token.text, other, OF_LENGTH, loops.exact)
                rank, text = likely or (GUESSED, shortest(other, loops.exact / 10.0))
                change = Change(constraints={index: replace(closure, **{key: float(text)})})
                what = f"'{key}' of closure '{closure.name}'"
                yield written(rank, change, what, text, token.text, [(token, text)])


def _of_coupling(loops: OpenLoops, index: int, coupling: Coupling) -> Iterator[Slip]:
    """Another offset, coefficient or coordinate with which a coupling is met."""
    pointer = next(entry.pointer for entry in loops.read.description.couplings if entry.name == coupling.name)
    at = {name: loops.pose.coordinates[name][0] for name in coupling.joints}
    gap = sum(c * at[name] for name, c in coupling.coefficients) - coupling.offset
    other = replace(coupling, offset=coupling.offset + gap)
    found = [
        ((*pointer, "offset"), other.offset, Change(constraints={index: other}), f"the offset of '{coupling.name}'")
    ]
    for name, c in coupling.coefficients:
        if at[name]:
            factors = tuple((each, c - gap / at[name] if each == name else of) for each, of in coupling.coefficients)
            change = Change(constraints={index: replace(coupling, coefficients=factors)})
            what = f"the coefficient of '{name}' in '{coupling.name}'"
            found.append(((*pointer, "joints", name), c - gap / at[name], change, what))
        if loops.configuration is not None:
            change, value = _turned(loops, name, at[name] - gap / c), at[name] - gap / c
            what = f"joint '{name}' in configuration '{loops.configuration}'"
            found.append((("configurations", loops.configuration, name), value, change, what))
    for place, value, change, what in found:
        token = loops.in_yaml(*place)
        if token is not None and token.is_number:
            likely = _slip(token.text, value, OF_ANGLE, loops.exact)
            rank, text = likely or (GUESSED, shortest(value, loops.exact / 10.0))
            yield written(rank, change, what, text, token.text, [(token, text)])


def _slip(token: str, value: float, units: Mapping[str, Decimal], exact: float) -> tuple[int, str] | None:
    """How likely a slip a number is in place of what closes the loops, and the latter; None if it is none."""
    number = float(token)
    if number and abs(number + value) <= exact:
        return POSSIBLE, negated(token)
    if not number:
        return GUESSED, shortest(value, exact / 2.0)
    for factor in units.values() if abs(number) >= _LEAST_IN_UNIT else ():
        if abs(float(in_unit(token, factor)) - value) <= exact:
            return SURE, in_unit(token, factor)
    text = with_one_slip(token, value, exact)
    return None if text is None else (RARE, text)
