"""Writing several files to a folder: all of them or none, and none elsewhere."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath


def write_files(folder: str | os.PathLike[str], files: Mapping[str, bytes], *, force: bool = False) -> tuple[Path, ...]:
    """Write files to a folder, which is made if it does not exist.

    Args:
        folder: Where to write.
        files: Content of each file, by its path relative to the folder, with ``/``.
        force: Whether to replace files that exist; other files in the folder are kept.

    Returns:
        Paths of the files.

    Raises:
        FileExistsError: A file exists, and ``force`` is False. Nothing is written.
        OSError: A file cannot be written, or would be outside the folder. Nothing is changed.
    """
    home = Path(folder)
    targets = {home / PurePosixPath(name): content for name, content in files.items()}
    for target in targets:
        _must_be_inside(home, target)
        if target.is_dir():
            raise IsADirectoryError(f"'{target}' is a folder; remove it, or write elsewhere")
        if not force and os.path.lexists(target):
            raise FileExistsError(f"'{target}' already exists; force replaces it")
    made = [each for each in (home, *home.parents) if not each.exists()]
    done: list[tuple[Path, Path | None]] = []
    try:
        home.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".eurdf-", dir=home) as scratch:
            for index, content in enumerate(targets.values()):
                (Path(scratch) / str(index)).write_bytes(content)
            try:
                for index, target in enumerate(targets):
                    made = [each for each in (target.parent, *target.parents) if not each.exists()] + made
                    target.parent.mkdir(parents=True, exist_ok=True)
                    before = Path(scratch) / f"{index}.before" if os.path.lexists(target) else None
                    if before is not None:
                        target.replace(before)
                    done.append((target, before))
                    (Path(scratch) / str(index)).replace(target)
            except OSError:
                for target, before in reversed(done):
                    target.unlink(missing_ok=True)
                    if before is not None:
                        before.replace(target)
                raise
    except OSError:
        for each in made:
            with contextlib.suppress(OSError):
                each.rmdir()
        raise
    return tuple(targets)


def _must_be_inside(home: Path, target: Path) -> None:
    """A link in the folder, or ``..`` in a name, can lead elsewhere."""
    inside, parent = Path(os.path.realpath(home)), Path(os.path.realpath(target.parent))
    if ".." in target.relative_to(home).parts or not parent.is_relative_to(inside):
        raise PermissionError(f"'{target}' is outside the folder '{home}'; nothing is written there")
