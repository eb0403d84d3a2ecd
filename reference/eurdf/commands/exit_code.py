"""Exit codes of programs ended by a signal: 128 plus the number of the signal."""

from __future__ import annotations

#: SIGINT, from Ctrl-C.
INTERRUPTED = 130

#: SIGPIPE: the reader of the output is gone.
BROKEN_PIPE = 141
