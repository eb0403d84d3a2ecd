"""The directives of the chapters, and those of pages that are generated when the site is built."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from typing import Any, ClassVar, cast

from docutils import nodes
from docutils.nodes import Node
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from eurdf.diagnostics import REGISTRY
from spec.site.blocks import Directive
from spec.site.citation import Citation
from spec.site.clause import ROOT, without_code
from spec.site.domain import NAME, SpecificationDomain, reference_to
from spec.site.example import EXAMPLES, Edit, NotAnEdit, Outcome, ShownDiagnostic, diagnostic_of, example_of
from spec.site.pages import source_url
from spec.site.registry import clauses_with_references
from spec.site.schema_page import property_anchors, schema_sections

_KEYWORD = re.compile(r"\b(?:MUST NOT|MUST|SHOULD NOT|SHOULD|MAY)\b")

#: Lines of a file shown before and after the changed lines.
_CONTEXT = 2

_LANGUAGES = {".yaml": "yaml", ".urdf": "xml"}

_SIDES = {"→": "eu-asked", "←": "eu-answered"}

# Styles in which `eurdf check` prints, as classes of the site.
_STYLES = {
    "bold": "eu-bold",
    "dim": "eu-dim",
    "blue": "eu-gutter",
    "red": "eu-error",
    "yellow": "eu-warning",
    "cyan": "eu-hint",
}


class SpecificationDirective(SphinxDirective):
    """A directive of the specification."""

    has_content = True
    required_arguments = 1

    @property
    def domain(self) -> SpecificationDomain:
        """The named items of the site."""
        return cast(SpecificationDomain, self.env.domains[NAME])

    @property
    def page(self) -> str:
        """Name of the current page."""
        return self.env.current_document.docname

    @property
    def stated(self) -> Directive:
        """The directive as `blocks` reads it."""
        options = {name: value or "" for name, value in self.options.items()}
        body = "\n".join(self.content)
        return Directive(self.lineno, self.name, self.arguments[0], options, body, self.content_offset + 1)

    def reference(self, what: str, name: str) -> Node:
        """A link to a clause or a diagnostic."""
        return reference_to(what, name, self.page)

    def anchored(self, name: str, title: str, *children: Node) -> nodes.container:
        """A clause, with its anchor."""
        self.domain.note("clause", name, title)
        block = nodes.container("", *children, ids=[name], classes=["eu-clause"])
        self.set_source_info(block)
        return block

    def parsed(self, text: str) -> list[Node]:
        """Rendered Markdown."""
        return self.parse_text_to_nodes(text, offset=self.content_offset)


class ClauseDirective(SpecificationDirective):
    """``{clause}``: one requirement, with its anchor, its diagnostics, and what enforces and tests it."""

    option_spec: ClassVar = dict.fromkeys(
        ("level", "version", "code", "untested", "unenforced"), directives.unchanged_required
    )

    def run(self) -> list[Node]:
        """The rendered clause."""
        name = self.arguments[0]
        entry = _registry(self).get(name)
        if entry is None:
            raise self.error(f"'{name}' is not a clause of the specification")
        head = _line("eu-head", _permalink(name), *_badge(f"level {entry['level']}"))
        if len(entry["versions"]) == 1:
            head += _badge(f"version {entry['versions'][0]}")
        body = nodes.container("", *self.parse_content_to_nodes(), classes=["eu-body"])
        _embolden(body)
        foot = nodes.container("", *self._facts(entry), classes=["eu-foot"])
        return [self.anchored(name, _plain(entry["text"]), head, body, foot)]

    def _facts(self, entry: dict[str, Any]) -> Iterator[Node]:
        if entry["codes"]:
            yield _fact("Diagnostic", _spaced(self.reference("code", code) for code in entry["codes"]))
        if entry["functions"]:
            yield from _folded("Enforced by", "function", entry["functions"])
        if entry["unenforced"]:
            yield _fact("Not enforced", [nodes.Text(entry["unenforced"])])
        if entry["cases"]:
            yield from _folded("Tested by", "case", entry["cases"])
        if entry["untested"]:
            yield _fact("Not tested", [nodes.Text(entry["untested"])])


class WithdrawnDirective(SpecificationDirective):
    """``{withdrawn}``: an id that is no longer used, and what replaced it."""

    option_spec: ClassVar[dict[str, Callable[[str], Any]]] = {}

    def run(self) -> list[Node]:
        """The rendered id."""
        name = self.arguments[0]
        head = _line("eu-head", _permalink(name), *_badge("withdrawn"))
        block = self.anchored(name, "Withdrawn", head, *self.parse_content_to_nodes())
        block["classes"].append("eu-withdrawn")
        return [block]


class ExampleDirective(SpecificationDirective):
    """``{example}``: a description or URDF that the reference has checked."""

    option_spec: ClassVar = {"file": directives.unchanged, "with": directives.unchanged, "part": directives.flag}

    def run(self) -> list[Node]:
        """The rendered example."""
        example = example_of(self.stated, self.page)
        caption = _line("eu-caption", nodes.literal("", example.file))
        if example.part:
            caption += nodes.Text(", in part")
        block = nodes.container("", caption, classes=["eu-example"])
        block += _code("\n".join(self.content), example.file)
        if example.code is not None:
            caption += [nodes.Text(" · wrong: "), self.reference("code", example.code)]
            block["classes"].append("eu-wrong")
            # In the checked file, the lines of a fragment have other numbers.
            block += _printed(example.shown().check(), with_source=not example.part)
        return [block]


class DiagnosticDirective(SpecificationDirective):
    """``{diagnostic}``: one code, the edit that causes it, its message and its fix."""

    option_spec: ClassVar = {
        "file": directives.unchanged,
        "with": directives.unchanged,
        "place": directives.unchanged_required,
        "unshown": directives.unchanged_required,
    }

    def run(self) -> list[Node]:
        """The rendered diagnostic."""
        shown = diagnostic_of(self.stated, self.page)
        if shown.code not in REGISTRY:
            raise self.error(f"there is no diagnostic '{shown.code}'")
        rule = REGISTRY[shown.code]
        head = _line("eu-head", *_badge(rule.severity, f"eu-severity-{rule.severity}"))
        head += _badge(f"phase {rule.phase}")
        if rule.clause is not None:
            head += [nodes.Text(" "), self.reference("clause", rule.clause)]
        self.domain.note("code", shown.code, rule.title)
        block = nodes.container("", _line("eu-title", nodes.Text(rule.title)), head, classes=["eu-code"])
        block += _fact("Points at", self.parse_inline(shown.place)[0])
        if shown.unshown is not None:
            block += _fact("Not shown", [nodes.Text(shown.unshown)])
        else:
            try:
                block += self._edit(shown)
            except NotAnEdit as error:
                raise self.error(f"'{shown.code}': {error}") from error
        block += self.parsed(shown.text)
        return [block]

    def _edit(self, shown: ShownDiagnostic) -> list[Node]:
        edit = shown.edit(EXAMPLES)
        outcome = shown.faulty(EXAMPLES).check()
        return [
            _line("eu-caption eu-caption-wrong", nodes.Text("Wrong, in "), nodes.literal("", shown.file)),
            _excerpt(edit, edit.after, edit.added, shown.file),
            _printed(outcome),
            _line("eu-caption eu-caption-right", nodes.Text("Right")),
            _excerpt(edit, edit.before, edit.removed, shown.file),
        ]


class TranscriptDirective(SpecificationDirective):
    """``{transcript}``: a conversation; → marks a request and ← an answer."""

    required_arguments = 0

    def run(self) -> list[Node]:
        """The rendered conversation."""
        block = _styled("eu-transcript")
        side = ""
        for line in self.content:
            side = _SIDES.get(line[:1], side)
            block += [nodes.inline("", line, classes=["eu-line", "eu-said", side]), nodes.Text("\n")]
        return [block]


class AllClausesDirective(SpecificationDirective):
    """``{all-clauses}``: a table of all clauses."""

    required_arguments = 0

    def run(self) -> list[Node]:
        """The table."""
        rows = []
        for entry in _registry(self).values():
            text = nodes.paragraph("", "", *self.parse_inline(_first_sentence(entry["text"]))[0])
            codes = nodes.paragraph("", "", *_spaced(self.reference("code", code) for code in entry["codes"]))
            clause = nodes.paragraph("", "", self.reference("clause", entry["id"]))
            rows.append([clause, nodes.paragraph("", entry["level"]), text, codes])
        return [_table("Clause", "Level", "Requirement", "Diagnostics", rows=rows)]


class DiagnosticsDirective(SpecificationDirective):
    """``{diagnostics}``: a table of diagnostics, one code per line; each row leads to the page of its code.

    A row has its code as anchor: the address that a diagnostic had when this page showed it.
    """

    required_arguments = 0

    def run(self) -> list[Node]:
        """The table."""
        table = _table("Diagnostic", "Severity, phase", "What is wrong", "Clause", rows=map(self._row, self.content))
        (body,) = table.findall(nodes.tbody)
        for code, row in zip(self.content, body.findall(nodes.row), strict=True):
            row["ids"] = [code]
        return [table]

    def _row(self, code: str) -> list[Node]:
        rule = REGISTRY[code]
        return [
            nodes.paragraph("", "", self.reference("code", code)),
            nodes.paragraph("", f"{rule.severity}, {rule.phase}"),
            nodes.paragraph("", rule.title),
            nodes.paragraph("", "", *([] if rule.clause is None else [self.reference("clause", rule.clause)])),
        ]


class SchemaDirective(SpecificationDirective):
    """``{schema} extended-urdf-2.0``: the contents of a JSON Schema, property by property."""

    def run(self) -> list[Node]:
        """The sections of the page."""
        path = ROOT / "schema" / f"{self.arguments[0]}.schema.json"
        self.env.note_dependency(str(path))
        schema = json.loads(path.read_text(encoding="utf-8"))
        for anchor, title in property_anchors(schema):
            self.domain.note("property", anchor, title)
        sections: list[Node] = list(schema_sections(schema))
        for section in sections:
            self.state.document.note_implicit_target(cast(nodes.Element, section))
        return sections


def _registry(directive: SpecificationDirective) -> dict[str, dict[str, Any]]:
    """The clauses by id, with what refers to them; read once per build."""
    app = directive.env.app
    if not hasattr(app, "eurdf_clauses"):
        app.eurdf_clauses = clauses_with_references()  # type: ignore[attr-defined]
    clauses: dict[str, dict[str, Any]] = app.eurdf_clauses  # type: ignore[attr-defined]
    return clauses


def _permalink(name: str) -> nodes.reference:
    return nodes.reference("", "", nodes.literal("", name), refid=name, classes=["eu-name"])


def _badge(text: str, *classes: str) -> list[Node]:
    return [nodes.Text(" "), nodes.inline("", text, classes=["eu-badge", *classes])]


def _line(classes: str, *children: Node) -> nodes.paragraph:
    return nodes.paragraph("", "", *children, classes=classes.split())


def _fact(label: str, said: Iterable[Node]) -> nodes.paragraph:
    return _line("eu-fact", nodes.inline("", label, classes=["eu-label"]), nodes.Text(" "), *said)


def _folded(label: str, kind: str, citations: Sequence[Citation]) -> Iterator[Node]:
    """What cites a clause: its number, and on a click its names, each with a link to its file."""
    count = f"{len(citations)} {kind}" if len(citations) == 1 else f"{len(citations)} {kind}s"
    opening = f'<details class="eu-citing"><summary><span class="eu-label">{label}</span> {count}</summary><ul>'
    items = "".join(f'<li><a href="{_url(each)}"><code>{escape(each.source)}</code></a></li>' for each in citations)
    yield nodes.raw("", f"{opening}{items}</ul></details>", format="html")


def _url(citation: Citation) -> str:
    return escape(source_url(citation.path.relative_to(ROOT).as_posix(), citation.line))


def _spaced(values: Iterable[Node]) -> Iterator[Node]:
    for index, value in enumerate(values):
        if index:
            yield nodes.Text(" ")
        yield value


def _code(text: str, file: str, first_line: int | None = None, marked: Iterable[int] = ()) -> nodes.literal_block:
    """Lines of a file. Errors in them are intended, so no lexer has to accept them."""
    block = nodes.literal_block(text, text, language=_LANGUAGES[file[file.rindex(".") :]], force=True)
    block["highlight_args"] = {"hl_lines": list(marked)}
    if first_line is not None:
        block["linenos"] = True
        block["highlight_args"]["linenostart"] = first_line
    return block


def _excerpt(edit: Edit, text: str, changed: int, file: str) -> nodes.literal_block:
    """The lines of a file around the changed ones, which are marked."""
    lines = text.rstrip("\n").split("\n")
    start = max(0, edit.start - _CONTEXT)
    end = min(len(lines), edit.start + changed + _CONTEXT)
    marked = range(edit.start - start + 1, edit.start - start + changed + 1)
    return _code("\n".join(lines[start:end]), file, start + 1, marked)


def _printed(outcome: Outcome, with_source: bool = True) -> nodes.literal_block:
    """The output of `eurdf check`, in its colours."""
    block = _styled("eu-printed")
    for line in outcome.lines:
        is_source = any("|" in text for text, style in line if style == "blue")
        pieces = list(line)
        if not with_source:
            if is_source:
                continue
            if pieces[0][1] == "bold":  # file, line and column
                del pieces[0]
        shown = nodes.inline("", "", classes=["eu-line", "eu-source" if is_source else "eu-said"])
        for text, style in pieces:
            shown += nodes.inline("", text, classes=[_STYLES[word] for word in style.split()])
        block += [shown, nodes.Text("\n")]
    return block


def _styled(name: str) -> nodes.literal_block:
    """A block of lines with their own styles; Sphinx requires a source that differs from the content for this."""
    return nodes.literal_block("styled", "", classes=[name])


def _embolden(body: nodes.Element) -> None:
    """Highlight the normative word of a clause."""
    for text in list(body.findall(nodes.Text)):
        parent = text.parent
        if isinstance(parent, nodes.literal | nodes.math | nodes.math_block | nodes.literal_block):
            continue
        pieces: list[Node] = []
        at = 0
        for match in _KEYWORD.finditer(text):
            pieces += [nodes.Text(text[at : match.start()]), nodes.strong("", match[0], classes=["eu-keyword"])]
            at = match.end()
        if pieces:
            parent.replace(text, [*pieces, nodes.Text(text[at:])])


def _plain(text: str) -> str:
    """Markdown as one line of plain text, for the tooltip of a link."""
    text = re.sub(r"\{\w+\}`([^`]*)`|`([^`]*)`", lambda span: span[1] or span[2], text)
    return " ".join(text.split())


def _first_sentence(text: str) -> str:
    """The first sentence of a clause, or the text before its list or equation."""
    paragraph = " ".join(text.split("\n\n")[0].split("\n- ")[0].split("\n* ")[0].split("$$")[0].split())
    end = re.search(r"(?<=[.;:])\s", without_code(paragraph))
    return paragraph if end is None or end.start() < 40 else paragraph[: end.start()].rstrip(";:")


def _table(*heads: str, rows: Iterable[Iterable[Node]]) -> nodes.container:
    group = nodes.tgroup("", *(nodes.colspec(colwidth=1) for _ in heads), cols=len(heads))
    group += nodes.thead("", nodes.row("", *(nodes.entry("", nodes.paragraph("", head)) for head in heads)))
    group += nodes.tbody("", *(nodes.row("", *(nodes.entry("", cell) for cell in row)) for row in rows))
    # Furo makes a table in its own block scroll on a narrow screen.
    return nodes.container("", nodes.table("", group, classes=["eu-table"]), classes=["table-wrapper"])


#: Every directive, by its name in the chapters.
DIRECTIVES: dict[str, type[SpecificationDirective]] = {
    "clause": ClauseDirective,
    "withdrawn": WithdrawnDirective,
    "example": ExampleDirective,
    "diagnostic": DiagnosticDirective,
    "diagnostics": DiagnosticsDirective,
    "transcript": TranscriptDirective,
    "all-clauses": AllClausesDirective,
    "schema": SchemaDirective,
}
