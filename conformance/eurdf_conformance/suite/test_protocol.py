"""The rules of the protocol, before anything else."""

from __future__ import annotations

import pytest

from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.judge import Judgement
from eurdf_conformance.suite.item import ProtocolItem, protocol_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import options_of
from eurdf_conformance.suite.protocol_check import Setup, check
from eurdf_conformance.suite.smoke import SMOKE, smoke_case


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a rule and version."""
    options = options_of(metafunc.config)
    items = [item for item in protocol_items() if options.wants(item.item)]
    metafunc.parametrize(
        "protocol_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items]
    )


def test_protocol(protocol_item: ProtocolItem, item_runner: ItemRunner) -> None:
    """The parser follows the rule."""
    item, three = protocol_item.item, SMOKE[protocol_item.item.version]
    valid, invalid = (smoke_case(all_cases(), case_id) for case_id in (three.valid, three.invalid))
    conversation = item_runner.conversation

    def ask() -> Judgement:
        setup = Setup(
            item_runner.session, item_runner.new_session, valid, invalid, conversation.handout, conversation.lacks
        )
        return check(protocol_item.rule, setup)

    item_runner.run(item, ask)
