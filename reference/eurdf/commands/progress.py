"""A progress bar on a terminal, for what takes long."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from eurdf.commands.output import is_terminal


@contextmanager
def progress_bar(what: str) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on the standard error, if that is a terminal, while the context lasts.

    Args:
        what: What is done.

    Yields:
        What to call with the amount that is done and the whole; None if there is no bar.
    """
    if not (sys.stderr.isatty() and is_terminal(sys.stderr)):
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what)
        yield lambda done, whole: bar.update(task, completed=done, total=whole)
