"""The equalities and tendons of an MJCF file: those that close loops, and those that relate coordinates of joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eurdf.closures.distance import DistanceClosure
from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.mjcf.compiled import Element
from eurdf.convert.mjcf.read_state import MjcfReading, name_of, pose_from, vector
from eurdf.convert.steps import turn_type
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import ROTARY
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots


def read_closures(reading: MjcfReading) -> list[Closure]:
    """The closures, in the order of the file."""
    found: list[Closure] = []
    for equality in reading.model["eq"]:
        if equality.index in reading.consumed:
            continue
        if not equality.active0:
            reading.losses.add("import-inactive-equality", name_of(equality, "equality"))
        elif equality.type in ("connect", "weld"):
            a, b = _anchors(reading, equality)
            name = reading.equalities.new(equality.name or f"{a.body}_{b.body}")
            reading.losses.add("import-softness", name)
            found.append((FrameClosure if equality.type == "weld" else PointClosure)(name, a, b))
        elif equality.type == "tendon" and (distance := _distance(reading, equality)) is not None:
            found.append(distance)
        else:
            continue
        reading.consumed.add(equality.index)
    return found


def _anchors(reading: MjcfReading, equality: Element) -> tuple[Anchor, Anchor]:
    one, other, data = equality.obj1id, equality.obj2id, equality.data
    if equality.objtype == "site":
        return _site_anchor(reading, one), _site_anchor(reading, other)
    if equality.type == "connect":
        poses = Pose(vector(data[:3])), Pose(vector(data[3:6]))
    else:
        poses = pose_from(data[3:6], data[6:10]), Pose(vector(data[:3]))
    return Anchor(reading.bodies[one].name, poses[0]), Anchor(reading.bodies[other].name, poses[1])


def _site_anchor(reading: MjcfReading, index: int) -> Anchor:
    site = reading.model["site"][index]
    return Anchor(reading.bodies[site.bodyid].name, pose_from(site.pos, site.quat))


def _distance(reading: MjcfReading, equality: Element) -> DistanceClosure | None:
    """The closure that keeps the length of a tendon between two sites."""
    tendon, wraps = reading.model["tendon"][equality.obj1id], reading.wraps(equality.obj1id)
    length = tendon.length0 + equality.data[0]
    if [wrap.type for wrap in wraps] != ["site", "site"] or equality.obj2id >= 0 or length < 1e-4:
        return None
    a, b = (_site_anchor(reading, wrap.objid) for wrap in wraps)
    name = reading.equalities.new(equality.name or tendon.name or f"distance_{equality.index}")
    reading.losses.add("import-softness", name)
    return DistanceClosure(name, a, b, length)


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


def read_couplings(reading: MjcfReading) -> tuple[Coupling, ...]:
    """The linear relations of joints; those that an export made of mimic joints are mimic joints again."""
    found: list[Coupling] = []
    seen: set[tuple[tuple[str, float], ...]] = set()
    for equality in reading.model["eq"]:
        if equality.index in reading.consumed:
            continue
        stated = name_of(equality, "equality")
        terms = _terms(reading, equality)
        if terms is None:
            reading.losses.add("import-equality", stated)
            continue
        coefficients, offset = terms
        if len(coefficients) < 2:
            _lock(reading, coefficients, offset, stated)
            continue
        first = next(iter(coefficients))
        if len(coefficients) == 2 and stated == f"{first}/mimic" and _mimic(reading, coefficients, offset):
            reading.losses.add("import-softness", first)
            continue
        ordered = sorted(coefficients.items())
        direction = tuple((name, value / ordered[0][1]) for name, value in ordered)
        if direction in seen:
            reading.losses.add("import-redundant-equality", stated)
            continue
        seen.add(direction)
        name = reading.equalities.new(equality.name or "_".join(coefficients))
        found.append(Coupling(name, tuple(coefficients.items()), offset))
        reading.losses.add("import-softness", name)
    return tuple(found)


def _terms(reading: MjcfReading, equality: Element) -> tuple[dict[str, float], float] | None:
    """Coefficients by joint, and offset, of a linear equality; None if it is no such equality."""
    data = equality.data
    if equality.type not in ("joint", "tendon") or any(data[2:5]):
        return None
    coefficients: dict[str, float] = {}
    offset = data[0]
    for element, factor in ((equality.obj1id, 1.0), (equality.obj2id, -data[1])):
        if element < 0:
            continue
        wraps = (
            reading.wraps(element) if equality.type == "tendon" else (Element(type="joint", objid=element, prm=1.0),)
        )
        for wrap in wraps:
            whole = reading.whole.get(wrap.objid)
            if wrap.type != "joint" or whole is None or whole.type.nv != 1:
                return None
            coefficient = factor * wrap.prm
            coefficients[whole.name] = coefficients.get(whole.name, 0.0) + coefficient
            offset += coefficient * reading.model.qpos0[reading.model["jnt"][wrap.objid].qposadr]
    return {name: float(value) for name, value in coefficients.items() if value}, float(offset)


def _lock(reading: MjcfReading, coefficients: Mapping[str, float], offset: float, stated: str) -> None:
    """A joint that an equality holds at a value."""
    if not coefficients:
        reading.losses.add("import-redundant-equality", stated)
        return
    ((name, c),) = coefficients.items()
    value, joint = offset / c, reading.joints[name]
    if stated == f"{name}/locked" and value:  # as an export writes equal limits
        locked = replace(joint, properties=replace(joint.properties, lower=(value,), upper=(value,)))
        reading.joints[name] = replace(locked, type=turn_type(locked)) if joint.type in ROTARY else locked
        return
    placement = joint.placement * joint.transform((value,))
    reading.joints[name] = replace(joint, placement=placement).fixed()
    reading.losses.add("import-locked-joint", name, f"is fixed at {value:g}, where an equality holds it")


def _mimic(reading: MjcfReading, coefficients: Mapping[str, float], offset: float) -> bool:
    """Make the first of two joints mimic the other; False if it cannot."""
    (follower, c), (leader, k) = coefficients.items()
    joint = reading.joints[follower]
    if not joint.type.is_axial:
        return False
    reading.joints[follower] = replace(joint, mimic=Mimic(leader, -k / c, offset / c))
    return True
