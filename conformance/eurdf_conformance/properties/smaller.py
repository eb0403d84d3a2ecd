"""Removes parts of a mechanism. Hypothesis cannot remove what it drew before the part that matters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

from eurdf_conformance.properties.mechanism import Joint, Mechanism, Part, Spot

_Part = TypeVar("_Part", bound=Part)


def smaller(mechanism: Mechanism) -> Iterator[Mechanism]:
    """Mechanisms with one closure, coupling, motor, frame or joint less, and without what refers to that part alone.

    Three joints that are merged go together. Of a mechanism whose loops are closed, those that are left are closed.
    """
    for i in range(len(mechanism.closures)):
        yield mechanism.replace(closures=_without(mechanism.closures, i))
    for i in range(len(mechanism.couplings)):
        yield mechanism.replace(couplings=_without(mechanism.couplings, i))
    for i in range(len(mechanism.actuators)):
        yield mechanism.replace(actuators=_without(mechanism.actuators, i))
    held = {end for closure in mechanism.closures for end in (closure.a, closure.b)}
    for i, frame in enumerate(mechanism.frames):
        if frame.name not in held:
            yield mechanism.replace(frames=_without(mechanism.frames, i))
    joints = {joint.name: joint for joint in mechanism.joints}
    for joint in mechanism.joints:
        if joint.name not in mechanism.merged:
            yield from _without_joints(mechanism, joint.name, [joint])
    for name, change in mechanism.changes.items():
        if change.merges:
            yield from _without_joints(mechanism, name, [joints[merged] for merged in change.merges])


def _without(parts: tuple[_Part, ...], index: int) -> tuple[_Part, ...]:
    return (*parts[:index], *parts[index + 1 :])


def _without_joints(mechanism: Mechanism, name: str, chain: list[Joint]) -> Iterator[Mechanism]:
    """The mechanism without the joints of one name, if nothing else refers to them.

    What hangs from it comes nearer to the root, where no loop is held open by that.
    """
    joints, links = {joint.name for joint in chain}, {joint.child for joint in chain}
    rest = [joint for joint in mechanism.joints if joint.name not in joints]
    ends = [end for closure in mechanism.closures for end in (closure.a, closure.b)]
    spots = [frame.spot for frame in mechanism.frames] + [end for end in ends if isinstance(end, Spot)]
    named = {spot.of for spot in spots} | {end for end in ends if isinstance(end, str)}
    named |= {coupled for coupling in mechanism.couplings for coupled in coupling.joints}
    named |= {joint.mimic.joint for joint in rest if joint.mimic}
    carries = any(joint.parent in links for joint in rest)
    if named & {name, *joints, *links} or (carries and mechanism.closures):
        return
    yield mechanism.replace(
        links=tuple(link for link in mechanism.links if link.name not in links),
        joints=tuple(
            joint.model_copy(update={"parent": chain[0].parent}) if joint.parent in links else joint for joint in rest
        ),
        changes={key: change for key, change in mechanism.changes.items() if key != name},
        actuators=tuple(actuator for actuator in mechanism.actuators if actuator.joint != name),
        configurations={
            key: {joint: q for joint, q in configuration.items() if joint != name}
            for key, configuration in mechanism.configurations.items()
        },
    )
