"""Every property, for each version at the level that the parser claims."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf_conformance.fresh.case import fresh_examples
from eurdf_conformance.judging.judge import Judgement
from eurdf_conformance.properties.explore import Trial, try_property
from eurdf_conformance.suite.item import PropertyItem, property_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import options_of


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test for each property and version; none in a smoke run."""
    options = options_of(metafunc.config)
    items = [] if options.smoke else [item for item in property_items() if options.wants(item.item)]
    metafunc.parametrize(
        "property_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items]
    )


def test_property(
    property_item: PropertyItem, item_runner: ItemRunner, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """The parser satisfies the property."""
    folder = tmp_path_factory.mktemp("files")  # its name says nothing of the property
    item_runner.run(property_item.item, lambda: try_item(property_item, item_runner, folder), folder=folder)


def try_item(item: PropertyItem, item_runner: ItemRunner, folder: Path) -> Judgement:
    """Try the property on the frozen and the fresh examples, and on further random mechanisms if requested."""
    level, version, options = item.item.level, item.item.version, item_runner.options
    lacks = item_runner.conversation.lacks
    fresh = fresh_examples(options.seed, version)
    if not options.explore:
        trial = Trial(item_runner.session, version, 0, folder, options.seed, fresh, lacks)
        return try_property(item.property, level, trial)
    # Shrinking repeats requests that crash the parser, so it uses a session of its own.
    with item_runner.new_session() as session:
        trial = Trial(session, version, options.explore, folder, options.seed, fresh, lacks)
        judgement = try_property(item.property, level, trial)
    item_runner.session.seconds_in_parser += session.seconds_in_parser
    item_runner.session.left += session.left
    return judgement
