"""Closures, motors, spherical and universal joints from the names in a URDF."""

from __future__ import annotations

import re
import shlex
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, cast

from eurdf.format.conventions import is_own_key
from eurdf.format.urdf.data import Urdf
from eurdf.format.yaml_text import Value
from eurdf.linking.merging import MASSLESS
from eurdf.mechanism.joint_types import ROTARY
from eurdf.mechanism.pose import Vector3
from eurdf.mechanism.spanning_tree import rigid_roots

#: The types of closure that are chosen between.
ClosureType = Literal["3d", "6d"]

#: The versions of a description that is generated.
GeneratedVersion = Literal["1", "2", "2.1"]


def _atomic(pattern: str) -> str:
    """Match in one way only, as ``(?>…)`` of Python 3.11 does: it bounds the attempts to match a name of any length."""
    return rf"(?=(?P<atom>{pattern}))(?P=atom)"


_LOOP_WORD = _atomic(r".*(?:closed_?loop|fermeture)")
_SIDE = r"(?:[_.-]|(?<=\d))(?P<side>[ab])"

#: ``closedloop1_A`` and ``closedloop1_B``, ``closedloop3D_1A``, ``closed_loop_knee_a``; and with ``_frame`` behind it,
#: the joint that some exporters fix such a link by.
PUBLISHED_CLOSURE = rf"(?is)(?P<loop>{_LOOP_WORD}(?:_?(?P<type>[36]d))?.*){_SIDE}(?:_frame)?"

#: ``closedloop0_A_3D`` and ``closedloop0_B_3D``: the type last.
TYPE_LAST_CLOSURE = rf"(?is)(?P<loop>{_LOOP_WORD}.*){_SIDE}_?(?P<type>[36]d)(?:_frame)?"

#: ``closing_knee_1`` and ``closing_knee_2``, as onshape-to-robot names the frames of a mate ``closing_knee``; and
#: ``closing_knee_1_z`` and ``closing_knee_2_z``, on the axis of a mate that is revolute.
MATE_CLOSURE = rf"(?s)(?P<loop>{_atomic('.*closing_')}.+)_(?P<side>[12])(?P<axis>_z)?(?:_frame)?"

#: A pattern of closures, as the user writes it on the command line.
EXAMPLE_CLOSURE = r"--closure '(?P<loop>rod\d+)_(?P<side>top|bottom)'"

_WHERE = r"left|right|front|rear|back|hind|upper|lower|inner|outer|[lr]|[frhb][lr]|[lr][frhb]"

#: Names that begin with the word ``mot`` or ``motor``, but for where it is on the robot: ``motor_knee``, ``mot1_rod2``
#: and ``left_motor_ankle``, but not ``moteur_rod`` or ``free_motor_holder``.
MOTOR = rf"(?i)^(?:(?:{_WHERE})\d*[_.-])*mot(?:or)?(?![^\W\d_])"

#: Names that end with the word, numbers and ``joint`` aside: ``left_knee_motor``, ``ankle_motor_2_joint``.
MOTOR_LAST = r"(?i)^(?!(?:free|passive|frame|fixed)[_.-]).*(?<![^\W_])mot(?:or)?[_.-]?\d*(?:[_.-]joint)?$"

#: Names that have the word in them.
SPHERICAL = r"(?i)spherical|to_rotule"

# As onshape-to-robot names the three revolutes of a ball mate: the names of the two parts, and a number.
_OF_BALL = re.compile(r"(?s)(.*_rev)[012]")


class BadPattern(ValueError):  # noqa: N818 - shown to the user as it is
    """A pattern that is no regular expression, or lacks a group or axes; its text says which."""


@dataclass(frozen=True, slots=True)
class Conventions:
    """Regular expressions (Python syntax) that give the meaning of a name.

    Attributes:
        closures: Match the whole name of a link or a joint, which then is one frame of a closure. The group ``side``
            distinguishes frames A and B; the one that sorts first is A. The group ``loop``, or else the name without
            its side, is common to both frames and names the closure. If the group ``type`` matches ``3d`` or ``6d``, in
            any case, it is the type of the closure. If the group ``axis`` matches, the frame is a second one on the
            axis of the loop's hinge.
        motors: Matches a part of the name of an actuated joint.
        sphericals: Matches a part of the name of a joint that is spherical, not revolute.
        universals: Matches a part of the name of a joint that is universal; and its axes, such as ``xy``.
    """

    closures: tuple[re.Pattern[str], ...]
    motors: tuple[re.Pattern[str], ...]
    sphericals: tuple[re.Pattern[str], ...]
    universals: tuple[tuple[re.Pattern[str], str], ...] = ()


def conventions(
    closures: Sequence[str] = (),
    motors: Sequence[str] = (),
    sphericals: Sequence[str] = (),
    universals: Sequence[str] = (),
) -> Conventions:
    """The user's conventions; of a kind that has none, the published ones, which say nothing of universal joints.

    Raises:
        BadPattern: Not a regular expression, one of a closure without the group ``side``, or one of a universal joint
            without its axes, as in ``xy=PATTERN``.
    """
    closing = tuple(map(_compiled, closures or (PUBLISHED_CLOSURE, TYPE_LAST_CLOSURE, MATE_CLOSURE)))
    for pattern in closing:
        if "side" not in pattern.groupindex:
            raise BadPattern(
                f"the closure pattern '{pattern.pattern}' has no group 'side', which distinguishes its two frames: "
                r"for instance '(?P<loop>loop\d+)_(?P<side>A|B)'"
            )
    turning = []
    for given in universals:
        axes, _, names = given.partition("=")
        if not re.fullmatch("[xyz]{2}", axes) or axes[0] == axes[1]:
            raise BadPattern(
                f"'{given}' states no axes of universal joints; write the letters of the two axes in the joint's frame "
                f"before the pattern: 'xy={given}'"
            )
        turning.append((_compiled(names), axes))
    return Conventions(
        closing,
        tuple(map(_compiled, motors or (MOTOR, MOTOR_LAST))),
        tuple(map(_compiled, sphericals or (SPHERICAL,))),
        tuple(turning),
    )


def _compiled(pattern: str) -> re.Pattern[str]:
    try:
        return re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        raise BadPattern(f"'{pattern}' is not a regular expression: {error}") from None


@dataclass(frozen=True, slots=True)
class NamedClosure:
    """A closure that two names say.

    Attributes:
        name: What its frames have in common.
        type: None where the names do not state it.
        frames: Names of frame A and frame B.
        hinge: Whether the names say that it is one of two that hold a hinge: a point on its axis, and a second one.
        axes: Of type hinge, the unit vectors of its axis in A and in B.
    """

    name: str
    type: ClosureType | Literal["hinge"] | None
    frames: tuple[str, str]
    hinge: bool = False
    axes: tuple[Vector3, Vector3] | None = None

    @property
    def axis_keys(self) -> dict[str, Value]:
        """The keys of a hinge that state its axis."""
        if self.axes is None:
            return {}
        a, b = ([int(number) if number.is_integer() else number for number in axis] for axis in self.axes)
        return {"axis": a} if a == b else {"axes": [a, b]}


@dataclass(frozen=True, slots=True)
class Found:
    """What the names in a URDF say.

    Attributes:
        closures: By the names of their loops, numbers in them sorted as numbers.
        motors: Actuated joints, in the order of the tree.
        sphericals: Spherical joints, in the order of the tree.
        warnings: Names that could not be used, one sentence each.
        universals: The axes of each universal joint, such as ``xy``.
    """

    closures: tuple[NamedClosure, ...]
    motors: tuple[str, ...]
    sphericals: tuple[str, ...]
    warnings: tuple[str, ...]
    universals: Mapping[str, str] = field(default_factory=dict)


def find(urdf: Urdf, convention: Conventions) -> Found:
    """Look for names that follow the conventions."""
    warnings: list[str] = []
    closures = tuple(_closures(urdf, convention.closures, warnings))
    motors = tuple(named_motors(urdf, convention.motors, warnings))
    universals: dict[str, str] = {}
    for pattern, axes in convention.universals:
        universals |= dict.fromkeys(_replaced(urdf, (pattern,), "universal", warnings, universals), axes)
    sphericals = tuple(_replaced(urdf, convention.sphericals, "spherical", warnings, universals))
    return Found(closures, motors, sphericals, tuple(warnings), universals)


def with_type(found: Found, closure_type: ClosureType) -> Found:
    """Give every closure one type. A 6d closure holds a hinge by one point: the second one would be redundant."""
    second = {f"{closure.name}_z" for closure in found.closures if closure.hinge}
    closures = tuple(
        replace(closure, type=closure_type, hinge=False)
        for closure in found.closures
        if not (closure_type == "6d" and closure.hinge and closure.name in second)
    )
    return replace(found, closures=closures)


# -- closures -----------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class _NamedLoop:
    """What names state of one loop.

    Attributes:
        sides: For each side, the names of links and joints.
        types: Those that the names state.
        axis_of: Name of the loop that it is the axis of, where it is a second point on a hinge.
    """

    sides: dict[str, list[str]] = field(default_factory=dict)
    types: set[ClosureType] = field(default_factory=set)
    axis_of: str | None = None


def _closures(urdf: Urdf, patterns: Iterable[re.Pattern[str]], warnings: list[str]) -> list[NamedClosure]:
    bodies = {name: name for name in urdf.links}
    for joint in urdf.joints.values():
        bodies.setdefault(joint.name, joint.child)
    loops = _loops(bodies, patterns)
    rigid = rigid_roots(urdf.root, urdf.walk())
    joined: dict[frozenset[str], str] = {}
    paired: list[NamedClosure] = []
    for name in sorted(loops, key=_natural):
        loop = loops[name]
        if len(loop.sides) != 2:
            warnings.append(_unpaired(name, loop.sides))
            continue
        frames = [_frame(name, side, loop.sides[side], bodies, warnings) for side in sorted(loop.sides, key=_natural)]
        a, b = bodies[frames[0]], bodies[frames[1]]
        if rigid[a] == rigid[b]:
            warnings.append(
                f"'{frames[0]}' and '{frames[1]}' are fixed to each other and cannot be a closure: left out"
            )
        elif (pair := frozenset({a, b})) in joined:
            warnings.append(f"'{frames[0]}' and '{frames[1]}' are the two frames of '{joined[pair]}' already: left out")
        else:
            joined[pair] = name
            if len(loop.types) > 1:
                warnings.append(f"the names of loop '{name}' state both 3d and 6d, so neither is used")
            type_ = next(iter(loop.types)) if len(loop.types) == 1 else None
            paired.append(NamedClosure(name, type_, (frames[0], frames[1])))
    names = {closure.name for closure in paired}
    hinges = {
        each
        for name in names
        if (point := loops[name].axis_of) is not None and point in names
        for each in (name, point)
    }
    # Two points hold a hinge, each in position alone.
    return [replace(closure, type="3d", hinge=True) if closure.name in hinges else closure for closure in paired]


def _loops(names: Iterable[str], patterns: Iterable[re.Pattern[str]]) -> dict[str, _NamedLoop]:
    """The loops that names of links and joints say, links first: of a link and the joint that fixes it, it is meant."""
    loops: dict[str, _NamedLoop] = {}
    for pattern in patterns:
        for name in names:
            match = pattern.fullmatch(name)
            if match is None or match["side"] is None:
                continue
            groups = match.groupdict()
            point = _loop(match)
            loop = loops.setdefault(point + (groups.get("axis") or ""), _NamedLoop())
            if groups.get("axis"):
                loop.axis_of = point
            side = loop.sides.setdefault(match["side"].upper(), [])
            if name not in side:
                side.append(name)
            stated = (groups.get("type") or "").lower()
            if stated in ("3d", "6d"):
                loop.types.add(cast(ClosureType, stated))
    return loops


def _frame(loop: str, side: str, names: Sequence[str], bodies: Mapping[str, str], warnings: list[str]) -> str:
    """The name that is taken for the frame of one side."""
    if len({bodies[name] for name in names}) > 1:
        others = ", ".join(f"'{name}'" for name in names[1:])
        warnings.append(f"side {side} of loop '{loop}' is taken to be '{names[0]}'; it might be {others}")
    return names[0]


def _loop(match: re.Match[str]) -> str:
    if "loop" in match.re.groupindex and match["loop"]:
        return match["loop"]
    begin, end = match.span("side")
    return (match.string[:begin] + match.string[end:]).strip("_.-") or match.string


def _unpaired(loop: str, sides: Mapping[str, Sequence[str]]) -> str:
    names = ", ".join(f"'{names[0]}'" for names in sides.values())
    if len(sides) == 1:
        return f"{names} has no other side: a closure has two frames; left out"
    return f"loop '{loop}' has {len(sides)} sides, {names}: a closure has two frames; left out"


def _natural(name: str) -> list[tuple[int, str]]:
    """Sorts loop2 before loop10, by the length of a number before its digits."""
    parts = re.split(r"(\d+)", name)
    return [(len(part.lstrip("0")), part.lstrip("0")) if index % 2 else (-1, part) for index, part in enumerate(parts)]


# -- joints -------------------------------------------------------------------------------------------------------


def named_motors(urdf: Urdf, patterns: Sequence[re.Pattern[str]], warnings: list[str]) -> list[str]:
    """The joints that patterns name as motors; why others are left out is added to the warnings."""
    named = [joint for joint in urdf.walk() if any(pattern.search(joint.name) for pattern in patterns)]
    if tuple(patterns) == conventions().motors:  # names of parts, which may be motors, are no names of joints
        named = [joint for joint in named if not _is_of_ball(joint.name, urdf)]
    motors = []
    for joint in named:
        if joint.type.is_fixed:
            warnings.append(f"joint '{joint.name}' is named as a motor, but is fixed: left out")
        elif joint.mimic is not None:
            warnings.append(f"joint '{joint.name}' is named as a motor, but mimics '{joint.mimic.joint}': left out")
        else:
            motors.append(joint.name)
    return motors


def _is_of_ball(name: str, urdf: Urdf) -> bool:
    match = _OF_BALL.fullmatch(name)
    return match is not None and all(f"{match[1]}{number}" in urdf.joints for number in range(3))


def mimic_pairs(urdf: Urdf) -> set[str]:
    """Names of the joints that mimic others, and of those that they mimic."""
    return {name for joint in urdf.joints.values() if joint.mimic for name in (joint.name, joint.mimic.joint)}


def _replaced(
    urdf: Urdf, patterns: Sequence[re.Pattern[str]], kind: str, warnings: list[str], others: Container[str]
) -> Iterable[str]:
    """Names of joints that become of another kind, without others that are given."""
    coupled = mimic_pairs(urdf)
    for joint in urdf.walk():
        if joint.name in others or not any(pattern.search(joint.name) for pattern in patterns):
            continue
        if joint.type not in ROTARY:
            why = f"is {joint.type}, and only a revolute joint becomes {kind}"
        elif joint.name in coupled:
            why = "mimics or is mimicked"
        elif is_own_key(joint.name):
            why = "begins with 'x-', which is reserved for user data"
        else:
            yield joint.name
            continue
        warnings.append(f"joint '{joint.name}' is named as {kind}, but {why}: left out")


# -- hints --------------------------------------------------------------------------------------------------------


def hints(urdf: Urdf, found: Found, convention: Conventions) -> tuple[str, ...]:
    """How to get closures, or motors, where the names say none: one sentence each, with names of this robot."""
    said = []
    if not found.closures:
        why = "no two links or joints are named as the frames of a closure"
        if convention.closures != conventions().closures:
            why = "no two names match a --closure pattern with different sides"
        carrying = {joint.parent for joint in urdf.joints.values()}
        ends = [
            name
            for name, link in urdf.links.items()
            if name not in carrying and (link.inertia is None or link.inertia.mass < MASSLESS)
        ]
        may_be = f"; links without mass at the ends of the tree, such frames perhaps: {_some(ends)}" if ends else ""
        said.append(
            f"{why}: name them closedloop1_A and closedloop1_B in CAD, or give a pattern of their names, such as "
            f"{EXAMPLE_CLOSURE}{may_be}"
        )
    if not found.motors:
        moving = [joint.name for joint in urdf.walk() if not joint.type.is_fixed and joint.mimic is None]
        why = "no joint is named as a motor"
        if convention.motors != conventions().motors:
            why = "no joint that can move matches a --motor pattern"
        if moving:
            likely = next((name for name in moving if "mot" in name.lower()), moving[0])
            said.append(
                f"{why}: give a pattern that is found in the names of the actuated joints, such as "
                f"--motor {shlex.quote(f'^{re.escape(likely)}$')}; the joints that move: {_some(moving)}"
            )
        else:
            said.append("no joint can be actuated: each is fixed or mimics another; change its type in the URDF")
    return tuple(said)


def _some(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")
