"""The text of a file, and the positions of its characters."""

from __future__ import annotations

import os
import stat
from collections import UserDict
from dataclasses import dataclass, field
from pathlib import Path

from eurdf.diagnostics import Edit, FileError, Fix, Place
from eurdf.diagnostics.lines import Lines
from eurdf.reading.other_formats import of_binary, other_format
from eurdf.regular_file import open_now, open_regular, reason_of

BOM = b"\xef\xbb\xbf"

#: Bytes that a file may have (EU-FIL-002).
FILE_LIMIT = 16 << 20


@dataclass(frozen=True, slots=True)
class Source:
    r"""A text that was read.

    Attributes:
        file: Path as the user gave it; what diagnostics call a text that is not in a file.
        text: Decoded, without byte order mark, line breaks as they are.
        data: The same as UTF-8 bytes.
        base: Folder that relative paths in a text start from which is not in a file; None for a file.
        is_quoted: Whether diagnostics show lines of the text.
        made_from: Paths of the files that a text was made from which is not in a file, the main one first.
    """

    file: str
    text: str
    data: bytes
    base: Path | None = field(default=None, compare=False)
    is_quoted: bool = True
    made_from: tuple[str, ...] = field(default=(), compare=False)
    lines: Lines = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lines", Lines(self.text))

    @property
    def is_file(self) -> bool:
        """Whether `file` is a path at which the text can be read again."""
        return self.base is None

    @property
    def files(self) -> tuple[str, ...]:
        """Paths of the files that the text depends on."""
        return (self.file,) if self.is_file else self.made_from

    @property
    def folder(self) -> Path:
        """Folder that relative paths in the text start from."""
        return Path(self.file).parent if self.base is None else self.base

    def position(self, index: int) -> tuple[int, int]:
        """Line and column, both from 1, of a character (EU-DIA-012); see `Lines`."""
        return self.lines.position(index)

    def place(self, start: int, end: int | None = None, pointer: str = "") -> Place:
        """Place of the characters from ``start`` to before ``end``; both are indices in ``text``."""
        line, column = self.position(start)
        end_column = None
        if end is not None:
            end_line, last = self.position(end)
            end_column = last if end_line == line else None
        return Place(self.file, line, column, end_column, pointer, self._quoted)

    def edit(self, start: int, end: int, text: str) -> Edit:
        """An edit of the characters from ``start`` to before ``end``."""
        return Edit(self.file, start, end, text, self.lines)

    def place_of_line(self, line: int) -> Place:
        """Place of a line, from 1, as a whole."""
        return Place(self.file, line, lines=self._quoted)

    @property
    def _quoted(self) -> Lines | None:
        return self.lines if self.is_quoted else None


class Texts(UserDict[str, str]):
    """Texts that are read in place of those of files; any path that leads to a file finds its text."""

    def __getitem__(self, file: str) -> str:
        return self.data[_real(file)]

    def __setitem__(self, file: str, text: str) -> None:
        self.data[_real(file)] = text

    def __delitem__(self, file: str) -> None:
        del self.data[_real(file)]

    def __contains__(self, file: object) -> bool:
        return _real(str(file)) in self.data


def _real(file: str) -> str:
    """The path with every symbolic link followed; itself if it cannot be a path."""
    try:
        return os.path.realpath(file)
    except ValueError:
        return file


def read_source(path: str | os.PathLike[str], limit: int = FILE_LIMIT, *, is_quoted: bool = True) -> Source:
    """Read a text file; lines of it are shown in diagnostics if ``is_quoted``.

    Never reads more than ``limit`` bytes, and nothing that is not a regular file: a pipe or a device could block.

    Raises:
        FileError: ``file-unreadable``, ``file-too-large`` or ``file-not-utf8``.
    """
    file = os.fsdecode(path)
    return decoded(read_bytes(file, limit), file, is_quoted=is_quoted)


def decoded(data: bytes, file: str, base: Path | None = None, *, is_quoted: bool = True) -> Source:
    """The text that is in some bytes, or ``file-not-utf8``, EU-FIL-003; for the arguments see `Source`."""
    if found := of_binary(data):
        raise other_format("file-not-utf8", found, Place(file, 1, 1))
    # The first bytes distinguish UTF-16 and UTF-32 from UTF-8, with or without a byte order mark (YAML 1.2.2, 5.2).
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data[:2]:
        message = "the file begins as UTF-16, UTF-32 or binary data; it must be UTF-8 text"
        text = of_utf16(data)
        fixes = () if text is None else (Fix("save it as UTF-8", (Edit(file, 0, 0, "", Lines(text)),)),)
        raise FileError("file-not-utf8", message, Place(file, 1, 1), "save it as UTF-8", fixes)
    data = data.removeprefix(BOM)
    try:
        text = data.decode()
    except UnicodeDecodeError as error:
        before = data[: error.start].decode()
        text = data.decode(errors="replace")
        place = Source(file, text, b"", base, is_quoted).place(len(before))
        message = f"the byte 0x{data[error.start]:02x} is not valid UTF-8"
        raise FileError("file-not-utf8", message, place, "save it as UTF-8") from None
    return Source(file, text, data, base, is_quoted)


def read_bytes(file: str, limit: int = FILE_LIMIT) -> bytes:
    """Read a file as `read_source` does, with the same errors; its text may have any encoding."""
    place = Place(file)
    try:
        descriptor = open_now(file)
        try:
            status = os.fstat(descriptor)
            if stat.S_ISDIR(status.st_mode):
                raise FileError("file-unreadable", f"'{file}' is a folder, not a file", place)
            if not stat.S_ISREG(status.st_mode):
                raise FileError("file-unreadable", f"'{file}' is a pipe or a device, not a file", place)
            size = status.st_size
            chunks = []
            # The size is only what the file system says, and files grow.
            room = limit + 1
            while size <= limit and (chunk := os.read(descriptor, min(max(size, 1 << 16) + 1, room))):
                if status.st_size == 0:  # as of all files in /proc, which tell of the process that reads them
                    message = f"'{file}' has a size of 0 and yet content: it is not a regular file"
                    raise FileError("file-unreadable", message, place)
                chunks.append(chunk)
                room -= len(chunk)
                size = max(size, limit + 1 - room)
        finally:
            os.close(descriptor)
    except OSError as error:
        raise unreadable(file, f"'{file}'", error) from None
    except ValueError:  # a NUL in the path
        raise FileError("file-unreadable", f"{file!r} is not a valid path", place) from None
    if size > limit:
        raise too_large(file, f"{limit:,} bytes")
    return b"".join(chunks)


def begin_of_file(path: str | os.PathLike[str], size: int) -> bytes:
    """The first bytes of a file, so many at most; the errors are those of `open_regular`."""
    with open_regular(path) as stream:
        return stream.read(size)


def unreadable(file: str, shown: str, error: OSError) -> FileError:
    """The error of a file that the system does not read, under the name that is shown."""
    return FileError("file-unreadable", f"{shown} cannot be read: {reason_of(error)}", Place(file))


def too_large(file: str, most: str, fixes: tuple[Fix, ...] = ()) -> FileError:
    """The error of a file that is beyond a limit."""
    message = f"the file has more than {most}, which is the maximum"
    return FileError("file-too-large", message, Place(file), proposals=fixes)


def short(text: str) -> str:
    """What a message quotes of a text of any length."""
    return text if len(text) <= 60 else text[:57] + "..."


def of_utf16(data: bytes) -> str | None:
    """The text that some bytes are in UTF-16, with or without a byte order mark; None if they are none."""
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        return data.decode("utf-16" if marked else "utf-16-be" if data[:1] == b"\0" else "utf-16-le")
    except UnicodeDecodeError:
        return None
