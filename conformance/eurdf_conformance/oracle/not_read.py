"""The one way in which the oracle declines."""

from __future__ import annotations


class NotRead(Exception):  # noqa: N818  it says what happened, no more: the file may be right
    """The oracle is not sure what these files say.

    It reads valid files only and is no validator: this is no verdict on the files.
    """
