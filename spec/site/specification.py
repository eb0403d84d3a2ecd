"""The specification: its chapters, and what must agree with them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from eurdf.diagnostics import REGISTRY, Rule, registry
from spec.site.blocks import Directive, Heading, Prose, read_blocks
from spec.site.citation import Citation, function_citations, suite_citations
from spec.site.clause import SPEC, Chapter, Clause, Withdrawn, read_chapters, read_clauses, read_withdrawn
from spec.site.example import EXAMPLES
from spec.site.registry import IDS, read_ids

#: The section that names it defines the normative words.
SOURCE_OF_WORDS = "RFC 2119"

_COMMENT = re.compile(r"<!--.*?-->|^%.*$", re.S | re.M)


@dataclass(frozen=True)
class Specification:
    """The text, and what must agree with it.

    Attributes:
        chapters: The text.
        codes: All diagnostics, by code.
        codes_path: The file that lists them.
        ids: Every id ever used.
        ids_path: The file that lists them.
        functions: Citations by functions of the reference.
        cases: Citations by cases of the suite; None if there is no suite.
        examples: Folder of the robots of examples and diagnostics.
    """

    chapters: Sequence[Chapter]
    codes: Mapping[str, Rule]
    codes_path: Path
    ids: Sequence[str]
    ids_path: Path
    functions: Sequence[Citation]
    cases: Sequence[Citation] | None
    examples: Path = field(default=EXAMPLES)

    @cached_property
    def clauses(self) -> list[Clause]:
        """The clauses of the text."""
        return read_clauses(self.chapters)

    @cached_property
    def withdrawn(self) -> list[Withdrawn]:
        """The ids that the text withdraws."""
        return read_withdrawn(self.chapters)

    @cached_property
    def by_id(self) -> dict[str, Clause]:
        """The clauses, by id."""
        return {clause.id: clause for clause in self.clauses}

    @cached_property
    def paths(self) -> dict[str, Path]:
        """The files of the chapters, by name."""
        return {chapter.name: chapter.path for chapter in self.chapters}

    def texts(self) -> Iterator[Text]:
        """All prose, paragraph by paragraph, without code."""
        for chapter in self.chapters:
            yield from _texts(chapter, chapter.text, 1, (), _defining_lines(chapter))


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph, or a heading.

    Attributes:
        chapter: Its chapter.
        line: Its first line there.
        text: Its text; comments are blank.
        inside: Names of the directives around it, the outermost first.
        is_heading: Whether it is a heading.
        defines_words: Whether it is in the section that defines the normative words.
    """

    chapter: Chapter
    line: int
    text: str
    inside: tuple[str, ...] = ()
    is_heading: bool = False
    defines_words: bool = False

    def line_of(self, offset: int) -> int:
        """The line of a character."""
        return self.line + self.text.count("\n", 0, offset)


def current_specification(folder: Path = SPEC) -> Specification:
    """The current specification."""
    return Specification(
        chapters=read_chapters(folder),
        codes=REGISTRY,
        codes_path=Path(registry.__file__),
        ids=read_ids(),
        ids_path=IDS,
        functions=function_citations(),
        cases=suite_citations(),
    )


def _texts(chapter: Chapter, text: str, line: int, inside: tuple[str, ...], defining: frozenset[int]) -> Iterator[Text]:
    for block in read_blocks(text, line):
        if isinstance(block, Directive) and not block.is_code:
            yield from _texts(chapter, block.body, block.body_line, (*inside, block.name), defining)
        elif isinstance(block, Prose | Heading):
            shown = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), block.text)
            yield Text(chapter, block.line, shown, inside, isinstance(block, Heading), block.line in defining)


def _defining_lines(chapter: Chapter) -> frozenset[int]:
    """First lines of the blocks in the section that defines the normative words."""
    if chapter.is_informative:
        return frozenset()
    sections: list[list[Heading | Prose]] = [[]]
    for block in read_blocks(chapter.text):
        if isinstance(block, Heading):
            sections.append([])
        if isinstance(block, Heading | Prose):
            sections[-1].append(block)
    return frozenset(
        block.line
        for section in sections
        if any(SOURCE_OF_WORDS in block.text for block in section)
        for block in section
    )
