"""Expanding a xacro file into the URDF that it means.

A xacro is a program: its expressions are evaluated, and it includes other files. So it is expanded in a process of its
own, bounded in time and memory. Where a description names it, and not the caller, that process reads only files of the
robot (EU-SEC-001).
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from eurdf.diagnostics import did_you_mean
from eurdf.errors import CannotExpand, MissingExtra
from eurdf.mesh_files.folders import Folders
from eurdf.reading.resource import package_homes
from eurdf.reading.source import FILE_LIMIT, Source, Texts, too_large
from eurdf.sandbox import run

#: Time allowed for an expansion, s.
TIME_LIMIT = 60.0

_PROGRAM = Path(__file__).with_name("xacro_process.py")


def is_xacro(path: str | os.PathLike[str]) -> bool:
    """Whether a path is that of a xacro file, by its ending."""
    return os.fspath(path).lower().endswith(".xacro")


def expand(
    path: str | os.PathLike[str],
    arguments: Mapping[str, str] | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    folders: Folders | None = None,
) -> tuple[Source, str]:
    """Expand a xacro file.

    Lines and columns in the source are those of the expanded text, as its name says: xacro does not keep those of the
    file.

    Args:
        path: The file.
        arguments: Values of its arguments, ``xacro:arg``.
        package_dirs: Folders to look for packages in, ``$(find package)``.
        folders: Where the files that it reads must be, for a xacro that its caller does not vouch for: it then also
            reads no environment variable. None for no such limits.

    Returns:
        The URDF, and what xacro warned of (empty for nothing).

    Raises:
        CannotExpand: It has an error, or an argument is given that it does not have.
        MissingExtra: The extra ``xacro`` is not installed.
        FileError: ``file-too-large``.
    """
    file = os.fspath(path)
    found = find_spec("xacro")
    if found is None or found.origin is None:  # a folder named xacro is not a module
        from eurdf.diagnostics.extras import install_command

        message = f"'{file}' is a xacro file, and the package that expands it is not installed; install it with: "
        raise MissingExtra(message + install_command("xacro"), "xacro")
    folder = Path(path).parent
    request = {
        "file": file,
        "arguments": dict(arguments or {}),
        "homes": [str(home) for home in package_homes(folder, package_dirs)],
        "folders": None if folders is None else ["/"] if folders.allow_outside else folders.real,
        "limit": FILE_LIMIT,
    }
    answer = _answer(file, request)
    unknown = next(iter(answer["unused"]), None)
    if unknown is not None:
        known = answer["declared"]
        hint = did_you_mean(unknown, known) or (f"it has {', '.join(known)}" if known else "it has none")
        raise CannotExpand(file, f"it has no argument '{unknown}': {hint}")
    if answer["error"] == "too large":
        raise too_large(f"{file} (expanded)", f"{FILE_LIMIT:,} bytes")
    if answer["error"]:
        raise CannotExpand(file, answer["error"])
    text = answer["urdf"]
    source = Source(f"{file} (expanded)", text, text.encode(), folder, made_from=(file, *answer["files"]))
    return source, answer["warnings"]


def expand_once(
    texts: Texts,
    path: Path,
    arguments: Mapping[str, str] | None,
    package_dirs: Sequence[str | os.PathLike[str]],
    folders: Folders | None,
) -> tuple[Source, str]:
    """As `expand`, or what is among the texts because it was expanded before."""
    name, warned = f"{path} (expanded)", f"{path} (warnings)"
    if name in texts:
        source = Source(name, texts[name], texts[name].encode(), path.parent, made_from=(os.fspath(path),))
        return source, texts[warned]
    source, warnings = expand(path, arguments, package_dirs, folders)
    texts[name], texts[warned] = source.text, warnings
    return source, warnings


def _answer(file: str, request: Mapping[str, object]) -> dict[str, Any]:
    done = run(_PROGRAM, request, seconds=TIME_LIMIT)
    if done.exceeded:
        raise CannotExpand(file, f"it takes longer than {TIME_LIMIT:g} s")
    if done.code:
        said = done.stderr.decode(errors="replace").split("\n")
        reason = next((line.strip() for line in reversed(said) if line.strip()), "it printed no reason")
        raise CannotExpand(file, f"its process ended with exit code {done.code}: {reason}")
    answer: dict[str, Any] = json.loads(done.output)
    return answer
