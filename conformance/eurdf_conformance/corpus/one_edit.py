"""Whether the files of an invalid case differ from those of its twin by one edit."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

#: Lines that the edit may take away, and put in their place.
LINES = 6


def edit_errors(files: tuple[Path, Path], twin: tuple[Path, Path]) -> list[str]:
    """Why the files are not one edit away: empty where they are.

    One edit is one contiguous run of lines of one of the two files. A file that an invalid case lacks, since its
    fault is that there is none, is no edit.

    Args:
        files: Description and URDF of the invalid case.
        twin: Those of the valid one.
    """
    edits = []
    for one, other in zip(files, twin, strict=True):
        if one.is_file() and other.is_file() and (edit := lines_edited(one, other)) != (0, 0):
            edits.append((one.name, *edit))
    faults = [
        f"{name}: the edit takes {removed} lines away and puts {added} in their place, {LINES} may be"
        for name, added, removed in edits
        if max(added, removed) > LINES
    ]
    if len(edits) == 2:
        faults.append("both files are edited")
    if not edits and all(path.is_file() for path in files):
        faults.append("the files are the same")
    return faults


def lines_edited(path: PathLike[str], other: PathLike[str]) -> tuple[int, int]:
    """How many lines stand in each file between what they begin with alike, and what they end with alike."""
    one, two = Path(path).read_bytes().splitlines(True), Path(other).read_bytes().splitlines(True)
    same = next((i for i, (a, b) in enumerate(zip(one, two, strict=False)) if a != b), min(len(one), len(two)))
    one, two = one[same:], two[same:]
    backwards = zip(reversed(one), reversed(two), strict=False)
    end = next((i for i, (a, b) in enumerate(backwards) if a != b), min(len(one), len(two)))
    return len(one) - end, len(two) - end
