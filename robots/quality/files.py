"""The rules on the files of a robot: they are sound, built, shown, and say the same in both versions."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import eurdf
from eurdf.linking.description import Unlinked, describe
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.same_model import differences, with_universal_joints
from eurdf_conformance.comparison.text import same_text
from robots.quality.candidate import Candidate

_CHECKOUT = Path(__file__).parents[2]
_WRITTEN = ("robot.urdf", "robot.yaml", "robot.v1.yaml")
_LONGEST_BUILD = 60.0  # s
# How far a number in a file may be from the one that build.py writes, relative and absolute (m, rad, kg). Numbers are
# written to 14 decimals or 12 digits, of which the last few depend on the processor: positions are sums of some dozen
# products of lengths of a metre, rounded to 1e-16 each.
_RELATIVE, _ABSOLUTE = 1e-9, 1e-12
_PNG = b"\x89PNG\r\n\x1a\n"


def is_sound(candidate: Candidate) -> list[str]:
    """`eurdf.check` finds nothing, not even a warning."""
    return [str(found) for found in eurdf.check(candidate.path).diagnostics]


def is_built(candidate: Candidate) -> list[str] | None:
    """The files are what build.py writes beside itself, but for the rounding of numbers; None without a build.py."""
    if not (candidate.folder / "build.py").is_file():
        return None
    with tempfile.TemporaryDirectory() as place:
        # In a copy, so that the files looked at are not the ones that were just written.
        copy = Path(place, candidate.folder.name)
        shutil.copytree(candidate.folder, copy, ignore=shutil.ignore_patterns(*_WRITTEN, "*.png", "__pycache__"))
        search = os.pathsep.join(filter(None, (str(_CHECKOUT), os.environ.get("PYTHONPATH", ""))))
        try:
            subprocess.run(
                [sys.executable, "build.py"],
                cwd=copy,
                env={**os.environ, "PYTHONPATH": search, "PYTHONDONTWRITEBYTECODE": "1"},
                check=True,
                capture_output=True,
                text=True,
                timeout=_LONGEST_BUILD,
            )
        except subprocess.CalledProcessError as failed:
            last = failed.stderr.strip().rpartition("\n")[2]
            return [f"build.py fails: {last or f'exit code {failed.returncode}'}"]
        except subprocess.TimeoutExpired:
            return [f"build.py is not done after {_LONGEST_BUILD:.0f} s"]
        return [
            f"{name} is not what build.py writes"
            for name in _WRITTEN
            if not _is_written(candidate.folder / name, copy / name)
        ]


def _is_written(file: Path, copy: Path) -> bool:
    """Whether a file says what the one that build.py has written says."""
    if not (file.is_file() and copy.is_file()):
        return file.is_file() == copy.is_file()
    texts = [path.read_text(encoding="utf-8", errors="surrogateescape") for path in (file, copy)]
    return same_text(*texts, relative=_RELATIVE, absolute=_ABSOLUTE)


def is_pictured(candidate: Candidate) -> list[str]:
    """There is a picture.png."""
    content = _bytes(candidate.folder / "picture.png")
    if content is None:
        return ["there is no picture.png: `python -m robots.picture` draws it"]
    return [] if content.startswith(_PNG) else ["picture.png is no PNG"]


def is_the_same_in_version_1(candidate: Candidate) -> list[str] | None:
    """robot.v1.yaml, where there is one, describes the same mechanism without a fault; None without it."""
    file = candidate.folder / "robot.v1.yaml"
    if not file.is_file() or file == candidate.path:
        return None
    new = candidate.robot.mechanism
    old = describe(file, root=new.root, geometry=False)
    told = set(is_sound(candidate))  # of the URDF, which both share
    faults = [fault for fault in map(str, old.diagnostics) if fault not in told]
    if isinstance(old, Unlinked) or faults:
        return faults
    return [f"robot.v1.yaml: {found}" for found in differences(_as_named(old.mechanism, new), new)]


def _as_named(old: Mechanism, new: Mechanism) -> Mechanism:
    """A mechanism of version 1 with what that version cannot say: names of closures, and configurations."""
    names = [closure.name for closure in new.closures]
    joined = with_universal_joints(old)
    closures = joined.closures
    if len(names) == len(closures):
        closures = tuple(replace(closure, name=name) for closure, name in zip(closures, names, strict=True))
    return replace(joined, closures=closures, configurations=new.configurations)


def _bytes(file: Path) -> bytes | None:
    return file.read_bytes() if file.is_file() else None
