"""What this package can use beside its dependencies: the command that installs it where it is missing."""

from __future__ import annotations

import json
import os
import shutil
import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path
from urllib.parse import unquote, urlsplit

_CHECKOUT = Path(__file__).parents[3]


def install_command(extra: str) -> str:
    """The command that installs an extra of this package, from where the package itself came."""
    pip = _pip()
    try:
        folder, editable = _installed_from(distribution("eurdf"))
    except PackageNotFoundError:  # run from a checkout
        return f'{pip} install "{"." if _is_here(_CHECKOUT) else _CHECKOUT}[{extra}]"'
    if folder is not None and _is_here(folder):
        return f'{pip} install {"-e " if editable else ""}".[{extra}]"'
    # It is installed: only the dependencies of the extra are.
    return f'{pip} install "eurdf[{extra}]"'


def install_suite_command() -> str:
    """The command that installs the conformance suite: of the same checkout, if this package came from one."""
    try:
        folder, editable = _installed_from(distribution("eurdf"))
    except PackageNotFoundError:  # run from a checkout
        folder, editable = _CHECKOUT, False
    if folder is None or not (folder / "conformance").is_dir():
        return f"{_pip()} install eurdf-conformance"
    if editable:  # the suite of the checkout is part of it
        return f'{_pip()} install -e "{folder}"'
    return f'{_pip()} install "{folder / "conformance"}"'


def build_page_command() -> str:
    """The command that builds the page of robots: with Node.js in a checkout, by another installation elsewhere."""
    if (_CHECKOUT / "js" / "build.js").is_file():
        js = "js" if _is_here(_CHECKOUT) else f'"{_CHECKOUT / "js"}"'
        return f"npm install --prefix {js} && npm run build --prefix {js}"
    folder, _ = _installed_from(distribution("eurdf"))
    origin = "eurdf" if folder is None else f'"{folder}"'
    return f"{_pip()} install --force-reinstall --no-deps {origin}"


def _installed_from(package: Distribution) -> tuple[Path | None, bool]:
    """The folder that a package was installed from, None for an archive; whether it is used from there (PEP 610)."""
    origin = json.loads(package.read_text("direct_url.json") or "{}")
    if "dir_info" not in origin:
        return None, False
    return Path(unquote(urlsplit(origin["url"]).path)), origin["dir_info"].get("editable", False)


def _is_here(folder: Path) -> bool:
    return folder.is_dir() and os.path.samefile(folder, os.curdir)


def _pip() -> str:
    """The command ``pip`` of this Python."""
    return "pip" if _pip_is_ours() else f"{sys.executable} -m pip"


def _pip_is_ours() -> bool:
    """Whether ``pip`` on the PATH installs for this Python."""
    pip = shutil.which("pip")
    return pip is not None and Path(pip).parent == Path(sys.executable).parent
