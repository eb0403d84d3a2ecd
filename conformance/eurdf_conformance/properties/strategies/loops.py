"""Closures that are closed by construction: at `assembled`, frame B is at the pose of frame A."""

from __future__ import annotations

from typing import Literal

from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from eurdf_conformance.level import Version
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.mechanism import Closure, Frame, Joint, Link, Mechanism, Pose, Spot
from eurdf_conformance.properties.placement import Matrix, inverse, matrix_of, pose_of
from eurdf_conformance.properties.strategies.numbers import poses, vectors
from eurdf_conformance.properties.truth import truth

KINDS: tuple[Literal["3d", "6d"], ...] = ("3d", "6d")


@st.composite
def with_closures(draw: DrawFn, tree: Mechanism, version: Version, least: int = 0) -> Mechanism:
    """A tree with at most three closures, each between two other bodies."""
    robot = truth(tree, version)
    at = robot.kinematics(configuration(tree, tree.configurations["assembled"], version))
    bodies = [links[0] for links in robot.bodies]
    pairs = [(a, b) for a in bodies for b in bodies if a != b]
    if not pairs:
        return tree
    assume(2 * least <= len(pairs))
    mechanism = tree
    chosen = st.lists(st.sampled_from(pairs), unique_by=lambda pair: frozenset(pair), min_size=least, max_size=3)
    for a, b in draw(chosen):
        kind = draw(st.sampled_from(KINDS))
        wMa = at.pose(robot.tree.links[a])
        aMb = inverse(wMa) @ at.pose(robot.tree.links[b])
        mechanism = draw(with_closure(mechanism, version, kind, a, b, aMb))
    return mechanism


@st.composite
def with_closure(
    draw: DrawFn, mechanism: Mechanism, version: Version, kind: Literal["3d", "6d"], a: str, b: str, aMb: Matrix
) -> Mechanism:
    """A tree with another closure between frames on links a and b, where aMb is the pose of b in a when closed."""
    on_a = draw(st.just(Pose()) | poses())
    M = inverse(aMb) @ matrix_of(on_a)
    if kind == "3d":
        M[:3, :3] = matrix_of(Pose(rpy=draw(vectors(3.1))))[:3, :3]
    mechanism, frame_a = draw(said(mechanism, version, a, on_a))
    mechanism, frame_b = draw(said(mechanism, version, b, pose_of(M)))
    name = f"closure_{len(mechanism.closures) + 1}"
    closure = Closure(name=name, type=kind, a=frame_a, b=frame_b)
    return mechanism.replace(closures=(*mechanism.closures, closure))


@st.composite
def said(draw: DrawFn, mechanism: Mechanism, version: Version, link: str, pose: Pose) -> tuple[Mechanism, str | Spot]:
    """A reference to a frame on a link, in one of the possible ways, with the parts that it needs."""
    carrier = {joint.child: joint.name for joint in mechanism.joints}
    if pose == Pose() and draw(st.booleans()):
        return mechanism, link
    if version == "1":
        number = len(mechanism.links)
        tip = Link(name=f"tip{number}")
        joint = Joint(name=f"mount{number}", type="fixed", parent=link, child=tip.name, origin=pose)
        name = draw(st.sampled_from([tip.name, joint.name]))
        return mechanism.replace(links=(*mechanism.links, tip), joints=(*mechanism.joints, joint)), name
    spot = Spot(on="link", of=link, pose=pose)
    if link in carrier and draw(st.booleans()):
        spot = Spot(on="joint", of=carrier[link], pose=pose)
    if draw(st.booleans()):
        return mechanism, spot
    frame = Frame(name=f"frame{len(mechanism.frames)}", spot=spot)
    return mechanism.replace(frames=(*mechanism.frames, frame)), frame.name
