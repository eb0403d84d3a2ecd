"""The loop closures: each between two frames that can move against each other, each stated once."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from eurdf.closures import REGISTRY
from eurdf.diagnostics import Fix, Proposals
from eurdf.format.closure_model import ClosureEntry, NamedFrame
from eurdf.format.fixes import renumbered
from eurdf.format.yaml_text import scalar
from eurdf.linking.frame_names import FrameNames
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import RIGID, Closure, Compliance
from eurdf.mechanism.pose import Pose, Vector3
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument, YamlReporter

# A word of a name, or what is between two.
_WORD = re.compile(r"([^\W\d_]+)")

# A word or a number in a name, and those that name two sides.
_PART = re.compile(r"[^\W\d_]+|\d+")
_SIDES = ([{"1", "2"}], [{"a", "b"}], [{"A", "B"}])


def link_closures(
    entries: Sequence[ClosureEntry], names: FrameNames, rigid: Mapping[str, str], reporter: YamlReporter
) -> tuple[Closure, ...]:
    """Look the frames of every closure up and check what two frames can have wrong together.

    A closure of a type that begins with ``x-`` is left out (EU-CLO-012). ``rigid`` has the body that each is fixed to.
    """
    closures: list[Closure] = []
    names_of_all = {entry.name for entry in entries}
    taken: dict[str, ClosureEntry] = {}
    joined: dict[frozenset[tuple[str, Pose]], str] = {}
    for entry in entries:
        if entry.name in taken:
            reporter.report(
                "duplicate-closure-name",
                f"there is already a closure '{entry.name}'",
                (*entry.pointer, "name"),
                "give every closure a unique name",
                partial(renumbered, reporter.document, (*entry.pointer, "name"), entry.name, names_of_all),
            )
            continue
        taken[entry.name] = entry
        a, b = map(names.find, entry.frames)
        others = partial(_paired_frames, entry, entries, names, reporter.document)
        if a is None or b is None or not _movable(entry, a, b, rigid, reporter, others):
            continue
        pair = frozenset({(a.body, a.pose), (b.body, b.pose)})
        if pair in joined:
            reporter.report(
                "closure-duplicate",
                f"closure '{entry.name}' connects the same two frames as '{joined[pair]}'",
                entry.pointer,
                "which of them connects other frames?",
                partial(_other_frames, entry, entries, names, reporter.document),
            )
            continue
        joined[pair] = entry.name
        kind = REGISTRY.get(entry.type)
        if kind is None:
            reporter.report(
                "closure-type-unknown",
                f"closure '{entry.name}' has the user-defined type '{entry.type}' and is left out of the model",
                (*entry.pointer, "type"),
            )
            continue
        if not _fits(kind, entry, reporter) or not _have_directions(entry, reporter):
            continue
        closures.append(kind(entry.name, a, b, compliance=_compliance(entry), **kind.values_of(entry.stated)))
    return tuple(closures)


def _other_frames(
    entry: ClosureEntry, entries: Sequence[ClosureEntry], names: FrameNames, document: YamlDocument
) -> Iterator[Fix]:
    """Fixes that name other frames, which no closure uses: one word of both names is another, as right for left."""
    one, other = (frame.target for frame in entry.frames)
    used = {frame.target for each in entries for frame in each.frames}
    free = [name for name in names.known() if name not in used]
    parts = _WORD.split(one)
    for name in free if all(isinstance(frame, NamedFrame) for frame in entry.frames) else ():
        pairs = [pair for pair in zip(parts, _WORD.split(name), strict=False) if pair[0] != pair[1]]
        if len(pairs) != 1 or name.count(pairs[0][1]) != one.count(pairs[0][0]):
            continue
        beside = "".join(pairs[0][1] if part == pairs[0][0] else part for part in _WORD.split(other))
        if beside in free:
            new = zip(entry.frames, (name, beside), strict=True)
            edits = tuple(document.edit(frame.pointer, scalar(each)) for frame, each in new)
            what = f"'{name}' and '{beside}', which no closure uses"
            yield Fix(f"name the frames {what}", edits, f"did you mean {what}?")


def _compliance(entry: ClosureEntry) -> Compliance:
    stated = entry.compliance
    return RIGID if stated is None else Compliance(stated.linear or 0.0, stated.angular or 0.0)


def _fits(kind: type[Closure], entry: ClosureEntry, reporter: YamlReporter) -> bool:
    """EU-CLO-020, EU-CLO-021: only a closure that holds an orientation has an angular compliance."""
    if not _compliance(entry).angular or "rad" in kind.units:
        return True
    reporter.report(
        "closure-compliance",
        f"closure '{entry.name}' of type {kind.type} holds no orientation, and cannot have an angular compliance",
        (*entry.pointer, "compliance", "angular"),
        "remove 'angular', or use type 6d or hinge",
    )
    return False


def _have_directions(entry: ClosureEntry, reporter: YamlReporter) -> bool:
    """EU-CLO-013: no axis of a hinge is zero."""
    stated = entry.stated
    axes: dict[Pointer, Vector3] = {("axis",): stated["axis"]} if "axis" in stated else {}
    axes |= {("axes", index): axis for index, axis in enumerate(stated.get("axes", ()))}
    zero = next((key for key, axis in axes.items() if not any(axis)), None)
    if zero is None:
        return True
    pointer = (*entry.pointer, *zero)
    hint = "write the direction of the pin in the frame; it may have any length"
    reporter.report("closure-axis-zero", f"an axis of hinge '{entry.name}' is zero", pointer, hint)
    return False


def _movable(
    entry: ClosureEntry, a: Anchor, b: Anchor, rigid: Mapping[str, str], reporter: YamlReporter, others: Proposals
) -> bool:
    """EU-CLO-002, EU-CLO-003: the two frames are not one, and not fixed to one another; ``others`` name others."""
    if a.body == b.body and a.pose == b.pose:
        same = not a.frame or not b.frame or a.frame == b.frame
        what = f"a frame on '{a.body}'" if not a.frame else f"'{a.frame}'"
        message = f"{what} with itself" if same else f"'{a.frame}' with '{b.frame}', which is the same frame"
        reporter.report(
            "closure-same-frame",
            f"closure '{entry.name}' connects {message}",
            entry.frames[1].pointer,
            "name the frame on the other side of the cut",
        )
        return False
    if rigid[a.body] == rigid[b.body]:
        which = f"'{a.body}'" if a.body == b.body else f"'{a.body}' and '{b.body}', which are fixed to each other"
        reporter.report(
            "closure-same-body",
            f"closure '{entry.name}' connects two frames of one rigid body, {which}",
            entry.pointer,
            "which frame is on the other side of the cut?",
            others,
        )
        return False
    return True


def _paired_frames(
    entry: ClosureEntry, entries: Sequence[ClosureEntry], names: FrameNames, document: YamlDocument
) -> Iterator[Fix]:
    """Fixes that name a frame that no closure uses, whose name differs from the other's in the side: 1 or 2, a or b."""
    used = {frame.target for each in entries for frame in each.frames}
    for kept, changed in (entry.frames, entry.frames[::-1]):
        parts = _PART.findall(kept.target)
        for name in names.known() if isinstance(changed, NamedFrame) else ():
            pairs = zip(parts, _PART.findall(name), strict=False)
            if name not in used and [{*pair} for pair in pairs if pair[0] != pair[1]] in _SIDES:
                what = f"'{name}', which no closure uses"
                edits = (document.edit(changed.pointer, scalar(name)),)
                yield Fix(f"name {what}, in place of '{changed.target}'", edits, f"did you mean {what}?")
