"""The clauses of the specification, as the chapters state them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from spec.site.blocks import Directive, walk

SPEC = Path(__file__).resolve().parents[1]
ROOT = SPEC.parent

#: Informative chapters: they have no clauses.
INFORMATIVE = frozenset({"tutorial", "rationale", "comparison", "bibliography"})

#: The conformance level that tests a clause; ``parser`` if the suite cannot test it.
LEVELS = ("accept", "structure", "kinematics", "dynamics", "diagnose", "parser")

#: Versions of the format, with which clauses are marked; a clause of version 2 is also of version 2.1.
VERSIONS = ("1", "2", "2.1")

_UNMARKED = ("1", "2")

ID = re.compile(r"EU-[A-Z]{3}-[0-9]{3}")

_KEYWORD = re.compile(r"\b(?:MUST NOT|MUST|SHOULD NOT|SHOULD|MAY)\b")
_CODE_SPAN = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.S)


@dataclass(frozen=True, slots=True)
class Clause:
    """One requirement.

    Attributes:
        id: Its permanent id, as ``EU-CLO-003``.
        chapter: Name of the chapter that states it, without ``.md``.
        line: Line at which it begins there.
        keyword: The word that makes it a requirement; empty where it has none.
        text: What it says, in Markdown.
        level: At what level of conformance it is tested, one of `LEVELS`.
        versions: The versions of the format that it is of.
        codes: Diagnostics that say that it is not met.
        untested: Why it cannot be tested, or None.
        unenforced: Why no function of the reference enforces it, or None.
    """

    id: str
    chapter: str
    line: int
    keyword: str
    text: str
    level: str
    versions: tuple[str, ...]
    codes: tuple[str, ...]
    untested: str | None = None
    unenforced: str | None = None


@dataclass(frozen=True, slots=True)
class Withdrawn:
    """An id that is no longer used, and what replaced it."""

    id: str
    chapter: str
    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Chapter:
    """A file of the specification.

    Attributes:
        name: Its name without ``.md``.
        path: Where it is.
        text: Its text.
    """

    name: str
    path: Path
    text: str

    @property
    def is_informative(self) -> bool:
        """Whether it has no clauses."""
        return self.name in INFORMATIVE


def read_chapters(folder: Path = SPEC) -> list[Chapter]:
    """The chapters in a folder, by name; its README is not a chapter."""
    paths = sorted(path for path in folder.glob("*.md") if path.name != "README.md")
    return [Chapter(path.stem, path, path.read_text(encoding="utf-8")) for path in paths]


def read_clauses(chapters: Iterable[Chapter]) -> list[Clause]:
    """All clauses, in the order of the text."""
    return [clause for chapter in chapters for clause in _clauses_of(chapter)]


def read_withdrawn(chapters: Iterable[Chapter]) -> list[Withdrawn]:
    """All withdrawn ids, in the order of the text."""
    return [
        Withdrawn(found.argument, chapter.name, found.line, found.body)
        for chapter in chapters
        for found in directives(chapter, "withdrawn")
    ]


def directives(chapter: Chapter, name: str) -> Iterator[Directive]:
    """The directives of one name in a chapter."""
    return (block for block in walk(chapter.text) if isinstance(block, Directive) and block.name == name)


def keywords(text: str) -> list[str]:
    """The normative words in a text, in order, without those in code spans."""
    return _KEYWORD.findall(without_code(text))


def without_code(text: str) -> str:
    """The text with spaces instead of code spans and roles; the length of each line is kept."""
    return _CODE_SPAN.sub(lambda span: re.sub(r"[^\n]", " ", span[0]), text)


def _clauses_of(chapter: Chapter) -> Iterator[Clause]:
    for found in directives(chapter, "clause"):
        words = keywords(found.body)
        yield Clause(
            id=found.argument,
            chapter=chapter.name,
            line=found.line,
            keyword=words[0] if words else "",
            text=found.body,
            level=found.options.get("level", ""),
            versions=_versions(found.options.get("version")),
            codes=tuple(found.options.get("code", "").split()),
            untested=found.options.get("untested"),
            unenforced=found.options.get("unenforced"),
        )


def _versions(given: str | None) -> tuple[str, ...]:
    if given is None:
        return _UNMARKED
    return tuple(given.split())
