"""What is lost between a robot and a file of another format.

A format states in rows what it lacks, one `LossKind` a row: the tables of losses in the documentation are made of them,
and `Losses.find` applies them to a mechanism before anything is written. What only its writer knows, the writer adds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import Any, NamedTuple

from eurdf.closures import REGISTRY
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism


class Effect(str, Enum):
    """How much of an element is left in what is written.

    ``exact``: all that has an effect on the robot, in other terms. ``approximate``: it behaves almost as it should.
    ``dropped``: nothing is left of it.
    """

    __str__ = str.__str__

    EXACT = "exact"
    APPROXIMATE = "approximate"
    DROPPED = "dropped"


# -- the elements of a mechanism ---------------------------------------------------------------------------------------


class MotorJoint(NamedTuple):
    """A joint with a motor or a gear, under the name of its actuator."""

    name: str
    joint: Joint
    control: tuple[float, float] | None
    is_actuated: bool

    @property
    def type(self) -> JointType:
        """Type of the joint."""
        return self.joint.type


Elements = Callable[[Mechanism], Iterable[Any]]


def _joints(has: Callable[[Joint], bool]) -> Elements:
    return lambda mechanism: filter(has, mechanism.joints)


def _finite(limit: str) -> Elements:
    return _joints(lambda joint: any(map(math.isfinite, getattr(joint.properties, limit))))


def _nonzero(number: str) -> Elements:
    return _joints(lambda joint: any(getattr(joint.properties, number)))


def _motors(has: Callable[[Joint], bool], mechanism: Mechanism) -> list[MotorJoint]:
    found = ((joint, mechanism.motor(joint.name)) for joint in mechanism.joints if has(joint))
    return [MotorJoint(motor.name, joint, motor.control, joint.name in mechanism.actuators) for joint, motor in found]


def _actuators(mechanism: Mechanism) -> list[MotorJoint]:
    return _motors(lambda joint: joint.name in mechanism.actuators, mechanism)


def _is_geared(joint: Joint) -> bool:
    return any(ratio != 1.0 for ratio in joint.properties.gear_ratio) or any(joint.properties.rotor_inertia)


def _textures(mechanism: Mechanism) -> Iterable[str]:
    return (shape.texture for body in mechanism.bodies for shape in (*body.visuals, *body.collisions) if shape.texture)


def _nothing(mechanism: Mechanism) -> tuple[()]:
    """Elements that only a writer finds."""
    return ()


def _of_joint_type(kind: JointType) -> Elements:
    return _joints(lambda joint: joint.type is kind)


def _of_closure_type(kind: str) -> Elements:
    return lambda mechanism: (closure for closure in mechanism.closures if closure.type == kind)


#: What a mechanism can contain, the rows of the overview of losses: by its name, the elements that a mechanism has.
ELEMENTS: dict[str, Elements] = {
    **{f"{kind} joint": _of_joint_type(kind) for kind in sorted(JointType, key=lambda kind: kind.is_fixed)},
    "floating root": lambda mechanism: mechanism.bodies[:1] if mechanism.root == "floating" else (),
    "mimic joint": _joints(lambda joint: joint.mimic is not None),
    "position limit": _joints(lambda joint: any(map(math.isfinite, joint.properties.lower + joint.properties.upper))),
    "velocity limit": _finite("velocity"),
    "effort limit": _finite("effort"),
    "acceleration limit": _joints(lambda joint: bool(joint.properties.rates)),
    "damping": _nonzero("damping"),
    "friction": _nonzero("friction"),
    "armature": _nonzero("armature"),
    "gear ratio": partial(_motors, _is_geared),
    "spring": _nonzero("stiffness"),
    **{f"{kind} closure": _of_closure_type(kind) for kind in REGISTRY},
    "coupling": lambda mechanism: mechanism.couplings,
    "contact": lambda mechanism: mechanism.contacts,
    "compliance": lambda mechanism: (
        closure for closure in mechanism.closures if closure.compliance.linear or closure.compliance.angular
    ),
    "actuator": _actuators,
    "control range": lambda mechanism: (motor for motor in _actuators(mechanism) if motor.control is not None),
    "inertia": _nothing,
    "link without mass": _nothing,
    "visual shape": _nothing,
    "collision shape": _nothing,
    "mesh": _nothing,
    "color": _nothing,
    "texture": _textures,
    "frame": lambda mechanism: mechanism.frames,
    "configuration": lambda mechanism: mechanism.configurations,
    "number": lambda mechanism: (mechanism,),
    "name": _nothing,
    "metadata": lambda mechanism: (mechanism,) if mechanism.metadata or mechanism.own_data else (),
}


# -- kinds of loss -----------------------------------------------------------------------------------------------------


def by_writer(element: object) -> bool:
    """Of no element: the writer, or the reader, adds the loss itself."""
    return False


def _of_all(element: object) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class LossKind:
    """A kind of loss in an export or an import; by default, an element is left out altogether.

    Attributes:
        effect: What is left.
        concept: Of an export: one of `ELEMENTS`.
        title: What happens, as one sentence.
        hint: What the user can do.
        code: Its permanent name, ``export-`` or ``import-`` and a few words; by default, ``export-`` and the concept.
        error: Of an approximate one: how large the error is.
        types: The joint types that it is about; empty for all.
        actuators: The choices of actuators with which it occurs; empty for all.
        where: Which elements of these have it.
        only: Which elements these are, or with which option they have it; by default, what ``types`` and ``actuators``
            say; empty if it is about all.
        sayable: Whether the format could say it: it is dropped because of an option or of the robot's files.
        message: What happened to an element, if the title does not say it.
    """

    effect: Effect
    concept: str
    title: str
    hint: str
    code: str = ""
    error: str = ""
    types: tuple[str, ...] = ()
    actuators: tuple[str, ...] = ()
    where: Callable[[Any], bool] = _of_all
    only: str = ""
    sayable: bool = False
    message: Callable[[Any], str] | None = None

    def __post_init__(self) -> None:
        only = f"--actuators {self.actuators[0]}" if len(self.actuators) == 1 else ""
        if self.types:
            only = f"{', '.join(self.types[:-1])} and {self.types[-1]} joints".removeprefix(" and ")
        object.__setattr__(self, "only", self.only or only)
        object.__setattr__(self, "code", self.code or f"export-{self.concept.replace(' ', '-')}")

    def applies(self, element: Any, actuators: str) -> bool:
        """Whether an element of the concept has it, with a choice of actuators."""
        if (self.actuators and actuators not in self.actuators) or (self.types and element.type not in self.types):
            return False
        return self.where(element)


exact, approximate, dropped = (partial(LossKind, effect) for effect in Effect)


# -- losses ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, repr=False)
class Loss:
    """One loss of one export or import.

    Attributes:
        code: Permanent name of its kind.
        effect: What is left: exact, in other terms; approximate; dropped, nothing.
        concept: Kind of the element, such as ``3d closure``: a row of the table of losses.
        name: Name of the element: of a joint, a link, a closure, an actuator.
        message: What happened, with values.
        hint: What to do about it.
    """

    code: str
    effect: Effect
    concept: str
    name: str
    message: str
    hint: str

    def __str__(self) -> str:
        return f"{self.effect}: {self.concept} '{self.name}': {self.message} [{self.code}]"

    def __repr__(self) -> str:
        return f"<Loss: {self}>"


class Losses:
    """The losses that an export or an import finds, each of a kind that its format has."""

    def __init__(self, kinds: Iterable[LossKind]) -> None:
        self._kinds = {kind.code: kind for kind in kinds}
        self._found: dict[tuple[str, str], Loss] = {}

    def add(self, code: str, name: str, message: str = "") -> None:
        """Record a loss; the second one of a kind for the same element is the same loss.

        Args:
            code: Of a kind that the format has.
            name: Name of the element.
            message: What happened; the title of the kind by default.
        """
        kind = self._kinds[code]
        loss = Loss(code, kind.effect, kind.concept, name, message or kind.title, kind.hint)
        self._found.setdefault((code, name), loss)

    def find(self, mechanism: Mechanism, actuators: str, stated: Collection[str]) -> None:
        """Record what the rows of a format say of a mechanism.

        Args:
            mechanism: The robot.
            actuators: What actuators become.
            stated: The joints and closures that the format states exactly, as in `ELEMENTS`. Others without a row are
                losses, too.
        """
        known = {*stated, *(kind.concept for kind in self._kinds.values())}
        for kind in self._kinds.values():
            for element in ELEMENTS.get(kind.concept, _nothing)(mechanism):
                if kind.applies(element, actuators):
                    self._record(kind, element)
        for what, elements in (("joint", mechanism.joints), ("closure", mechanism.closures)):
            for element in elements:
                if f"{element.type} {what}" not in known:
                    self._record(self._kinds[f"export-{what}-kind"], element)

    def _record(self, kind: LossKind, element: Any) -> None:
        name = element if isinstance(element, str) else element.name
        self.add(kind.code, name, kind.message(element) if kind.message else "")

    def has_kind(self, code: str) -> bool:
        """Whether the format has a kind of loss."""
        return code in self._kinds

    @property
    def found(self) -> tuple[Loss, ...]:
        """What was recorded, in order."""
        return tuple(self._found.values())
