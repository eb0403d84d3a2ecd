"""Why a text is not YAML, in plain words."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import islice
from typing import Any, NamedTuple

import yaml
from yaml import CSafeLoader
from yaml.error import MarkedYAMLError, YAMLError

from eurdf.diagnostics import FileError, Fix, Place
from eurdf.reading.indentation import first_line_hint, indentation_hint
from eurdf.reading.source import Source, short

#: Characters that libyaml refuses: those that are not printable (YAML 1.2.2, section 5.1). YAML allows them in quotes,
#: if they are not among U+0000 to U+001F, but a parser need not (EU-YML-012).
_NOT_PRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_MARK = "\ufeff"

#: Lines that are indented with tabs, at most, of which a fix changes all.
_MOST_TABS = 1000


class _Meaning(NamedTuple):
    """What a problem of libyaml means for the author of the file; ``{line}`` is where the node around it begins."""

    message: str
    hint: str | None = None
    code: str = "yaml-syntax"
    late: bool = False  # whether libyaml notices it only long after the place where the node around it begins


_AFTER_VALUE = _Meaning("there is text after the end of a value", "quote the value as a whole")
_UNUSUAL_NAME = _Meaning("this is not a valid anchor name", "use only ASCII letters, digits, '-' and '_'")
_TAB = _Meaning("a tab is used as indentation", "indent with spaces")
_MEANINGS = {
    "mapping values are not allowed in this context": _Meaning(
        "a ':' is not allowed here", "quote a value that has ': ' in it, and indent the keys of one mapping equally"
    ),
    "mapping keys are not allowed in this context": _Meaning("a '?' is not allowed here"),
    "block sequence entries are not allowed in this context": _Meaning(
        "a list item cannot begin here", "begin the list on a line of its own"
    ),
    "did not find expected key": _Meaning(
        "this does not continue the mapping that begins on line {line}", "indent the keys of one mapping equally"
    ),
    "did not find expected '-' indicator": _Meaning(
        "this does not continue the list that begins on line {line}", "begin each item with '- ', all indented equally"
    ),
    "did not find expected ',' or ']'": _Meaning("a ',' or ']' is missing in the list that begins on line {line}"),
    "did not find expected ',' or '}'": _Meaning("a ',' or '}' is missing in the mapping that begins on line {line}"),
    "did not find expected node content": _Meaning("a value is missing here"),
    "did not find expected <document start>": _Meaning(
        "this does not continue anything before it", "after a directive, a line '---' must follow"
    ),
    "could not find expected ':'": _Meaning(
        "a key has no ':' after it", "write 'key: value', with a space after the ':'", late=True
    ),
    "found unexpected end of stream": _Meaning("a quoted text is never closed", late=True),
    "found unexpected document indicator": _Meaning("a quoted text is not closed before its document ends", late=True),
    "found a tab character that violates indentation": _TAB,
    "found a tab character where an indentation space is expected": _TAB,
    "found unknown escape character": _Meaning(
        "an unknown escape in double quotes", r"write '\\' for a backslash, or use single quotes"
    ),
    "did not find expected hexdecimal number": _Meaning("an escape has too few hexadecimal digits"),
    "found invalid Unicode character escape code": _Meaning("an escape is not a Unicode character"),
    "did not find expected alphabetic or numeric character": _UNUSUAL_NAME,
    "found unknown directive name": _Meaning("only the directives %YAML and %TAG are known", "remove the line"),
    "found incompatible YAML document": _Meaning(
        "the %YAML directive states a version other than 1.2", "remove the directive", "yaml-version"
    ),
    "found undefined tag handle": _Meaning("the tag has an unknown prefix", None, "yaml-unknown-tag"),
}
_TOO_DEEP = "mapping values are not allowed in this context"
_NO_ITEM = "block sequence entries are not allowed in this context"
_NOT_CONTINUED = ("did not find expected key", "did not find expected '-' indicator")


def unusual_name(place: Place) -> FileError:
    """The error of an anchor or an alias whose name libyaml would end too early."""
    return FileError(_UNUSUAL_NAME.code, _UNUSUAL_NAME.message, place, _UNUSUAL_NAME.hint)


def stray_mark(source: Source, data: bytes) -> FileError | None:
    """The error of the first byte order mark outside quotes, which libyaml takes for an ordinary character.

    The text is YAML otherwise, without its own byte order mark. ``data`` is what libyaml reads: as many characters,
    perhaps others.
    """
    index = source.text.find(_MARK)
    if index > 0:  # libyaml skips one at the start
        events: Iterable[Any] = yaml.parse(data, CSafeLoader)
        for event in events:
            if getattr(event, "style", None) not in ("'", '"'):  # only quoted scalars have one of these
                continue
            if event.start_mark.index > index >= 0:
                break
            if index < event.end_mark.index:
                index = source.text.find(_MARK, event.end_mark.index)
    if index < 0:
        return None
    message = "a byte order mark, U+FEFF, is allowed only at the start of the file and in quotes"
    hint = 'remove it, or write "\\ufeff" in double quotes'
    fix = Fix("remove it", (source.edit(index, index + 1, ""),))
    return FileError("yaml-syntax", message, source.place(index, index + 1), hint, (fix,))


def version_fix(source: Source) -> tuple[Fix, ...]:
    """The proposal to state version 1.2, which is how the file is read."""
    found = re.search(r"^%YAML[ \t]+(\d+\.\d+)", source.text, re.MULTILINE)
    return () if found is None else (Fix("write %YAML 1.2", (source.edit(*found.span(1), "1.2"),)),)


def tags_fix(source: Source, most: int) -> tuple[Fix, ...]:
    """The proposal to remove the %TAG directives of a file, so many at most."""
    found = islice(re.finditer(r"(?m)^%TAG[^\r\n]*(?:\r\n?|\n|$)", source.text), most)
    return (Fix("remove them: no tag can use them", tuple(source.edit(*each.span(), "") for each in found)),)


def mapping_fix(source: Source, start: int, value: object) -> tuple[Fix, ...]:
    """The only item of a list, or a key and its value with a colon between them, as the top level."""
    if isinstance(value, list) and len(value) == 1 and source.text.startswith("-", start):
        return (Fix("remove the '-'", (source.edit(start, start + 1, " "),)),)
    found = re.compile(r"[A-Za-z_]\w*([ \t]+)\S.*").match(source.text, start)
    if found is None or value != found[0].rstrip():
        return ()
    return (Fix("write a colon after the key", (source.edit(*found.span(1), ": "),)),)


def anchor_fix(source: Source, start: int, end: int, name: str) -> tuple[Fix, ...]:
    """The anchor where its first alias is, and an alias where it was, if its value is on one line."""
    value = r"(?:\[[^\[\]\n]*\]|\{[^{}\n]*\}|[^\s,#&*!\[\]{}][^,#\[\]{}\n]*)"
    found = re.compile(rf"&{re.escape(name)}[ \t]+{value}").search(source.text, end)
    if found is None:
        return ()
    anchored, last = found[0].rstrip(), found.start() + len(found[0].rstrip())
    edits = source.edit(start, end, anchored), source.edit(found.start(), last, source.text[start:end])
    return (Fix(f"write '{short(anchored)}' here, and the alias where that is", edits),)


def syntax_error(source: Source, error: YAMLError | UnicodeDecodeError) -> FileError:
    """The error at which libyaml stopped, which may have read other characters, but the same number of them."""
    text = source.text
    if not isinstance(error, MarkedYAMLError) or error.problem is None:
        # Also an error of libyaml's decoder, whose position is in bytes.
        found = _NOT_PRINTABLE.search(text)
        if found is None:
            return FileError("yaml-syntax", "the file contains an escape that is not UTF-8", source.place(0))
        message = f"the character U+{ord(found[0]):04X} is not allowed in YAML"
        hint = f'in double quotes, write "\\u{ord(found[0]):04x}"'
        return FileError("yaml-syntax", message, source.place(found.start(), found.end()), hint)
    problem = min(error.problem_mark.index, len(text)) if error.problem_mark else 0
    context = min(error.context_mark.index, problem) if error.context_mark else problem
    if error.problem == "found character that cannot start any token":
        meaning = _cannot_begin(text, problem)
    elif error.problem in _NOT_CONTINUED and _line_before(source, problem).strip(" -"):
        meaning = _AFTER_VALUE
    elif error.problem in _MEANINGS:
        meaning = _MEANINGS[error.problem]
    else:
        meaning = _Meaning(" ".join(filter(None, (error.problem, error.context))))
    if text[context : context + 1] in ("[", "{") and not text[problem:].strip():
        meaning = _Meaning(f"'{text[context]}' is never closed", late=True)
    message = meaning.message.replace("{line}", str(source.position(context)[0]))
    advice = meaning.hint
    if meaning.code == "yaml-syntax" and (better := _about_indentation(source, error.problem, problem)):
        advice = better
        if error.problem == _TOO_DEEP:
            message = "this key is not aligned with those before it"
    start = context if meaning.late else problem
    fixes = version_fix(source) if meaning.code == "yaml-version" else _syntax_fixes(source, meaning, start)
    return FileError(meaning.code, message, source.place(start, min(start + 1, len(text))), advice, fixes)


def _syntax_fixes(source: Source, meaning: _Meaning, at: int) -> tuple[Fix, ...]:
    """Spaces where a tab indents, or after a colon that lacks one."""
    line, _ = source.position(at)
    start, end = source.lines.span(line) or (at, at)
    text = source.text[start:end]
    if meaning is _TAB:
        tabs = list(re.finditer(r"^ *\t[ \t]*", source.text, re.MULTILINE))[:_MOST_TABS]
        summary = "indent with {} spaces, not tabs"
        return tuple(
            Fix(summary.format(width), tuple(source.edit(*each.span(), each[0].expandtabs(width)) for each in tabs))
            for width in (2, 4, 8)
        )
    if found := re.match(r"\s*(?:- )?[\w-]+(:)[^\s:]", text):
        colon = start + found.end(1)
        return (Fix("write a space after the ':'", (source.edit(colon, colon, " "),)),)
    return ()


def _about_indentation(source: Source, said: str, problem: int) -> str | None:
    """How to indent the line at which libyaml stopped; None if its indentation is not the error."""
    before = _line_before(source, problem)
    if said == "did not find expected <document start>":
        return None if before.strip() else first_line_hint(source.lines)
    key_alone = said == _TOO_DEEP and ": " not in before
    if key_alone or (said in (*_NOT_CONTINUED, _NO_ITEM) and not before.strip(" -")):
        return indentation_hint(source.lines, source.position(problem)[0])
    return None


def _line_before(source: Source, index: int) -> str:
    """The text before a character on its line."""
    return source.text[index + 1 - source.position(index)[1] : index]


def _cannot_begin(text: str, index: int) -> _Meaning:
    character = text[index : index + 1]
    if character == "\t":
        return _TAB
    return _Meaning(f"a value cannot begin with '{character}'", "quote the value")


def without_other_breaks(source: Source) -> tuple[str, dict[int, str]]:
    """The text with U+0085, U+2028 and U+2029 replaced, and what turns them back in the values.

    They are ordinary characters in YAML 1.2, but libyaml breaks lines at them, as YAML 1.1 does. What replaces them is
    characters that the file does not have; it cannot have all of this range, which takes more bytes than it may have.
    """
    breaks = [] if source.text.isascii() else [mark for mark in "\x85\u2028\u2029" if mark in source.text]
    if not breaks:
        return source.text, {}
    used = set(source.text)
    free = (chr(code) for code in range(0x10000, 0x110000) if chr(code) not in used)
    replaced = source.text
    original = {}
    for mark, replacement in zip(breaks, free, strict=False):
        replaced = replaced.replace(mark, replacement)
        original[ord(replacement)] = mark
    return replaced, original
