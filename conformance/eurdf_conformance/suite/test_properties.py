"""Every property, for each version at the level that the reader claims."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf_conformance.suite.asking import Asking
from eurdf_conformance.suite.item import PropertyItem, property_items
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
    item = property_item.item
    trial = Trial(asking.session, item.version, asking.options.explore, tmp_path)
    asking.settle(item, lambda: property_item.property.check(trial))
