"""Atomic writing of a text file."""

from __future__ import annotations

import os
from pathlib import Path


def write_atomically(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file in UTF-8, completely or not at all; an existing one keeps its permissions.

    Args:
        path: Path of the file; a symbolic link is followed.
        text: Content of the file.

    Raises:
        OSError: It cannot be written.
    """
    target = Path(os.path.realpath(path))
    scratch = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        if target.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        with scratch.open("x", encoding="utf-8", newline="") as stream:
            stream.write(text)
        if target.exists():
            scratch.chmod(target.stat().st_mode & 0o7777)
        scratch.replace(target)
    finally:
        scratch.unlink(missing_ok=True)
