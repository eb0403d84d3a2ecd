"""The loop closures: each between two frames that can move against each other, each stated once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial

from eurdf.closures import REGISTRY
from eurdf.diagnostics import Fix
from eurdf.format.closure_model import ClosureEntry, NamedFrame
from eurdf.format.fixes import named, removed, renumbered
from eurdf.format.yaml_text import scalar
from eurdf.linking.counterparts import changes_between, other_frame, unused_pairs
from eurdf.linking.frame_names import FrameNames
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import RIGID, Closure, Compliance
from eurdf.mechanism.pose import Pose, Vector3
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlReporter

# Pairs of frames that are proposed, at most.
_FEW = 3


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
        if a is None or b is None or not _movable(entry, a, b, rigid, entries, names, reporter):
            continue
        pair = frozenset({(a.body, a.pose), (b.body, b.pose)})
        if pair in joined:
            reporter.report(
                "closure-duplicate",
                f"closure '{entry.name}' connects the same two frames as '{joined[pair]}'",
                entry.pointer,
                None,
                _other_frames(entry, taken[joined[pair]], entries, names, reporter),
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


def _used(entries: Iterable[ClosureEntry]) -> list[tuple[str, str]]:
    """The names of the frames of closures, where both are named."""
    pairs = (entry.frames for entry in entries)
    return [(a.target, b.target) for a, b in pairs if isinstance(a, NamedFrame) and isinstance(b, NamedFrame)]


def _other_frames(
    entry: ClosureEntry, first: ClosureEntry, entries: Sequence[ClosureEntry], names: FrameNames, reporter: YamlReporter
) -> Iterator[Fix]:
    """Proposals for a closure that repeats another one: frames that no closure uses, or to remove it."""
    document = reporter.document
    changes = changes_between(first.name, entry.name)
    likely = [pair for pair in unused_pairs(_used(entries), names.known()) if pair.changes]
    likely.sort(key=lambda pair: pair.changes.values() != changes.values())
    for pair in likely[:_FEW]:
        shown = f"'{pair.frames[0]}', '{pair.frames[1]}'"
        edits = (
            document.edit(side.pointer, scalar(name)) for side, name in zip(entry.frames, pair.frames, strict=True)
        )
        asked = f"did you mean {shown}, which no closure uses?"
        yield Fix(f"name the frames {shown}, which no closure uses", tuple(edits), asked, rivals=len(likely) > 1)
    if not likely:
        yield from removed(document, entry.pointer, f"closure '{entry.name}'")
        yield Fix("", (), "which of them connects other frames?")


def _partners(
    entry: ClosureEntry, entries: Iterable[ClosureEntry], names: FrameNames, reporter: YamlReporter
) -> list[Fix]:
    """Proposals to connect a frame of a closure to the one that pairs with it by name and that no closure uses."""
    used = _used(entries)
    free = frozenset(names.known()).difference(name for pair in used for name in pair)
    fixes = []
    for side, other in (entry.frames, entry.frames[::-1]):
        if isinstance(side, NamedFrame) and (name := other_frame(side.target, used, free)):
            edits = named(reporter.document, other.pointer, False, name)
            asked = f"did you mean '{side.target}' and '{name}', which no closure uses?"
            fixes.append(Fix(f"connect '{side.target}' to '{name}', which no closure uses", edits, asked))
    return fixes


def _movable(
    entry: ClosureEntry,
    a: Anchor,
    b: Anchor,
    rigid: Mapping[str, str],
    entries: Iterable[ClosureEntry],
    names: FrameNames,
    reporter: YamlReporter,
) -> bool:
    """EU-CLO-002, EU-CLO-003: the two frames are not one, and not fixed to one another."""
    if a.body == b.body and a.pose == b.pose:
        same = not a.frame or not b.frame or a.frame == b.frame
        what = f"a frame on '{a.body}'" if not a.frame else f"'{a.frame}'"
        message = f"{what} with itself" if same else f"'{a.frame}' with '{b.frame}', which is the same frame"
        fixes = _partners(entry, entries, names, reporter)
        reporter.report(
            "closure-same-frame",
            f"closure '{entry.name}' connects {message}",
            entry.frames[1].pointer,
            None if fixes else "name the frame on the other side of the cut",
            fixes[:1],
        )
        return False
    if rigid[a.body] == rigid[b.body]:
        which = f"'{a.body}'" if a.body == b.body else f"'{a.body}' and '{b.body}', which are fixed to each other"
        fixes = _partners(entry, entries, names, reporter)
        reporter.report(
            "closure-same-body",
            f"closure '{entry.name}' connects two frames of one rigid body, {which}",
            entry.pointer,
            None if fixes else "which frames, that can move relative to each other, does it connect?",
            fixes,
        )
        return False
    return True
