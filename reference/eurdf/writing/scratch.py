"""A folder for files that are not complete yet, beside those that they will replace."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_PREFIX, _SUFFIX = ".eurdf-", ".tmp"
_NAME = re.compile(rf"{re.escape(_PREFIX)}[a-z0-9_]{{8}}{re.escape(_SUFFIX)}")


@contextlib.contextmanager
def scratch_folder(beside: Path) -> Iterator[Path]:
    """A new folder in another one, which is removed at the end; those that killed processes left there, at the start.

    A lock shows whether the process that made such a folder still runs. Windows has no such lock: what a killed process
    left stays there.

    Args:
        beside: The folder that contains it.

    Raises:
        OSError: It cannot be made.
    """
    with contextlib.suppress(OSError):
        for entry in filter(_NAME.fullmatch, os.listdir(beside)):
            with contextlib.suppress(OSError), _locked(beside / entry) as is_abandoned:
                if is_abandoned:
                    shutil.rmtree(beside / entry, ignore_errors=True)
    with contextlib.ExitStack() as stack:
        is_own = False
        while not is_own:  # another process can take a new folder for an abandoned one before it is locked
            made = Path(tempfile.mkdtemp(_SUFFIX, _PREFIX, beside))
            try:
                is_own = stack.enter_context(_locked(made))
            except OSError:  # this system, or this file system, has no locks: nobody removes the folder
                is_own = True
        stack.callback(shutil.rmtree, made, ignore_errors=True)
        yield made


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[bool]:
    """Lock a folder; False if another one has the lock, or has removed the folder.

    Raises:
        OSError: It cannot be locked.
    """
    if fcntl is None:
        raise OSError("no locks")
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except FileNotFoundError:
        yield False
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_there = os.path.exists(folder)
    except BlockingIOError:
        is_there = False
    try:
        yield is_there
    finally:
        os.close(descriptor)
