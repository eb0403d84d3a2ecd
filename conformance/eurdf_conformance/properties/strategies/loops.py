"""Closures that are closed by construction: at `assembled`, frame B is at the pose of frame A."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from eurdf_conformance.level import Version
from eurdf_conformance.oracle.spatial import rotation
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.mechanism import (
    Closure,
    Compliance,
    Frame,
    Joint,
    Link,
    Mechanism,
    Pose,
    Spot,
    Vector,
)
from eurdf_conformance.properties.placement import Matrix, inverse, matrix_of, pose_of
from eurdf_conformance.properties.strategies.numbers import axes, decimals, poses, vectors
from eurdf_conformance.properties.truth import truth

Kind = Literal["3d", "6d", "hinge", "distance"]

#: The types of closures of a version.
KINDS: dict[Version, tuple[Kind, ...]] = {
    "1": ("3d", "6d"),
    "2": ("3d", "6d"),
    "2.1": ("hinge", "distance", "3d", "6d"),
}

#: m, of a distance that is drawn.
LEAST_LENGTH = 0.3

#: Of two unit vectors whose sum is shorter than this, one is taken for the other turned round.
_OPPOSITE = 1e-3


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
        kind = draw(st.sampled_from(KINDS[version]))
        wMa = at.pose(robot.tree.links[a])
        aMb = inverse(wMa) @ at.pose(robot.tree.links[b])
        mechanism = draw(with_closure(mechanism, version, kind, a, b, aMb))
    return mechanism


@st.composite
def with_closure(
    draw: DrawFn, mechanism: Mechanism, version: Version, kind: Kind, a: str, b: str, aMb: Matrix
) -> Mechanism:
    """A tree with another closure between frames on links a and b, where aMb is the pose of b in a when closed."""
    on_a = draw(st.just(Pose()) | poses())
    M = inverse(aMb) @ matrix_of(on_a)
    keys: dict[str, Any] = {}
    if kind == "hinge":
        keys = draw(hinge_axes())
        M[:3, :3] = M[:3, :3] @ aligned(*keys.pop("held"))
    if kind == "distance":
        apart = np.array(draw(vectors(0.8).filter(lambda v: np.linalg.norm(v) > LEAST_LENGTH)))
        M[:3, 3] += M[:3, :3] @ apart
        keys["length"] = float(np.linalg.norm(apart))
    if kind in ("3d", "distance"):
        M[:3, :3] = matrix_of(Pose(rpy=draw(vectors(3.1))))[:3, :3]
    if version == "2.1":
        keys["compliance"] = draw(st.none() | compliances(kind))
    mechanism, frame_a = draw(said(mechanism, version, a, on_a))
    mechanism, frame_b = draw(said(mechanism, version, b, pose_of(M)))
    name = f"closure_{len(mechanism.closures) + 1}"
    closure = Closure(name=name, type=kind, a=frame_a, b=frame_b, **keys)
    return mechanism.replace(closures=(*mechanism.closures, closure))


@st.composite
def hinge_axes(draw: DrawFn) -> dict[str, Any]:
    """The keys that state the axes of a hinge, if any; as `held`, the axis in A, that in B, and a turn about it."""
    turn = draw(decimals(-3.1, 3.1))
    z: Vector = (0.0, 0.0, 1.0)
    match draw(st.sampled_from(["none", "axis", "axes"])):
        case "axis":
            axis = draw(axes())
            return {"axis": axis, "held": (axis, axis, turn)}
        case "axes":
            a, b = draw(axes()), draw(axes())
            return {"axes": (a, b), "held": (a, b, turn)}
    return {"held": (z, z, turn)}


def aligned(a: Vector, b: Vector, turn: float) -> Matrix:
    """A rotation (3, 3) of B in A with which b is along a."""
    first, second = (np.array(axis) / np.linalg.norm(axis) for axis in (a, b))
    z = np.array([0.0, 0.0, 1.0])
    to_a, to_b = (_from_z(axis, z) for axis in (first, second))
    return np.asarray(to_a @ rotation(z, turn) @ to_b.T)


def _from_z(axis: Matrix, z: Matrix) -> Matrix:
    """A rotation (3, 3) that takes z to an axis: half a turn about the line between them."""
    middle = z + axis
    length = np.linalg.norm(middle)
    return rotation(middle / length, np.pi) if length > _OPPOSITE else np.diag([1.0, -1.0, -1.0])


def compliances(kind: Kind) -> SearchStrategy[Compliance]:
    """What a type of closure can give way by, EU-CLO-020; at least one of the two is stated."""
    few = decimals(0, 0.01, 4)
    linear = st.builds(Compliance, linear=few)
    if kind in ("3d", "distance"):
        return linear
    return linear | st.builds(Compliance, linear=st.none() | few, angular=few)


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
