"""An example of a property: a mechanism and its variation."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.mechanism import Mechanism, Part

#: The examples of every certification: the same on every machine and with every version of Hypothesis.
FROZEN = Path(__file__).with_name("frozen.json")


class Example(Part):
    """A mechanism and its variation.

    Attributes:
        mechanism: Of version 1, one that both versions can say.
        seed: Of the choices of those properties that compare it with a variant.
        known: Its nv, nc, rank, mobility, redundant rows and uncontrolled mobility, where they are known beforehand.
    """

    mechanism: Mechanism
    seed: int = 0
    known: tuple[int, int, int, int, int, int] | None = None

    @property
    def chance(self) -> Chance:
        """The random choices, from the first one."""
        return Chance(self.seed)


@cache
def frozen_examples(version: Version) -> tuple[Example, ...]:
    """The examples of every certification, of one version of the format."""
    found = json.loads(FROZEN.read_text(encoding="utf-8"))
    return tuple(Example.model_validate_json(json.dumps(each)) for each in found[version])


def frozen_text(examples: Mapping[Version, Iterable[Example]]) -> str:
    """The file of the examples: one a line."""
    parts = []
    for version in VERSIONS:
        lines = [json.dumps(_compact(example), ensure_ascii=False) for example in examples[version]]
        parts.append(f'"{version}": [\n' + ",\n".join(lines) + "\n]")
    return "{" + ",\n".join(parts) + "}\n"


def _compact(example: Example) -> object:
    return example.model_dump(mode="json", exclude_defaults=True)
