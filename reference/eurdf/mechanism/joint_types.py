"""The joint types of Extended URDF, a row each: how a joint of the type moves, and how it is written.

What else is to be known of a type follows from its row: poses and velocities, its parts in formats that lack the type,
which joints have limits, springs or couplings. Only how Pinocchio has it is a fact about Pinocchio.
"""

from __future__ import annotations

import sys
from enum import Enum
from typing import Any, Literal, NamedTuple

from eurdf.mechanism.pose import Vector3, X, Y, Z


class Step(NamedTuple):
    """An elementary motion of a joint.

    Attributes:
        kind: A turn about an axis, a slide along one, a screw, which does both, or the rotations of a ball.
        axis: Number of the axis among those of the joint, or a direction in the joint's frame.
    """

    kind: Literal["turn", "slide", "screw", "ball"]
    axis: int | Vector3 = 0


class _Row(NamedTuple):
    text: str
    coordinates: tuple[str, ...] = ()
    steps: tuple[Step, ...] = ()
    moving_frame: bool = False
    limited: bool = True
    replaces: frozenset[str] = frozenset()


_TURN, _SLIDE, _BALL = Step("turn"), Step("slide"), Step("ball")

#: The types of URDF that turn about one axis, and those that slide along one.
ROTARY, SLIDING = frozenset({"revolute", "continuous"}), frozenset({"prismatic"})


class JointType(str, Enum):
    """URDF's own joint types and the four that it lacks.

    Attributes:
        coordinates: One name for each number in files: angles in rad, lengths in m, a unit quaternion x y z w.
        steps: The elementary motions, from the parent to the child; slides come before turns. Each has a number in
            files, and a velocity; a ball has four and three.
        moving_frame: Whether its velocity is that of the child, in the child's axes, and not the rates of its
            coordinates (EU-JNT-026).
        limited: Whether limits can bound its coordinates (EU-JNT-009).
        replaces: The types of URDF that a description may make a joint of this type of (EU-JNT-005); none for
            URDF's own types.
        nv: Number of velocities.
        neutral: The coordinates at which child and joint frame coincide.
        quaternion: Index of the first of the quaternion's four numbers, or None.
        is_fixed: Whether it has no motion.
    """

    _value_: str
    coordinates: tuple[str, ...]
    steps: tuple[Step, ...]
    moving_frame: bool
    limited: bool
    replaces: frozenset[str]
    nv: int
    neutral: tuple[float, ...]
    quaternion: int | None
    is_fixed: bool

    FIXED = _Row("fixed")
    REVOLUTE = _Row("revolute", ("angle",), (_TURN,))
    CONTINUOUS = _Row("continuous", ("angle",), (_TURN,), limited=False)
    PRISMATIC = _Row("prismatic", ("length",), (_SLIDE,))
    PLANAR = _Row(
        "planar",
        ("x", "y", "angle"),
        (Step("slide", X), Step("slide", Y), Step("turn", Z)),
        moving_frame=True,
        limited=False,
    )
    FLOATING = _Row(
        "floating",
        ("x", "y", "z", "qx", "qy", "qz", "qw"),
        (Step("slide", X), Step("slide", Y), Step("slide", Z), _BALL),
        moving_frame=True,
        limited=False,
    )
    SPHERICAL = _Row("spherical", ("x", "y", "z", "w"), (_BALL,), moving_frame=True, limited=False, replaces=ROTARY)
    UNIVERSAL = _Row("universal", ("angle", "angle"), (_TURN, Step("turn", 1)), replaces=ROTARY)
    CYLINDRICAL = _Row("cylindrical", ("length", "angle"), (_SLIDE, _TURN), replaces=ROTARY | SLIDING)
    HELICAL = _Row("helical", ("angle",), (Step("screw"),), replaces=ROTARY | SLIDING)

    def __new__(cls, *values: Any) -> JointType:
        """Take the values of a row."""
        row = _Row(*values)
        member = str.__new__(cls, row.text)
        member._value_ = row.text
        member.coordinates, member.steps, member.replaces = row.coordinates, row.steps, row.replaces
        member.moving_frame, member.limited, member.is_fixed = row.moving_frame, row.limited, not row.steps
        balls = row.steps.count(_BALL)  # 0 or 1; its quaternion comes last
        member.nv = len(row.coordinates) - balls
        member.neutral = (0.0,) * member.nv + (1.0,) * balls
        member.quaternion = len(row.coordinates) - 4 if balls else None
        return member

    __str__ = str.__str__
    # The hash of the string it equals: Enum's own is a Python function, and lookups by type are frequent.
    __hash__ = str.__hash__

    @property
    def is_axial(self) -> bool:
        """Whether it is URDF's own and has one coordinate; these can mimic and be mimicked (EU-URD-023)."""
        return self.nv == 1 and not self.replaces

    @property
    def is_ranged(self) -> bool:
        """Whether URDF states a range of it."""
        return self.is_axial and self.limited

    @property
    def is_ball(self) -> bool:
        """Whether it is the rotations of a ball, and nothing else."""
        return self.steps == (_BALL,)

    @property
    def slides(self) -> bool:
        """Whether it has a slide of its own; that of a screw comes with its turn."""
        return any(step.kind == "slide" for step in self.steps)


if sys.version_info < (3, 12):
    # There, a member is looked up through a descriptor written in Python, which takes four times as long.
    for _member in JointType:
        type.__setattr__(JointType, _member.name, _member)
