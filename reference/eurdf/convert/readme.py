"""The README of an imported robot: where it comes from, its licence, and what is lost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from eurdf.convert.import_format import RobotRead
from eurdf.convert.losses import Loss
from eurdf.diagnostics.wording import visible
from eurdf.kinematics.opening import Opening
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mesh_files.folders import Folders

_LICENCES = ("LICENSE", "LICENCE", "COPYING")

#: Folders above that of the file that may have the licence of a collection of robots.
_ABOVE = 2

#: Largest file that counts as a licence, bytes.
_LONGEST = 200_000


def licence_file(path: Path, folders: Folders) -> Path | None:
    """The licence beside a file, or in a folder near above it, if it is where files of the robot may be."""
    folder = path.absolute().parent
    for place in (folder, *folder.parents[:_ABOVE]):
        for name in _LICENCES:
            for ending in ("", ".txt", ".md"):
                found = place / f"{name}{ending}"
                if found.is_file() and found.stat().st_size <= _LONGEST and folders.admit(found):
                    return found
    return None


def readme(
    path: Path,
    title: str,
    mechanism: Mechanism,
    losses: Sequence[Loss],
    read: RobotRead,
    opened: Sequence[Opening],
    licence: Path | None,
) -> str:
    """The text of the README."""
    lines = [
        f"# {_plain(mechanism.name)}",
        "",
        f"Imported from `{_plain(path.name)}` ({title}).",
        "",
        "| | |",
        "| --- | --- |",
        f"| source | {', '.join(f'`{_plain(each.name)}`' for each in read.sources) or _plain(path.name)} |",
        f"| licence | {f'see `LICENSE`, copied from `{_plain(licence.name)}`' if licence else 'TODO: not found'} |",
    ]
    if opened:
        shown = "; ".join(f"`{_plain(each.name)}` {each.position:.3g} m" for each in opened)
        lines.append(f"| loops at {_plain(read.start[0])}, before assembling | {shown} |")
    lines += ["", "## Losses", ""]
    lines += [f"- {_plain(str(loss))}" for loss in losses] or ["None."]
    return "\n".join(lines) + "\n"


def _plain(text: str) -> str:
    """Text that Markdown shows as it is, on one line."""
    return "".join(f"\\{each}" if each in "\\`|<>[]" else each for each in visible(text))
