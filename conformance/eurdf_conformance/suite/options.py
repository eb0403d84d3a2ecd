"""The options of the suite."""

from __future__ import annotations

import argparse
import math
import random
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from eurdf_conformance.judging.known_failures import (
    NONE_KNOWN,
    KnownFailures,
    WrongKnownFailures,
    read_known_failures,
)
from eurdf_conformance.judging.result import Item
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.named_folder import named_folder
from eurdf_conformance.runner.command import REFERENCE
from eurdf_conformance.suite.reproduce import FOLDER, PACKAGE, START_TIMEOUT, TIMEOUT, Setting, command_line

#: Where the options of a run of pytest are kept.
OPTIONS: pytest.StashKey[Options] = pytest.StashKey()


@dataclass(frozen=True)
class Options:
    """The options of the suite.

    Attributes:
        parser: ``package.module:object`` or ``cmd:…``.
        suite: Arguments of pytest that select the suite: a folder in a checkout, else a package with its plug-in.
        timeout: Time allowed for an answer, s.
        start_timeout: Time allowed for a start, s.
        levels: Those to test.
        versions: Those to test.
        known: Failures that are known.
        certificate: Folder to write a certificate into.
        explore: Further random mechanisms to try for each property.
        seed: The seed of the order of the items, of the fresh cases and of further mechanisms.
        smoke: Whether to try three cases only.
    """

    parser: str = REFERENCE
    suite: tuple[str, ...] = FOLDER
    timeout: float = TIMEOUT
    start_timeout: float = START_TIMEOUT
    levels: tuple[Level, ...] = tuple(Level)
    versions: tuple[Version, ...] = VERSIONS
    known: KnownFailures = NONE_KNOWN
    certificate: Path | None = None
    explore: int = 0
    seed: int = 0
    smoke: bool = False

    def wants(self, item: Item) -> bool:
        """Whether the level and the version of an item are requested."""
        return item.level in self.levels and item.version in self.versions

    def reproduce(self, item: Item) -> str:
        """The command line that runs one item alone."""
        setting = Setting(self.parser, self.suite, self.timeout, self.start_timeout, self.explore, self.seed)
        return command_line(setting, item.id, item.level)


def add_options(parser: pytest.Parser) -> None:
    """The options of the suite."""
    group = parser.getgroup("eurdf", "conformance suite of Extended URDF")
    group.addoption(
        "--parser",
        metavar="PARSER",
        help="package.module:object, or 'cmd:./my_parser --flag'; default: reference, which is eurdf",
    )
    group.addoption(
        "--parser-timeout",
        type=float,
        default=TIMEOUT,
        metavar="S",
        help=f"time limit of an answer (default: {TIMEOUT:g} s); with -x the run stops at the first failure",
    )
    group.addoption(
        "--parser-start-timeout",
        type=float,
        default=START_TIMEOUT,
        metavar="S",
        help=f"time limit of the start (default: {START_TIMEOUT:g} s)",
    )
    group.addoption(
        "--level", action="append", choices=[level.value for level in Level], help="test this level only (repeatable)"
    )
    group.addoption("--format-version", choices=VERSIONS, help="test this version of the format only")
    group.addoption("--known-failures", type=Path, metavar="FILE", help="YAML list of {id, level, verdict, reason}")
    group.addoption("--certificate", type=named_folder, metavar="DIR", help="write a certificate into this folder")
    group.addoption("--explore", type=int, default=0, metavar="N", help="try N more random mechanisms per property")
    group.addoption(
        "--seed",
        type=int,
        metavar="SEED",
        help="seed of the order of the cases, of the fresh cases and of --explore (default: a new one)",
    )
    # For a program that has seen already that the parser starts.
    group.addoption("--parser-starts", action="store_true", help=argparse.SUPPRESS)
    group.addoption("--smoke", action="store_true", help="test three cases per version, to check the adapter")


def read_options(config: pytest.Config) -> Options:
    """The options on the command line.

    Raises:
        pytest.UsageError: An option has an invalid value, or two options exclude each other.
    """

    def said(name: str, default: Any = None) -> Any:
        # If this plug-in was loaded after the command line was parsed, the options are missing.
        value = config.getoption(name, default)
        return default if value is None else value

    known = said("--known-failures")
    try:
        failures = NONE_KNOWN if known is None else read_known_failures(known)
    except WrongKnownFailures as error:
        raise pytest.UsageError(str(error)) from None
    timeout, start_timeout = said("--parser-timeout", TIMEOUT), said("--parser-start-timeout", START_TIMEOUT)
    if not (0 < timeout < math.inf and 0 < start_timeout < math.inf):
        raise pytest.UsageError("a time limit must be positive and finite")
    explore = said("--explore", 0)
    if explore < 0:
        raise pytest.UsageError("--explore must not be negative")
    if said("--seed") is None:
        config.option.seed = random.SystemRandom().randrange(10**9)
    if said("--smoke", False) and (known is not None or explore):
        raise pytest.UsageError("--smoke cannot be combined with --known-failures or --explore")
    version = said("--format-version")
    parser = said("--parser", REFERENCE)
    if not parser.strip():
        raise pytest.UsageError("--parser is empty")
    return Options(
        parser=parser,
        suite=FOLDER if _is_beside(config.invocation_params.dir) and not config.option.pyargs else PACKAGE,
        timeout=timeout,
        start_timeout=start_timeout,
        levels=tuple(level for level in Level if level in said("--level", list(Level))),
        versions=VERSIONS if version is None else (version,),
        known=failures,
        certificate=said("--certificate"),
        explore=explore,
        seed=said("--seed", 0),
        smoke=said("--smoke", False),
    )


def _is_beside(folder: Path) -> bool:
    """Whether ``pytest conformance/`` runs this suite from a folder: elsewhere it is named as a package."""
    return (folder / FOLDER[0] / "eurdf_conformance").resolve() == Path(__file__).resolve().parents[1]


def options_of(config: pytest.Config) -> Options:
    """The options of a run of pytest."""
    return config.stash[OPTIONS]
