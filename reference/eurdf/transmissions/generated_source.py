"""Source code that is generated of a transmission, in files."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.writing.output_folder import write_files

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True)
class GeneratedSource:
    """The transmission as source code.

    Attributes:
        files: The content of each file, by its path with ``/``: of C alone, the header and the source.
    """

    files: Mapping[str, bytes]

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Raises:
            FileExistsError: A file exists, and ``force`` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files, force=force)


def checked_prefix(prefix: str | None, robot: Robot) -> str:
    """The name of the files, without their suffix; by default the robot's name and ``_transmission``.

    Raises:
        ValueError: It is no identifier.
    """
    if prefix is None:
        made = re.sub(r"[^A-Za-z0-9_]", "_", f"{robot.mechanism.name}_transmission")
        return made.lstrip("_0123456789").lower() or "transmission"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", prefix):
        raise ValueError(f"prefix is {prefix!r}; it must be an identifier: letters, digits and _")
    return prefix
