"""Atomic writing of files."""

from __future__ import annotations

import argparse
import os

from eurdf.commands.cannot_run import CannotRun
from eurdf.writing.atomic_file import write_atomically

#: The path that means the standard output.
STDOUT = "-"


def add_output_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--output`` to the parser of a command that writes one file; None means the standard output."""
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        type=lambda path: None if path == STDOUT else path,
        help="the file to write; default, or -: the standard output",
    )


def refuse_to_replace(path: str | os.PathLike[str], force: bool) -> None:
    """Raise `CannotRun` if a file exists and ``force`` is False."""
    if not force and os.path.exists(path):
        raise CannotRun(f"'{os.fspath(path)}' already exists; --force replaces it")


def write_new(path: str | os.PathLike[str], text: str, force: bool = False) -> None:
    """Write a text file in UTF-8, completely or not at all.

    Args:
        path: Path of the file; a symbolic link is followed.
        text: Content of the file.
        force: Whether to replace an existing file.

    Raises:
        CannotRun: The file exists and ``force`` is False, or it cannot be written.
    """
    refuse_to_replace(path, force)
    try:
        write_atomically(path, text)
    except OSError as error:
        raise CannotRun(f"cannot write '{path}': {error.strerror or error}") from error
