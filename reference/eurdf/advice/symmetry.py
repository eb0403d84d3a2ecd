"""Advice on values that differ between left and right, of a robot that is else symmetric."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import starmap
from typing import NamedTuple

from eurdf.advice.mirrored_names import mirrored_names
from eurdf.advice.plausibility import place_of, reach_of
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

# Differences of lengths are relative to at least this part of how far the robot reaches from its root.
_SHORT = 0.02

# The text of a point.
_POINT = "[{}] m"

# Differences that are named.
_NAMED = 3


class _Family(NamedTuple):
    """Values that are about equally symmetric, and when a difference is reported.

    Attributes:
        name: Of the family.
        for_each: If several pairs differ, so many agree at least for each of them.
        one: The least difference, if one pair differs.
        several: The least difference, if several do.
    """

    name: str
    for_each: int = 4
    one: float = 0.0
    several: float = 0.0


# A wrong name makes two pairs differ. In published robots, the inertias of a few parts differ by so much.
_STRUCTURE, _PLACES, _NUMBERS = _Family("structure", 1), _Family("places"), _Family("numbers")
_INERTIA = _Family("inertia", 4, 0.1, 0.5)

# Numbers of joints, with their units where the joint turns and where it slides.
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
        family: What it is compared with.
        what: The quantity, and the kind of the things.
        names: Of the two things.
        values: Of each, with the form that makes a text of it, with the unit.
        difference: Relative difference, of what does not depend on how the frames of a side are chosen.
        place: Where the value of the first is stated.
        mirrored: Relative difference from the mirror image at neutral; None if the quantity has no direction.
        body: The first of the bodies in whose frames a direction is stated.
    """

    family: _Family
    what: str
    names: tuple[str, str]
    values: tuple[str, object, object]
    difference: float
    place: Callable[[], Place]
    mirrored: float | None = None
    body: str = ""

    def text(self, side: int) -> str:
        """The value of a side."""
        form, *values = self.values
        value = values[side]
        if isinstance(value, tuple) and form.startswith("["):
            value = ", ".join(f"{each:.6g}" for each in value)
        return form.format(value).rstrip()


def advise_on_symmetry(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report once what differs between left and right, where most values of its family agree."""
    sides = _Sides(read)
    if not sides.pairs:
        return
    families: dict[_Family, list[_Fact]] = defaultdict(list)
    for fact in (*sides.of_bodies(), *sides.of_joints(), *sides.of_closures(), *sides.of_couplings()):
        families[fact.family].append(fact)
    turned = sides.turned()
    found: dict[tuple[str, tuple[str, str]], tuple[float, _Fact]] = {}
    for family, facts in families.items():
        directed = [(f.mirrored, f) for f in facts if f.mirrored is not None and f.body not in turned]
        for each in (*_unlike(directed, family), *_unlike([(f.difference, f) for f in facts], family)):
            found.setdefault((each[1].what, each[1].names), each)
    if found:
        clearest = [fact for _, fact in sorted(found.values(), key=lambda each: -each[0])]
        told = [f"{f.what} '{f.names[0]}': {f.text(0)}, '{f.names[1]}': {f.text(1)}" for f in clearest[:_NAMED]]
        more = [f"{len(found) - _NAMED} more"] if len(found) > _NAMED else []
        diagnostics.report(
            "x-asymmetric",
            "left and right differ, although most of their values agree: " + "; ".join(told + more),
            clearest[0].place,
            "is that on purpose? 'eurdf check --ignore x-asymmetric' hides this warning",
        )


class _Sides:
    """Left and right of a robot: the pairs of joints, and the facts about the pairs."""

    def __init__(self, read: ReadRobot) -> None:
        self._read, self._mechanism = read, read.mechanism
        self._body = {body.name: body for body in read.mechanism.bodies}
        joints = self._joint = {joint.name: joint for joint in read.mechanism.joints}
        self._image, self._of_joint = mirrored_names(self._body), mirrored_names(joints)
        self.pairs = [(joints[name], joints[other]) for name, other in self._of_joint.items() if name < other]
        self._short = _SHORT * reach_of(read.mechanism)
        self._pose = {read.mechanism.bodies[0].name: IDENTITY}  # at neutral, in the root
        for joint in read.mechanism.joints if self.pairs else ():
            self._pose[joint.child] = self._pose[joint.parent] * joint.placement * joint.offset
        # Points of both sides, seen in the root: the origins of joints, later also the centres of mass.
        self._points = [
            (one.parent, *self._rotated(one.parent, one.placement.xyz, two.parent, two.placement.xyz))
            for one, two in self.pairs
        ]
        # The axis of the root along which left and right are mirrored is that which suits most of them.
        number = Counter({1: 0, 0: 0, 2: 0})
        for self._across in number:
            near = (abs(a[self._across]) > self._short and self._off(a, b) <= _ROUNDING[0] for _, a, b in self._points)
            number[self._across] = sum(near)
        self._across = number.most_common(1)[0][0]

    def turned(self) -> set[str]:
        """Bodies in whose frames most points are not mirrored: they are turned against their images at neutral."""
        count: Counter[str] = Counter()
        for body, a, b in self._points:
            if body in self._image and math.hypot(*a) > self._short:
                count[body] += 1 if self._off(a, b) > _CLEAR * _ROUNDING[0] else -1
        return {body for body, more in count.items() if more > 0}

    def of_bodies(self) -> Iterator[_Fact]:
        """Masses, centres of mass and moments of inertia."""
        links = self._read.urdf.links
        for body in self._mechanism.bodies:
            other = self._image.get(body.name, "")
            if not body.name < other or not {body.name, other} <= links.keys():
                continue
            link, one, two = links[body.name], body.inertia, self._body[other].inertia
            place = partial(self._read.urdf.document.place, link.element if link.inertial is None else link.inertial)
            fact = partial(_Fact, _INERTIA, names=(body.name, other), place=place)
            masses = [0.0 if each is None else each.mass for each in (one, two)]
            yield fact("mass of link", values=("{:.6g} kg", masses[0], masses[1]), difference=_apart(*masses))
            if one is not None and two is not None:
                points, (a, b) = (one.pose.xyz, two.pose.xyz), (one.moments, two.moments)
                self._points.append((body.name, *self._rotated(body.name, points[0], other, points[1])))
                off = self._off(*self._points[-1][1:])
                mirrored = off if points[0] != points[1] or off <= _ROUNDING[0] else None  # a copy
                point, apart = (_POINT, *points), self._lengths(*points)
                yield fact("centre of mass of link", values=point, difference=apart, mirrored=mirrored, body=body.name)
                values = "{0[0]:.4g}, {0[3]:.4g}, {0[5]:.4g} kg·m²", a, b
                traces = [each[0] + each[3] + each[5] for each in (a, b)]
                yield fact("moments of inertia of link", values=values, difference=_apart(*traces))

    def of_joints(self) -> Iterator[_Fact]:
        """Facts about joints, except the fixed ones that carry neither a joint that moves nor a closure.

        Those may be sensors of one side.
        """
        carrying = {anchor.body for closure in self._mechanism.closures for anchor in closure.anchors}
        for joint in reversed(self._mechanism.joints):
            if not joint.type.is_fixed or joint.child in carrying:
                carrying.update((joint.parent, joint.child))
        actuated = set(self._mechanism.actuators)
        for one, two in self.pairs:
            if one.child not in carrying:
                continue
            names, place = (one.name, two.name), partial(place_of, self._read, one.name)
            fact = partial(_Fact, _STRUCTURE, names=names, place=place)
            yield fact("type of joint", values=("{}", one.type, two.type), difference=float(one.type != two.type))
            parents = "'{}'", one.parent, two.parent
            same = self._image.get(one.parent, one.parent) == two.parent
            yield fact("parent of joint", values=parents, difference=float(not same))
            points = one.placement.xyz, two.placement.xyz
            yield self._point("origin of joint", names, (one.parent, two.parent), points, place)
            if one.type != two.type or one.type.is_fixed:
                continue
            if actuated:
                a, b = ("an actuator" if name in actuated else "no actuator" for name in names)
                description = self._read.description
                place = partial(description.document.place, (description.actuators_key,), True)
                yield _Fact(_STRUCTURE, "role of joint", names, ("{}", a, b), float(a != b), place)
            yield from self._of_pair(one, two)

    def _of_pair(self, one: Joint, two: Joint) -> Iterator[_Fact]:
        """The axes and numbers of two joints of one type, and which joints they mimic."""
        names, slides = (one.name, two.name), one.type.slides
        for axes in zip(one.axes, two.axes, strict=True):
            a, b = (
                (self._pose[joint.parent] * joint.placement).rotate(direction(axis))
                for joint, axis in zip((one, two), axes, strict=True)
            )
            image = self._mirrored(a)
            off = min(math.dist(image, b), math.dist(image, [-value for value in b]))
            place = partial(place_of, self._read, one.name)
            yield _Fact(_PLACES, "axis of joint", names, ("[{}]", *axes), 0.0, place, off, one.parent)
        if one.properties == two.properties and one.mimic is None and two.mimic is None:
            place = partial(place_of, self._read, one.name)
            # Ranges that are stated the same are a copy if they are not mirrored.
            mirrored = 0.0 if self._range_off(one, two) == 0.0 else None
            yield _Fact(_NUMBERS, "numbers of joint", names, ("", 0, 0), 0.0, place, mirrored, one.parent)
            return
        values: tuple[str, object, object]
        for c, d in zip(one.ranges, two.ranges, strict=True):
            widths = c[1] - c[0], d[1] - d[0]  # the zero of a side may be elsewhere
            values = "{0[0]:.4g} to {0[1]:.4g} " + ("m" if slides else "rad"), c, d
            place = partial(place_of, self._read, one.name, "upper")
            yield _Fact(
                _NUMBERS, "range of joint", names, values, _apart(*widths), place, self._range_off(one, two), one.parent
            )
        if one.mimic is not None or two.mimic is not None:
            e, f = (each.mimic or Mimic("", 0.0) for each in (one, two))
            factors = _apart(abs(e.multiplier), abs(f.multiplier)), _apart(abs(e.offset), abs(f.offset))
            difference = max(factors) if self._of_joint.get(e.joint, e.joint) == f.joint else 1.0
            values = "{0.multiplier:g} · '{0.joint}' + {0.offset:g}", e, f
            place = partial(place_of, self._read, one.name, "mimic")
            yield _Fact(_NUMBERS, "<mimic> of joint", names, values, difference, place)
        for name, units in _PROPERTIES.items():
            g, h = getattr(one.properties, name), getattr(two.properties, name)
            if any(g) or any(h):
                size = max(len(g), len(h))
                pairs = zip(map(abs, g or (0.0,) * size), map(abs, h or (0.0,) * size), strict=True)
                values = (
                    f"[{{}}] {units[slides]}" if size > 1 else f"{{0[0]:g}} {units[slides]}",
                    g or (0.0,),
                    h or (0.0,),
                )
                what, place = f"{name.replace('_', ' ')} of joint", partial(place_of, self._read, one.name, name)
                yield _Fact(_NUMBERS, what, names, values, max(starmap(_apart, pairs)), place)

    def _range_off(self, one: Joint, two: Joint) -> float | None:
        """Relative difference of a range from the mirrored one; None if either is not known."""
        if not (sense := self._sense(one, two)):
            return None
        (lower, upper), other = one.ranges[0], two.ranges[0]
        image = (lower, upper) if sense > 0.0 else (-upper, -lower)
        size = max(map(abs, image + other))
        return math.dist(image, other) / (size or 1.0) if math.isfinite(size) else None

    def of_closures(self) -> Iterator[_Fact]:
        """Which closures there are, by name or by the links that they join, and their types, frames and lengths."""
        closures = self._mechanism.closures
        alike: dict[frozenset[str], list[Closure]] = defaultdict(list)
        for closure in closures:
            alike[frozenset(anchor.body for anchor in closure.anchors)].append(closure)
        named = {each.name: each for each in closures}
        image = mirrored_names(named)
        done: set[str] = set()
        for one in closures:
            links = frozenset(anchor.body for anchor in one.anchors)
            mirrored = frozenset(self._image.get(link, link) for link in links)
            if mirrored == links or one.name in done:
                continue
            place = partial(self._read.place_of_constraint, one.name)
            same = alike.get(mirrored, [])
            two = named.get(image.get(one.name, "")) or (same[0] if len(same) == len(alike[links]) == 1 else None)
            if two is None:
                if not same:
                    names = " and ".join(sorted(links)), " and ".join(sorted(mirrored))
                    yield _Fact(_STRUCTURE, "closure of links", names, ("{}", f"'{one.name}'", "missing"), 1.0, place)
                continue
            done.add(two.name)
            names = one.name, two.name
            kinds = "{0.type} of '{0.a.body}' and '{0.b.body}'", one, two
            is_same = one.type == two.type and two in same
            yield _Fact(_STRUCTURE, "closure", names, kinds, float(not is_same), place)
            if not is_same:
                continue
            others = two.anchors if self._image.get(one.a.body, one.a.body) == two.a.body else two.anchors[::-1]
            for a, b in zip(one.anchors, others, strict=True):
                yield self._point("frame of closure", names, (a.body, b.body), (a.pose.xyz, b.pose.xyz), place)
            for key, value in one.own.items():
                if isinstance(value, float):
                    values, difference = ("{:.6g} m", value, two.own[key]), _apart(value, two.own[key])
                    yield _Fact(_PLACES, f"{key} of closure", names, values, difference, place)

    def of_couplings(self) -> Iterator[_Fact]:
        """Their joints, and coefficients up to a common factor; without signs where axes are not mirrored."""
        couplings = {each.name: each for each in self._mechanism.couplings}
        for name, other in mirrored_names(couplings).items():
            if not name < other:
                continue
            one, two = (dict(couplings[each].coefficients) for each in (name, other))
            image = {self._of_joint.get(joint, joint): joint for joint in one}
            difference = 1.0
            if image.keys() == two.keys():
                senses = {joint: self._sense(self._joint[image[joint]], self._joint[joint]) for joint in two}
                # A joint of the middle is not mirrored: it only says how far both sides move.
                known = all(senses.values()) and image.keys().isdisjoint(one)
                c, d = (
                    [(value if known else abs(value)) / (math.hypot(*each) or 1.0) for value in each]
                    for each in ([one[image[joint]] * (senses[joint] or 1.0) for joint in two], list(two.values()))
                )
                difference = min(math.dist(c, d), math.dist(c, [-value for value in d]))
            a, b = (" ".join(f"{value:+g} · '{joint}'" for joint, value in each.items()) for each in (one, two))
            place = partial(self._read.place_of_constraint, name)
            yield _Fact(_STRUCTURE, "coupling", (name, other), ("{}", a, b), difference, place)

    def _sense(self, one: Joint, two: Joint) -> float:
        """Of two joints with one axis: 1 if the same value is the mirrored motion at neutral, -1 if the opposite is.

        0 if their axes are not mirrored.
        """
        if len(one.axes) != 1 or one.type != two.type:
            return 0.0
        a, b = ((self._pose[each.parent] * each.placement).rotate(direction(each.axes[0])) for each in (one, two))
        image = self._mirrored(a)
        for sense in (1.0, -1.0):
            if math.dist(image, [sense * value for value in b]) <= _ROUNDING[0]:
                return sense if one.type.slides else -sense
        return 0.0

    def _point(
        self,
        what: str,
        names: tuple[str, str],
        bodies: tuple[str, str],
        points: tuple[Vector3, Vector3],
        place: Callable[[], Place],
    ) -> _Fact:
        """A fact about two points, each in the frame of its body."""
        a, b = self._rotated(bodies[0], points[0], bodies[1], points[1])
        return _Fact(_PLACES, what, names, (_POINT, *points), self._lengths(a, b), place, self._off(a, b), bodies[0])

    def _rotated(self, body: str, point: Vector3, other: str, image: Vector3) -> tuple[Vector3, Vector3]:
        return self._pose[body].rotate(point), self._pose[other].rotate(image)

    def _lengths(self, a: Vector3, b: Vector3) -> float:
        """Relative difference of the lengths of two vectors."""
        return abs(math.hypot(*a) - math.hypot(*b)) / self._scale(a, b)

    def _off(self, a: Vector3, b: Vector3) -> float:
        """Relative difference of a vector from the mirror image of another one."""
        return math.dist(self._mirrored(a), b) / self._scale(a, b)

    def _scale(self, a: Vector3, b: Vector3) -> float:
        return max(math.hypot(*a), math.hypot(*b), self._short) or 1.0

    def _mirrored(self, vector: Vector3) -> list[float]:
        return [-value if index == self._across else value for index, value in enumerate(vector)]


def _unlike(facts: Sequence[tuple[float, _Fact]], family: _Family) -> list[tuple[float, _Fact]]:
    """The facts whose difference, given with each, is large, where most agree."""
    count = len({fact.names for _, fact in facts})
    for rounding in _ROUNDING:
        different = [each for each in facts if each[0] > rounding]
        unlike = len({fact.names for _, fact in different})
        several = unlike > 1
        enough = len(facts) - len(different) >= _AGREEING
        if enough and (not several or count - unlike >= family.for_each * unlike):
            bound = max(_CLEAR * rounding, family.several if several else family.one)
            # Several that are stated the same are a copy, as of a gripper, rather than a mirror image.
            return [
                (difference, fact)
                for difference, fact in different
                if difference > bound and not (several and fact.values[1] == fact.values[2])
            ]
    return []


def _apart(a: float, b: float) -> float:
    """The relative difference of two numbers."""
    largest = max(abs(a), abs(b))
    return 0.0 if a == b else abs(a - b) / largest if math.isfinite(largest) else 1.0
