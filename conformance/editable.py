"""Lets an editable install of the repository offer the command of the suite, as an installed suite does."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.core import load_toml


class EntryPoints(BuildHookInterface):  # type: ignore[misc]
    """Adds the entry points of ``conformance/pyproject.toml`` to an editable install, and to nothing else."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add them before the metadata are written."""
        if version == "editable":
            suite = load_toml(str(Path(self.root, "conformance", "pyproject.toml")))
            self.metadata.core.entry_points.update(suite["project"]["entry-points"])
