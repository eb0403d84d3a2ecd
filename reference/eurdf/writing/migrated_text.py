"""The text of a version 1 description in version 2: implicit rules become explicit, and comments are kept."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from eurdf.diagnostics.lines import BREAK
from eurdf.format.closure_model import AXES, CLOSURE, FrameReference, NamedFrame
from eurdf.format.conventions import VERSION2_0, VERSION2_1, is_own_key
from eurdf.format.joint_model import JOINT, JointEntry, Overridden, Spherical
from eurdf.format.model import VERSION1, Description
from eurdf.format.schema import FILES
from eurdf.format.urdf.data import Urdf
from eurdf.format.yaml_text import (
    WIDTH,
    Value,
    YamlEntry,
    item_of_mapping,
    lines_of,
    lines_of_item,
    modeline,
    scalar,
    section,
    text_of,
)
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument, plain_data
from eurdf.writing.comments import Attached, Comment, attach, comments_of

# The comment by which an editor finds the schema.
_MODELINE = re.compile(r"#\s*yaml-language-server:\s*\$schema=(.*)")

# The keys of version 1 that become one key of version 2, by that key.
_SECTIONS = {
    section: [name for name, key in VERSION1.all_keys.items() if key.becomes == section]
    for section in ("closures", "joints", "actuators")
}


class NotMigratable(Exception):  # noqa: N818 - shown to the user as it is
    """Version 2 cannot state something that the file states; the text says what.

    Attributes:
        pointer: Where the file says it.
    """

    def __init__(self, message: str, pointer: Pointer) -> None:
        self.pointer = pointer
        super().__init__(message)


def version_needed(urdf: Urdf) -> Literal["2", "2.1"]:
    """The lowest version that states what version 1 states with a URDF: 2.1 frees mimic joints (EU-ONE-009)."""
    return "2.1" if any(joint.mimic for joint in urdf.joints.values()) else "2"


def schema_named(document: YamlDocument, urdf: Urdf) -> str | None:
    """Path of the schema of version 2, where a file of version 1 names that of version 1; None where it names none."""
    for match in map(_MODELINE.match, document.source.text.splitlines()):
        if match and match[1].strip().endswith(FILES["1"]):
            return match[1].strip().removesuffix(FILES["1"]) + FILES[version_needed(urdf)]
    return None


def own_keys(data: Iterable[str]) -> dict[str, str]:
    """For each user-defined key of a version 1 file, its name in version 2: ``x-`` and the key."""
    own = [key for key in data if key not in VERSION1.all_keys]
    taken = {key for key in own if is_own_key(key)}
    names = {}
    for key in own:
        name = key
        if not is_own_key(key):
            name = f"x-{key}"
            while name in taken:
                name = f"x-{name}"
            taken.add(name)
        names[key] = name
    return names


@dataclass(slots=True)
class MigratedText:
    """A description of version 1 that is written in version 2.

    Attributes:
        description: The description, of version 1 and linked without error.
        urdf: Its URDF.
        merged: The joints that version 1 merges by rule: for each spherical joint, the three it is made of.
        urdf_path: Path of the URDF from the new file.
        schema: Path of the schema from the new file, for its first line; None for no such line.
        notes: What was done, one sentence each.
    """

    description: Description
    urdf: Urdf
    merged: Mapping[str, Sequence[str]]
    urdf_path: str
    schema: str | None
    notes: list[str] = field(default_factory=list)

    @property
    def document(self) -> YamlDocument:
        """The file."""
        return self.description.document

    @property
    def mimicking(self) -> list[str]:
        """The mimic joints of the URDF."""
        return [joint.name for joint in self.urdf.joints.values() if joint.mimic]

    @property
    def halves(self) -> dict[str, tuple[str, int]]:
        """For each revolute that version 1 makes of a universal joint: that joint, and 0 or 1 for first or second."""
        return {
            f"{entry.name}_{letter}": (entry.name, index)
            for entry in self.description.joints
            for index, letter in enumerate(entry.split)
        }

    def text(self) -> str:
        """The text of the new file, and in `notes` what was done.

        Raises:
            NotMigratable: Version 2 cannot say the same.
        """
        comments = comments_of(self.document.source)
        own, comments = self.own_entries(comments)
        attached = attach(comments, self.pointers(), self.document)
        top = attached[()].above
        head = [text for text in top if not _MODELINE.match(text)]
        line = [] if self.schema is None else [modeline(self.schema)]
        items = {
            "closures": list(self.closures(attached)),
            "joints": list(self.joints(attached)),
            "actuators": list(self.actuators(attached)),
        }
        entries = [
            YamlEntry(lines_of("extended_urdf", VERSION2_1 if self.mimicking else VERSION2_0), (*line, *head)),
            YamlEntry(lines_of("urdf", self.urdf_path)),
        ]
        foot = attached[()].beside
        for key, written in items.items():
            above, beside = _together(attached, [(old,) for old in _SECTIONS[key]])
            if written:
                entries.append(_section(key, written, above, beside))
            else:
                foot = [*above, *([beside] if beside else []), *foot]
        for key, entry in own.items():
            above, beside = _together(attached, [(key,)])
            entries.append(YamlEntry(entry.lines, above, beside))
        foot_text = "".join(f"{comment}\n" for comment in foot)
        return text_of(entries) + foot_text

    def pointers(self) -> Iterator[Pointer]:
        """The entries that comments may go with."""
        for key, value in self.document.data.items():
            yield (key,)
            if key in VERSION1.all_keys:
                yield from ((key, index) for index in range(len(value)))

    # -- what the format knows ------------------------------------------------------------------------------------

    def closures(self, attached: Mapping[Pointer, Attached]) -> Iterator[YamlEntry]:
        """The closures, with the comments that go with each."""
        for index, closure in enumerate(self.description.closures):
            a, b = map(self.frame, closure.frames)
            value = CLOSURE.write(CLOSURE.entry(closure.type, {}, name=closure.name, frames=(a, b)))
            yield YamlEntry(item_of_mapping(value), *_together(attached, [("closed_loop", index), ("type", index)]))
        count = len(self.description.closures)
        if count:
            to = f" to 'closure_{count}'" if count > 1 else ""
            self.notes.append(f"closures are numbered as in version 1, 'closure_1'{to}; you can rename them")

    def frame(self, reference: FrameReference) -> FrameReference:
        """A closure's frame; the second half of a universal joint is now the joint itself."""
        name = reference.target
        halves = self.halves
        if name not in halves or name in self.urdf.links:
            return reference
        joint, index = halves[name]
        if index == 0:
            raise NotMigratable(
                f"the frame '{name}' lies between the two axes of universal joint '{joint}', "
                "and version 2 has no frame there",
                reference.pointer,
            )
        return NamedFrame(target=joint)

    def joints(self, attached: Mapping[Pointer, Attached]) -> Iterator[YamlEntry]:
        """The joints: replaced, merged by rule, freed."""
        pointers: dict[str, Pointer] = {entry.name: entry.pointer for entry in self.description.joints}
        changed = {*pointers, *(joint for joints in self.merged.values() for joint in joints)}
        mimicking = self.mimicking
        freed = [name for name in mimicking if name not in changed]
        for name in (*pointers, *self.merged, *freed):
            if is_own_key(name):
                raise NotMigratable(
                    f"joint '{name}' cannot be a key: in version 2, keys that begin with 'x-' are your own data",
                    pointers.get(name, ()),
                )
        for index, entry in enumerate(self.description.joints):
            lines = lines_of(entry.name, self.joint(entry))
            yield YamlEntry(lines, *_together(attached, [("joint_name", index), ("joint_type", index)]))
        for name, joints in self.merged.items():
            mimic = False if any(joint in mimicking for joint in joints) else None
            yield YamlEntry(lines_of(name, JOINT.write(Spherical(type="spherical", merges=tuple(joints), mimic=mimic))))
        for name in freed:
            yield YamlEntry(lines_of(name, JOINT.write(Overridden(mimic=False))))
        if mimicking:
            why = "because version 1 ignores <mimic> and version 2 does not"
            self.notes.append(f"freed with 'mimic: false', {why}: {_joints(mimicking)}")
        if self.merged:
            self.notes.append(
                "merged from three revolutes, which version 1 does implicitly and version 2 states: spherical "
                + _joints(self.merged)
            )
        split = [entry.name for entry in self.description.joints if entry.split]
        if split:
            self.notes.append(
                f"one joint with two angles, for two revolute joints of version 1: universal {_joints(split)}"
            )

    def joint(self, entry: JointEntry) -> Value:
        """What the new file says of a joint that is replaced."""
        axes = tuple(AXES[letter] for letter in entry.split.lower())
        mimic = False if entry.name in self.mimicking else None
        written: Value = JOINT.write(type(entry)(type=entry.type, axes=axes, mimic=mimic))
        return written

    def actuators(self, attached: Mapping[Pointer, Attached]) -> Iterator[YamlEntry]:
        """The actuators; the two halves of a universal joint are one."""
        entries, halves = iter(self.description.actuators), self.halves
        for entry in entries:
            name, pointers = entry.joint, [entry.pointer]
            if name in halves:
                name, index = halves[name]
                other = next(entries, None)
                if index != 0 or other is None or halves.get(other.joint) != (name, 1):
                    first, second = (half for half, (joint, _) in halves.items() if joint == name)
                    raise NotMigratable(
                        f"actuator '{entry.joint}' is one of the two axes of universal joint '{name}', and version 2 "
                        f"actuates both, one after the other: '{first}', '{second}'",
                        entry.pointer,
                    )
                pointers.append(other.pointer)
            yield YamlEntry(lines_of_item(name), *_together(attached, pointers))

    # -- user-defined keys ----------------------------------------------------------------------------------------

    def own_entries(self, comments: list[Comment]) -> tuple[dict[str, YamlEntry], list[Comment]]:
        """The user-defined entries, as they are written if that is possible; and the comments outside them."""
        document = self.document
        source = document.source
        spans = {key: document.span((key,), key=True) for key in document.data}
        begins = sorted(start for start, _ in spans.values())
        begins.append(len(source.text))
        indices = [comment.index for comment in comments]
        entries = {}
        kept: set[int] = set()
        for key, name in own_keys(document.data).items():
            if name != key:
                self.notes.append(f"'{key}', your own data, is now '{name}'")
            entries[key] = YamlEntry(lines_of(name, document.data[key]))
            start, begin = spans[key]
            if begin is None or BREAK.search(source.text, start, begin):
                continue
            end = begins[bisect_left(begins, begin)]
            inside = comments[bisect_left(indices, begin) : bisect_left(indices, end)]
            while inside and not inside[-1].beside:
                end = inside.pop().index
            verbatim = BREAK.sub("\n", scalar(name) + source.text[begin:end].rstrip())
            if _says(verbatim, name, document.data[key]):
                entries[key] = YamlEntry(tuple(verbatim.split("\n")))
                kept.update(comment.index for comment in inside)
        return entries, [comment for comment in comments if comment.index not in kept]


def _says(text: str, key: str, value: object) -> bool:
    """Whether the text is an entry of a block mapping at the top, with this key and this value."""
    # What follows must still be read as the next entry.
    return repr(plain_data(f"{text}\nnext: entry\n")) == repr({key: value, "next": "entry"})


def _section(key: str, items: list[YamlEntry], above: tuple[str, ...], beside: str) -> YamlEntry:
    if key == "actuators" and not any(item.above or item.beside for item in items):
        names = [item.lines[0].removeprefix("- ") for item in items]
        one = f"{key}: [{', '.join(names)}]"
        if len(one) <= WIDTH:
            return YamlEntry((one,), above, beside)
    return section(key, items, above, beside)


def _joints(names: Iterable[str]) -> str:
    quoted = [f"'{name}'" for name in names]
    return ("joint " if len(quoted) == 1 else "joints ") + ", ".join(quoted)


def _together(attached: Mapping[Pointer, Attached], pointers: Iterable[Pointer]) -> tuple[tuple[str, ...], str]:
    """The comments above and beside an entry that is made of several."""
    several = [attached[pointer] for pointer in pointers if pointer in attached]
    above = tuple(comment for one in several for comment in one.above if not _MODELINE.match(comment))
    return above, " ".join(dict.fromkeys(comment for one in several for comment in one.beside))
