"""Opening a file whose path another file names: it may be a pipe, a device, or larger than memory."""

from __future__ import annotations

import os
import stat
from typing import BinaryIO

#: Flags with which `os.open` opens a file to read its bytes: it waits for nobody who writes to a pipe. Not every system
#: has all of them.
_READ_NOW = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_BINARY"))


def reason_of(error: OSError) -> str:
    """What the system says of an error, as a part of a sentence."""
    return (error.strerror or str(error)).lower()


def open_now(path: str | os.PathLike[str]) -> int:
    """A descriptor of a file, to read from, without waiting: to open a pipe would wait for someone to write into it.

    Raises:
        OSError: It cannot be opened.
        ValueError: The path has a NUL.
    """
    return os.open(path, _READ_NOW)


def open_regular(path: str | os.PathLike[str]) -> BinaryIO:
    """A regular file, opened to be read, as by `open_now`; `OSError` if it is no regular file."""
    descriptor = open_now(path)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(f"'{os.fsdecode(path)}' is not a regular file")
    return open(descriptor, "rb")
