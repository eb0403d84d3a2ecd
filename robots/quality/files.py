"""The rules on the files of a robot: valid, up to date, with a picture, and equal in both versions."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import eurdf
from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.constraint import RIGID, Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.same_model import differences, with_universal_joints
from eurdf_conformance.comparison.text import same_text
from robots.quality.candidate import Candidate

_CHECKOUT = Path(__file__).parents[2]
_WRITTEN = ("robot.urdf", "robot.yaml", "robot.v1.yaml")
_LONGEST_BUILD = 60.0  # s
# Accepted difference of a number in a file from the one that build.py writes, relative and absolute (m, rad, kg).
# Numbers are written with 14 decimals or 12 digits; the last few depend on the processor, because positions are sums of
# about a dozen products of lengths of a metre, each rounded to 1e-16.
_RELATIVE, _ABSOLUTE = 1e-9, 1e-12
#: What version 1 cannot say, and what is left out where it is compared with version 2. A closure of version 1 between
#: the frames of a hinge or of a distance is left out too.
NOT_IN_VERSION_1 = (
    "names of closures",
    "hinges, distances and compliances",
    "couplings",
    "properties of joints: limits, damping, friction, armature, springs, gear ratios, rotor inertias",
    "names and control ranges of actuators",
    "frames",
    "configurations",
)
_PNG = b"\x89PNG\r\n\x1a\n"


def is_sound(candidate: Candidate) -> list[str]:
    """`eurdf.check` reports no error and no warning, except what the rule on mirrored legs reports exactly."""
    return [str(found) for found in eurdf.check(candidate.path).without({"x-asymmetric"}).diagnostics]


def is_built(candidate: Candidate) -> list[str] | None:
    """The files are those that build.py writes, except for rounding; None without a build.py."""
    if not (candidate.folder / "build.py").is_file():
        return None
    with tempfile.TemporaryDirectory() as place:
        # Build in a copy, so that the checked files are not overwritten.
        copy = Path(place, candidate.folder.name)
        shutil.copytree(candidate.folder, copy, ignore=shutil.ignore_patterns(*_WRITTEN, "*.png", "__pycache__"))
        try:
            _build(copy)
        except subprocess.CalledProcessError as failed:
            last = failed.stderr.strip().rpartition("\n")[2]
            return [f"build.py fails: {last or f'exit code {failed.returncode}'}"]
        except subprocess.TimeoutExpired:
            return [f"build.py does not finish within {_LONGEST_BUILD:.0f} s"]
        return [
            f"{name} differs from what build.py writes; run build.py"
            for name in _WRITTEN
            if not _is_written(candidate.folder / name, copy / name)
        ]


def _build(folder: Path) -> None:
    """Run the build.py of a folder in a process of its own."""
    search = os.pathsep.join(filter(None, (str(_CHECKOUT), os.environ.get("PYTHONPATH", ""))))
    subprocess.run(
        [sys.executable, "build.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": search, "PYTHONDONTWRITEBYTECODE": "1"},
        check=True,
        capture_output=True,
        text=True,
        timeout=_LONGEST_BUILD,
    )


def _is_written(file: Path, copy: Path) -> bool:
    """Whether a file equals the one that build.py wrote, except for rounding."""
    if not (file.is_file() and copy.is_file()):
        return file.is_file() == copy.is_file()
    texts = [path.read_text(encoding="utf-8", errors="surrogateescape") for path in (file, copy)]
    return same_text(*texts, relative=_RELATIVE, absolute=_ABSOLUTE)


def is_pictured(candidate: Candidate) -> list[str]:
    """There is a picture.png."""
    content = _bytes(candidate.folder / "picture.png")
    if content is None:
        return ["picture.png is missing; `python -m robots.picture` draws it"]
    return [] if content.startswith(_PNG) else ["picture.png is not a PNG file"]


def is_the_same_in_version_1(candidate: Candidate) -> list[str] | None:
    """robot.v1.yaml is valid and the same mechanism, except for `NOT_IN_VERSION_1`; None if there is no such file."""
    file = candidate.folder / "robot.v1.yaml"
    if not file.is_file() or file == candidate.path:
        return None
    new = candidate.robot.mechanism
    old = read_robot(file, root=new.root, geometry=False)
    shared = set(is_sound(candidate))  # errors of the URDF, which both versions share
    errors = [error for error in map(str, old.diagnostics) if error not in shared]
    if old.linked is None or errors:
        return errors
    one, other = comparable(old.mechanism, new)
    return [f"robot.v1.yaml: {found}" for found in differences(one, other)]


def comparable(old: Mechanism, new: Mechanism) -> tuple[Mechanism, Mechanism]:
    """The mechanisms of version 1 and of version 2, both without what is in `NOT_IN_VERSION_1`."""
    sayable = [closure for closure in new.closures if isinstance(closure, PointClosure | FrameClosure)]
    left_out = {_cut(closure) for closure in new.closures if closure not in sayable}
    joined = with_universal_joints(old)
    stated = [closure for closure in joined.closures if _cut(closure) not in left_out]
    names = [closure.name for closure in sayable]
    if len(names) == len(stated):
        stated = [replace(closure, name=name) for closure, name in zip(stated, names, strict=True)]
    properties = {joint.name: joint.properties for joint in joined.joints}
    added = {frame.name for frame in new.frames} - {frame.name for frame in joined.frames}
    return (
        replace(joined, closures=tuple(stated), configurations=new.configurations),
        replace(
            new,
            closures=tuple(replace(closure, compliance=RIGID) for closure in sayable),
            couplings=(),
            motors={},
            frames=tuple(frame for frame in new.frames if frame.name not in added),
            joints=tuple(
                replace(joint, properties=properties.get(joint.name, joint.properties)) for joint in new.joints
            ),
        ),
    )


def _cut(closure: Closure) -> frozenset[tuple[str, Pose]]:
    """Where a closure is, whichever of its frames is A."""
    return frozenset((anchor.body, anchor.pose) for anchor in closure.anchors)


def _bytes(file: Path) -> bytes | None:
    return file.read_bytes() if file.is_file() else None
