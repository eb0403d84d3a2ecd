"""Causes of open loops: the single slips without which they close exactly at the stated configuration.

That a change as small as a slip closes loops to `EXACT` is hardly a coincidence. Symmetric and parallel linkages have
several such changes; names, and the other side of the robot, decide between them, or else the user does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from difflib import SequenceMatcher
from itertools import combinations, compress, product

import numpy as np

from eurdf.advice.other_numbers import other_constraints, other_coordinates, other_poses
from eurdf.advice.slip import AS_THERE, EXACT, GUESSED, LIKELY, SURE, OpenLoops, Slip, exchanged, written
from eurdf.advice.spelling import common_start, other_side, side
from eurdf.advice.stated_pose import Change, Side, StatedPose
from eurdf.closures import CLOSED
from eurdf.diagnostics import Fix
from eurdf.format.closure_model import NamedFrame
from eurdf.format.urdf.data import UrdfJoint
from eurdf.format.yaml_text import scalar
from eurdf.linking.counterparts import changes_between, is_elsewhere, renamed
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.pose import IDENTITY, Pose

# Names of links and joints that are compared with those of frames.
_MOST_NAMES = 500

# By how much names fit better that are worth a trial.
_FITS_BETTER = 0.05

# Joints that poses are walked along: about half a second.
_MOST_STEPS = 60_000


def causes_of_open_loops(
    read: ReadRobot, pose: StatedPose, configuration: str | None, exact: float = EXACT, only_exchanged: bool = False
) -> list[Slip]:
    """The slips without which loops close exactly, and none opens, the likeliest first.

    Args:
        read: The robot as read.
        pose: It at a configuration.
        configuration: The name of that; None for neutral.
        exact: By how much loops are open that close exactly, m or rad.
        only_exchanged: Whether only exchanged frames are looked for.
    """
    loops, steps, found = OpenLoops(read, pose, configuration, exact), 0, []
    for slip in (slip for kind in ((_exchanged_frames,) if only_exchanged else _KINDS) for slip in kind(loops)):
        steps += 5 + sum(len(pose.chain(pose.joints[name].child)) for name in slip.change.joints)
        if closed := pose.closed_by(slip.change, exact, CLOSED):
            found.append(replace(slip, closed=closed))
        if steps > _MOST_STEPS:
            break
    unlike: dict[object, Slip] = {}
    for slip in sorted(found, key=lambda each: each.order):
        unlike.setdefault(slip.fix.edits or slip.question, slip)
    return list(unlike.values())


def proposed(causes: Sequence[Slip], loops: int) -> list[Fix]:
    """The likeliest cause of so many open loops, for `Diagnostics.report`: with edits if there is no doubt.

    There is a second one if it may as well be that.
    """
    if not causes:
        return []
    first, *others = causes
    doubtful = [each for each in others if not first.is_likelier_than(each)]
    if not doubtful and first.closed == loops and first.rank < GUESSED:
        return [first.fix]
    return [replace(each.fix, edits=()) for each in (first, *doubtful[:1])]


def suggested_by_names(read: ReadRobot, pose: StatedPose, names: AbstractSet[str]) -> list[Fix]:
    """Other frames of closures, whose names fit better: to try where no configuration closes some of them."""
    loops, found = OpenLoops(read, pose, None, EXACT), list[tuple[float, Slip]]()
    entries = {index: loops.entry(index) for index, each in enumerate(pose.constraints) if each.anchors}
    targets = {index: [frame.target for frame in entry.frames] for index, entry in entries.items()}
    used = {name for pair in targets.values() for name in pair}
    for (index, entry), of in product(entries.items(), (0, 1)):
        frame, beside = entry.frames[of], targets[index][1 - of]
        what, token = f"frame {'AB'[of]} of closure '{entry.name}'", loops.in_yaml(*frame.pointer)
        others = read.urdf.links.keys() | read.urdf.joints.keys() if isinstance(frame, NamedFrame) else set()
        for name in sorted(others - used if entry.name in names and len(others) <= _MOST_NAMES else ()):
            edits = [(token, scalar(name))]
            slip = written(GUESSED, Change(), what, f"'{name}'", f"'{frame.target}'", edits)
            found.append((_fit(name, beside) - _fit(frame.target, beside), slip))
    for one, other in combinations(entries, 2):
        (a, b), (c, d) = targets[one], targets[other]
        if names & {entries[one].name, entries[other].name}:
            gain = _fit(d, a) + _fit(b, c) - _fit(b, a) - _fit(d, c)
            found.append((gain, _exchange(loops, Change(), ((one, 1), (other, 1)))))
    found = sorted((each for each in found if each[0] > _FITS_BETTER), key=lambda each: -each[0])[:2]
    return [replace(slip.fix, question=None) for _, slip in found]


def _other_frames(loops: OpenLoops) -> Iterator[Slip]:
    """Another frame in place of one that a closure names, or another link or joint in place of that of a pose."""
    pose, links = loops.pose, loops.read.urdf.links
    named = {link: Anchor(link, frame=link) for link in links}
    named |= {each.name: Anchor(each.body, each.pose, each.name) for each in pose.mechanism.frames}
    named |= {each.name: Anchor(each.child, frame=each.name) for each in loops.read.urdf.joints.values()}
    used = {anchor.frame for each in pose.mechanism.closures for anchor in each.anchors}
    for index, of in loops.sides:
        closure, entry = pose.constraints[index], loops.entry(index)
        frame, beside, anchor = entry.frames[of], entry.frames[1 - of].target, closure.anchors[of]
        what, pointer = f"frame {'AB'[of]} of closure '{closure.name}'", frame.pointer
        candidates = named
        if not isinstance(frame, NamedFrame):
            what, pointer = f"the link of {what}", (*frame.pointer, frame.kind)
            candidates = {link: Anchor(link, anchor.pose) for link in links} if any(anchor.pose.xyz) else {}
        points = [pose.poses[each.body].act(each.pose.xyz) for each in candidates.values()]
        place = pose.frame((index, 1 - of)).xyz
        reached = pose.reached(index, np.array(points), place, loops.exact).tolist()
        best: dict[tuple[str, Pose], tuple[float, str]] = {(anchor.body, anchor.pose): (math.inf, "")}
        for name, there in compress(candidates.items(), reached):
            best[there.body, there.pose] = max(
                best.get((there.body, there.pose), (-math.inf, "")), (_fit(name, beside, closure.name), name)
            )
        now = _fit(frame.target, beside, closure.name)
        for then, name in (each for each in best.values() if each[1]):
            rank = SURE if then > now and name not in used else GUESSED
            edits = [(loops.in_yaml(*pointer), scalar(name))]
            change = Change(anchors={(index, of): candidates[name]})
            yield written(rank, change, what, f"'{name}'", f"'{frame.target}'", edits, score=then)


def _exchanged_frames(loops: OpenLoops) -> Iterator[Slip]:
    """Frames of two closures that are exchanged.

    To exchange the other two gives the same pairs, under the other names: that whose names fit better is taken.
    """
    for one, other in combinations(dict.fromkeys(index for index, _ in loops.sides), 2):
        for crossed in (0, 1):
            ways = []
            for of in (1, 0):
                sides = (one, of), (other, of ^ crossed)
                a, b = (loops.pose.constraints[index].anchors[k] for index, k in sides)
                change = Change(anchors=dict(zip(sides, (b, a), strict=True)))
                if loops.pose.closed_by(change, loops.exact, CLOSED):
                    ways.append(_exchange(loops, change, sides))
            yield from sorted(ways, key=lambda way: -way.score)[:1]


def _exchange(loops: OpenLoops, change: Change, sides: Sequence[Side]) -> Slip:
    entries = [loops.entry(index) for index, _ in sides]
    frames = [entry.frames[of] for entry, (_, of) in zip(entries, sides, strict=True)]
    score = 0.0
    for entry, frame, (_, of) in zip(entries, reversed(frames), sides, strict=True):
        score += _fit(frame.target, entry.name) + _fit(frame.target, entry.frames[1 - of].target)
    shown = [f"frame {'AB'[of]} of '{entry.name}'" for entry, (_, of) in zip(entries, sides, strict=True)]
    tokens = [loops.in_yaml(*frame.pointer) for frame in frames]
    return exchanged(SURE, change, " and ".join(shown), [tokens], score)


def _fit(name: str, *others: str) -> float:
    """How well a name fits others: how it begins as the first and is like it, and whether it says the same side."""
    apart = sum(side(each) not in (None, side(name)) for each in others) if side(name) else 0
    begins = common_start(name, others[0]) / max(len(name), len(others[0]))
    return 0.5 * (SequenceMatcher(None, name, others[0]).ratio() + begins) - apart


def _other_parents(loops: OpenLoops) -> Iterator[Slip]:
    """Another link that carries a joint of an open loop: certain only if names or the other side say so."""
    pose, joints = loops.pose, loops.read.urdf.joints
    links = list(loops.read.urdf.links)
    for joint, sides in _of_urdf(loops):
        index, of = sides[0]
        local = pose.poses[joint.parent].inverse() * pose.frame((index, of))
        reached = pose.reached(index, pose.points(links, local.xyz), pose.frame((index, 1 - of)).xyz, loops.exact)
        for link in np.array(links)[reached].tolist():
            if link == joint.parent or joint.name in pose.chain(link):
                continue
            now, then = (_fit(each, joint.child) for each in (joint.parent, link))
            rank = LIKELY if now < 0.0 <= then else GUESSED
            expected = _parent_as_elsewhere(joint, joints)
            rank += AS_THERE * (expected == joint.parent) - (expected == link)
            edits = [(loops.in_urdf(joint.name, "parent", "link"), link)]
            what, change = f"the parent of joint '{joint.name}'", Change(parents={joint.name: link})
            yield written(rank, change, what, f"'{link}'", f"'{joint.parent}'", edits, score=then)


def _parent_as_elsewhere(joint: UrdfJoint, joints: Mapping[str, UrdfJoint]) -> str | None:
    """The parent that the same joint on the other side suggests, or all that have another number; None if they differ.

    One other number says nothing: it may be that of the next joint in a chain.
    """
    if (there := joints.get(other_side(joint.name) or "")) is not None:
        return other_side(there.parent) or there.parent
    alike = ((each.parent, changes_between(each.name, joint.name)) for each in joints.values())
    found = [renamed(parent, changes) for parent, changes in alike if is_elsewhere(changes)]
    return found[0] if len(found) > 1 and len(set(found)) == 1 else None


def _exchanged_origins(loops: OpenLoops) -> Iterator[Slip]:
    """Origins of two joints that are exchanged: never certain, since links often have frames at the same places."""
    joints = loops.read.urdf.joints
    for one, other in combinations([joint for joint, _ in _of_urdf(loops)], 2):
        there = [joints.get(other_side(joint.name) or "") for joint in (one, other)]
        as_there = all(
            found is not None and list(map(abs, found.placement.xyz)) == list(map(abs, joint.placement.xyz))
            for found, joint in zip(there, (one, other), strict=True)
        )
        if one.placement != other.placement != IDENTITY != one.placement:
            change = Change(placements={one.name: other.placement, other.name: one.placement})
            what = f"the origins of joints '{one.name}' and '{other.name}'"
            yield exchanged(GUESSED + AS_THERE * as_there, change, what)


def _of_urdf(loops: OpenLoops) -> Iterator[tuple[UrdfJoint, list[Side]]]:
    """The joints of open loops that are as the URDF has them, and the frames that they move."""
    for name, sides in loops.joints.items():
        joint, made = loops.read.urdf.joints.get(name), loops.pose.joints[name]
        if joint is not None and (made.parent, made.placement) == (joint.parent, joint.placement):
            yield joint, sides


_KINDS = (
    other_coordinates,
    other_constraints,
    _other_frames,
    _exchanged_frames,
    other_poses,
    _other_parents,
    _exchanged_origins,
)
