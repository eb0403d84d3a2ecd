"""Options of the tests, how they are spread over processes, and the summary of skipped tests."""

from __future__ import annotations

import gc
import os
import tempfile
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from support.shared_runs import SharedRun, certify_once
from support.warm import SESSION

#: Files whose tests are run by one worker, since they share something that takes long to make.
TOGETHER = ("test_site.py", "test_site_in_browser.py", "test_editor.py", "test_explore.py", "test_examples.py")

#: Files with the longest tests. They are started first, so that no worker is left with one at the end.
FIRST = (
    "test_certify.py",
    "test_site.py",
    "test_site_in_browser.py",
    "test_editor.py",
    "test_write_an_adapter.py",
    "test_explore.py",
    "test_random_mechanisms.py",
    "test_suite.py",
    "test_workspace.py",
    "test_bad_input.py",
    "test_examples.py",
    "test_schema.py",
)

# Random examples are the same in each run. `--hypothesis-profile=random` draws others. Time decides no test.
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("random", derandomize=False, deadline=None)
settings.load_profile("same")


def pytest_configure(config: pytest.Config) -> None:
    # Here, and not where pytest is configured: the conformance suite runs with whatever plug-ins its users have.
    config.addinivalue_line("filterwarnings", "error")
    # The matrices are small, and there is a worker for each processor: more threads would only slow each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if hasattr(config, "workerinput"):
        return
    session = tempfile.TemporaryDirectory(prefix="eurdf-tests-")
    config.add_cleanup(session.cleanup)
    os.environ[SESSION] = session.name
    if os.environ.get("PYTHONDONTWRITEBYTECODE"):
        # Tests start the package in some hundred processes, and each would compile it: keep what is compiled elsewhere.
        compiled = tempfile.TemporaryDirectory(prefix="eurdf-tests-")
        config.add_cleanup(compiled.cleanup)
        del os.environ["PYTHONDONTWRITEBYTECODE"]
        os.environ["PYTHONPYCACHEPREFIX"] = compiled.name


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("damaged robots")
    group.addoption("--mutations", type=int, default=1300, metavar="N", help="damaged robots to try (default: 1300)")
    group.addoption(
        "--mutation-seed", type=int, default=0, metavar="SEED", help="from which they are drawn (default: 0)"
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    last = len(FIRST)
    items.sort(key=lambda item: FIRST.index(item.path.name) if item.path.name in FIRST else last)


@pytest.fixture(scope="session")
def shared_run(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., SharedRun]:
    """``eurdf certify`` with some arguments, run once a session."""
    base = tmp_path_factory.getbasetemp()
    return partial(certify_once, base.parent if "PYTEST_XDIST_WORKER" in os.environ else base)


def pytest_collection_finish() -> None:
    """What was collected stays to the end: the garbage collector need not look through it again and again."""
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Spread tests one by one, but those of `TOGETHER` by file.

    The mark ``xdist_group`` would say so beside the tests, but pytest-xdist 3.8 does not see it with pytest 9.2
    (https://github.com/pytest-dev/pytest-xdist/issues/1386).
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):  # type: ignore[misc]
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.partition("::")[0]
            return file if Path(file).name in TOGETHER else nodeid

    return ByFile(config, log) if config.getvalue("dist") == "loadgroup" else None


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print how many tests were skipped, why, and how to run them."""
    reasons = Counter[str]()
    for report in terminalreporter.stats.get("skipped", ()):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        reasons[reason.removeprefix("Skipped: ")] += 1
    if reasons:
        terminalreporter.section("tests that were skipped")
    for reason, count in reasons.most_common():
        terminalreporter.line(f"{count} skipped: {reason}")
