"""The certain fixes of a robot, applied to its files: all, or none if one of the files cannot be written."""

from __future__ import annotations

import difflib
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eurdf.collection import collection_folder
from eurdf.diagnostics import Diagnostic, Fix
from eurdf.diagnostics.report import Report
from eurdf.diagnostics.text import Line
from eurdf.diagnostics.wording import visible
from eurdf.errors import CannotRun
from eurdf.loading import check_texts
from eurdf.reading.robot_source import is_stream, is_text
from eurdf.reading.source import BOM, of_utf16
from eurdf.writing.atomic_file import write_together

#: Rounds of fixes: one can show what another one, or an error, had hidden.
_MOST_ROUNDS = 20

_STYLES = {"+": "green", "-": "red", "@": "cyan"}


@dataclass
class Fixing:
    """What fixes do to a robot.

    Attributes:
        report: The result of the check with them.
        before: The text of each file that they change, as it was read.
        texts: Its new text.
        applied: The diagnostics that had a fix, in the order of the fixes; their places are in the text at that time.
    """

    report: Report
    before: dict[str, str] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    applied: list[Diagnostic] = field(default_factory=list)

    def diff(self) -> Iterator[Line]:
        """The changes of the files as a unified diff."""
        for file, after in self.texts.items():
            lines = difflib.unified_diff(self.before[file].splitlines(), after.splitlines(), file, file, lineterm="")
            yield from ([(visible(line), _STYLES.get(line[:1], ""))] for line in lines)

    def write(self) -> None:
        """Write the files; `CannotRun` if one was changed in the meantime or cannot be written, and none is written."""
        files = {}
        try:
            for file, text in self.texts.items():
                data = Path(file).read_bytes()
                if data.removeprefix(BOM) != self.before[file].encode() and of_utf16(data) != self.before[file]:
                    raise CannotRun(f"another program changed '{file}' in the meantime; nothing was written, try again")
                files[file] = (BOM if data.startswith(BOM) else b"") + text.encode()
            write_together(files)
        except OSError as error:
            reason = error.strerror or error
            raise CannotRun(f"cannot write '{error.filename}': {reason}; nothing was written") from None


def fixing(robot: str, urdf: str | None = None, **options: Any) -> Fixing:
    """Apply the certain fixes of a robot to the texts of its files, and check it again, until none is left.

    Fixes that overlap, or that together make another error, are applied one after the other.

    Raises:
        CannotRun: It is a robot of the collection, or is not in files.
    """
    _require_files(robot, urdf)
    done = Fixing(check_texts({}, robot, urdf, **options))
    for _ in range(_MOST_ROUNDS):
        fixable = [found for found in done.report.diagnostics if found.fix and _is_own(found.fix, robot, urdf)]
        for chosen in (fixable, fixable[:1]):
            fix = Fix.together(found.fix for found in chosen if found.fix)
            texts = {**done.texts, **fix.texts()}
            after = check_texts(texts, robot, urdf, **options)
            if not _codes(after) - _codes(done.report):
                break
        if not fixable:
            break
        kept = [found for found in chosen if found.fix and set(found.fix.edits) <= set(fix.edits)]
        before = {edit.file: edit.lines.text for edit in fix.edits} | done.before
        done = Fixing(after, before, texts, done.applied + kept)
    return done


def _codes(report: Report) -> Counter[str]:
    return Counter(found.code for found in report.diagnostics)


def _require_files(robot: str, urdf: str | None) -> None:
    """Raise `CannotRun` for what is no file of the user's own."""
    for given in filter(None, (robot, urdf)):
        if is_stream(given) or is_text(given):
            raise CannotRun(f"--fix and --diff change files, and '{given}' is none; give the path of a file")
    folder = collection_folder()
    if not os.path.lexists(robot) or (folder is not None and Path(robot).resolve().is_relative_to(folder.resolve())):
        raise CannotRun(f"'{robot}' is a robot of the collection; copy its folder, and fix the copy")


def _is_own(fix: Fix, robot: str, urdf: str | None) -> bool:
    """Whether a fix changes only files in the robot's folder, and those that were given."""
    given = [Path(path).resolve() for path in (robot, urdf) if path is not None]
    home = given[0] if given[0].is_dir() else given[0].parent
    files = [Path(edit.file) for edit in fix.edits]
    return all(file.is_file() and (file.resolve().is_relative_to(home) or file.resolve() in given) for file in files)
