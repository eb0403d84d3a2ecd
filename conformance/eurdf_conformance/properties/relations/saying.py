"""The ways to refer to a frame: by name, as a pose in place, or as a link of the URDF."""

from __future__ import annotations

from collections.abc import Callable

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Frame, Joint, Link, Mechanism, Spot
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property, closed
from eurdf_conformance.properties.query import all_frames, query_of


def saying(example: Example, version: Version) -> Pair:
    """A mechanism with poses in place, and the same with other references to the same frames."""
    inline = with_inline_frames(example.mechanism)
    other = said_otherwise(inline, example.chance)
    return Pair(query_of(inline, version), query_of(other, version, frames=all_frames(inline)))


def with_inline_frames(mechanism: Mechanism) -> Mechanism:
    """Poses in place of names that the description adds."""
    added = {frame.name: frame.spot for frame in mechanism.frames}
    return _with_frames(mechanism, lambda frame: added.get(frame, frame) if isinstance(frame, str) else frame)


def with_named_frames(mechanism: Mechanism) -> Mechanism:
    """Names in place of poses."""
    frames = list(mechanism.frames)

    def name(frame: str | Spot) -> str:
        if isinstance(frame, str):
            return frame
        frames.append(Frame(name=f"named {len(frames)}", spot=frame))
        return frames[-1].name

    named = _with_frames(mechanism, name)
    return named.replace(frames=tuple(frames))


def said_otherwise(mechanism: Mechanism, chance: Chance) -> Mechanism:
    """Each pose in place as a named frame, as a pose on the joint that carries its link, or as a link."""
    carrier = {joint.child: joint.name for joint in mechanism.joints}
    links, joints, frames = list(mechanism.links), list(mechanism.joints), list(mechanism.frames)

    def said(frame: str | Spot) -> str | Spot:
        if isinstance(frame, str):
            return frame
        if frame.on == "link" and frame.of in carrier and chance.is_so(0.5):
            frame = frame.model_copy(update={"on": "joint", "of": carrier[frame.of]})
        match chance.one_of(["frame", "place", "link"]):
            case "frame":
                frames.append(Frame(name=f"said {len(frames)}", spot=frame))
                return frames[-1].name
            case "link":
                return mount(frame)
        return frame

    def mount(spot: Spot) -> str:
        parent = spot.of if spot.on == "link" else next(j.child for j in mechanism.joints if j.name == spot.of)
        name = f"mounted {len(links)}"
        links.append(Link(name=name))
        joints.append(Joint(name=f"mount {len(links)}", type="fixed", parent=parent, child=name, origin=spot.pose))
        return chance.one_of([name, joints[-1].name])

    found = _with_frames(mechanism, said)
    return found.replace(links=tuple(links), joints=tuple(joints), frames=tuple(frames))


def _with_frames(mechanism: Mechanism, say: Callable[[str | Spot], str | Spot]) -> Mechanism:
    return mechanism.replace(
        closures=tuple(each.model_copy(update={"a": say(each.a), "b": say(each.b)}) for each in mechanism.closures)
    )


PROPERTIES = (
    Property(
        "frames",
        "A closure frame is the same whether given by name, by an inline pose on a link or its joint, or as a link.",
        ("EU-FRM-001", "EU-FRM-004", "EU-FRM-005", "EU-FRM-006", "EU-CLO-008", "EU-CLO-009"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(saying),
        versions=("2",),
        applies=closed,
        closures=1,
    ),
)
