"""The process that expands one xacro file: the request is JSON on standard input, the answer on standard output.

Of this package, it imports only `eurdf.system`. The module ``xacro`` keeps its state in globals, prints, and evaluates
expressions of the file, none of which belongs in the process of a caller.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import Any

from eurdf.system import bound_memory

#: Memory that an expansion may take, bytes.
MEMORY_LIMIT = 4 << 30


class Arguments(dict[str, str]):
    """Values of arguments, which records those that were requested.

    Attributes:
        declared: Names that the file has requested, in order.
    """

    def __init__(self, values: dict[str, str]) -> None:
        super().__init__(values)
        self.declared: dict[str, None] = {}

    def __contains__(self, name: object) -> bool:
        self.declared[str(name)] = None
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.declared[name] = None
        return super().__getitem__(name)


def main() -> None:
    """Answer the request."""
    request = json.load(sys.stdin.buffer)
    bound_memory(MEMORY_LIMIT)
    _find_packages_in(request["homes"])
    arguments = Arguments(request["arguments"])
    log = io.StringIO()
    with contextlib.redirect_stdout(log), contextlib.redirect_stderr(log):
        urdf, error = _expanded(request["file"], arguments)
    if len(urdf) > request["limit"]:
        urdf, error = "", "too large"
    unused = [name for name in request["arguments"] if name not in arguments.declared]
    answer: dict[str, Any] = {
        "urdf": urdf,
        "error": error,
        "warnings": "" if error else log.getvalue().strip(),
        "declared": list(arguments.declared),
        "unused": [] if error else unused,
    }
    json.dump(answer, sys.stdout)


def _expanded(file: str, arguments: Arguments) -> tuple[str, str]:
    """The URDF, or why there is none."""
    import xacro

    try:
        return xacro.process_file(file, mappings=arguments).toprettyxml(indent="  "), ""
    except RecursionError:
        reason = "its macros or properties contain themselves"
    except MemoryError:
        reason = f"it takes more than {MEMORY_LIMIT >> 30} GiB of memory"
    except Exception as found:
        reason = " ".join(str(found).split()) or repr(found)
    macros = [f"macro '{macro.body.getAttribute('name')}'" for macro in reversed(xacro.macrostack or [])]
    files = [f"'{name}'" for name in reversed(xacro.filestack or []) if name and name != file]
    within = [*macros, *files]
    return "", f"{reason}, in {', in '.join(within)}" if within else reason


def _find_packages_in(homes: Sequence[str]) -> None:
    """Let ``$(find package)``, which asks ROS 2 by this module, look where meshes are looked for."""

    def get_package_share_directory(package: str) -> str:
        for home in homes:
            for folder in (os.path.join(home, package), home if os.path.basename(home) == package else ""):
                if os.path.isdir(folder):
                    return folder
        raise LookupError(
            f"package '{package}' is not found; give the folder that contains it with --package-dir "
            "(package_dirs= in Python), ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
        )

    packages = ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = get_package_share_directory  # type: ignore[attr-defined]
    sys.modules["ament_index_python"] = ModuleType("ament_index_python")
    sys.modules["ament_index_python.packages"] = packages


if __name__ == "__main__":
    main()
