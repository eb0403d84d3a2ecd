"""The path, or the robot of the collection, that a path which does not exist most probably means."""

from __future__ import annotations

import difflib
import itertools
import os
from collections.abc import Collection, Iterable
from pathlib import Path

#: Endings of files that a robot may be given by.
YAML_ENDINGS, URDF_ENDINGS = (".yaml", ".yml"), (".urdf", ".xml", ".xacro")
ENDINGS = (*YAML_ENDINGS, *URDF_ENDINGS)

#: Files and folders that a name is compared with.
_COMPARED = 2000


def near_path(path: str, names: Collection[str] = (), endings: tuple[str, ...] = ENDINGS) -> str | None:
    """What a path may mean that leads nowhere, or None: a file with an ending, or by a name alone a robot."""
    if not path.strip() or "\0" in path:
        return None
    place = Path(path)
    rest = 0
    while not os.path.isdir(place.parent) and place.parent != place:
        place, rest = place.parent, rest + 1
    entries = _entries(place.parent, endings, folders_only=rest > 0)
    if len(Path(path).parts) == 1:
        entries = [*names, *entries]
    nearest = _nearest(place.name, entries)
    if nearest is None:
        return None
    # With os.path, so that './' before a name stays.
    return os.path.join(os.path.dirname(os.fspath(place) if rest else path), nearest)


def _entries(folder: Path, endings: tuple[str, ...], *, folders_only: bool) -> list[str]:
    try:
        with os.scandir(folder) as found:
            return sorted(
                entry.name
                for entry in itertools.islice(found, _COMPARED)
                if not entry.name.startswith(".")
                and (entry.is_dir() or (not folders_only and entry.name.lower().endswith(endings)))
            )
    except OSError:
        return []


def _nearest(name: str, known: Iterable[str]) -> str | None:
    """The nearest name, endings aside: nearly all files have the same ones."""
    by_stem: dict[str, list[str]] = {}
    for one in known:
        if one.casefold() == name.casefold():
            return one
        by_stem.setdefault(_stem(one), []).append(one)
    close = difflib.get_close_matches(_stem(name), by_stem, n=1)
    if not close:
        return None
    # Of those, the one whose ending is the nearest: 'arm.yml' means 'arm.yaml' rather than 'arm.urdf'.
    return difflib.get_close_matches(name, by_stem[close[0]], n=1, cutoff=0.0)[0]


def _stem(name: str) -> str:
    return name.casefold().partition(".")[0] or name.casefold()
