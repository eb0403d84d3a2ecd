"""What a shell reports of a program that a signal ended: 128 and the signal's number."""

from __future__ import annotations

#: SIGINT, from Ctrl-C.
INTERRUPTED = 130

#: SIGPIPE: nobody reads the output any more.
BROKEN_PIPE = 141
