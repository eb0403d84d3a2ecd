"""Asks one parser about each item, reports the results to pytest and keeps them for the certificate."""

from __future__ import annotations

import re
import time
import traceback
from collections.abc import Callable, Collection
from pathlib import Path

import pytest

from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.failure_text import failure_text
from eurdf_conformance.judging.judge import Judgement
from eurdf_conformance.judging.result import RESULT, Item, Result
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Started
from eurdf_conformance.runner.session import NotStarted, Session
from eurdf_conformance.suite.options import Options
from eurdf_conformance.visible import visible

#: Name of the user property of a pytest report that holds what the parser reported about itself.
STARTED = "eurdf_conformance.started"

#: Name of the user property of a pytest report that holds what processes the parser left behind.
LEFT = "eurdf_conformance.left"

#: Number of differences of one item kept for the certificate.
_KEPT = 20


class ItemRunner:
    """Runs items on one parser.

    Attributes:
        options: The options of the user.
        conversation: The conversation with the parser about cases.
        node: The running test.
    """

    def __init__(self, options: Options, session: Session) -> None:
        self.options = options
        self.conversation = Conversation(session)
        self.node: pytest.Item | None = None
        self._session = session

    @property
    def session(self) -> Session:
        """The parser, for requests that are not about cases."""
        self.conversation.forget()
        return self._session

    def new_session(self) -> Session:
        """A further session with the parser."""
        return new_session(self.options)

    def run(
        self,
        item: Item,
        ask: Callable[[], Judgement],
        case: CorpusCase | None = None,
        rather: Collection[Level] = (),
        folder: Path | None = None,
    ) -> None:
        """Run an item, keep its result, and fail the running test unless the item passed.

        An item of a level that the parser does not claim is skipped.

        Args:
            item: The item.
            ask: Runs it and returns the judgement.
            case: Its case, if any.
            rather: Levels that replace this one; if the parser claims one of them, the item is skipped.
            folder: The folder of files for the parser other than those of a case.
        """
        started = self._started()
        if started is not None:
            self.conversation.lacks = frozenset(started.lacks)
        claimed = tuple(Level) if started is None else started.claims.get(item.version, ())
        if started is not None and item.level not in claimed:
            name = visible(started.parser.name, kept="")
            pytest.skip(f"{name} does not claim level {item.level} for version {item.version}")
        if asked := next((level for level in rather if level in claimed), None):
            pytest.skip(f"tested at level {asked}")
        begin, before = time.perf_counter(), self._session.seconds_in_parser
        try:
            judgement = ask()
        except Exception as error:
            # An exception here is an error in the suite, but the item has not passed either.
            why = f"an error in the suite itself, please report it: {type(error).__name__}: {error}"
            judgement = Judgement(Verdict.FAILED, why, log=traceback.format_exc())
        seconds, in_parser = time.perf_counter() - begin, self._session.seconds_in_parser - before
        reproduce = self.options.reproduce(item)
        texts = tuple(filter(None, (judgement.reason, *map(str, judgement.differences[:_KEPT]))))
        for given in filter(None, (self.conversation.handout.folder, folder)):
            # Its name differs from run to run.
            texts = tuple(re.sub(re.escape(str(given)) + "(/[0-9a-f]{16})?", item.id, text) for text in texts)
        result = Result(item, judgement.verdict, texts, reproduce, judgement.log, seconds, in_parser)
        self._keep(RESULT, result.to_json())
        self.keep_left()
        self._tell(result, judgement, case)

    def keep_left(self) -> None:
        """Keep with the test that runs, or ran last, what processes the parser has left behind since."""
        if self._session.left and self.node is not None:
            self._keep(LEFT, self._session.left)
            self._session.left = []

    def _tell(self, result: Result, judgement: Judgement, case: CorpusCase | None) -> None:
        known = self.options.known.of(result.item)
        if known is not None and known == result.verdict:
            pytest.xfail(f"listed as '{known}' in the known failures")
        if known is not None and result.verdict == Verdict.PASSED:
            pytest.fail(f"listed as '{known}' but passes; remove it from the known failures", pytrace=False)
        if result.verdict == Verdict.EXCUSED:
            pytest.skip(f"excused: {judgement.reason}")
        if result.verdict != Verdict.PASSED:
            text = failure_text(result.item, judgement, result.reproduce, case)
            pytest.fail(text + (f"\n  listed as '{known}' in the known failures" if known else ""), pytrace=False)

    def _started(self) -> Started | None:
        """What the parser reports about itself; None if it does not start. Every item then reports why."""
        try:
            started = self._session.started
        except NotStarted:
            return None
        self._keep(STARTED, started.model_dump(mode="json"))
        return started

    def _keep(self, name: str, value: object) -> None:
        assert self.node is not None
        self.node.user_properties.append((name, value))


def new_session(options: Options) -> Session:
    """A session with the parser that is tested."""
    return Session(options.parser, timeout=options.timeout, start_timeout=options.start_timeout)
