"""Errors in the text of the specification: ``python -m spec.site.lint`` lists them, as ``file:line: message``.

Each rule is one function. A finding ends with the name of its rule.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from eurdf.diagnostics import Rule, Severity
from eurdf.diagnostics.registry import OWN_PREFIX
from spec.site.blocks import Code, Directive, read_blocks, walk
from spec.site.citation import Citation
from spec.site.clause import (
    ID,
    LEVELS,
    ROOT,
    VERSIONS,
    Chapter,
    Clause,
    Withdrawn,
    directives,
    keywords,
    without_code,
)
from spec.site.example import DESCRIPTIONS, FILES
from spec.site.specification import Specification, Text, current_specification

#: Languages of examples of a robot.
EXAMPLE_LANGUAGES = frozenset({"yaml", "yml", "xml", "urdf"})

_OPTIONS = {
    "clause": {"level", "version", "code", "untested", "unenforced"},
    "withdrawn": set[str](),
    "example": {"file", "with", "part"},
    "diagnostic": {"file", "with", "place", "unshown"},
}

# Synonyms in RFC 2119 of the words that clauses use.
_SYNONYM = re.compile(r"\b(?:SHALL|REQUIRED|RECOMMENDED|OPTIONAL)\b")
_ROLE = re.compile(r"\{(clause|code)\}`([^`]*)`")
_LINK = re.compile(r"(?<!\\)\[(?P<text>[^\[\]]*)\]\((?P<target>[^()\s]*(?:\([^()\s]*\)[^()\s]*)*)(?:\s+\"[^\"]*\")?\)")
_AUTOLINK = re.compile(r"<(?P<target>[a-z][a-z0-9+.-]*:[^\s<>]+)>")
_SECTION_NUMBER = re.compile(
    r"§|\b(?:section|chapter|clause|paragraph)s? +[0-9]|\b(?:annex|annexes|appendix|appendices) +(?:[0-9]|[A-Z]\b)",
    re.I,
)
_NUMBERED_HEADING = re.compile(r"^(?:[0-9]+\.)+[0-9]* |^[0-9]+ +[A-Z]")


@dataclass(frozen=True, slots=True, order=True)
class Finding:
    """One error: its place, its message and the name of its rule."""

    path: Path
    line: int
    message: str
    rule: str

    def __str__(self) -> str:
        path = self.path.relative_to(ROOT) if self.path.is_relative_to(ROOT) else self.path
        return f"{path}:{self.line}: {self.message} [{self.rule}]"


def lint(spec: Specification) -> list[Finding]:
    """All errors in a specification, ordered by place."""
    return sorted(finding for rule in RULES for finding in rule(spec))


def id_form(spec: Specification) -> Iterator[Finding]:
    """An id is ``EU-``, three letters, and three digits."""
    for entry in _entries(spec):
        if not ID.fullmatch(entry.id):
            yield _at(
                spec, entry, f"'{entry.id}' is not an id: use EU-, three capital letters, -, three digits", "id-form"
            )


def id_twice(spec: Specification) -> Iterator[Finding]:
    """An id belongs to one requirement."""
    seen: set[str] = set()
    for entry in _entries(spec):
        if entry.id in seen:
            yield _at(spec, entry, f"{entry.id} occurs twice", "id-twice")
        seen.add(entry.id)


def id_listed(spec: Specification) -> Iterator[Finding]:
    """An id is never lost: the text states it or withdraws it."""
    present = {entry.id for entry in _entries(spec)}
    for number, given in enumerate(spec.ids, start=1):
        if given not in present:
            message = f"{given} was used before and is missing: state it, or withdraw it with a {{withdrawn}} directive"
            yield Finding(spec.ids_path, number, message, "id-lost")
    listed = set(spec.ids)
    for entry in _entries(spec):
        if ID.fullmatch(entry.id) and entry.id not in listed:
            message = f"{entry.id} is not in {spec.ids_path.name}: run python -m spec.site.registry"
            yield _at(spec, entry, message, "id-unlisted")


def id_informative(spec: Specification) -> Iterator[Finding]:
    """An informative chapter has no clauses."""
    for chapter in spec.chapters:
        if chapter.is_informative:
            for found in directives(chapter, "clause"):
                message = f"{found.argument} is in an informative chapter, which cannot have clauses"
                yield Finding(chapter.path, found.line, message, "clause-informative")


def one_keyword(spec: Specification) -> Iterator[Finding]:
    """A clause has exactly one normative word."""
    for clause in spec.clauses:
        words = keywords(clause.text)
        if not words:
            message = f"{clause.id} has no normative word: one of MUST, MUST NOT, SHOULD, SHOULD NOT, MAY"
            yield _at(spec, clause, message, "keyword-missing")
        elif len(words) > 1:
            message = f"{clause.id} has {len(words)} normative words ({', '.join(words)}): split it"
            yield _at(spec, clause, message, "keyword-several")


def keyword_place(spec: Specification) -> Iterator[Finding]:
    """Normative words occur only in clauses and where they are defined; their synonyms do not occur."""
    for text in spec.texts():
        if text.defines_words:
            continue
        plain = without_code(text.text)
        for match in _SYNONYM.finditer(plain):
            message = f"{match[0]}: clauses say MUST, SHOULD or MAY"
            yield _in(text, match.start(), message, "keyword-other")
        if "clause" not in text.inside and (words := keywords(text.text)):
            message = f"{words[0]} outside a clause: only clauses are normative"
            yield _in(text, plain.index(words[0]), message, "keyword-outside")


def options(spec: Specification) -> Iterator[Finding]:
    """Directives have known options; a clause has a known level and known versions."""
    for chapter, found in _directives(spec, *_OPTIONS):
        for name in sorted(found.options.keys() - _OPTIONS[found.name]):
            message = f"a {{{found.name}}} has no option '{name}'"
            yield Finding(chapter.path, found.line, message, "option-unknown")
    for clause in spec.clauses:
        if clause.level not in LEVELS:
            given = f"the level '{clause.level}'" if clause.level else "no level"
            yield _at(spec, clause, f"{clause.id} has {given}: one of {', '.join(LEVELS)}", "clause-level")
    for chapter, found in _directives(spec, "clause"):
        version = found.options.get("version")
        if version is not None and version not in ("1 2", *VERSIONS):
            message = f"{found.argument} has the version '{version}': 1, 2, 2.1 or 1 2"
            yield Finding(chapter.path, found.line, message, "clause-version")


def reasons(spec: Specification) -> Iterator[Finding]:
    """A clause that is not tested or enforced, or a diagnostic that is not shown, states the reason."""
    for chapter, found in _directives(spec, "clause", "diagnostic"):
        for name in ("untested", "unenforced", "unshown"):
            if found.options.get(name) == "":
                message = f"'{name}' has no reason"
                yield Finding(chapter.path, found.line, message, "reason-missing")


def codes(spec: Specification) -> Iterator[Finding]:
    """A diagnostic and its clause name each other; an error belongs to a MUST, a warning to a SHOULD."""
    for clause in spec.clauses:
        for code in clause.codes:
            rule = spec.codes.get(code)
            if rule is None:
                yield _at(spec, clause, f"{clause.id} names '{code}', which is not a diagnostic", "code-unknown")
            elif rule.clause != clause.id:
                message = f"{clause.id} names '{code}', which cites {rule.clause or 'no clause'}"
                yield _at(spec, clause, message, "code-elsewhere")
            else:
                word = "MUST" if rule.severity is Severity.ERROR else "SHOULD"
                if clause.keyword.split()[:1] not in ([word], []):
                    message = f"'{code}' has severity {rule.severity}, but {clause.id} has no {word}"
                    yield _at(spec, clause, message, "code-severity")
    for code, rule in spec.codes.items():
        if code.startswith(OWN_PREFIX) or rule.clause is None:
            yield from _own_code(spec, code, rule)
            continue
        cites = spec.by_id.get(rule.clause)
        if cites is None:
            message = f"'{code}' cites {rule.clause}, which is not a clause"
            yield Finding(spec.codes_path, _line_of(spec.codes_path, code), message, "code-clause")
        elif code not in cites.codes:
            yield _at(spec, cites, f"{cites.id} does not name '{code}', which cites it", "code-unnamed")


def _own_code(spec: Specification, code: str, rule: Rule) -> Iterator[Finding]:
    """A code that begins with ``x-`` is a warning without a clause; any other code has a clause."""
    line = _line_of(spec.codes_path, code)
    if not code.startswith(OWN_PREFIX):
        yield Finding(spec.codes_path, line, f"'{code}' cites no clause", "code-clause")
    elif rule.clause is not None or rule.severity is not Severity.WARNING:
        message = f"'{code}' is advice of the parser itself: it must be a warning that cites no clause"
        yield Finding(spec.codes_path, line, message, "code-own")


def enforced(spec: Specification) -> Iterator[Finding]:
    """A function of the reference enforces each clause, or the clause states why not; cited clauses exist."""
    enforcing = {citation.clause for citation in spec.functions}
    for clause in spec.clauses:
        if clause.id not in enforcing and clause.unenforced is None:
            message = f"{clause.id} is enforced by no function of the reference and has no 'unenforced' reason"
            yield _at(spec, clause, message, "clause-unenforced")
        elif clause.id in enforcing and clause.unenforced is not None:
            names = sorted(citation.source for citation in spec.functions if citation.clause == clause.id)
            message = f"{clause.id} has an 'unenforced' reason, but {names[0]} enforces it"
            yield _at(spec, clause, message, "clause-enforced")
    for citation in spec.functions:
        yield from _unknown(spec, citation, "function-cites")


def tested(spec: Specification) -> Iterator[Finding]:
    """If the suite is present, a case cites each clause, or the clause states why not."""
    if spec.cases is None:
        return
    testing = {citation.clause: citation.source for citation in spec.cases}
    for clause in spec.clauses:
        if clause.id not in testing and clause.untested is None and clause.level != "parser":
            message = f"{clause.id} is cited by no case of the suite and has no 'untested' reason"
            yield _at(spec, clause, message, "clause-untested")
        elif clause.id in testing and clause.untested is not None:
            message = f"{clause.id} has an 'untested' reason, but case {testing[clause.id]} tests it"
            yield _at(spec, clause, message, "clause-tested")
    for citation in spec.cases:
        yield from _unknown(spec, citation, "case-cites")


def roles(spec: Specification) -> Iterator[Finding]:
    """References to clauses and diagnostics use their roles, and their targets exist."""
    known = {entry.id for entry in _entries(spec)}
    for text in spec.texts():
        for match in _ROLE.finditer(text.text):
            kind, name = match.groups()
            if name not in (known if kind == "clause" else spec.codes):
                what = "clause" if kind == "clause" else "diagnostic"
                yield _in(text, match.start(), f"there is no {what} '{name}'", "role-unknown")
        for match in ID.finditer(_ROLE.sub(lambda role: " " * len(role[0]), text.text)):
            message = f"write {{clause}}`{match[0]}`, so that it is a link"
            yield _in(text, match.start(), message, "role-missing")


def links(spec: Specification) -> Iterator[Finding]:
    """An internal link leads to an existing file; an external link is an https address."""
    for text in spec.texts():
        plain = without_code(text.text)
        for match in [*_LINK.finditer(plain), *_AUTOLINK.finditer(plain)]:
            target = match["target"]
            address = urlsplit(target.removeprefix("path:"))
            if address.scheme or address.netloc:
                if address.scheme != "mailto" and (address.scheme != "https" or "." not in address.netloc):
                    yield _in(text, match.start(), f"'{target}' is not an https address", "link-form")
            elif address.path and not (text.chapter.path.parent / address.path).exists():
                yield _in(text, match.start(), f"there is no file '{address.path}'", "link-missing")


def section_numbers(spec: Specification) -> Iterator[Finding]:
    """No reference uses a section number, except in the text of links to other documents."""
    for text in spec.texts():
        plain = _LINK.sub(_blank_if_external, without_code(text.text))
        for match in _SECTION_NUMBER.finditer(plain):
            message = (
                f"'{plain[match.start() : match.end()].strip()}…': refer to it by a link, a clause or a diagnostic"
            )
            yield _in(text, match.start(), message, "section-number")
        if text.is_heading and _NUMBERED_HEADING.match(text.text):
            yield _in(text, 0, "remove the number from the heading", "section-number")


def bare_examples(spec: Specification) -> Iterator[Finding]:
    """Every description or URDF in the text is an ``{example}``, so that it is checked."""
    for chapter in spec.chapters:
        for block in walk(chapter.text):
            language = ""
            if isinstance(block, Code):
                language = block.language
            elif isinstance(block, Directive) and block.name in ("code", "code-block", "sourcecode", "literalinclude"):
                language = block.options.get("language", block.argument)
            if language.lower() in EXAMPLE_LANGUAGES:
                message = f"a block of {language}: make it an {{example}}, which is checked"
                yield Finding(chapter.path, block.line, message, "example-bare")


def shown_codes(spec: Specification) -> Iterator[Finding]:
    """Examples and diagnostics name existing codes, files and robots; each diagnostic occurs once."""
    seen: Counter[str] = Counter()
    for chapter, found in _directives(spec, "example", "diagnostic"):
        known = {"valid", *spec.codes} if found.name == "example" else set(spec.codes)
        if found.argument not in known:
            message = f"there is no diagnostic '{found.argument}'"
            yield Finding(chapter.path, found.line, message, f"{found.name}-code")
        file = found.options.get("file", DESCRIPTIONS[0])
        if file not in FILES:
            message = f"'{file}' is not one of {', '.join(FILES)}"
            yield Finding(chapter.path, found.line, message, f"{found.name}-file")
        robot = found.options.get("with")
        if robot is not None and not (spec.examples / robot).is_dir():
            message = f"there is no robot '{robot}' in {spec.examples.name}/"
            yield Finding(chapter.path, found.line, message, f"{found.name}-robot")
        if found.name == "diagnostic":
            seen[found.argument] += 1
            if seen[found.argument] == 2:
                yield Finding(chapter.path, found.line, f"'{found.argument}' is shown twice", "diagnostic-twice")
            yield from _edit_and_place(chapter, found)


def _edit_and_place(chapter: Chapter, found: Directive) -> Iterator[Finding]:
    """A diagnostic is shown by one edit, or states why not, and states what it points at."""
    diffs = sum(isinstance(block, Code) and block.language == "diff" for block in read_blocks(found.body))
    if diffs != (0 if "unshown" in found.options else 1):
        message = f"'{found.argument}' has {diffs} blocks of diff: use one, or none with 'unshown'"
        yield Finding(chapter.path, found.line, message, "diagnostic-diff")
    if not found.options.get("place"):
        message = f"'{found.argument}' does not state what it points at: add 'place'"
        yield Finding(chapter.path, found.line, message, "diagnostic-place")


#: All rules, in the order in which they run.
RULES: tuple[Callable[[Specification], Iterable[Finding]], ...] = (
    id_form,
    id_twice,
    id_listed,
    id_informative,
    one_keyword,
    keyword_place,
    options,
    reasons,
    codes,
    enforced,
    tested,
    roles,
    links,
    section_numbers,
    bare_examples,
    shown_codes,
)


def main() -> int:
    """List the errors, and return 1 if there are any."""
    findings = lint(current_specification())
    for finding in findings:
        print(finding)
    print(f"{len(findings)} findings" if findings else "the specification is sound", file=sys.stderr)
    return 1 if findings else 0


def _entries(spec: Specification) -> list[Clause | Withdrawn]:
    return [*spec.clauses, *spec.withdrawn]


def _at(spec: Specification, entry: Clause | Withdrawn, message: str, rule: str) -> Finding:
    return Finding(spec.paths[entry.chapter], entry.line, message, rule)


def _in(text: Text, offset: int, message: str, rule: str) -> Finding:
    return Finding(text.chapter.path, text.line_of(offset), message, rule)


def _directives(spec: Specification, *names: str) -> Iterator[tuple[Chapter, Directive]]:
    for chapter in spec.chapters:
        for block in walk(chapter.text):
            if isinstance(block, Directive) and block.name in names:
                yield chapter, block


def _unknown(spec: Specification, citation: Citation, rule: str) -> Iterator[Finding]:
    if citation.clause not in spec.by_id:
        withdrawn = any(citation.clause == gone.id for gone in spec.withdrawn)
        what = "is withdrawn" if withdrawn else "is not a clause"
        message = f"{citation.source} cites {citation.clause}, which {what}"
        yield Finding(citation.path, citation.line, message, rule)


def _line_of(path: Path, word: str) -> int:
    """The line of a file that begins with a word; 1 if none does."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return next((number for number, line in enumerate(lines, start=1) if line.split()[:1] == [word]), 1)


def _blank_if_external(link: re.Match[str]) -> str:
    blank = " " * len(link[0])
    return blank if urlsplit(link["target"]).scheme else link["text"].ljust(len(link[0]))


if __name__ == "__main__":
    sys.exit(main())
