"""The examples in the text, and the edits that show diagnostics, with the diagnostics of the reference."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import eurdf
from eurdf.diagnostics.text import Line, report_lines
from spec.site.blocks import Code, Directive, read_blocks
from spec.site.clause import SPEC, Chapter, directives

#: Sound robots for examples and diagnostics, one in each folder.
EXAMPLES = SPEC / "examples"

#: The default robot of an example.
DEFAULT_ROBOT = "four_bar"

#: Files that describe a robot, in version 2 and in version 1.
DESCRIPTIONS = ("robot.yaml", "robot.v1.yaml")

URDF = "robot.urdf"

#: Files that an example can show.
FILES = (*DESCRIPTIONS, URDF)

#: The folder of a robot in messages.
SHOWN_FOLDER = "my_robot"

_TOP_LEVEL = re.compile(r"^(?![\s#-])(?P<key>\"[^\"]*\"|'[^']*'|[^:]*?)\s*:(?:\s|$)")


class NotAnEdit(ValueError):  # noqa: N818 - named after the error, like the exceptions of the reference
    """A diff that does not fit its robot."""


@dataclass(frozen=True, slots=True)
class ShownRobot:
    """The robot of an example.

    Attributes:
        files: Its files, by name.
        checked: The checked file: the description, or the URDF if there is none.
    """

    files: Mapping[str, str]
    checked: str

    def check(self) -> Outcome:
        """The diagnostics of the reference."""
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made).resolve()
            for name, text in self.files.items():
                (folder / name).write_text(text, encoding="utf-8")
            urdf = folder / URDF if self.checked == "robot.v1.yaml" else None
            report = eurdf.check(folder / self.checked, urdf)
            printed = [
                [(text.replace(str(folder), SHOWN_FOLDER), style) for text, style in line]
                for line in report_lines(report)
            ]
            return Outcome(tuple(found.code for found in report.diagnostics), tuple(printed))


@dataclass(frozen=True, slots=True)
class Outcome:
    """The diagnostics of a robot.

    Attributes:
        codes: The diagnostics, in the order found.
        lines: What ``eurdf check`` prints of them, as lines of styled pieces.
    """

    codes: tuple[str, ...]
    lines: tuple[Line, ...]

    @property
    def text(self) -> str:
        """The output of ``eurdf check``."""
        return "\n".join("".join(text for text, _ in line) for line in self.lines)


@dataclass(frozen=True, slots=True)
class Example:
    """A description or a URDF in the text.

    Attributes:
        chapter: Chapter that shows it.
        line: Line of its fence there.
        code: The diagnostic that it illustrates; None where it is sound.
        file: Which file of a robot it is.
        robot: The robot with the other files; None for a URDF without a description.
        part: Whether it is a fragment.
        text: The file, or the fragment.
    """

    chapter: str
    line: int
    code: str | None
    file: str
    robot: str | None
    part: bool
    text: str

    @property
    def expected(self) -> tuple[str, ...]:
        """The diagnostics that it gives."""
        return () if self.code is None else (self.code,)

    def shown(self, examples: Path = EXAMPLES) -> ShownRobot:
        """The robot of the example."""
        files = {} if self.robot is None else _files(examples / self.robot)
        text = self.text + "\n"
        if self.part:
            text = with_elements(files[URDF], text) if self.file == URDF else with_keys(files[self.file], text)
        return _robot(files | {self.file: text}, self.file)


@dataclass(frozen=True, slots=True)
class ShownDiagnostic:
    """A diagnostic, and the edit of a sound robot that causes it.

    Attributes:
        chapter: Chapter that shows it.
        line: Line of its fence there.
        code: The diagnostic.
        file: The file that is edited.
        robot: The robot that is edited.
        diff: The edit: lines that begin with ``-``, ``+`` or a blank; None where no edit can show it.
        unshown: Why no edit can show it, or None.
        place: What it points at, in Markdown.
        text: What usually causes it, and what to do, in Markdown.
    """

    chapter: str
    line: int
    code: str
    file: str
    robot: str
    diff: str | None
    unshown: str | None
    place: str
    text: str

    def sound(self, examples: Path = EXAMPLES) -> ShownRobot:
        """The robot before the edit."""
        return _robot(_files(examples / self.robot), self.file)

    def faulty(self, examples: Path = EXAMPLES) -> ShownRobot:
        """The robot after the edit."""
        sound = self.sound(examples)
        return _robot({**sound.files, self.file: self.edit(examples).after}, self.file)

    def edit(self, examples: Path = EXAMPLES) -> Edit:
        """Apply the edit to the file of the robot.

        Raises:
            NotAnEdit: If the lines to replace do not occur together exactly once.
        """
        return _edited(_files(examples / self.robot)[self.file], self.diff or "")


@dataclass(frozen=True, slots=True)
class Edit:
    """An edit of a file.

    Attributes:
        before: The file without it.
        after: The file with it.
        start: Index of the first line that differs.
        removed: Number of lines of ``before`` that it replaces.
        added: Number of lines that replace them.
    """

    before: str
    after: str
    start: int
    removed: int
    added: int


def read_examples(chapters: Iterable[Chapter]) -> list[Example]:
    """All examples, in the order of the text."""
    return [example_of(found, chapter.name) for chapter in chapters for found in directives(chapter, "example")]


def read_diagnostics(chapters: Iterable[Chapter]) -> list[ShownDiagnostic]:
    """All diagnostics that the text shows, in order."""
    return [diagnostic_of(found, chapter.name) for chapter in chapters for found in directives(chapter, "diagnostic")]


def example_of(found: Directive, chapter: str) -> Example:
    """The example of a directive."""
    file = found.options.get("file", DESCRIPTIONS[0])
    part = "part" in found.options
    # A complete URDF has other names than the default robot.
    alone = file == URDF and not part
    robot = found.options.get("with", None if alone else DEFAULT_ROBOT)
    code = None if found.argument == "valid" else found.argument
    return Example(chapter, found.line, code, file, robot, part, found.body)


def diagnostic_of(found: Directive, chapter: str) -> ShownDiagnostic:
    """The diagnostic of a directive."""
    blocks = [
        block
        for block in read_blocks(found.body, found.body_line)
        if isinstance(block, Code) and block.language == "diff"
    ]
    lines = found.body.splitlines()
    for block in blocks:
        start = block.line - found.body_line
        lines[start : start + len(block.text.splitlines()) + 2] = [""]
    return ShownDiagnostic(
        chapter=chapter,
        line=found.line,
        code=found.argument,
        file=found.options.get("file", DESCRIPTIONS[0]),
        robot=found.options.get("with", DEFAULT_ROBOT),
        diff=blocks[0].text if blocks else None,
        unshown=found.options.get("unshown"),
        place=found.options.get("place", ""),
        text="\n".join(lines).strip(),
    )


def with_keys(base: str, fragment: str) -> str:
    """A YAML mapping with its top-level keys replaced by those of another; both may be malformed."""
    new = dict(_top_level(fragment))
    kept = [(key, new.pop(key, text)) for key, text in _top_level(base)]
    return "".join(text for _, text in [*kept, *new.items()])


def with_elements(base: str, fragment: str) -> str:
    """A URDF with elements added at its end; they may be malformed."""
    head, end, tail = base.rpartition("</robot>")
    return head + fragment + end + tail


def _top_level(text: str) -> Iterator[tuple[str, str]]:
    """The text of each top-level key; text before the first one has the empty key."""
    key, lines = "", list[str]()
    for line in text.splitlines(keepends=True):
        if match := _TOP_LEVEL.match(line):
            if lines:
                yield key, "".join(lines)
            key, lines = match["key"].strip("\"'"), []
        lines.append(line)
    if lines:
        yield key, "".join(lines)


def _edited(text: str, diff: str) -> Edit:
    rows = [row for row in diff.splitlines() if row.strip()]
    if strange := [row for row in rows if row[0] not in "+- "]:
        raise NotAnEdit(f"a line of a diff must begin with -, + or a space: {strange[0]!r}")
    old = [row[1:] for row in rows if row[0] != "+"]
    new = [row[1:] for row in rows if row[0] != "-"]
    if not old:
        raise NotAnEdit("a diff needs a line that begins with - or a space")
    lines = text.split("\n")
    starts = [start for start in range(len(lines)) if lines[start : start + len(old)] == old]
    if len(starts) != 1:
        raise NotAnEdit(f"the lines to replace occur {len(starts)} times, not once: {old[0].strip()!r} …")
    lead = next((count for count, row in enumerate(rows) if row[0] != " "), 0)
    trail = next((count for count, row in enumerate(reversed(rows)) if row[0] != " "), 0)
    after = "\n".join([*lines[: starts[0]], *new, *lines[starts[0] + len(old) :]])
    return Edit(text, after, starts[0] + lead, len(old) - lead - trail, len(new) - lead - trail)


def _files(folder: Path) -> dict[str, str]:
    return {name: (folder / name).read_text(encoding="utf-8") for name in FILES if (folder / name).exists()}


def _robot(files: Mapping[str, str], file: str) -> ShownRobot:
    """The robot of a shown file. That file is checked; for a URDF, its description is."""
    checked = next((name for name in DESCRIPTIONS if name in files), URDF) if file == URDF else file
    return ShownRobot(files, checked)
