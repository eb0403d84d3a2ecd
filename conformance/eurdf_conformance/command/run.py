"""``eurdf certify``: run the conformance suite on any parser."""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import random
import sys
from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path

from eurdf.commands.command import ending
from eurdf.commands.output_file import refuse_to_replace, write_new
from eurdf.commands.terminal import is_terminal, write_json, write_lines
from eurdf.diagnostics.text import Line
from eurdf.diagnostics.wording import visible
from eurdf.errors import CannotRun
from eurdf_conformance.certificate.certificate import Certificate, NoCertificate, read_certificate
from eurdf_conformance.certificate.comparison_page import comparison_markdown, comparison_page
from eurdf_conformance.certificate.write import NoRoom, make_room, write_certificate
from eurdf_conformance.command.output import show
from eurdf_conformance.command.replay import (
    Replay,
    file_differences,
    own_errors,
    replay_differences,
    suite_differences,
)
from eurdf_conformance.command.suite_run import CannotRunSuite, Progress, SuiteRun, run_suite
from eurdf_conformance.judging.known_failures import WrongKnownFailures, read_known_failures
from eurdf_conformance.level import Level
from eurdf_conformance.named_folder import named_folder

_DESCRIPTION = """\
Run the conformance suite on a parser written in any language, and report the certified levels.

A parser is 'package.module:object', a Python object, or 'cmd:' and a command line that starts a program with the
protocol of the suite, or 'reference', which is eurdf. --verify runs the command in the certificate: read it first, or
give your own with --parser.
--compare runs every parser with one seed, and writes one page of all of them.
"""
_EPILOG = ending(
    "0 every level claimed and asked for is certified (--smoke: the cases passed; --verify: the result is the same),\n"
    "1 otherwise, 2 the command cannot run. A known failure does not pass.",
    "eurdf certify --parser 'cmd:./my_parser --flag' --certificate out",
)

# Options that select what is tested, and options of how to run it.
_OF_A_RUN = ("level", "format_version", "known_failures", "certificate", "date", "explore", "seed")
_OF_ANY_RUN = ("jobs", "parser_timeout", "parser_start_timeout", "json")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="eurdf certify",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--parser", metavar="PARSER", help="the parser to certify")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--verify", metavar="PATH", type=Path, help="run again and compare with a certificate")
    what.add_argument(
        "--compare", metavar="PARSER", nargs="+", help="run several parsers, and compare them on one page"
    )
    what.add_argument("--smoke", action="store_true", help="test three cases per version, to check the adapter")
    parser.add_argument(
        "--level", choices=list(map(str, Level)), action="append", default=[], help="test this level only (repeatable)"
    )
    parser.add_argument("--format-version", choices=("1", "2", "2.1"), help="test this version of the format only")
    parser.add_argument("--known-failures", metavar="FILE", type=Path, help="YAML list of expected failures")
    parser.add_argument(
        "--certificate", metavar="DIR", type=named_folder, help="write a certificate: JSON, a page and a badge"
    )
    parser.add_argument("--date", metavar="YYYY-MM-DD", type=_date, help="date in the certificate")
    parser.add_argument(
        "--explore", metavar="N", type=_count, default=0, help="try N more random mechanisms for each property"
    )
    parser.add_argument(
        "--seed",
        metavar="SEED",
        type=_count,
        help="seed of the order, the fresh cases and --explore (default: a new one)",
    )
    parser.add_argument("--jobs", metavar="N", type=_count, help="number of parallel processes (default: one per core)")
    parser.add_argument("--parser-timeout", metavar="S", type=_seconds, help="time limit of an answer (default: 10 s)")
    parser.add_argument(
        "--parser-start-timeout", metavar="S", type=_seconds, help="time limit of the start (default: 30 s)"
    )
    page = "the page that --compare writes: HTML, or Markdown if its name ends with .md"
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help=page)
    parser.add_argument("--force", action="store_true", help="replace existing files")
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    return parser


def certify(argv: Sequence[str]) -> int:
    """Run the command, and return the exit code.

    Raises:
        CannotRun: It cannot be done.
    """
    args = _parser().parse_args(argv)
    if not hasattr(os, "fork"):
        raise CannotRun("the suite runs parsers on Linux and macOS; this system cannot end all that a parser started")
    try:
        if args.compare is not None:
            _refuse("--compare", args, "parser", "known_failures", "certificate", "explore", "json")
            return _compare(args)
        if args.verify is not None:
            _refuse("--verify", args, "output", "force", *_OF_A_RUN)
            return _verify(args)
        _refuse("--parser", args, "output")
        if args.smoke:
            _refuse("--smoke", args, "known_failures", "explore", "seed")
        if args.force and args.certificate is None:
            raise CannotRun("--force goes with --certificate, or with --compare and -o")
        if args.parser is None:
            raise CannotRun("--parser says which parser to certify, such as --parser='cmd:./my_parser'")
        return _certify(args)
    except CannotRunSuite as reason:
        sys.stderr.write(reason.log)
        raise CannotRun(str(reason)) from reason
    except (NoCertificate, WrongKnownFailures) as reason:
        raise CannotRun(str(reason)) from reason


def _certify(args: argparse.Namespace) -> int:
    if args.known_failures is not None:
        read_known_failures(args.known_failures)
    if args.certificate is not None:
        # Where nothing can be written, that is reported before the run.
        try:
            make_room(args.certificate, force=args.force)
        except NoRoom as reason:
            raise CannotRun(f"{reason}; --force replaces it" if args.certificate.is_dir() else str(reason)) from reason
    certificate = _run_suite(_suite_run(args, args.parser))
    if args.certificate is not None:
        write_certificate(args.certificate, certificate)
    if args.json:
        write_json(certificate.model_dump(mode="json"))
    else:
        show(certificate)
    tried = any(level.counts for level in certificate.levels)
    passes = tried and not certificate.failures if certificate.scope.smoke else certificate.certified
    return 0 if passes and not certificate.unexpected else 1


def _verify(args: argparse.Namespace) -> int:
    certificate = read_certificate(args.verify)
    parser = args.parser or certificate.parser_option
    # The command comes from the author of the certificate: show it before it runs.
    write_lines([[("running ", ""), (visible(parser), "bold")]], sys.stderr)
    again = _run_suite(_suite_run(args, parser, certificate))
    found = [*suite_differences(certificate), *replay_differences(certificate, again)]
    found += [*own_errors(certificate), *file_differences(args.verify, certificate)]
    if args.json:
        write_json(Replay(same=not found, differences=tuple(found)).model_dump(mode="json"))
    else:
        lines: list[Line] = [[(visible(line), "")] for line in found]
        verdict: Line = [("differs", "bold red")] if found else [("the same", "green")]
        write_lines([*lines, [(f"{args.verify}: ", "bold"), *verdict]], sys.stdout)
    return 1 if found else 0


def _compare(args: argparse.Namespace) -> int:
    """Run every parser here: a certificate would be somebody's word."""
    if args.output is None:
        raise CannotRun("--compare needs -o FILE for its page")
    refuse_to_replace(args.output, args.force)
    if args.seed is None:
        args.seed = random.SystemRandom().randrange(10**9)
    certificates = []
    for number, parser in enumerate(args.compare, 1):
        write_lines([[(f"{number} of {len(args.compare)}: ", ""), (visible(parser), "bold")]], sys.stderr)
        certificates.append(_run_suite(_suite_run(args, parser)))
    written = comparison_markdown if args.output.suffix == ".md" else comparison_page
    write_new(args.output, written(certificates), args.force)
    return 0


def _suite_run(args: argparse.Namespace, parser: str, certificate: Certificate | None = None) -> SuiteRun:
    """What to run: as the arguments say, or as a certificate records."""
    scope = certificate.scope if certificate else None
    versions = scope.versions if scope else (args.format_version,)
    return SuiteRun(
        parser=parser,
        levels=scope.levels if scope else tuple(map(Level, args.level)),
        version=versions[0] if len(versions) == 1 else None,
        timeout=args.parser_timeout,
        start_timeout=args.parser_start_timeout,
        known_failures=args.known_failures,
        smoke=scope.smoke if scope else args.smoke,
        explore=scope.explore if scope else args.explore,
        seed=scope.seed if scope else args.seed,
        date=args.date,
        jobs=args.jobs,
    )


def _run_suite(run: SuiteRun) -> Certificate:
    with _progress() as progress:
        return run_suite(run, progress)


@contextlib.contextmanager
def _progress() -> Iterator[Progress | None]:
    """A bar where a person sees it. The standard error is the suite's own meanwhile, so the bar has another handle."""
    if not (sys.stderr.isatty() and is_terminal(sys.stderr)):
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    with (
        os.fdopen(os.dup(sys.stderr.fileno()), "w", encoding="utf-8") as stream,
        Bar(console=Console(file=stream, force_terminal=True), transient=True) as bar,
    ):
        task = bar.add_task("certifying", total=None)
        yield lambda done, every: bar.update(task, completed=done, total=every)


def _refuse(mode: str, args: argparse.Namespace, *names: str) -> None:
    """Refuse options that would have no effect."""
    given = [name for name in names if getattr(args, name) not in (None, False, 0, [])]
    if given:
        raise CannotRun(f"{mode} does not go with --{given[0].replace('_', '-')}")


def _date(text: str) -> date:
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a date such as 2026-01-31") from None


def _count(text: str) -> int:
    if not (text.isascii() and text.isdecimal()):
        raise argparse.ArgumentTypeError(f"'{text}' is not a count")
    return int(text)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0 < seconds < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a time in seconds")
    return seconds
