"""The errors of a file as diagnostics with codes, places, messages and hints: one error gives one diagnostic."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from eurdf.diagnostics import Diagnostic, Fix, renamings
from eurdf.diagnostics.wording import similar
from eurdf.format.closure_model import CLOSURE
from eurdf.format.conventions import HINT, VERSION2_0, VERSION2_1, VERSION_KEY, Version
from eurdf.format.fixes import added, free_name, listed, named, removed, renamed, restated, unsigned, without_key
from eurdf.format.joint_model import ACTUATOR, JOINT, LimitsEntry
from eurdf.format.mappings import OneOf, Record, in_order
from eurdf.format.model import VERSION1, VERSION2
from eurdf.format.one_cause import later_word, with_one_cause
from eurdf.format.other_words import key_meant, number_meant, type_meant
from eurdf.format.value_types import Violation
from eurdf.format.wording import described, likeliest_key, near, quoted
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

#: Maximum number of reported errors per file; a file with more is not a description.
MOST = 100

#: What to write in place of a joint type, or of axes, that the file cannot state.
_JOINT_TYPE_HINTS = {
    "universal": "a universal joint needs its axes: {type: universal, axes: xy}",
    "xyz": "does it turn about all three axes? then its type is 'spherical'",
    "helical": "a helical joint needs its pitch: {type: helical, pitch: 0.005}",
    **dict.fromkeys(
        ("revolute", "continuous", "prismatic", "planar", "floating"), "a joint without a type keeps its URDF type"
    ),
}

#: Keys whose values are three numbers.
_VECTORS = ("xyz", "rpy", "axis")

_JOINT_KEYS = JOINT.keys(VERSION2_1).keys()

#: Keys that describe a joint or its motor: those of the format, and the words of a URDF and of other formats.
_OF_JOINTS = {*_JOINT_KEYS, *Record(LimitsEntry).all_keys, *ACTUATOR.keys(VERSION2_1)}
_OF_JOINTS |= {"limit", "dynamics", "actuated", "actuator", "motor"}
_OF_JOINTS -= {"name", "type", "joint", "axes"}

#: Keys of the file whose values are mappings of names that the user chooses, and what these are names of.
_NAMED = {"joints": "joint", "configurations": "configuration"}

#: Lists of the file whose items have a name that may be any, and what these are.
_NUMBERED = {"closures": "closure", "couplings": "coupling"}


def diagnostics_of(found: Sequence[Violation], version: Version, document: YamlDocument) -> list[Diagnostic]:
    """The diagnostics of the errors of a file, which was checked against a version, in file order."""
    return _Messages(found, version, document).diagnostics()


def subject(pointer: Pointer) -> str:
    """How a message names the value at a pointer."""
    if not pointer:
        return "the file"
    if isinstance(pointer[-1], int):
        return f"item {pointer[-1] + 1} of {subject(pointer[:-1])}"
    noun = _NAMED.get(str(pointer[0]), "") if len(pointer) == 2 else ""
    return f"{noun} {quoted(pointer[-1])}".lstrip()


class _Messages:
    """The errors of one file."""

    def __init__(self, found: Sequence[Violation], version: Version, document: YamlDocument) -> None:
        self.version = version
        self.document, self.place = document, document.place
        self.omitted = len(found) - MOST
        mistyped = {each.pointer[:2] for each in found[:MOST] if each.pointer[::2] == ("closures", "type")}
        # A key that some type or version does not have may go with the type that was meant.
        forms = CLOSURE.forms if mistyped else None
        some = forms.keys(VERSION2_1).keys() - forms.keys(VERSION2_0) if forms is not None else ()
        self.found = [each for each in found[:MOST] if not (each.pointer[:2] in mistyped and each.pointer[-1] in some)]
        self.faulty = {each.pointer[:end] for each in self.found for end in range(1, len(each.pointer) + 1)}

    def diagnostics(self) -> list[Diagnostic]:
        diagnostics, self.found = with_one_cause(self.found, self.document)
        lacking: dict[Pointer, list[str]] = {}
        for each in self.found:
            if each.code == "missing":
                lacking.setdefault(each.pointer[:-1], []).append(str(each.pointer[-1]))
        meant: dict[Pointer, str] = {}  # for an unknown key, the required key that it misspells
        for each in self.found:
            wanted = [other for lacked in lacking.get(each.pointer[:-1], ()) for other in _alternatives(lacked)]
            key = str(each.pointer[-1]) if each.pointer else ""
            if each.code == "unknown-key" and (likely := near(key, wanted) or key_meant(key, wanted)):
                meant[each.pointer] = likely
        misspelt = {(*pointer[:-1], key) for pointer, key in meant.items()}
        for mapping, keys in lacking.items():
            lacked = [key for key in keys if misspelt.isdisjoint((*mapping, each) for each in _alternatives(key))]
            if lacked:
                diagnostics.append(self.lacking(mapping, lacked))
        for each in self.found:
            if each.code == "unknown-key":
                diagnostics.append(self.unknown_key(each, meant.get(each.pointer)))
            elif each.code != "missing":
                diagnostics.append(self.wrong_value(each))
        diagnostics.sort(key=lambda diagnostic: (diagnostic.line or 0, diagnostic.column or 0))
        if self.omitted > 0:
            last = diagnostics.pop()
            more = f"{self.omitted:,} more errors of the file are not listed"
            hint = f"{last.hint}; {more}" if last.hint else more
            diagnostics.append(Diagnostic(last.code, last.message, last.place, hint, proposals=last.proposals))
        return diagnostics

    # -- missing and unknown keys ---------------------------------------------------------------------------------

    def lacking(self, mapping: Pointer, keys: Sequence[str]) -> Diagnostic:
        """The diagnostic of a mapping that lacks keys, of which one or all are one error (EU-DIA-001)."""
        said = sorted((" or ".join(f"'{other}'" for other in _alternatives(key)) for key in keys), key=len)
        listed = f"{', '.join(said[:-1])} and {said[-1]}" if len(said) > 1 else said[0]
        hint = next(filter(None, (self.key_outside(mapping, key) for key in keys)), None)
        if hint is None and len(keys) == 1 and mapping[:-1] == ("closures",):
            form = CLOSURE.forms.form_of(self.mapping_at(mapping), self.version)
            stated = form.all_keys.get(keys[0]) if isinstance(form, Record) else None
            hint = stated and f"{stated.title}: {stated.text.removesuffix('.')}"
        is_all = len(keys) == 1 and not any(
            each.code == "unknown-key" and each.pointer[:-1] == mapping for each in self.found
        )
        value = self.missing_value(mapping, keys[0]) if is_all else None
        proposals = () if value is None else added(self.document, mapping, keys[0], value)
        if keys == ["joint"] and mapping[0] == "actuators" and "name" in self.mapping_at(mapping):
            proposals = renamed(self.document, (*mapping, "name"), "joint", key=True)
        message = f"{subject(mapping)} lacks {listed}"
        return Diagnostic("missing-key", message, self.place(mapping), hint, proposals=tuple(proposals))

    def missing_value(self, mapping: Pointer, key: str) -> str | None:
        """The value that a missing key can only have, or that may be any: a name."""
        if key == "type":
            forms = (JOINT if mapping[0] == "joints" else CLOSURE.forms).records
            having = [form for form in forms if self.mapping_at(mapping).keys() <= form.keys(self.version).keys()]
            types = [kind for form in having for kind in form.values_of_type()]
            return types[0] if len(types) == 1 else None
        if key != "name" or mapping[0] not in _NUMBERED:
            return None
        lists = [self.document.data.get(each) for each in _NUMBERED]
        items = [item for each in lists if isinstance(each, list) for item in each]
        taken = {item.get("name") for item in items if isinstance(item, dict)}
        return free_name(f"{_NUMBERED[str(mapping[0])]}_{int(mapping[1]) + 1}", taken)

    def unknown_key(self, violation: Violation, meant: str | None) -> Diagnostic:
        """The diagnostic of a key that the mapping does not have, or that does not go with its others.

        ``meant`` is the required key that it misspells.
        """
        record: Record
        union: OneOf | None
        record, union = violation.about
        mapping, key = violation.pointer[:-1], str(violation.pointer[-1])
        place = self.place(violation.pointer, key=True)
        apart = {} if union is None else union.apart(record, self.version)
        if key in apart and union is not None:
            fixes = without_key(self.document, violation.pointer, self.version, record, union.records)
            return Diagnostic("conflicting-keys", f"{subject(mapping)}: {apart[key]}", place, proposals=tuple(fixes))
        of_any_form = record if union is None else union
        word = key_meant(key, record.all_keys.keys() - self.mapping_at(mapping).keys())
        likely = meant or word or likeliest_key(key, (*record.all_keys, *apart))
        beside = self.another_entry(violation.pointer) if meant is None else None
        proposals: Sequence[Fix] = ()
        if meant is None and (outside := _key_of_the_file(violation.pointer)):
            hint = outside
        elif not mapping and key in VERSION1.all_keys:
            hint = f"it is a key of version 1; in version 2.0, use '{VERSION1.all_keys[key].becomes}'"
        elif meant is None and self.version == VERSION2_0 and (later := later_word(violation)):
            hint = self.version_hint(later)
            proposals = self.version_fix(hint)
        elif meant is None and (of_joint := _key_of_a_joint(violation.pointer)):
            hint = of_joint
        elif likely is not None:
            hint = f"did you mean '{likely}'?" + (f" {beside}" if beside else "")
            if meant or word or near(key, [likely]):  # else it is only a question
                proposals = renamed(self.document, violation.pointer, likely, key=True)
        elif beside:
            hint = beside
        else:
            # A mapping whose form is decided by the lack of a key can have it.
            is_open = union is not None and not record.values_of_type() and union.values_of_type(self.version)
            keys = (of_any_form if is_open else record).keys(self.version)
            known = ", ".join(f"'{known}'" for known, _ in in_order(keys))
            hint = f"the keys here are {known}; your own keys begin with 'x-'"
        message = f"{subject(mapping)} has an unknown key {quoted(key)}"
        return Diagnostic("unknown-key", message, place, hint, proposals=tuple(proposals))

    def version_fix(self, hint: str) -> tuple[Fix]:
        """What the hint about the version says, as a fix."""
        return (replace(restated(self.document, (VERSION_KEY,), VERSION2_1), summary=hint),)

    def version_hint(self, what: str) -> str:
        """Which line to change so that a file may have what version 2.1 adds."""
        line = self.place((VERSION_KEY,)).line
        return f'{what} is of version {VERSION2_1}: write {VERSION_KEY}: "{VERSION2_1}" on line {line}'

    # -- values ---------------------------------------------------------------------------------------------------

    def wrong_value(self, violation: Violation) -> Diagnostic:
        """The diagnostic of a value, or of a mapping as a whole."""
        pointer, code, text, value, about = violation
        name, place = subject(pointer), self.place(pointer)
        match code:
            case "empty-name":
                message = f"a name in {subject(pointer[:-1])} is empty"
                return Diagnostic("wrong-value", message, self.place(pointer, key=True))
            case "choice":
                return self.wrong_choice(pointer, value, about)
            case "later-value":
                message = f"{name} cannot be {described(value)} in a file of version {VERSION2_0}"
                later = self.version_hint(f"{pointer[-1]} '{value}'")
                return Diagnostic("wrong-value", message, place, later, proposals=self.version_fix(later))
            case "missing-key" if about is not None:
                return Diagnostic(code, f"{name} {text}", self.place((*pointer, about), key=True))
            case "number-out-of-bounds":
                return Diagnostic(code, f"{name} {text}", place, HINT)
            case "wrong-type":
                message = f"{name} {text}, not {described(value)}"
                if (misplaced := self.misplaced(pointer, value)) is not None:
                    return Diagnostic(code, message, place, misplaced)
                fixes = _type_fix(self.document, text, pointer, value)
                is_nested = fixes and isinstance(value, dict | list)
                hint = fixes[0].summary if is_nested else _type_hint(text, pointer, value)
                return Diagnostic(code, message, place, hint, proposals=fixes)
        message = f"{name} {text}" + ("" if value is None else f", not {described(value)}")
        if pointer[0] == "joints" and pointer[-1] == "mimic":
            hint = "without this key, the joint follows the <mimic> of the URDF"
            proposals = tuple(removed(self.document, pointer, "it: the joint follows the <mimic> of the URDF"))
            return Diagnostic(code, message, place, hint, proposals=proposals)
        return Diagnostic(code, message, place, proposals=unsigned(self.document, pointer, value))

    def wrong_choice(self, pointer: Pointer, value: Any, allowed: Sequence[str]) -> Diagnostic:
        """The diagnostic of a value that is not one of those allowed."""
        *others, last = (f"'{choice}'" for choice in allowed)
        choices = f"{', '.join(others)} or {last}" if others else last
        message = f"{subject(pointer)} must be {choices}, not {described(value)}"
        if not isinstance(value, str):
            asked = "is the root fixed to the world, or does it float?" if pointer == ("root",) else None
            return Diagnostic("wrong-type", message, self.place(pointer), asked)
        is_type = len(pointer) == 2 or pointer[-1] in ("type", "root")
        meant = type_meant(pointer[0], value) if is_type else None
        here = next((choice for choice in allowed if choice.casefold() == meant), None)
        hint = _JOINT_TYPE_HINTS.get(meant or value) if pointer[0] == "joints" else None
        if here is not None and value.casefold() != meant:
            hint = f"'{value}' is called '{here}' here"
            proposals: Sequence[Fix] = [
                replace(restated(self.document, pointer, here), summary=f"write '{here}': {hint}")
            ]
        elif here is None and pointer[0] == "closures" and meant in CLOSURE.forms.values_of_type(VERSION2_1):
            hint, proposals = self.version_hint(f"'{value}' is called '{meant}' here; that"), ()
        else:
            proposals = renamings(similar(value, allowed), partial(named, self.document, pointer, False))
        return Diagnostic("wrong-value", message, self.place(pointer), hint, proposals=tuple(proposals))

    # -- what is indented too little or too much --------------------------------------------------------------------

    def misplaced(self, pointer: Pointer, value: Any) -> str | None:
        """What to try where a value is of the wrong type; None where its indentation is not the likely reason."""
        if value is None:
            return self.meant_below(pointer)
        # Elsewhere the value of a key is of a wrong type, so that the key belongs there.
        return (_key_of_the_file(pointer) if pointer[0] in _NAMED else None) or self.another_entry(pointer)

    def meant_below(self, pointer: Pointer) -> str | None:
        """For a key without a value: whether the next key beside it was meant to be in it."""
        siblings = self.mapping_at(pointer[:-1])
        if pointer[-1] not in siblings:
            return None
        keys = list(siblings)
        following = keys[keys.index(str(pointer[-1])) + 1 :]
        if not following:
            return None
        key = (*pointer[:-1], following[0])
        mine, next_one = self.place(pointer, True), self.place(key, True)
        in_a_joint = pointer[:-1] == ("joints",) and following[0] in _JOINT_KEYS
        if mine.column != next_one.column or not (key in self.faulty or in_a_joint):
            return None
        return (
            f"if '{following[0]}' on line {next_one.line} belongs to it, indent it deeper than '{pointer[-1]}'; "
            "remove the key if it has no value"
        )

    def another_entry(self, pointer: Pointer) -> str | None:
        """For a key inside a joint or a configuration whose value looks like another joint or configuration."""
        if len(pointer) != 3 or pointer[0] not in _NAMED:
            return None
        name, key = pointer[1:]
        value = self.mapping_at(pointer[:-1]).get(str(key))
        if pointer[0] == "joints" and isinstance(value, str):
            is_entry = value in JOINT.values_of_type(VERSION2_1)
        else:
            is_entry = isinstance(value, dict) and (pointer[0] != "joints" or key != "limits")
        return f"if '{key}' is another {_NAMED[str(pointer[0])]}, indent it like '{name}'" if is_entry else None

    def key_outside(self, mapping: Pointer, key: str) -> str | None:
        """For a key that an item of a list lacks: whether the list's own mapping has it, later in the file."""
        if len(mapping) < 2 or not isinstance(mapping[-1], int) or key not in self.mapping_at(mapping[:-2]):
            return None
        item, outside = self.place(mapping), self.place((*mapping[:-2], key), True)
        if item.line is None or item.column is None or outside.line is None or outside.line < item.line:
            return None
        if (self.document.source.lines.line(item.line) or "").startswith("{", item.column - 1):
            return None
        return f"if '{key}' on line {outside.line} belongs to it, indent it by {item.column - 1} spaces"

    def mapping_at(self, pointer: Pointer) -> Mapping[str, Any]:
        """The mapping at a pointer; empty if there is none."""
        data: Any = self.document.data
        for step in pointer:
            if not (step in data if isinstance(data, dict) else isinstance(data, list) and isinstance(step, int)):
                return {}
            data = data[step]
        return data if isinstance(data, dict) else {}


def _alternatives(key: str) -> tuple[str, ...]:
    """The keys of which one is required, where a required key is missing."""
    return ("link", "joint") if key == "link" else (key,)


def _key_of_the_file(pointer: Pointer) -> str | None:
    """For a key inside another entry that belongs at the top of the file."""
    if len(pointer) < 2 or pointer[-1] not in VERSION2.all_keys or pointer[::2] == ("couplings", "joints"):
        return None
    return f"'{pointer[-1]}' is a key of the whole file: do not indent it"


def _key_of_a_joint(pointer: Pointer) -> str | None:
    """For a key in a closure or coupling that describes the joint of a tree."""
    if len(pointer) != 3 or pointer[-1] not in _OF_JOINTS or pointer[0] not in ("closures", "couplings"):
        return None
    if pointer[0] == "couplings":
        return "a coupling has no limit, friction or motor; the joints that it relates have them"
    return (
        "a closure has no coordinate, so no limit, friction, spring or motor: put this joint into the tree, and cut "
        "the loop at another one"
    )


def _type_fix(document: YamlDocument, must: str, pointer: Pointer, value: Any) -> tuple[Fix, ...]:
    """What `_type_hint` says, as a fix."""
    if value is None:
        is_asked = isinstance(pointer[-1], int) or len(pointer) == 1
        return () if is_asked else tuple(removed(document, pointer, f"'{pointer[-1]}'"))
    if must == "must be a list" and isinstance(value, str | int | float):
        items: list[Any] = re.split(r"[,\s]+", value.strip(", ")) if isinstance(value, str) else [value]
        if pointer[-1] in _VECTORS:
            items = [number for number in map(_number, map(str, items)) if number is not None]
        return (restated(document, pointer, items),) if pointer[-1] not in _VECTORS or len(items) == 3 else ()
    if must == "must be a list" and isinstance(value, dict):
        return tuple(listed(document, pointer, "joint" if pointer[-1] == "actuators" else "name"))
    if "letters" in must and isinstance(value, list):
        return (restated(document, pointer, "".join(value).lower()),)
    if "number" in must and isinstance(value, str) and (number := _number(value)) is not None:
        fix = restated(document, pointer, int(number) if number.is_integer() else number)
        return (replace(fix, summary=_type_hint(must, pointer, value) or fix.summary),)
    if ("text" in must or "name" in must) and isinstance(value, bool | int | float):
        start, end = document.span(pointer)
        return (restated(document, pointer, document.source.text[start:end]),)
    return ()


def _number(text: str) -> float | None:
    """The finite number that a text is, if it is one, also with a comma or underscores, a unit or π."""
    if meant := number_meant(text):
        return float(f"{meant[0]:.12g}")
    try:
        number = float(text.replace("_", "").replace(",", "."))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _type_hint(must: str, pointer: Pointer, value: Any) -> str | None:
    """How to write what is probably meant, if it can be guessed."""
    if value is None:
        if len(pointer) == 1:
            return "is its value missing?"
        return None if isinstance(pointer[-1], int) else "remove the key if it has no value"
    if ("text" in must or "name" in must) and isinstance(value, bool | int | float):
        return "quote a name that looks like a number, true or false"
    if must == "must be a list" and isinstance(value, dict):
        return "begin each item with '- '"
    if must == "must be a list" and isinstance(value, str | int | float) and len(str(value)) <= 60:
        if pointer[-1] in _VECTORS:
            return "write three numbers in brackets, like [0, 0, 1]"
        return f"write it as a list: [{value}]"
    if "number" in must and isinstance(value, str):
        number = _number(value)
        if number is not None:
            meant = number_meant(value)
            why = f": {quoted(value)} in {meant[1]}" if meant and meant[1] else ""
            return f"write the number as {repr(number).removesuffix('.0')}, without quotes{why}"
    return None
