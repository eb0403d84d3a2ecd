"""A plug-in of pytest for the project's own tests: options, processes, runs that tests share, what was skipped."""

from __future__ import annotations

import fcntl
import gc
import hashlib
import json
import os
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from support.warm import SESSION, run_module

#: Files whose tests are run by one worker, since they share something that takes long to make.
TOGETHER = ("test_site.py", "test_site_in_browser.py", "test_editor.py", "test_explore.py", "test_examples.py")

#: Files with the longest tests. They are started first, so that no worker is left with one at the end.
FIRST = (
    "test_certify.py",
    "test_site.py",
    "test_site_in_browser.py",
    "test_editor.py",
    "test_pages.py",
    "test_explore.py",
    "test_oracle_reference.py",
    "test_suite.py",
    "test_reading.py",
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


@dataclass(frozen=True)
class SharedRun:
    """A run of ``eurdf certify`` that has ended."""

    returncode: int
    stdout: str
    stderr: str
    #: The folder with its certificate: not to be written to.
    certificate: str


def certify_once(session: Path, *argv: str) -> SharedRun:
    """Run ``eurdf certify`` with some arguments, unless that was done in this session.

    Args:
        session: A folder that all workers of the session share.
        argv: The arguments.
    """
    folder = session / f"certify-{hashlib.sha256(json.dumps(argv).encode()).hexdigest()[:16]}"
    folder.mkdir(exist_ok=True)
    done = folder / "run.json"
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            certificate = str(folder / "certificate")
            ended = run_module("eurdf", ["certify", *argv, "--certificate", certificate], cwd=folder)
            made = SharedRun(ended.returncode, ended.stdout, ended.stderr, certificate)
            done.write_text(json.dumps(asdict(made)), encoding="utf-8")
    return SharedRun(**json.loads(done.read_text(encoding="utf-8")))


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
