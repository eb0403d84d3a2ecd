"""Writing files completely or not at all, and several of them all or none."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_PREFIX, _SUFFIX = ".eurdf-", ".tmp"
_NAME = re.compile(rf"{re.escape(_PREFIX)}[a-z0-9_]{{8}}{re.escape(_SUFFIX)}")

_Path = TypeVar("_Path", bound="str | os.PathLike[str]")


def write_atomically(path: str | os.PathLike[str], content: str | bytes, *, replace: bool = True) -> None:
    """Write one file as `write_together` does; an existing one keeps its permissions."""
    write_together({path: content}, replace=replace)


def write_together(files: Mapping[_Path, str | bytes], *, replace: bool = True, follow: bool = True) -> None:
    """Write files, by path, completely or not at all, also if the process is killed: all of them, or none.

    Each takes its name only when all are on the disk, in the order given. If the process is killed between the first
    and the last of these steps, only the first files are written. A text is written in UTF-8.

    Args:
        files: Content of each file, by its path.
        replace: Whether to replace existing files; a link counts as one, wherever it leads.
        follow: Whether a symbolic link is followed, or is itself what is replaced.

    Raises:
        FileExistsError: One exists, and ``replace`` is False. Nothing is written.
        OSError: One cannot be written; ``filename`` is its path. Nothing is changed.
    """
    with contextlib.ExitStack() as stack:
        folders: dict[Path, Path] = {}
        drafts: list[_Draft] = []
        for index, (path, content) in enumerate(files.items()):
            with naming(path):
                if not replace and os.path.lexists(path):
                    raise FileExistsError(errno.EEXIST, "it already exists")
                status = replaceable(path, follow=follow)
                place = Path(os.path.realpath(Path(path)) if follow else path)
                if place.parent not in folders:
                    folders[place.parent] = stack.enter_context(scratch_folder(place.parent))
                draft = _Draft(path, place, folders[place.parent] / str(index), status is not None)
                write_to_disk(draft.file, content, status)
                if draft.replaces and len(files) > 1:
                    _link_or_copy(place, draft.before)
            drafts.append(draft)
        _place(drafts, replace)
        for folder in folders:
            sync_folder(folder)


class _Draft(NamedTuple):
    """A file that does not have its name yet.

    Attributes:
        path: As the user gave it.
        place: Where it goes.
        file: Where it is.
        replaces: Whether there is a file at its place.
    """

    path: str | os.PathLike[str]
    place: Path
    file: Path
    replaces: bool

    @property
    def before(self) -> Path:
        """Where the file that it replaces is kept."""
        return self.file.with_suffix(".before")


def _place(drafts: Sequence[_Draft], replace: bool) -> None:
    """Give each file its name, or none."""
    done: list[_Draft] = []
    try:
        for draft in drafts:
            with naming(draft.path):
                if replace:
                    draft.file.replace(draft.place)
                else:
                    _name_new(draft)
            done.append(draft)
    except BaseException:
        for draft in reversed(done):
            if draft.replaces:
                draft.before.replace(draft.place)
            else:
                draft.place.unlink()
        raise


def _name_new(draft: _Draft) -> None:
    """Give a file its name, unless another file has got it in the meantime."""
    try:
        os.link(draft.file, draft.place)
    except FileExistsError:
        raise
    except OSError:  # this file system has no hard links
        if os.path.lexists(draft.place):
            raise FileExistsError(errno.EEXIST, "it already exists") from None
        draft.file.replace(draft.place)


def _link_or_copy(path: Path, to: Path) -> None:
    """Keep a file, which may be a symbolic link, under another name."""
    try:
        os.link(path, to, follow_symlinks=False)
    except (OSError, NotImplementedError):  # this file system has no hard links, or this system none of symbolic links
        shutil.copy2(path, to, follow_symlinks=False)


def write_to_disk(path: Path, content: str | bytes, like: os.stat_result | None = None) -> None:
    """Write a new file, and wait until it is on the disk.

    It gets the owner and permissions that are in the status ``like``, by default those of a new file.
    """
    with path.open("xb") as stream:
        stream.write(content.encode() if isinstance(content, str) else content)
        stream.flush()
        os.fsync(stream.fileno())
    if like is not None and stat.S_ISREG(like.st_mode):
        with contextlib.suppress(PermissionError, AttributeError):  # only root may; Windows has no owners
            os.chown(path, like.st_uid, like.st_gid)
        path.chmod(stat.S_IMODE(like.st_mode))


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system can wait for that."""
    with contextlib.suppress(OSError):  # Windows opens no folder
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


@contextlib.contextmanager
def naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let an error of the system name the file of the user, and not one on the way to it."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, os.fspath(path)) from error


def replaceable(path: str | os.PathLike[str], *, follow: bool = False) -> os.stat_result | None:
    """The status of what has a path, a symbolic link followed or not, or None; `OSError` if it is no file."""
    try:
        status = os.stat(path, follow_symlinks=follow)
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder")
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISLNK(status.st_mode)):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file")
    return status


@contextlib.contextmanager
def scratch_folder(beside: Path) -> Iterator[Path]:
    """A new folder in another one, which is removed at the end; those that killed processes left there, at the start.

    A lock shows whether the process that made such a folder still runs. Windows has no such lock: what a killed process
    left stays there.
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
    """Lock a folder, or raise `OSError`; False if another one has the lock, or has removed the folder."""
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
