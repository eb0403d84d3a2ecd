"""Advice on values that differ between left and right, of a robot that is else symmetric."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import starmap
from typing import NamedTuple

from eurdf.advice.mirrored_names import mirrored_names
from eurdf.diagnostics import Diagnostics, Place
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.pose import IDENTITY, Vector3, direction

# Relative differences up to the first of these are rounding, if most pairs agree so well; else up to the next one, as a
# CAD model may be not quite symmetric. What is reported differs by more than `_CLEAR` times as much.
_ROUNDING = (1e-3, 1e-2, 0.1)
_CLEAR = 3.0

# So many values of a family agree at least.
_AGREEING = 3


class _Rule(NamedTuple):
    """When values of a family are reported.

    Attributes:
        for_each: If several pairs differ, so many agree at least for each of them.
        one: The least difference, if one pair differs.
        several: The least difference, if several do.
    """

    for_each: int = 4
    one: float = 0.0
    several: float = 0.0


# A wrong name makes two pairs differ. Inertias of published robots differ by as much because the parts do.
_USUAL, _STRICT, _OF_INERTIA = _Rule(), _Rule(1), _Rule(4, 0.1, 0.5)

# Differences of lengths are relative to at least this part of how far the robot reaches from its root.
_SHORT = 0.02

# Differences that are named.
_NAMED = 3

# Properties of joints, with their units where the joint turns and where it slides.
_PROPERTIES = {
    "velocity": ("rad/s", "m/s"),
    "effort": ("N·m", "N"),
    "damping": ("N·m·s/rad", "N·s/m"),
    "friction": ("N·m", "N"),
    "armature": ("kg·m²", "kg"),
    "gear_ratio": ("", "rad/m"),
    "rotor_inertia": ("kg·m²", "kg·m²"),
    "stiffness": ("N·m/rad", "N/m"),
    "rest": ("rad", "m"),
}


@dataclass(frozen=True, slots=True)
class _Fact:
    """A quantity of two things with mirrored names.

    Attributes:
        what: The quantity, and the kind of the things.
        names: Of the two things.
        values: As text, with the unit.
        difference: Relative difference, of what does not depend on how the frames of a side are chosen.
        place: Where the value of the first is stated.
        mirrored: Relative difference from the mirror image at neutral; None if the quantity has no direction.
        body: The first of the bodies in whose frames a direction is stated.
    """

    what: str
    names: tuple[str, str]
    values: tuple[str, str]
    difference: float
    place: Callable[[], Place]
    mirrored: float | None = None
    body: str = ""


def advise_on_symmetry(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report once what differs between left and right, where most values of its family agree."""
    sides = _Sides(read)
    families = (
        (sides.of_structure(), _STRICT),
        (sides.of_origins(), _USUAL),
        (sides.of_joints(), _USUAL),
        (sides.of_bodies(), _OF_INERTIA),
    )
    of_families = [(list(facts), rule) for facts, rule in families] if sides.joints else []
    turned = sides.turned()
    found: dict[tuple[str, tuple[str, str]], tuple[float, _Fact]] = {}
    for facts, rule in of_families:
        directed = [(f.mirrored, f) for f in facts if f.mirrored is not None and f.body not in turned]
        for each in (*_unlike(directed, rule), *_unlike([(f.difference, f) for f in facts], rule)):
            found.setdefault((each[1].what, each[1].names), each)
    if found:
        clearest = [fact for _, fact in sorted(found.values(), key=lambda each: -each[0])]
        told = [f"{f.what} '{f.names[0]}': {f.values[0]}, '{f.names[1]}': {f.values[1]}" for f in clearest[:_NAMED]]
        more = [f"{len(found) - _NAMED} more"] if len(found) > _NAMED else []
        diagnostics.report(
            "x-asymmetric",
            "left and right differ, although most of their values agree: " + "; ".join(told + more),
            clearest[0].place,
            "is that on purpose? 'eurdf check --ignore x-asymmetric' hides this warning",
        )


class _Sides:
    """Left and right of a robot: the pairs of names, and the facts about them, by families."""

    def __init__(self, read: ReadRobot) -> None:
        self._read = read
        mechanism = self._mechanism = read.mechanism
        self._body = {body.name: body for body in mechanism.bodies}
        joints = {joint.name: joint for joint in mechanism.joints}
        self._image, self.joints = mirrored_names(self._body), mirrored_names(joints)
        root = mechanism.bodies[0].name
        self._pose, path = {root: IDENTITY}, {root: 0.0}  # at neutral, in the root
        for joint in mechanism.joints:
            self._pose[joint.child] = self._pose[joint.parent] * joint.placement * joint.offset
            path[joint.child] = path[joint.parent] + math.hypot(*joint.placement.xyz)
        self._short = _SHORT * max(path.values())
        # A fixed joint that carries neither a joint that moves nor a closure may be a sensor of one side.
        carrying = {anchor.body for closure in mechanism.closures for anchor in closure.anchors}
        moving = set()
        for joint in reversed(mechanism.joints):
            if not joint.type.is_fixed or joint.child in carrying:
                carrying.add(joint.parent)
                moving.add(joint.name)
        self._all_pairs = [
            (joint, joints[self.joints[joint.name]])
            for joint in mechanism.joints
            if joint.name < self.joints.get(joint.name, "")
        ]
        self._pairs = [pair for pair in self._all_pairs if pair[0].name in moving]
        self._entries = {} if read.yaml is None else {entry.name: entry for entry in read.yaml.joints}
        self._across = 1  # the axis of the root that left and right are mirrored along
        self._across = max((1, 0, 2), key=self._number_mirrored)

    def turned(self) -> set[str]:
        """Bodies in whose frames most points are not mirrored: they are turned against their images at neutral."""
        points = [(one.parent, one.placement.xyz, two.parent, two.placement.xyz) for one, two in self._all_pairs]
        for name, other in self._image.items():
            one, two = self._body[name].inertia, self._body[other].inertia
            if name < other and one is not None and two is not None:
                points.append((name, one.pose.xyz, other, two.pose.xyz))
        count: Counter[str] = Counter()
        for body, point, image, mirrored in points:
            a, b = self._pose[body].rotate(point), self._pose[image].rotate(mirrored)
            if body in self._image and math.hypot(*a) > self._short:
                count[body] += 1 if self._off(a, b, self._across) > _CLEAR * _ROUNDING[0] else -1
        return {body for body, more in count.items() if more > 0}

    def of_bodies(self) -> Iterator[_Fact]:
        """Masses, centres of mass and moments of inertia."""
        for body in self._mechanism.bodies:
            other = self._body.get(self._image.get(body.name, ""))
            if other is None or other.name < body.name or body.virtual or other.virtual:
                continue
            names, place = (body.name, other.name), partial(self._place_of_link, body.name)
            one, two = body.inertia, other.inertia
            masses = [0.0 if each is None else each.mass for each in (one, two)]
            yield _Fact("mass of link", names, _texts("{:.6g} kg", *masses), _apart(*masses), place)
            if one is None or two is None:
                continue
            points = one.pose.xyz, two.pose.xyz
            yield _Fact("centre of mass of link", names, _at(*points), self._lengths(*points), place)
            traces = [each.moments[0] + each.moments[3] + each.moments[5] for each in (one, two)]
            values = _texts("{0[0]:.4g}, {0[3]:.4g}, {0[5]:.4g} kg·m²", one.moments, two.moments)
            yield _Fact("moments of inertia of link", names, values, _apart(*traces), place)

    def of_structure(self) -> Iterator[_Fact]:
        """Types and parents of joints, which of them are actuated, and closures."""
        yield from self._of_closures()
        actuated = set(self._mechanism.actuators)
        for one, two in self._pairs:
            names, place = (one.name, two.name), partial(self._place_of_joint, one.name)
            yield _Fact("type of joint", names, (one.type, two.type), float(one.type != two.type), place)
            parents = f"'{one.parent}'", f"'{two.parent}'"
            same = self._image.get(one.parent, one.parent) == two.parent
            yield _Fact("parent of joint", names, parents, float(not same), partial(self._place_in_urdf, one.name))
            if actuated and not one.type.is_fixed:
                a, b = ("an actuator" if name in actuated else "no actuator" for name in names)
                yield _Fact("role of joint", names, (a, b), float(a != b), self._place_of_actuators)

    def of_origins(self) -> Iterator[_Fact]:
        """Origins and axes of joints, and frames of closures."""
        yield from self._in_closures()
        for one, two in self._pairs:
            names, place = (one.name, two.name), partial(self._place_in_urdf, one.name)
            bodies, points = (one.parent, two.parent), (one.placement.xyz, two.placement.xyz)
            yield self._point("origin of joint", names, bodies, points, place)
            for axes in zip(one.axes, two.axes, strict=False) if one.type == two.type else ():
                a, b = (self._axis(joint, axis) for joint, axis in zip((one, two), axes, strict=True))
                image = self._mirrored(a, self._across)
                off = min(math.dist(image, b), math.dist(image, [-value for value in b]))
                yield _Fact("axis of joint", names, _texts("{}", *map(_vector, axes)), 0.0, place, off, one.parent)

    def of_joints(self) -> Iterator[_Fact]:
        """Ranges, mimic joints, and what else is stated of joints."""
        for one, two in self._pairs:
            names, place = (one.name, two.name), partial(self._place_of_joint, one.name)
            if one.type != two.type or one.type.is_fixed:
                continue
            unit = "m" if one.type.slides else "rad"
            for c, d in zip(one.ranges, two.ranges, strict=True):
                widths = c[1] - c[0], d[1] - d[0]  # the zero of a side may be elsewhere
                values = _texts("{0[0]:.4g} to {0[1]:.4g} " + unit, c, d)
                yield _Fact("range of joint", names, values, _apart(*widths), place)
            if one.mimic is not None or two.mimic is not None:
                a, b = (each.mimic or Mimic("", 0.0) for each in (one, two))
                factors = _apart(abs(a.multiplier), abs(b.multiplier)), _apart(abs(a.offset), abs(b.offset))
                difference = max(factors) if self.joints.get(a.joint, a.joint) == b.joint else 1.0
                values = _texts("{0.multiplier:g} · '{0.joint}' + {0.offset:g}", a, b)
                yield _Fact("<mimic> of joint", names, values, difference, place)
            for name, units in _PROPERTIES.items():
                of_one, of_two = getattr(one.properties, name), getattr(two.properties, name)
                if any(of_one) or any(of_two):
                    size = max(len(of_one), len(of_two))
                    pairs = zip(map(abs, of_one or (0.0,) * size), map(abs, of_two or (0.0,) * size), strict=True)
                    form = f"{{}} {units[one.type.slides]}".rstrip()
                    values = _texts(form, *(" ".join(f"{v:g}" for v in each) or "0" for each in (of_one, of_two)))
                    yield _Fact(f"{name.replace('_', ' ')} of joint", names, values, max(starmap(_apart, pairs)), place)

    def _of_closures(self) -> Iterator[_Fact]:
        """Which closures there are, their types, and the links that they join."""
        for one, two in self._closures():
            place = partial(self._read.place_of_constraint, one.name)
            links = _links(one)
            if two is None:
                names = _texts("{}", *(" and ".join(sorted(each)) for each in (links, self._mirrored_links(links))))
                yield _Fact("closure of links", names, (f"'{one.name}'", "missing"), 1.0, place)
                continue
            names = one.name, two.name
            yield _Fact("type of closure", names, (one.type, two.type), float(one.type != two.type), place)
            values = _texts("{}", *(" and ".join(f"'{a.body}'" for a in each.anchors) for each in (one, two)))
            difference = float(self._mirrored_links(links) != _links(two))
            yield _Fact("pair of links of closure", names, values, difference, place)

    def _in_closures(self) -> Iterator[_Fact]:
        """Frames and numbers of closures that join mirrored links."""
        for one, two in self._closures():
            if two is None or one.type != two.type or self._mirrored_links(_links(one)) != _links(two):
                continue
            names, place = (one.name, two.name), partial(self._read.place_of_constraint, one.name)
            others = two.anchors if self._image.get(one.a.body, one.a.body) == two.a.body else two.anchors[::-1]
            for a, b in zip(one.anchors, others, strict=True):
                yield self._point("frame of closure", names, (a.body, b.body), (a.pose.xyz, b.pose.xyz), place)
            for key, value in one.own.items():
                if isinstance(value, float):
                    values, difference = _texts("{:.6g} m", value, two.own[key]), _apart(value, two.own[key])
                    yield _Fact(f"{key} of closure", names, values, difference, place)

    def _closures(self) -> Iterator[tuple[Closure, Closure | None]]:
        """The closures of one side with those of the other, by name or by the links that they join."""
        closures = self._mechanism.closures
        by_links: dict[frozenset[str], list[Closure]] = defaultdict(list)
        for closure in closures:
            by_links[_links(closure)].append(closure)
        named = {each.name: each for each in closures}
        image = mirrored_names(named)
        done: set[str] = set()
        for one in closures:
            links = _links(one)
            mirrored = self._mirrored_links(links)
            if mirrored == links or one.name in done:
                continue
            alike = by_links.get(mirrored, [])
            two = named.get(image.get(one.name, "")) or (alike[0] if len(alike) == len(by_links[links]) == 1 else None)
            if two is not None:
                done.add(two.name)
            if two is not None or not alike:
                yield one, two

    def _mirrored_links(self, links: frozenset[str]) -> frozenset[str]:
        return frozenset(self._image.get(link, link) for link in links)

    def _point(
        self,
        what: str,
        names: tuple[str, str],
        bodies: tuple[str, str],
        points: tuple[Vector3, Vector3],
        place: Callable[[], Place],
    ) -> _Fact:
        """A fact about two points, each in the frame of its body."""
        a, b = (self._pose[body].rotate(point) for body, point in zip(bodies, points, strict=True))
        return _Fact(what, names, _at(*points), self._lengths(a, b), place, self._off(a, b, self._across), bodies[0])

    def _axis(self, joint: Joint, axis: Vector3) -> Vector3:
        return (self._pose[joint.parent] * joint.placement).rotate(direction(axis))

    def _scale(self, a: Vector3, b: Vector3) -> float:
        return max(math.hypot(*a), math.hypot(*b), self._short) or 1.0

    def _lengths(self, a: Vector3, b: Vector3) -> float:
        """Relative difference of the lengths of two vectors."""
        return abs(math.hypot(*a) - math.hypot(*b)) / self._scale(a, b)

    def _off(self, a: Vector3, b: Vector3, across: int) -> float:
        """Relative difference of a vector from the mirror image of another one."""
        return math.dist(self._mirrored(a, across), b) / self._scale(a, b)

    @staticmethod
    def _mirrored(vector: Vector3, across: int) -> list[float]:
        return [-value if index == across else value for index, value in enumerate(vector)]

    def _number_mirrored(self, across: int) -> int:
        """How many joints are mirrored along an axis of the root."""
        count = 0
        for one, two in self._pairs:
            a, b = (self._pose[joint.parent].rotate(joint.placement.xyz) for joint in (one, two))
            count += abs(a[across]) > self._short and self._off(a, b, across) <= _ROUNDING[0]
        return count

    def _place_of_link(self, name: str) -> Place:
        link = self._read.urdf.links[name]
        return self._read.urdf.document.place(link.element if link.inertial is None else link.inertial)

    def _place_in_urdf(self, name: str) -> Place:
        urdf = self._read.urdf
        return urdf.document.place(urdf.joints[name].element if name in urdf.joints else urdf.document.root)

    def _place_of_joint(self, name: str) -> Place:
        if name in self._entries:
            return self._read.description.document.place(self._entries[name].pointer, True)
        return self._place_in_urdf(name)

    def _place_of_actuators(self) -> Place:
        key = "name_mot" if self._mechanism.version == "1" else "actuators"
        return self._read.description.document.place((key,), True)


def _unlike(facts: Sequence[tuple[float, _Fact]], rule: _Rule) -> list[tuple[float, _Fact]]:
    """The facts whose difference, given with each, is large, where most agree."""
    pairs = {fact.names for _, fact in facts}
    for rounding in _ROUNDING:
        different = [each for each in facts if each[0] > rounding]
        unlike = {fact.names for _, fact in different}
        several = len(unlike) > 1
        if len(facts) - len(different) < _AGREEING or (
            several and len(pairs) - len(unlike) < rule.for_each * len(unlike)
        ):
            continue
        bound = max(_CLEAR * rounding, rule.several if several else rule.one)
        # Several that are stated the same are a copy, as of a gripper, rather than a mirror image.
        return [each for each in different if each[0] > bound and not (several and len(set(each[1].values)) == 1)]
    return []


def _links(closure: Closure) -> frozenset[str]:
    return frozenset(anchor.body for anchor in closure.anchors)


def _apart(a: float, b: float) -> float:
    """The relative difference of two numbers."""
    largest = max(abs(a), abs(b))
    return 0.0 if a == b else abs(a - b) / largest if math.isfinite(largest) else 1.0


def _texts(form: str, a: object, b: object) -> tuple[str, str]:
    return form.format(a), form.format(b)


def _at(a: Vector3, b: Vector3) -> tuple[str, str]:
    return _texts("at {} m", _vector(a), _vector(b))


def _vector(values: Iterable[float]) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
