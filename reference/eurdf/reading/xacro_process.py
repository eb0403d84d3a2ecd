"""The process that expands one xacro file: the request is JSON on standard input, the answer on standard output.

Of this package, it imports only modules that need nothing but the standard library. The module ``xacro`` keeps its
state in globals, prints, and evaluates expressions of the file, none of which belongs in the process of a caller.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from types import ModuleType
from typing import Any, NoReturn

from eurdf.mesh_files.folders import Folders
from eurdf.sandbox import bound_memory, request_and_answers

#: Memory that an expansion may take, bytes.
MEMORY_LIMIT = 4 << 30

#: Modules that xacro imports when it first needs them.
_LATE = ("glob", "xacro.substitution_args", "xml.dom.expatbuilder", "xml.parsers.expat", "yaml")

#: What an expansion does, by the names of Python's audit events.
_HARMLESS = ("builtins.id", "compile", "exec", "glob.glob", "glob.glob/2", "open", "os.listdir", "os.scandir")

_MAY_NOT = "which a xacro that a description names may not"
_IF_TRUSTED = "if you trust the xacro, give it with --urdf (urdf= in Python)"


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


class _Watch:
    """What an expansion reads. A confined one may do no more than read files of the robot.

    The expressions of a xacro reach most of Python, so that a hostile one may find a way round this: it is no sandbox.

    Attributes:
        read: Paths of the files that were read, in order.
        refused: What was refused, in order: xacro may go on after an exception, and changes its text.
    """

    def __init__(self, folders: Sequence[str] | None) -> None:
        """Watch from now on."""
        for name in _LATE:
            import_module(name)
        self._folders = None if folders is None else Folders(folders)
        self.read: dict[str, None] = {}
        self.refused: list[str] = []
        if self._folders is not None:
            os.environ.clear()
            import_module(os.name).environ.clear()  # its own copy
            os.environ = _NoEnvironment(self)  # type: ignore[assignment]  # noqa: B003 - for this process alone
        sys.addaudithook(self._audit)

    def refuse(self, what: str) -> PermissionError:
        """The exception for what a confined expansion may not do."""
        self.refused.append(f"{what}; {_IF_TRUSTED}")
        return PermissionError(what)

    def _audit(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and not isinstance(arguments[0], int):  # no descriptor, which is open already
            path, _, flags = arguments
            is_read = not flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
            if self._folders is not None and not (is_read and self._folders.contains(path)):
                hint = "give the folder of its package with --package-dir (package_dirs= in Python)"
                raise self.refuse(f"it opens '{path}', which is outside {self._folders}; {hint}")
            self.read[os.path.abspath(path)] = None
        elif self._folders is not None and event not in _HARMLESS:
            raise self.refuse(f"it uses '{event}' of Python, {_MAY_NOT}")


class _NoEnvironment(dict[str, str]):
    """Does not say what is in the environment."""

    def __init__(self, watch: _Watch) -> None:
        super().__init__()
        self._watch = watch

    def __getitem__(self, name: object) -> NoReturn:
        raise self._watch.refuse(f"it reads the environment variable '{name}', {_MAY_NOT}")

    __contains__ = __getitem__


def main() -> None:
    """Answer the request."""
    request, answers = request_and_answers()
    bound_memory(MEMORY_LIMIT)
    _find_packages_in(request["homes"])
    arguments = Arguments(request["arguments"])
    watch = _Watch(request["folders"])
    log = io.StringIO()
    with contextlib.redirect_stdout(log), contextlib.redirect_stderr(log):
        urdf, error = _expanded(request["file"], arguments)
    if watch.refused:
        urdf, error = "", watch.refused[0]
    if len(urdf) > request["limit"]:
        urdf, error = "", "too large"
    unused = [name for name in request["arguments"] if name not in arguments.declared]
    answer: dict[str, Any] = {
        "urdf": urdf,
        "error": error,
        "warnings": "" if error else log.getvalue().strip(),
        "declared": list(arguments.declared),
        "unused": [] if error else unused,
        "files": list(watch.read),
    }
    answers.write(json.dumps(answer).encode())
    answers.flush()


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
        inner = getattr(found, "exc", None)  # whose text xacro repeats after its class
        is_repeated = inner is not None and str(found).startswith(f"{type(inner)}: ")
        reason = " ".join(str(inner if is_repeated else found).split()) or repr(found)
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
