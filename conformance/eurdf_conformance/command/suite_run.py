"""Runs the suite from within a program and returns its certificate.

It is the suite that ``pytest conformance/`` runs, whether this package lies in a checkout or in a wheel. Neither a
configuration of pytest that lies about, nor what the environment says to it, has a part in it.
"""

from __future__ import annotations

import contextlib
import io
import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import date, datetime, time, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eurdf_conformance.certificate.certificate import Certificate, read_certificate
from eurdf_conformance.level import Level, Version
from eurdf_conformance.needed import is_installed
from eurdf_conformance.runner.session import NotStarted, Session
from eurdf_conformance.visible import visible

if TYPE_CHECKING:
    import pytest

_SUITE = "eurdf_conformance.suite"

#: Called with the number of finished items and the number of all items.
Progress = Callable[[int, int], None]


class CannotRunSuite(Exception):  # noqa: N818 - shown to the user as it is
    """The suite gave no result; the text gives the reason.

    Attributes:
        log: What pytest wrote, or the parser, where that may help.
    """

    def __init__(self, why: str, log: str = "") -> None:
        self.log = visible(log)
        super().__init__(why)


@dataclass(frozen=True)
class SuiteRun:
    """What to run."""

    #: ``package.module:object``, or ``cmd:`` and a command line.
    parser: str
    levels: Sequence[Level] = ()
    version: Version | None = None
    #: Time allowed for an answer, and for starting, s; that of the suite where it is None.
    timeout: float | None = None
    start_timeout: float | None = None
    known_failures: Path | None = None
    smoke: bool = False
    explore: int = 0
    #: What the order, the fresh cases and further mechanisms are drawn from; None for another seed each time.
    seed: int | None = None
    #: The day that the certificate shows; None for that of SOURCE_DATE_EPOCH, or none.
    date: date | None = None
    #: Number of processes; None for as many as there are cores. Where pytest-xdist is missing there is one.
    jobs: int | None = None


def run_suite(run: SuiteRun, progress: Progress | None = None) -> Certificate:
    """Run the suite on a parser.

    Args:
        run: What to run.
        progress: Called after each item.

    Raises:
        CannotRunSuite: The parser does not start, or the suite broke off.
        KeyboardInterrupt: The user ended it.
    """
    import pytest

    from eurdf_conformance.suite.untouched import snapshot, void_text

    before = snapshot()
    _greet(run)
    with tempfile.TemporaryDirectory(prefix="eurdf-certify-") as scratch:
        written = io.StringIO()
        with _environment(run), contextlib.redirect_stdout(written):
            code = pytest.main(_arguments(run, scratch), plugins=[_Listener(progress)] if progress else [])
        if code == pytest.ExitCode.INTERRUPTED and "KeyboardInterrupt" in written.getvalue():
            raise KeyboardInterrupt
        if (void := void_text(before)) is not None:
            raise CannotRunSuite(void)
        if code == pytest.ExitCode.NO_TESTS_COLLECTED:
            raise CannotRunSuite("the suite has no tests at that level for that version")
        if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
            raise CannotRunSuite(f"the suite was aborted (pytest exit code {int(code)})", written.getvalue())
        return read_certificate(Path(scratch))


def _greet(run: SuiteRun) -> None:
    """Check that the parser starts, before the whole suite is run on it."""
    session = Session(run.parser) if run.start_timeout is None else Session(run.parser, start_timeout=run.start_timeout)
    with session:
        try:
            _ = session.started
        except NotStarted as refusal:
            why, _, log = str(refusal).partition("\n")
            raise CannotRunSuite(f"'{run.parser}' could not be started: {why}", f"{log}\n" if log else "") from None


def _arguments(run: SuiteRun, folder: str) -> list[str]:
    jobs = "auto" if run.jobs is None else str(run.jobs)
    is_spread = is_installed("xdist") and not run.smoke
    package = Path(__file__).parents[1]
    return [
        *("--pyargs", _SUITE, "-p", f"{_SUITE}.plugin", "--noconftest"),
        *("-c", os.devnull, "--rootdir", str(package), "-p", "no:cacheprovider", "-q", "--tb=no"),
        *(("-p", "xdist.plugin", "-n", jobs, "--dist", "loadgroup") if is_spread else ()),
        *(f"--parser={run.parser}", "--parser-starts", f"--certificate={folder}"),
        *(f"--level={level}" for level in run.levels),
        *(f"--{name}={value}" for name, value in _options(run) if value is not None),
        *(["--smoke"] if run.smoke else []),
    ]


def _options(run: SuiteRun) -> Iterator[tuple[str, Any]]:
    yield "format-version", run.version
    yield "parser-timeout", run.timeout
    yield "parser-start-timeout", run.start_timeout
    yield "known-failures", run.known_failures
    yield "explore", run.explore or None
    yield "seed", run.seed


@contextlib.contextmanager
def _environment(run: SuiteRun) -> Iterator[None]:
    """The environment without the plug-ins and options of pytest that the user has set for other tests."""
    before = dict(os.environ)
    for name in before:
        if name.startswith("PYTEST_"):
            del os.environ[name]
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    if run.date is not None:
        os.environ["SOURCE_DATE_EPOCH"] = f"{datetime.combine(run.date, time(), timezone.utc).timestamp():.0f}"
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


class _Listener:
    """Counts the items of pytest as they are done, in this process or in those of pytest-xdist."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._done = 0
        self._all = 0

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        self._all = max(self._all, len(session.items))

    def pytest_xdist_node_collection_finished(self, node: object, ids: Sequence[str]) -> None:
        self._all = max(self._all, len(ids))

    # Where pytest-xdist is not loaded, there is no such hook. This is what pytest's decorator, not imported here, sets.
    pytest_xdist_node_collection_finished.pytest_impl = {"optionalhook": True}  # type: ignore[attr-defined]  # noqa: RUF012

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        self._done += 1
        self._progress(self._done, max(self._all, self._done))
