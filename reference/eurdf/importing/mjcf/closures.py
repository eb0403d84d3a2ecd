"""The equalities and tendons that close loops."""

from __future__ import annotations

from collections.abc import Sequence

from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.values import pose_from, vector
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, DistanceClosure, FrameClosure, PointClosure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots


def read_closures(reading: MjcfReading) -> list[Closure]:
    """The closures, in the order of the file."""
    model = reading.model
    found: list[Closure] = []
    for index, kind in enumerate(model["eq_type"]):
        if index in reading.consumed:
            continue
        name = model.names["equality"][index]
        if not model["eq_active0"][index]:
            reading.consumed.add(index)
            reading.losses.add("import-inactive-equality", name or f"equality {index}")
        elif kind in ("connect", "weld"):
            reading.consumed.add(index)
            a, b = _anchors(reading, index)
            name = reading.equalities.new(name or f"{a.body}_{b.body}")
            reading.losses.add("import-softness", name)
            found.append((FrameClosure if kind == "weld" else PointClosure)(name, a, b))
        elif kind == "tendon" and (distance := _distance(reading, index)) is not None:
            reading.consumed.add(index)
            found.append(distance)
    return found


def _anchors(reading: MjcfReading, index: int) -> tuple[Anchor, Anchor]:
    model = reading.model
    one, other = model["eq_obj1id"][index], model["eq_obj2id"][index]
    if model["eq_objtype"][index] == "site":
        return _site_anchor(reading, one), _site_anchor(reading, other)
    data = model["eq_data"][index]
    if model["eq_type"][index] == "connect":
        poses = Pose(vector(data[:3])), Pose(vector(data[3:6]))
    else:
        poses = pose_from(data[3:6], data[6:10]), Pose(vector(data[:3]))
    return Anchor(reading.bodies[one].name, poses[0]), Anchor(reading.bodies[other].name, poses[1])


def _site_anchor(reading: MjcfReading, site: int) -> Anchor:
    model = reading.model
    pose = pose_from(model["site_pos"][site], model["site_quat"][site])
    return Anchor(reading.bodies[model["site_bodyid"][site]].name, pose)


def _distance(reading: MjcfReading, index: int) -> DistanceClosure | None:
    """The closure that keeps the length of a tendon between two sites."""
    model = reading.model
    tendon, data = model["eq_obj1id"][index], model["eq_data"][index]
    wraps = reading.wraps(tendon)
    length = model["tendon_length0"][tendon] + data[0]
    if [kind for kind, _, _ in wraps] != ["site", "site"] or model["eq_obj2id"][index] >= 0 or length < 1e-4:
        return None
    (_, one, _), (_, other, _) = wraps
    stated = model.names["equality"][index] or model.names["tendon"][tendon]
    name = reading.equalities.new(stated or f"distance_{index}")
    reading.losses.add("import-softness", name)
    return DistanceClosure(name, _site_anchor(reading, one), _site_anchor(reading, other), length)


def movable(reading: MjcfReading, closures: Sequence[Closure], mechanism: Mechanism) -> tuple[Closure, ...]:
    """The closures of bodies that can move against each other, each once."""
    rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
    found: dict[frozenset[tuple[str, Pose]], Closure] = {}
    for closure in closures:
        pair = frozenset((end.body, end.pose) for end in (closure.a, closure.b))
        if pair in found and found[pair].type != closure.type:
            reading.losses.add("import-equality", closure.name, "is left out: another one joins the same two frames")
        elif rigid[closure.a.body] == rigid[closure.b.body] or pair in found:
            reading.losses.add("import-redundant-equality", closure.name)
        else:
            found[pair] = closure
    return tuple(found.values())
