"""Writing several files to a folder: all of them or none, and none elsewhere."""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from eurdf.writing.atomic_file import naming, replaceable, scratch_folder, sync_folder, write_to_disk, write_together

#: Files and folders of others that a folder may contain to be exchanged: each is linked from the new one.
_MOST_OTHERS = 1000


def write_files(folder: str | os.PathLike[str], files: Mapping[str, bytes], *, force: bool = False) -> tuple[Path, ...]:
    """Write files, by their path relative to a folder, with ``/``: all of them or none. The folder is made if need be.

    A process that is killed leaves all the old files or all the new ones: a folder with the new files, and links to the
    other files of the old one, takes the place of the old one in one step. A program whose working folder it is has to
    enter it again. The step is not possible for the working folder of this process, a mount point, a folder of another
    user, one with more than 1,000 other files, and on Windows: there, the files are replaced one after the other when
    all are on the disk, and a process that is killed in that moment leaves old and new files.

    Returns:
        Paths of the files.

    Raises:
        FileExistsError: A file exists, and ``force`` is False. Nothing is written.
        OSError: A file cannot be written, or would be outside the folder; ``filename`` is its path. Nothing is changed.
    """
    home = Path(folder)
    targets = {home / PurePosixPath(name): content for name, content in files.items()}
    for target in targets:
        _must_be_inside(home, target)
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a folder; remove it, or write elsewhere", os.fspath(target))
        if not force and os.path.lexists(target):
            raise FileExistsError(f"'{target}' already exists; force replaces it")
    made = [each for each in (home, *home.parents) if not each.exists()]
    try:
        with naming(home):
            home.mkdir(parents=True, exist_ok=True)
        if not _replaced(home, targets):
            for target in targets:
                made = [each for each in (target.parent, *target.parents) if not each.exists()] + made
                with naming(target):
                    target.parent.mkdir(parents=True, exist_ok=True)
            write_together(targets, replace=force, follow=False)
    except BaseException:
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


class _NotPossible(Exception):  # noqa: N818 - the files are then written in another way
    """The folder cannot be exchanged."""


def _replaced(home: Path, targets: Mapping[Path, bytes]) -> bool:
    """Let a folder with the files take the place of one that exists; False if it cannot, and nothing is changed."""
    place = Path(os.path.realpath(home))
    is_working_folder = Path(os.path.realpath(os.curdir)).is_relative_to(place)
    is_windows = not hasattr(os, "geteuid")
    if is_windows or is_working_folder or os.path.ismount(place) or not os.access(place.parent, os.W_OK):
        return False
    with scratch_folder(place.parent) as scratch:
        new = scratch / place.name
        new.mkdir()
        own = {target.relative_to(home) for target in targets}
        for target, content in targets.items():
            with naming(target):
                inner = target.relative_to(home)
                (new / inner).parent.mkdir(parents=True, exist_ok=True)
                write_to_disk(new / inner, content, replaceable(place / inner))
        try:
            linked = _link_others(place, new, own)
            for path, _, _ in os.walk(new):
                sync_folder(Path(path))
            _exchange(new, place)
        except _NotPossible:
            return False
        _keep_late(new, place, own, linked)
        sync_folder(place.parent)
    return True


def _link_others(old: Path, new: Path, own: set[Path]) -> dict[Path, os.stat_result]:
    """Link every file of a folder that is not ``own`` from a new folder, with the folders that contain it.

    The result has the status of each file that was linked, by its path in the folder. `_NotPossible` if they cannot be
    linked, or are too many.
    """
    count = 0
    folders = []
    linked = {}
    try:
        for path, names, files in os.walk(old, onerror=_refuse):
            inner = Path(path).relative_to(old)
            if os.lstat(path).st_uid != os.geteuid() or not os.access(path, os.W_OK):
                raise _NotPossible
            (new / inner).mkdir(exist_ok=True)
            folders.append(inner)
            links = [name for name in names if os.path.islink(os.path.join(path, name))]
            count += len(names) + len(files)
            if count > _MOST_OTHERS + len(own):
                raise _NotPossible
            for name in (*files, *links):
                if inner / name not in own:
                    os.link(old / inner / name, new / inner / name, follow_symlinks=False)
                    linked[inner / name] = os.lstat(new / inner / name)
        for inner in reversed(folders):  # at last, since it may forbid to write there
            shutil.copystat(old / inner, new / inner)
    except OSError:
        raise _NotPossible from None
    return linked


def _refuse(error: OSError) -> None:
    raise error


def _exchange(one: Path, other: Path) -> None:
    """Let two folders change places in one step; `_NotPossible` if the system, or the file system, cannot do that."""
    ours, theirs = os.fsencode(one), os.fsencode(other)
    try:
        library = ctypes.CDLL(None, use_errno=True)
        if sys.platform == "darwin":
            failed = library.renamex_np(ours, theirs, 2)  # RENAME_SWAP
        else:
            here = -100  # AT_FDCWD
            failed = library.renameat2(here, ours, here, theirs, 2)  # RENAME_EXCHANGE
    except (AttributeError, OSError):  # there is no such function
        raise _NotPossible from None
    if failed:
        raise _NotPossible


def _keep_late(old: Path, new: Path, own: set[Path], linked: Mapping[Path, os.stat_result]) -> None:
    """Move what another program has written to the old folder since its files were linked."""
    for path, names, files in os.walk(old):
        inner = Path(path).relative_to(old)
        for name in map(inner.__truediv__, (*names, *files)):
            with contextlib.suppress(OSError):
                if name in linked:
                    is_late = not os.path.samestat(os.lstat(old / name), linked[name])
                    is_latest = os.path.samestat(os.lstat(new / name), linked[name])
                else:
                    is_late, is_latest = name not in own, not os.path.lexists(new / name)
                if is_late and is_latest:
                    (old / name).replace(new / name)
