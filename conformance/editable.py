"""Lets an editable install of the repository offer the command of the suite, as an installed suite does."""

import tomllib
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class EntryPoints(BuildHookInterface):  # type: ignore[misc]
    """Adds the entry points of ``conformance/pyproject.toml`` to an editable install, and to nothing else."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add them before the metadata are written."""
        if version == "editable":
            suite = tomllib.loads(Path(self.root, "conformance", "pyproject.toml").read_text(encoding="utf-8"))
            self.metadata.core.entry_points.update(suite["project"]["entry-points"])
