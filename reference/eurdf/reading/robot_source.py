"""What a caller names a robot by: the path of a file, a text, standard input, a pipe.

Only a caller can give a text or a stream: a path that a file names is that of a regular file (EU-FIL-001).
"""

from __future__ import annotations

import json
import os
import re
import select
import stat
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from eurdf.diagnostics import FileError, Place
from eurdf.reading.source import BOM, FILE_LIMIT, Source, decoded, too_large, unreadable
from eurdf.regular_file import open_now

#: What is given: a path, ``-`` for standard input, the text itself, or what a description contains.
RobotSource = str | bytes | os.PathLike[str] | Mapping[str, Any]

#: The path that means standard input.
STDIN = "-"

#: Time allowed for somebody to open a named pipe for writing, s.
PATIENCE = 2.0

_CHUNK = 1 << 16
_SPACE = " \t\r\n"
# How a text of one line begins: a URDF, or a mapping of YAML with its first key, quoted or not.
_ONE_LINE = re.compile(r"""<|\{|---\s|(["']?)[\w.-]+\1:(\s|$)""")
# What JSON states otherwise than YAML: characters in quotes that YAML would change or refuse, infinite numbers.
_NOT_PLAIN = re.compile(r"[^\x20-\x7e\n]")
_NUMBERS = {"NaN": ".nan", "Infinity": ".inf", "-Infinity": "-.inf"}
_NUMBER_OR_TEXT = re.compile(r'"(?:[^"\\]|\\.)*"|-?Infinity|NaN')


def is_stream(given: RobotSource) -> bool:
    """Whether it can be read only once: standard input, or a pipe."""
    if isinstance(given, bytes | Mapping):
        return False
    return given == STDIN or _is_pipe(given)


def is_text(given: RobotSource) -> bool:
    """Whether it is content and no path: bytes, a mapping, or a string that begins as a URDF or a mapping of YAML does.

    A string of several lines is one, too.
    """
    if isinstance(given, bytes | Mapping):
        return True
    if not isinstance(given, str):
        return False
    text = given.strip("\ufeff" + _SPACE)
    return ("\n" in text or _ONE_LINE.match(text) is not None) and not os.path.lexists(given)


def display_name(given: RobotSource) -> str:
    """What a report calls it: a path as it is."""
    if isinstance(given, Mapping) or is_text(given):
        return "<text>"
    return "<stdin>" if given == STDIN else os.fsdecode(given)


def source_of(given: RobotSource, limit: int = FILE_LIMIT) -> Source | None:
    """The source of a text, or of what a stream holds; None for the path of anything else.

    Relative paths in it start from the working directory. The errors are those of `read_source`; `ValueError` if a
    mapping contains what no file can.
    """
    if isinstance(given, Mapping):
        given = _text_of(given).encode()
    if is_text(given):
        data = given if isinstance(given, bytes) else str(given).encode("utf-8", "surrogatepass")
        return _checked(data, "<urdf>" if _is_xml(data) else "<description>", limit)
    if given == STDIN:
        return _checked(_read_stdin(limit), "<stdin>", limit)
    if not isinstance(given, bytes) and _is_pipe(given):
        file = os.fsdecode(given)
        return _checked(_read_pipe(file, limit), file, limit)
    return None


def is_xml(source: Source) -> bool:
    """Whether a text is XML, so a URDF, rather than YAML."""
    return _is_xml(source.data)


def _text_of(description: Mapping[str, Any]) -> str:
    """A description as JSON, which is YAML, a line for each value."""
    try:
        text = json.dumps(_plain(description, "the description"), indent=1, ensure_ascii=False)
    except RecursionError:
        raise ValueError("the description contains itself, or is nested too deeply") from None
    text = _NUMBER_OR_TEXT.sub(lambda found: _NUMBERS.get(found[0], found[0]), text)
    return _NOT_PLAIN.sub(lambda found: f"\\U{ord(found[0]):08x}", text)


def _plain(value: Any, where: str) -> Any:
    """A value of a description as lists, dictionaries, texts and numbers, which are those of Python, not of NumPy."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Mapping):
        if other := next((key for key in value if not isinstance(key, str)), None):
            raise ValueError(f"{where} has the key {other!r}; keys must be texts")
        return {key: _plain(each, f"{where}['{key}']") for key, each in value.items()}
    if value is None or isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [_plain(each, f"{where}[{index}]") for index, each in enumerate(value)]
    raise ValueError(f"{where} is {value!r}; a description has texts, numbers, true, false, null, lists and mappings")


def _is_xml(data: bytes) -> bool:
    return data.removeprefix(BOM).lstrip(_SPACE.encode()).startswith(b"<")


def _is_pipe(path: str | os.PathLike[str]) -> bool:
    try:
        return stat.S_ISFIFO(os.stat(path).st_mode)
    except (OSError, ValueError):
        return False


def _checked(data: bytes, file: str, limit: int) -> Source:
    if len(data) > limit:
        raise too_large(file, f"{limit:,} bytes")
    if not data.strip():
        raise FileError("file-unreadable", f"{file} is empty; it must contain a URDF or a description", Place(file))
    return decoded(data, file, Path())


def _read_stdin(limit: int) -> bytes:
    if sys.stdin is None:  # closed; the number of its file may be that of another one by now
        raise FileError("file-unreadable", "standard input is closed", Place("<stdin>"))
    try:
        return sys.stdin.buffer.read(limit + 1)
    except OSError as error:
        raise unreadable("<stdin>", "standard input", error) from None


def _read_pipe(file: str, limit: int) -> bytes:
    try:
        descriptor = open_now(file)
        try:
            if not stat.S_ISFIFO(os.fstat(descriptor).st_mode):  # it was a moment ago
                raise FileError("file-unreadable", f"'{file}' is not a pipe any more", Place(file))
            first = _first_chunk(descriptor, file)
            os.set_blocking(descriptor, True)
            return first + b"".join(_chunks(descriptor, max(limit - len(first), 0)))
        finally:
            os.close(descriptor)
    except OSError as error:
        raise unreadable(file, f"'{file}'", error) from None


def _first_chunk(descriptor: int, file: str) -> bytes:
    """The first bytes in a pipe; empty if its writer has written nothing so far, or has closed it."""
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    end = time.monotonic() + PATIENCE
    while True:
        has_event = poll.poll(50)  # ms
        try:
            chunk = os.read(descriptor, _CHUNK)
        except BlockingIOError:  # there is a writer
            return b""
        if chunk or has_event:
            return chunk
        if time.monotonic() > end:
            raise FileError("file-unreadable", f"nothing writes to the pipe '{file}'", Place(file))


def _chunks(descriptor: int, limit: int) -> Iterator[bytes]:
    room = limit + 1
    while room and (chunk := os.read(descriptor, min(_CHUNK, room))):
        room -= len(chunk)
        yield chunk
