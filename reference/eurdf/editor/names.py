"""Where the names of links, joints, frames and closures occur in the files of a robot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from eurdf.diagnostics.lines import Lines
from eurdf.format.closure_model import AnyClosure
from eurdf.format.conventions import VERSION2_1, VERSION_KEY, Version, is_own_key
from eurdf.format.mappings import Alone, OneOf, Record
from eurdf.format.model import MODELS, VERSION1
from eurdf.format.value_types import ByName, ListOf, Text, ValueType
from eurdf.reading.xml_reader import Element, XmlDocument
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

#: What a name is of, by the type of the value in the model.
KINDS = {
    "LinkName": "link",
    "FrameName": "frame",
    **dict.fromkeys(("JointName", "MovingJointName", "UrdfJointName"), "joint"),
}

# What has its name under `name`, by the key of the list that it is in.
_NAMED = {"closures": "closure", "couplings": "coupling", "frames": "frame", "actuators": "actuator"}

# Attributes of a URDF that name something, by tag; and elements in which they refer to what is named elsewhere.
_ATTRIBUTES = {
    "link": (("name", "link"),),
    "joint": (("name", "joint"),),
    "parent": (("link", "link"),),
    "child": (("link", "link"),),
    "mimic": (("joint", "joint"),),
    "gazebo": (("reference", "frame"),),
}
_REFERRING = ("transmission", "ros2_control")


@dataclass(frozen=True)
class Occurrence:
    """A place at which something is named.

    Attributes:
        kind: What is named: a link, joint, frame, closure, coupling, actuator or configuration.
        name: Its name.
        file: Path of the file.
        start: Index of the first character of the name.
        end: Index of the one after its last.
        lines: The text of the file.
        pointer: Of a YAML file, what leads to the value or the key.
        element: Of a URDF, the element.
        defines: Whether the name is given here; else it refers to what has it.
    """

    kind: str
    name: str
    file: str
    start: int
    end: int
    lines: Lines
    pointer: Pointer = ()
    element: Element | None = None
    defines: bool = False


class RobotNames:
    """All names in the files of one robot.

    Attributes:
        all: Where they occur, in the order of the files, the description first.
        defined: Of each kind, the first place that gives a name, by name.
    """

    def __init__(self, description: YamlDocument | None, urdf: XmlDocument | None) -> None:
        found = [] if urdf is None else [*_in_urdf(urdf)]
        described = [] if description is None else [*_in_description(description)]
        self.defined: dict[str, dict[str, Occurrence]] = {}
        for each in (*found, *described):
            if each.defines:
                self.defined.setdefault(each.kind, {}).setdefault(each.name, each)
        split = () if description is None else _split_joints(description)
        self.all = [self._meant(each, split) for each in (*described, *found)]

    def of(self, kind: str) -> dict[str, Occurrence]:
        """What is defined of a kind; of a frame, all that a frame can be named by."""
        if kind != "frame":
            return self.defined.get(kind, {})
        return self.of("joint") | self.of("link") | self.defined.get("frame", {})

    def at(self, file: str, index: int) -> Occurrence | None:
        """What is named at a character of a file."""
        return next((each for each in self.all if each.file == file and each.start <= index <= each.end), None)

    def same(self, one: Occurrence) -> list[Occurrence]:
        """Where the same thing is named."""
        return [each for each in self.all if (each.kind, each.name) == (one.kind, one.name)]

    def _meant(self, each: Occurrence, split: tuple[str, ...]) -> Occurrence:
        """A reference with the kind of what it refers to, which for a frame can be a link or a joint (EU-FRM-001)."""
        if each.kind == "frame" and not each.defines:
            kinds = ("frame", "link", "joint")
            each = replace(
                each, kind=next((kind for kind in kinds if each.name in self.defined.get(kind, {})), "frame")
            )
        is_plain = each.lines.text[each.start : each.end] == each.name
        if each.name in self.defined.get(each.kind, {}) or each.name[-2:-1] != "_" or not is_plain:
            return each
        # EU-ONE-006: a universal joint of version 1 is two joints, named after it.
        whole = each.name[:-2]
        return replace(each, kind="joint", name=whole, end=each.end - 2) if whole in split else each


def version_in(data: dict[str, Any]) -> Version:
    """The version that a description probably has, if it is not finished."""
    stated = str(data.get(VERSION_KEY, ""))
    if not stated and not data.keys().isdisjoint(VERSION1.all_keys):
        return "1"
    return next((version for version in MODELS if version == stated), VERSION2_1)


def form_of(kind: ValueType, value: Any, version: Version) -> ValueType | None:
    """The form of a type that a value is meant to have; None if it has none."""
    if isinstance(kind, AnyClosure):
        kind = kind.forms
    if isinstance(kind, OneOf):
        kind = kind.form_of(value, version)  # type: ignore[assignment]
    return None if kind is None or type(value) not in kind.types else kind


def _in_description(document: YamlDocument) -> Iterator[Occurrence]:
    version = version_in(document.data)
    seen = set()
    for kind, name, pointer, is_key, defines in _in_value(MODELS[version], document.data, (), version):
        start, end = document.span(pointer, is_key)
        if end is None or (start, is_key) in seen:  # what is in an anchor is where it is written
            continue
        seen.add((start, is_key))
        source = document.source
        yield Occurrence(kind, name, source.file, start, end, source.lines, pointer, defines=defines)


def _in_value(
    kind: ValueType, value: Any, at: Pointer, version: Version
) -> Iterator[tuple[str, str, Pointer, bool, bool]]:
    """RobotNames in a value of a type: kind, name, pointer, whether it is a key, whether it is given here."""
    form = form_of(kind, value, version)
    if isinstance(form, Alone):
        yield from _in_value(form.text, value, at, version)
    elif isinstance(form, Record):
        for name, key in form.keys(version).items():
            if name == "name" and type(value.get(name)) is str:
                yield _NAMED[str(at[0])], value[name], (*at, name), False, True
            elif name in value:
                yield from _in_value(key.type, value[name], (*at, name), version)
    elif isinstance(form, ListOf):
        for index, item in enumerate(value):
            yield from _in_value(form.item, item, (*at, index), version)
    elif isinstance(form, ByName):
        for name, item in value.items():
            if not is_own_key(name):
                what = "configuration" if form.keys is None else KINDS[form.keys.name]
                merges = at == ("joints",) and type(item) is dict and "merges" in item
                yield what, name, (*at, name), True, form.keys is None or merges
                yield from _in_value(form.item, item, (*at, name), version)
    elif isinstance(form, Text) and form.name in KINDS:
        yield KINDS[form.name], value, at, False, False


def _split_joints(document: YamlDocument) -> tuple[str, ...]:
    names = document.data.get("joint_name")
    return tuple(map(str, names)) if isinstance(names, list) else ()


def _in_urdf(document: XmlDocument) -> Iterator[Occurrence]:
    source = document.source
    for element in document.root.iter(*_ATTRIBUTES):
        for attribute, kind in _ATTRIBUTES[str(element.tag)]:
            name = element.get(attribute)
            if name is None or "${" in name or "$(" in name:  # which a xacro makes
                continue
            above = {str(each.tag) for each in element.iterancestors()}
            if "gazebo" in above:  # which contains another format
                continue
            refers = not above.isdisjoint(_REFERRING)
            start, end = document.span(element, attribute)
            defines = attribute == "name" and not refers
            yield Occurrence(kind, name, source.file, start, end, source.lines, element=element, defines=defines)
