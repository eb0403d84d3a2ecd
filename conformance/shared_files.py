"""Puts files of the repository into the distributions of the suite."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def shared(repository: Path) -> Iterator[tuple[Path, str]]:
    """Files, and where they are in a distribution."""
    yield repository / "LICENSE", "eurdf_conformance/LICENSE"
    yield repository / "spec/clauses.json", "eurdf_conformance/spec/clauses.json"
    for schema in sorted((repository / "schema").glob("extended-urdf-*.schema.json")):
        yield schema, f"eurdf_conformance/schema/{schema.name}"


class SharedFiles(BuildHookInterface):  # type: ignore[misc]
    """Adds them; in a source distribution they are in their places, from which a wheel takes them."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add them before the distribution is written."""
        for source, target in shared(Path(self.root).parent):
            if not Path(self.root, target).exists():
                build_data["force_include"][str(source)] = target
