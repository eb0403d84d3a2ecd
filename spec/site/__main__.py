"""Build the site of the specification: ``python -m spec.site``."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from sphinx.cmd.build import main as sphinx_build

from eurdf.collection import collection_names
from spec.site.clause import SPEC
from spec.site.diagnostics import write_diagnostic_pages
from spec.site.drop import write_drop_page
from spec.site.links import site_errors
from spec.site.pages import gather
from spec.site.robots import write_robot_pages

BUILD = SPEC / "_build"


def build(output: Path, builder: str = "html", source: Path = SPEC, robots: Sequence[str] | None = None) -> int:
    """Build the site from scratch; a warning or a broken link is an error.

    Args:
        output: Folder that the site is written into.
        builder: ``html``, or ``linkcheck`` to look the addresses of other sites up.
        source: Folder of the specification, beside that of the other pages.
        robots: Names of the robots that get a page; by default all of the collection.

    Returns:
        0, or another number where something is wrong; what is, is printed.
    """
    if (output / ".buildinfo").exists():  # an earlier build: a page that is gone would still be there
        shutil.rmtree(output)
    doctrees = str(output.parent / f"{output.name}.doctrees")
    with TemporaryDirectory() as pages:
        gather(Path(pages), source.resolve())
        write_diagnostic_pages(Path(pages))
        write_robot_pages(Path(pages), collection_names() if robots is None else robots)
        options = ["-q", "-E", "-a", "-n", "-W", "-d", doctrees, "-c", str(source)]
        failed = sphinx_build(["-b", builder, *options, pages, str(output)])
    if failed or builder != "html":
        return failed
    write_drop_page(output)
    errors = site_errors(output)
    for error in errors:
        print(error, file=sys.stderr)
    return 1 if errors else 0


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m spec.site", description="Build the site of the specification.")
    parser.add_argument(
        "-o", "--output", type=Path, default=BUILD / "html", metavar="FOLDER", help="default: %(default)s"
    )
    parser.add_argument("--linkcheck", action="store_true", help="check every external link")
    args = parser.parse_args()
    if args.linkcheck:
        return build(BUILD / "linkcheck", "linkcheck")
    failed = build(args.output)
    if not failed:
        print(f"the site is in {args.output / 'index.html'}")
    return failed


if __name__ == "__main__":
    sys.exit(main())
