"""The plug-in of pytest: its options, one parser a worker, and at the end the certificate and a summary.

Each worker of pytest-xdist starts its own process of the parser. The result of an item is part of its report; the main
process collects the reports into a `Run`.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from eurdf_conformance.certificate.issue import issue
from eurdf_conformance.certificate.write import NoRoom, make_room, write_certificate
from eurdf_conformance.corpus.read import all_cases, keep_files_in
from eurdf_conformance.fresh.case import drawn_hash, drawn_text, keep_drawn
from eurdf_conformance.judging.level_result import unclaimed
from eurdf_conformance.judging.result import RESULT, Item, Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.protocol.message import Started
from eurdf_conformance.runner.session import NotStarted, Session
from eurdf_conformance.suite.item import planned_items
from eurdf_conformance.suite.item_runner import LEFT, STARTED, ItemRunner, new_session
from eurdf_conformance.suite.options import OPTIONS, add_options, options_of, read_options
from eurdf_conformance.suite.summary import summary_lines
from eurdf_conformance.suite.untouched import snapshot, void_text
from eurdf_conformance.visible import visible

#: Keys in the input of a worker: the seed of the run, which it may have drawn itself, and the fresh cases.
_SEED, _FRESH = "eurdf_conformance.seed", "eurdf_conformance.fresh"

#: The session whose parser has started before anything is asked of it.
GREETED: pytest.StashKey[Session] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of the suite."""
    add_options(parser)


def pytest_configure(config: pytest.Config) -> None:
    """Read the options; in the main process, collect the results."""
    worker = getattr(config, "workerinput", None)
    if worker is not None:
        config.option.seed = worker[_SEED]
    config.stash[OPTIONS] = read_options(config)
    if worker is not None and _FRESH in worker:
        keep_drawn(config.stash[OPTIONS].seed, worker[_FRESH])
    if worker is None:
        config.pluginmanager.register(Collector(config), "eurdf_conformance.collector")


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Let all workers of pytest-xdist use the same seed, and the same fresh cases, drawn once."""
    options = options_of(node.config)
    node.workerinput[_SEED] = options.seed
    if not options.smoke:
        node.workerinput[_FRESH] = drawn_text(options.seed)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Let one worker judge all levels of a case, which is then loaded once, and one worker all rules of the protocol.

    Of pytest-xdist's own ``--dist`` only `loadgroup` is replaced: 3.8 sees no groups with pytest 9.2
    (https://github.com/pytest-dev/pytest-xdist/issues/1386).
    """
    if config.getvalue("dist") != "loadgroup":
        return None
    from xdist.scheduler import LoadScopeScheduling

    smoke = options_of(config).smoke

    class ByCase(LoadScopeScheduling):  # type: ignore[misc]
        def _split_scope(self, nodeid: str) -> str:
            return "" if smoke else group_of(nodeid)

    return ByCase(config, log)


def group_of(nodeid: str) -> str:
    """The group of items that one worker runs: those of a case, all protocol rules, or a single item."""
    file, _, name = nodeid.partition("::")
    if file.endswith("test_protocol.py"):
        return file
    return nodeid.rpartition("/")[0] if name.startswith(("test_case[", "test_fresh[")) else nodeid


def pytest_itemcollected(item: pytest.Item) -> None:
    """Let ``-k EU-CLO-003`` select the items that test a clause."""
    callspec = getattr(item, "callspec", None)
    for value in callspec.params.values() if callspec else ():
        if isinstance(found := getattr(value, "item", None), Item):
            item.extra_keyword_matches.update(found.clauses)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the protocol rules first, then all else in an order that the seed decides; levels of a case stay together."""
    options = options_of(config)
    groups: dict[str, list[pytest.Item]] = {}
    for item in items:
        if not item.name.endswith("[NOTSET]"):
            groups.setdefault(group_of(item.nodeid), []).append(item)
    names = list(groups) if options.smoke else Chance(options.seed).shuffled(groups)
    names.sort(key=lambda name: not name.endswith("test_protocol.py"))
    items[:] = [item for name in names for item in groups[name]]


def pytest_sessionstart(session: pytest.Session) -> None:
    """Report once, before the run, what makes it useless; a smoke run reports this in its own way."""
    options, said = options_of(session.config), session.config.option
    if hasattr(session.config, "workerinput") or said.collectonly:
        return
    if options.explore and not os.access(Path.cwd(), os.W_OK):
        raise pytest.UsageError("--explore writes cases into explored/, but this folder is not writable")
    try:
        if options.certificate is not None:
            make_room(options.certificate)
        if not (options.smoke or said.parser_starts):
            # Without workers, this process starts the parser itself.
            session.config.stash[GREETED] = greeted = new_session(options)
            _ = greeted.started
            if session.config.getoption("dist", "no") != "no":
                greeted.stop()
    except NoRoom as reason:
        raise pytest.UsageError(str(reason)) from None
    except NotStarted as refusal:
        raise pytest.UsageError(visible(f"'{options.parser}' could not be started: {refusal}")) from None


def pytest_collection_finish() -> None:
    """Exclude the collected items, which live to the end, from garbage collection: this saves time."""
    gc.freeze()


@pytest.fixture(scope="session")
def _session_item_runner(pytestconfig: pytest.Config, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ItemRunner]:
    options = options_of(pytestconfig)
    # pytest keeps the files of its last runs there, so that the files of a failed case can be opened.
    keep_files_in(tmp_path_factory.mktemp("cases", numbered=False))
    with pytestconfig.stash.get(GREETED, None) or new_session(options) as session:
        yield (item_runner := ItemRunner(options, session))
    item_runner.keep_left()


def pytest_unconfigure(config: pytest.Config) -> None:
    """Stop the parser if it was started but not used."""
    if (session := config.stash.get(GREETED, None)) is not None:
        session.stop()


@pytest.fixture
def item_runner(_session_item_runner: ItemRunner, request: pytest.FixtureRequest) -> ItemRunner:
    """The parser, for the running test."""
    _session_item_runner.node = request.node
    return _session_item_runner


class Collector:
    """Collects the results of all workers."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._started: Started | None = None
        self._results: list[Result] = []
        self._unexpected: list[str] = []
        self._left: list[str] = []
        self._before = snapshot()
        self._void: str | None = None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Take a result out of a report."""
        # The parser of a worker ends after its last item.
        for name, value in report.user_properties if report.when == "teardown" else ():
            if name == LEFT:
                assert isinstance(value, list)
                self._left += value
        for name, value in report.user_properties if report.when == "call" else ():
            if name == RESULT:
                assert isinstance(value, dict)
                self._results.append(Result.from_json(value))
            elif name == STARTED and self._started is None:
                self._started = Started.model_validate(value, strict=False)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session, exitstatus: int) -> None:
        """Write the certificate; fail the run if the results differ from the known failures."""
        if not self._results and self._started is None:
            return
        if (void := void_text(self._before)) is not None:
            self._void, session.exitstatus = void, pytest.ExitCode.TESTS_FAILED
            return
        run = self.run()
        self._unexpected = run.known_failures.unexpected(run.results, run.planned)
        # A run that tested none of the requested levels has failed.
        if (self._unexpected or unclaimed(run)) and exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
        # An interrupted run writes no certificate and leaves an existing one alone.
        broke_off = exitstatus in (pytest.ExitCode.INTERRUPTED, pytest.ExitCode.INTERNAL_ERROR)
        if (run_folder := options_of(self._config).certificate) and not broke_off:
            options = options_of(self._config)
            fresh = None if options.smoke else drawn_hash(options.seed)
            write_certificate(run_folder, issue(replace(run, fresh=fresh)))

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print the summary."""
        if not self._results and self._started is None:
            return
        terminalreporter.section("conformance to Extended URDF")
        if self._void is not None:
            terminalreporter.line(visible(self._void, kept=""))
            return
        for line in summary_lines(self.run(), self._unexpected, options_of(self._config).certificate):
            terminalreporter.line(line)

    def run(self) -> Run:
        """The run, from the results collected so far."""
        options = options_of(self._config)
        return Run(
            parser=options.parser,
            started=self._started,
            planned=tuple(planned_items(all_cases())),
            results=tuple(self._results),
            levels=options.levels,
            versions=options.versions,
            smoke=options.smoke,
            explore=options.explore,
            seed=options.seed,
            known_failures=options.known,
            left=tuple(self._left),
        )
