"""Makes the data packages of the corpus: ``python -m eurdf_conformance.corpus.packages eurdf-corpus.zip OUT``.

``OUT/npm`` and ``OUT/python`` contain the files of the archive, and what ``npm pack`` and ``python -m build`` need to
build packages that contain them.
"""

from __future__ import annotations

import argparse
import json
import sys
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from eurdf_conformance.corpus.archive import NAME

_PACKAGE = Path(__file__).with_name("package")


class NotAnArchive(Exception):  # noqa: N818 - it says what the file is
    """A file that is not an archive of the corpus."""


def npm_package(archive: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files of the package for npm, of those of the archive."""
    package = json.loads((_PACKAGE / "package.json").read_bytes())
    package["version"] = json.loads(archive["index.json"])["version"]
    return {**archive, "package.json": (json.dumps(package, indent=2) + "\n").encode()}


def python_package(archive: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files from which the distributions for PyPI are built, of those of the archive."""
    module = NAME.replace("-", "_")
    return {
        **{f"{module}/{name}": content for name, content in archive.items()},
        f"{module}/__init__.py": (_PACKAGE / "__init__.py").read_bytes(),
        **{name: archive[name] for name in ("README.md", "LICENSE")},
        "pyproject.toml": (_PACKAGE / "pyproject.toml").read_bytes(),
    }


def read_archive(path: Path) -> dict[str, bytes]:
    """The files of the archive by name.

    Raises:
        NotAnArchive: The file is not a zip, or another one.
        OSError: The file cannot be read.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
    except zipfile.BadZipFile as error:
        raise NotAnArchive(f"'{path}' is not a zip file: {error}") from None
    if missing := {"index.json", "README.md", "LICENSE"} - files.keys():
        raise NotAnArchive(f"'{path}' has no {min(missing)}; write it with eurdf_conformance.corpus.archive")
    return files


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the two folders, and print their paths.

    Returns:
        0 if they are written, 2 if not.
    """
    parser = argparse.ArgumentParser(
        prog="python -m eurdf_conformance.corpus.packages",
        description="Write OUT/npm and OUT/python, from which `npm pack` and `python -m build` make packages.",
        epilog="Exit codes: 0 written, 2 not written.",
    )
    parser.add_argument("archive", metavar="ARCHIVE", type=Path, help=f"{NAME}.zip")
    parser.add_argument("out", metavar="OUT", type=Path, help="the folder, new or empty")
    options = parser.parse_args(arguments)
    try:
        archive = read_archive(options.archive)
        if options.out.exists() and any(options.out.iterdir()):
            raise FileExistsError(17, "it is not empty", str(options.out))
        for name, files in (("npm", npm_package(archive)), ("python", python_package(archive))):
            _write(options.out / name, files)
            sys.stdout.write(f"{options.out / name}: {len(files)} files\n")
    except NotAnArchive as error:
        sys.stderr.write(f"{parser.prog}: {error}\n")
        return 2
    except OSError as error:
        sys.stderr.write(f"{parser.prog}: '{error.filename}': {error.strerror}\n")
        return 2
    return 0


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


if __name__ == "__main__":
    sys.exit(main())
