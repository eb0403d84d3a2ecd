"""Writing a file whole or not at all."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from eurdf.commands.cannot_run import CannotRun

#: The path that means the standard output.
STDOUT = "-"


def add_output_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--output`` to the parser of a command that writes one file; None where it is the standard output."""
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        type=lambda path: None if path == STDOUT else path,
        help="the file to write; default, and for -: the standard output",
    )


def refuse_to_replace(path: str | os.PathLike[str], force: bool) -> None:
    """Raise `CannotRun` where a file is there already and not to be replaced."""
    if not force and os.path.exists(path):
        raise CannotRun(f"'{os.fspath(path)}' exists already; --force replaces it")


def write_new(path: str | os.PathLike[str], text: str, force: bool = False) -> None:
    """Write a text file in UTF-8, whole or not at all.

    Args:
        path: Where to; a symbolic link is followed.
        text: What.
        force: Whether a file that is there already is replaced.

    Raises:
        CannotRun: The file is there already and not to be replaced, or it cannot be written.
    """
    target = Path(os.path.realpath(path))
    refuse_to_replace(path, force)
    scratch = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        if target.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        with scratch.open("x", encoding="utf-8", newline="") as stream:
            stream.write(text)
        if target.exists():
            scratch.chmod(target.stat().st_mode & 0o7777)
        scratch.replace(target)
    except OSError as error:
        raise CannotRun(f"cannot write '{path}': {error.strerror or error}") from error
    finally:
        scratch.unlink(missing_ok=True)
