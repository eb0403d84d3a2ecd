"""Every property, for each version at the level that the reader claims."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf_conformance.suite.asking import Asking
from eurdf_conformance.suite.item import PropertyItem, property_items
from eurdf_conformance.suite.judge import Judgement
from eurdf_conformance.suite.options import options_of
from eurdf_conformance.suite.property import Trial


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a property and version; three cases tried out have none."""
    options = options_of(metafunc.config)
    items = [] if options.smoke else [item for item in property_items() if options.wants(item.item)]
    metafunc.parametrize(
        "property_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items]
    )


def test_property(property_item: PropertyItem, asking: Asking, tmp_path: Path) -> None:
    """The property holds of the reader."""
    asking.settle(property_item.item, lambda: ask(property_item, asking, tmp_path))


def ask(item: PropertyItem, asking: Asking, folder: Path) -> Judgement:
    """Try the property on the frozen examples, and on as many more as the user asks for."""
    version, count = item.item.version, asking.options.explore
    if not count:
        return item.property.check(Trial(asking.session, version, 0, folder))
    # What crashes a reader is tried again and again, to make it small: the session of all items has no part in that.
    with asking.new_session() as session:
        judgement = item.property.check(Trial(session, version, count, folder, asking.options.explore_seed))
    asking.session.seconds_in_reader += session.seconds_in_reader
    return judgement
