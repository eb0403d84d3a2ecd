"""The files that a command writes."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping

from eurdf.errors import CannotRun


def refuse_to_replace(path: str | os.PathLike[str], force: bool) -> None:
    """Raise `CannotRun` if a file, or a link wherever it leads, exists and ``force`` is False."""
    if not force and os.path.lexists(path):
        raise CannotRun(f"'{os.fspath(path)}' already exists; --force replaces it")


def write_new(path: str | os.PathLike[str], content: str | bytes, force: bool = False) -> None:
    """Write a file, completely or not at all; a symbolic link is followed, and a text is written in UTF-8.

    Raises:
        CannotRun: The file exists and ``force`` is False, or it cannot be written.
    """
    write_all_new({os.fspath(path): content}, force)


def write_all_new(files: Mapping[str, str | bytes], force: bool = False) -> None:
    """Write files as `write_new` does: all of them, or none."""
    from eurdf.writing.atomic_file import write_together  # only now: often nothing is written

    for path in files:
        refuse_to_replace(path, force)
    with writing():
        write_together(files, replace=force)


@contextlib.contextmanager
def writing() -> Iterator[None]:
    """Raise `CannotRun` if a file cannot be written, with its path."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            raise CannotRun(str(error).replace("; force replaces it", "; --force replaces it")) from error
        raise CannotRun(f"cannot write '{os.fsdecode(error.filename)}': {error.strerror}") from error
