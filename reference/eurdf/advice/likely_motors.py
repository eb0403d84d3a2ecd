"""Joints that are probably motors but not actuated, and actuated joints that are probably none: by names, ratings."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from eurdf.diagnostics import Edit, Fix, enumerated
from eurdf.format.fixes import removed
from eurdf.format.yaml_text import Value, flow, scalar
from eurdf.linking.actuators import name_in
from eurdf.linking.counterparts import changes_between, is_opposite, renamed, words_of
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.joint import Joint
from eurdf.writing.naming_conventions import conventions, named_motors
from eurdf.writing.yaml_edits import edited


class LikelyMotors:
    """What the files of a robot say of its motors beside the list of actuators."""

    def __init__(self, read: ReadRobot) -> None:
        self._read = read
        self.listed = read.mechanism.actuators
        self._key = read.description.actuators_key
        self.named = frozenset(named_motors(read.urdf, conventions().motors, []))
        self._single = {
            joint.name: joint for joint in read.mechanism.joints if joint.type.nv == 1 and joint.mimic is None
        }
        self._free = [name for name in self._single if name not in self.listed]
        elements = read.urdf.document.root.iterfind("transmission/joint")
        self._transmitted = frozenset(element.get("name") for element in elements)

    def could_be(self, names: Iterable[str]) -> list[str]:
        """Those of some joints that are not actuated, and have one velocity of their own."""
        return [name for name in self._free if name in frozenset(names)]

    def by_name(self, moved: Collection[str]) -> Iterator[Fix]:
        """Proposals to list joints by their names; all are among those that move with every actuator held."""
        free = self.could_be(moved)
        yield from self._additions([name for name in free if name in self.named], "named as motors are")
        beside = {name: other for name in free if (other := self._opposite(name, self.listed))}
        yield from self._additions(list(beside), "actuated on the other side")
        first, *rest = [frozenset(words_of(name)) for name in self.listed] or [frozenset()]
        for word in first.intersection(*rest) if rest else ():
            has = partial(_has_word, word)
            yield from self._additions(self._distinct(free, has), f"named like all actuators, with '{word}'")

    def without_stiffness(self, moved: Iterable[str]) -> list[str]:
        """The joints that are named as springs, and have no stiffness."""
        return [
            name
            for name in self.could_be(moved)
            if "spring" in words_of(name) and not any(self._single[name].properties.stiffness)
        ]

    def by_rating(self, moved: Collection[str]) -> Iterator[Fix]:
        """Proposals to list joints by what the URDF says of motors."""
        free = self.could_be(moved)
        transmitted = self._distinct(free, lambda joint: joint.name in self._transmitted)
        yield from self._additions(transmitted, "in a <transmission> of the URDF")
        yield from self._additions(self._distinct(free, _has_rotor), "given the inertia of a rotor")
        yield from self._additions(self._distinct(free, _is_rated), "given an effort limit")

    def _additions(self, names: Sequence[str], why: str) -> Iterator[Fix]:
        if names:
            it = "it is" if len(names) == 1 else "they are"
            question = f"{'is' if len(names) == 1 else 'are'} {enumerated(names)} actuated, since {it} {why}?"
            yield Fix(f"add {enumerated(names)} to '{self._key}': {it} {why}", self._adding(names), question)

    def _distinct(self, free: Collection[str], has: Callable[[Joint], bool]) -> list[str]:
        """The joints that are not actuated and have what all actuators have, if each of them is among those given."""
        having = [name for name in self._free if has(self._single[name])]
        listed = [self._single[name] for name in self.listed if name in self._single]
        rest = len(having) < len(self._free)  # where all have it, it says nothing
        return having if rest and all(map(has, listed)) and frozenset(having) <= frozenset(free) else []

    def _opposite(self, name: str, among: Iterable[str]) -> str | None:
        """The name of the same joint on the other side."""
        return next((other for other in among if is_opposite(other, name)), None)

    def superfluous(self, together: Collection[str]) -> Iterator[Fix]:
        """Proposals not to list some of the actuators that depend on one another; never those that are named so."""
        motors = [name for name in together if name in self.named]
        passive = [name for name in together if name not in self.named]
        if motors and passive:
            yield self._removal(passive, "not named as motors are, unlike the others")
            return
        alone = [
            name for name in passive if self._opposite(name, self._single) and not self._opposite(name, self.listed)
        ]
        if alone and len(alone) < len(together):
            yield self._removal(alone, "not actuated on the other side")

    def of_several(self, joint: Joint) -> Iterator[Fix]:
        """Proposals for an actuated joint with several velocities: one of its own type, or none of the actuators."""
        document, name = self._read.description.document, joint.name
        stated = document.data.get("joints", {}) if self._key == "actuators" else {}
        is_motor = name in self.named
        if isinstance(stated.get(name), str):
            asked = f"is joint '{name}' {joint.type}, although a motor turns one axis?"
            why = "it is named as motors are, which turn one axis"
            for fix in removed(document, ("joints", name) if len(stated) > 1 else ("joints",), ""):
                summary = f"remove '{name}' from 'joints': {why}"
                yield replace(fix, summary=summary, question=asked, rivals=not is_motor)
        if not is_motor:
            asked = f"is joint '{name}' actuated?"
            why = f"a {joint.type} joint has no motor"
            yield Fix(f"remove '{name}' from '{self._key}': {why}", self.removing([name]), asked)

    def exchange(self, new: Mapping[str, str]) -> Fix:
        """The proposal to actuate other joints, by name, in the place of some that are actuated."""
        document = self._read.description.document
        edits = [
            document.edit(name_in(entry, document), scalar(new[entry.joint]))
            for entry in self._read.description.actuators
            if entry.joint in new
        ]
        names = enumerated(list(new.values()))
        return Fix(
            f"actuate {names} in the place of {enumerated(list(new))}", tuple(edits), f"are {names} the motors instead?"
        )

    def _removal(self, names: list[str], why: str) -> Fix:
        which = "it is" if len(names) == 1 else "they are"
        return Fix(f"remove {enumerated(names)} from '{self._key}': {which} {why}", self.removing(names))

    def removing(self, names: Collection[str]) -> tuple[Edit, ...]:
        """The edits that take joints from the list of actuators; none if that is not possible."""
        document, key = self._read.description.document, self._key
        pointers = [entry.pointer for entry in self._read.description.actuators if entry.joint in names]
        rest = [item for index, item in enumerate(document.data[key]) if (key, index) not in pointers]
        if document.span((key,))[1] is not None:  # in brackets
            return (document.edit((key,), flow(rest)),)
        return tuple(edit for pointer in pointers for fix in removed(document, pointer, "") for edit in fix.edits)

    def _adding(self, names: Iterable[str]) -> tuple[Edit, ...]:
        entries = [self._entry(name) for name in names]
        return edited(self._read.description.document, lambda edits: edits.add_items(self._key, entries))

    def _entry(self, name: str) -> Value:
        """The entry of an actuator, with the gear and rotor of the one on the other side."""
        other = self._opposite(name, self.listed)
        if other is None:
            return name
        index = [entry.joint for entry in self._read.description.actuators].index(other)
        value = self._read.description.document.data[self._key][index]
        changes = changes_between(other, name)
        if isinstance(value, str):
            return name
        return {key: renamed(each, changes) if isinstance(each, str) else each for key, each in value.items()}


def _has_word(word: str, joint: Joint) -> bool:
    return word in words_of(joint.name)


def _is_rated(joint: Joint) -> bool:
    return any(0.0 < effort < math.inf for effort in joint.properties.effort)


def _has_rotor(joint: Joint) -> bool:
    return any(joint.properties.rotor_inertia) or any(joint.properties.armature)
