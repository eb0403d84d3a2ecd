"""A folder on a command line."""

from __future__ import annotations

from argparse import ArgumentTypeError
from pathlib import Path


def named_folder(text: str) -> Path:
    """The folder of a name.

    Raises:
        ArgumentTypeError: The name is empty, as of a variable that was not set: that would be the working folder.
    """
    if not text:
        raise ArgumentTypeError("the folder name is empty; write '.' for the working folder")
    return Path(text)
