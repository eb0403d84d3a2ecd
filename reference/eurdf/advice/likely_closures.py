"""Closures that are probably forgotten, by the names of frames, and those that probably have another type, by trial."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, takewhile
from typing import Any, NamedTuple

from eurdf.advice.stated_pose import StatedPose
from eurdf.diagnostics import Diagnostics, Fix, enumerated, quoted
from eurdf.format.closure_model import NamedFrame
from eurdf.linking.counterparts import is_elsewhere, renamed, unused_pairs
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.writing.naming_conventions import conventions, find
from eurdf.writing.yaml_edits import YamlEdits, edited

# The types that a closure has by its frames alone.
_PLAIN = ("6d", "3d")

# Pairs of frames that are proposed, at most.
_MOST_PAIRS = 8


class _Missing(NamedTuple):
    """A closure that is missing.

    Attributes:
        entry: What would state it; without its type if nothing says it.
        is_sure: Whether a closure like it on another side has the type.
        is_likely: Whether its frames are named as others, not only one as the other.
    """

    entry: dict[str, Any]
    is_sure: bool
    is_likely: bool = True


def advise_on_missing_closures(read: ReadRobot, diagnostics: Diagnostics, causes: bool) -> None:
    """Report that a robot with actuators has no closure, but frames that are named as those of one."""
    if read.mechanism.actuators and (found := list(islice(_missing(read), _MOST_PAIRS))):
        frames = "; ".join(enumerated(each.entry["frames"]) for each in found)
        diagnostics.report(
            "x-no-closure",
            f"the robot has no closure, but frames whose names pair, or that are at one point: {frames}",
            read.description.document.place((read.description.actuators_key,), True),
            None,
            forgotten_closures(read) if causes else (),
        )


def forgotten_closures(read: ReadRobot) -> Iterator[Fix]:
    """Proposals to add closures of frames that no closure uses and whose names pair: all of them, then each."""
    missing = list(islice(_missing(read), _MOST_PAIRS))
    is_plain = all(closure.type in _PLAIN for closure in read.mechanism.closures)
    for some in [missing] * (len(missing) > 1) + [[each] for each in missing]:
        if all(each.is_sure for each in some):
            yield _addition(read, [each.entry for each in some])
            continue
        for kind in _PLAIN:  # as long as they are all that the robot has, one of them may be seen to be right
            entries = [
                each.entry if each.is_sure else {key: each.entry[key] for key in ("name", "frames")} | {"type": kind}
                for each in some
            ]
            fix = _addition(read, entries)
            is_asked = kind == _PLAIN[0] and all(each.is_likely for each in some)
            question = fix.question if is_asked else None
            yield replace(fix, summary=fix.summary if is_plain else "", question=question, rivals=True)


def _missing(read: ReadRobot) -> Iterator[_Missing]:
    """The closures of frames that no closure uses, named as those of others, or by convention."""
    mechanism, description = read.mechanism, read.description
    data = description.document.data.get("closures")  # which version 1 does not have
    stated = {
        (a.target, b.target): data[entry.pointer[1]] if data else {"name": entry.name, "type": entry.type}
        for entry in description.closures
        for a, b in [entry.frames]
        if isinstance(a, NamedFrame) and isinstance(b, NamedFrame)
    }
    bodies = {joint.name: joint.child for joint in mechanism.joints}
    bodies |= {body.name: body.name for body in mechanism.bodies}
    same = dict(bodies)  # a link and the joint that carries it have one frame
    bodies |= {frame.name: frame.body for frame in mechanism.frames}
    same |= {frame.name: frame.name for frame in mechanism.frames}
    heavy = {body.name for body in mechanism.bodies if body.inertia is not None}
    rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
    used = {same[name] for pair in stated for name in pair if name in same}
    names = {closure.name for closure in mechanism.closures}
    found: list[tuple[_Missing, tuple[str, str]]] = []
    for pair in unused_pairs(stated, bodies):
        new, old = ([same.get(name) in heavy for name in frames] for frames in (pair.frames, pair.like))
        if new == old:
            like = stated[pair.like]
            name = renamed(like["name"], pair.changes) if pair.changes else _common(*pair.frames)
            missing = _Missing({**like, "name": name}, is_elsewhere(pair.changes), bool(pair.changes))
            found.append((missing, pair.frames))
    for closure in find(read.urdf, conventions()).closures:
        typed = {"type": closure.type} if closure.type else {}
        found.append((_Missing({"name": closure.name, **typed}, bool(typed)), closure.frames))
    found.sort(key=lambda each: not each[0].is_likely)
    inner = {joint.parent for joint in mechanism.joints}
    ends = [body.name for body in mechanism.bodies if body.name not in heavy and body.name not in inner]
    found += [(_Missing({"name": _common(*pair)}, False), pair) for pair in _coinciding(mechanism, ends)]
    for (entry, *more), (a, b) in found:
        if used & {same[a], same[b]} or rigid[bodies[a]] == rigid[bodies[b]]:
            continue
        used |= {same[a], same[b]}
        while entry["name"] in names:
            entry["name"] += "_closure"
        names.add(entry["name"])
        yield _Missing({**entry, "frames": [a, b]}, *more)


def _coinciding(mechanism: Mechanism, bodies: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Pairs of bodies whose origins, and no others, coincide at 'assembled', or else at neutral."""
    tree = replace(mechanism, closures=(), couplings=())
    poses = StatedPose(tree, mechanism.configurations.get("assembled", {})).poses
    there: dict[tuple[float, ...], list[str]] = {}
    for body in bodies:
        there.setdefault(tuple(round(value, 6) + 0.0 for value in poses[body].xyz), []).append(body)
    yield from ((names[0], names[1]) for names in there.values() if len(names) == 2)


def _common(a: str, b: str) -> str:
    """What two names have in common at their beginning."""
    same = "".join(one for one, _ in takewhile(lambda pair: pair[0] == pair[1], zip(a, b, strict=False)))
    return same.rstrip("_-.") or a


def _addition(read: ReadRobot, entries: Sequence[dict[str, Any]]) -> Fix:
    document = read.description.document

    def add(edits: YamlEdits) -> None:
        if read.mechanism.version != "1":
            edits.add_items("closures", entries)
            return
        types = [entry["type"] for entry in entries]
        edits.add_items("closed_loop", [entry["frames"] for entry in entries])
        if "type" in document.data or "6d" not in types:
            edits.add_items("type", types)

    several = len(entries) > 1
    pairs = "; ".join(enumerated(entry["frames"]) for entry in entries)
    types = " and ".join(dict.fromkeys(entry["type"] for entry in entries))
    return Fix(
        f"add {'closures' if several else 'a closure'} of type {types} between {pairs}: no closure uses these frames",
        edited(document, add),
        f"{'are closures' if several else 'is a closure'} missing between {pairs}, which no closure uses?",
    )


def retyped(read: ReadRobot, names: Sequence[str], kind: str, why: str) -> Fix:
    """The proposal to give closures another type."""
    document, is_first = read.description.document, read.mechanism.version == "1"
    edits = []
    for entry in read.description.closures:
        if entry.name in names and (not is_first or "type" in document.data):
            pointer = ("type", entry.pointer[1]) if is_first else (*entry.pointer, "type")
            edits.append(document.edit(pointer, kind))
    which = f"closure{'s' if len(names) > 1 else ''} {quoted(names, _MOST_PAIRS)}"
    return Fix(f"use type {kind} for {which}: {why}", tuple(edits))
