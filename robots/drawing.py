"""The command line of the modules that draw one picture each."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import eurdf


def draw(
    module: str, description: str, default: Path, save: Callable[[Path], object], arguments: Sequence[str] | None
) -> int:
    """Save the picture of a module to the file that is asked for; 0 if it is drawn, 2 if it cannot be."""
    parser = argparse.ArgumentParser(f"python -m robots.{module}", description=description)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", default=default, help="default: %(default)s")
    try:
        save(parser.parse_args(arguments).output)
    except eurdf.errors.MissingExtra as missing:
        print(missing, file=sys.stderr)
        return 2
    return 0
