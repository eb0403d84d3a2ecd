"""What a call prints, in Python or in C++."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager


class Printed:
    """What was printed on both outputs; known after the block."""

    text = ""


@contextmanager
def captured() -> Iterator[Printed]:
    """Capture both outputs of the process, also what C++ writes there."""
    printed = Printed()
    sys.stdout.flush()
    sys.stderr.flush()
    with tempfile.TemporaryFile() as file:
        kept = os.dup(1), os.dup(2)
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        try:
            yield printed
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            for number, copy in zip((1, 2), kept, strict=True):
                os.dup2(copy, number)
                os.close(copy)
            file.seek(0)
            printed.text = file.read().decode(errors="replace")
