"""The exception for files that the oracle does not read."""

from __future__ import annotations


class NotRead(Exception):  # noqa: N818  it says what happened, no more: the file may be right
    """The oracle is not sure what these files mean.

    It reads valid files only and is no validator: this is no verdict on the files.
    """
